//! Where a link's frame stands, and vectors and forces seen from the frame before.

use super::link::{Link, Twist};
use crate::lanes::Lane;
use crate::spatial::{Three, cross, sum};

/// Values of [`Twist`] that a function is compiled for.
pub(in crate::dynamics) const ANY: u8 = 0;
pub(in crate::dynamics) const PARALLEL: u8 = 1;
pub(in crate::dynamics) const RIGHT: u8 = 2;

/// Moment about a frame's origin and force, N·m and N.
pub type Wrench<V> = (Three<V>, Three<V>);

/// Where a link's frame stands: sine and cosine of its turn about z, and its origin in the frame before.
#[derive(Clone, Copy, Debug)]
pub struct Pose<V> {
    /// Sine of the turn.
    pub sin: V,
    /// Its cosine.
    pub cos: V,
    /// m.
    pub origin: Three<V>,
}

#[inline(always)]
pub(super) fn splat<V: Lane>(one: V, a: &[f64; 3]) -> Three<V> {
    [one.splat(a[0]), one.splat(a[1]), one.splat(a[2])]
}

/// `p × f`, where `p` has no z but behind [`ANY`] twist.
#[inline(always)]
pub(super) fn arm<const TWIST: u8, V: Lane>(p: &Three<V>, f: &Three<V>) -> Three<V> {
    if TWIST == ANY { cross(p, f) } else { [p[1] * f[2], -(p[0] * f[2]), p[0] * f[1] - p[1] * f[0]] }
}

impl Link {
    /// Where the frame stands at coordinate `q`, whose angle has this sine and cosine.
    #[inline(always)]
    pub fn pose<V: Lane>(&self, q: V, (sin, cos): (V, V)) -> Pose<V> {
        let mut origin = splat(q, &self.origin);
        if self.prismatic {
            origin[1] = origin[1] - q.splat(self.sin) * q;
            origin[2] = origin[2] + q.splat(self.cos) * q;
        }
        Pose { sin, cos, origin }
    }

    /// What the joint takes of a wrench.
    #[inline(always)]
    pub fn along<V: Lane>(&self, (n, f): &Wrench<V>) -> V {
        if self.prismatic { f[2] } else { n[2] }
    }
}

impl<V: Lane> Pose<V> {
    /// Not turned, at the origin of the frame before.
    #[inline(always)]
    pub fn nowhere(zero: V) -> Self {
        Self { sin: zero, cos: zero.splat(1.0), origin: [zero; 3] }
    }

    /// A vector of the frame before, in the link's frame: `Rzᵀ Rxᵀ v`.
    #[inline(always)]
    pub(super) fn outward<const TWIST: u8>(&self, link: &Link, v: &Three<V>) -> Three<V> {
        let (y, z) = match TWIST {
            PARALLEL => (v[1], v[2]),
            RIGHT => (v[2], -v[1]),
            _ => {
                let (sa, ca) = (self.sin.splat(link.sin), self.sin.splat(link.cos));
                (ca * v[1] + sa * v[2], ca * v[2] - sa * v[1])
            }
        };
        [self.cos * v[0] + self.sin * y, self.cos * y - self.sin * v[0], z]
    }

    /// A vector of the link's frame, in the frame before: `Rx Rz v`.
    #[inline(always)]
    pub(in crate::dynamics) fn inward<const TWIST: u8>(&self, link: &Link, v: &Three<V>) -> Three<V> {
        let x = self.cos * v[0] - self.sin * v[1];
        let y = self.sin * v[0] + self.cos * v[1];
        match TWIST {
            PARALLEL => [x, y, v[2]],
            RIGHT => [x, -v[2], y],
            _ => {
                let (sa, ca) = (self.sin.splat(link.sin), self.sin.splat(link.cos));
                [x, ca * y - sa * v[2], sa * y + ca * v[2]]
            }
        }
    }

    /// A wrench about the link's origin, about the origin of the frame before and in its axes.
    #[inline(always)]
    pub(in crate::dynamics) fn carry<const TWIST: u8>(&self, link: &Link, (n, f): &Wrench<V>) -> Wrench<V> {
        let (n, f) = (self.inward::<TWIST>(link, n), self.inward::<TWIST>(link, f));
        (if link.meets { n } else { sum(&n, &arm::<TWIST, V>(&self.origin, &f)) }, f)
    }

    /// A wrench about the link's origin, about the origin of the frame before and in its axes.
    #[inline(always)]
    pub fn to_parent(&self, link: &Link, wrench: &Wrench<V>) -> Wrench<V> {
        match link.twist {
            Twist::Any => self.carry::<ANY>(link, wrench),
            Twist::Parallel => self.carry::<PARALLEL>(link, wrench),
            Twist::Right => self.carry::<RIGHT>(link, wrench),
        }
    }

    /// `Rzᵀ v`.
    #[inline(always)]
    pub(in crate::dynamics) fn turn_back(&self, v: &Three<V>) -> Three<V> {
        [self.cos * v[0] + self.sin * v[1], self.cos * v[1] - self.sin * v[0], v[2]]
    }

    /// A velocity or an acceleration (angular, linear) of the frame before, of the link's and in its axes, before the joint moves.
    #[inline(always)]
    pub(in crate::dynamics) fn moved<const TWIST: u8>(&self, link: &Link, (w, v): &Wrench<V>) -> Wrench<V> {
        let mut v = *v;
        if !link.meets {
            let arm = arm::<TWIST, V>(&self.origin, w);
            v = [v[0] - arm[0], v[1] - arm[1], v[2] - arm[2]];
        }
        (self.outward::<TWIST>(link, w), self.outward::<TWIST>(link, &v))
    }
}
