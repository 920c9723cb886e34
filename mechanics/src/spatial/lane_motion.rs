//! Motions, forces and placements in lanes: what [`Motion`], [`Force`](super::Force) and [`Placement`](super::Placement) are for one
//! sample, for several at once.

use super::vectors::Motion;
use crate::lanes::Lane;

/// A vector of each of several samples.
pub type Three<V> = [V; 3];

/// `a × b`.
#[inline(always)]
pub fn cross<V: Lane>(a: &Three<V>, b: &Three<V>) -> Three<V> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `a + b`.
#[inline(always)]
pub fn sum<V: Lane>(a: &Three<V>, b: &Three<V>) -> Three<V> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `a · b`.
#[inline(always)]
fn dot<V: Lane>(a: &Three<V>, b: &Three<V>) -> V {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A spatial motion `(ω, v)` of each of several samples.
#[derive(Clone, Copy, Debug)]
pub struct LaneMotion<V> {
    /// Angular part.
    pub ang: Three<V>,
    /// Linear part, of the point at the frame's origin.
    pub lin: Three<V>,
}

/// A spatial force `(n, f)` of each of several samples.
#[derive(Clone, Copy, Debug)]
pub struct LaneForce<V> {
    /// Moment about the frame's origin.
    pub ang: Three<V>,
    /// Force.
    pub lin: Three<V>,
}

/// The pose of a child frame in its parent, of each of several samples: `x_parent = R x_child + p`.
#[derive(Clone, Copy, Debug)]
pub struct LanePlacement<V> {
    /// Columns of `R`: the child's axes seen from the parent.
    pub axes: [Three<V>; 3],
    /// Position of the child's origin in the parent, m.
    pub origin: Three<V>,
}

/// What motions and forces have in common.
macro_rules! six_numbers {
    ($name:ident) => {
        impl<V: Lane> $name<V> {
            /// `self + other`.
            #[inline(always)]
            #[must_use]
            pub fn plus(&self, other: &Self) -> Self {
                Self { ang: sum(&self.ang, &other.ang), lin: sum(&self.lin, &other.lin) }
            }

            /// Every number times the sample's factor.
            #[inline(always)]
            #[must_use]
            pub fn times(&self, factor: V) -> Self {
                let ([x, y, z], [u, v, w]) = (self.ang, self.lin);
                Self { ang: [x * factor, y * factor, z * factor], lin: [u * factor, v * factor, w * factor] }
            }
        }
    };
}

six_numbers!(LaneMotion);
six_numbers!(LaneForce);

impl<V: Lane> LaneMotion<V> {
    /// One motion for all samples; `one` says how many there are.
    #[inline(always)]
    pub fn splat(one: V, motion: &Motion) -> Self {
        let Motion { ang, lin } = motion;
        Self {
            ang: [one.splat(ang.x), one.splat(ang.y), one.splat(ang.z)],
            lin: [one.splat(lin.x), one.splat(lin.y), one.splat(lin.z)],
        }
    }

    /// `self × other`, as [`Motion::cross`].
    #[inline(always)]
    #[must_use]
    pub fn cross(&self, other: &Self) -> Self {
        let lin = sum(&cross(&self.ang, &other.lin), &cross(&self.lin, &other.ang));
        Self { ang: cross(&self.ang, &other.ang), lin }
    }

    /// `self ×* force`, as [`Motion::cross_force`].
    #[inline(always)]
    pub fn cross_force(&self, force: &LaneForce<V>) -> LaneForce<V> {
        let ang = sum(&cross(&self.ang, &force.ang), &cross(&self.lin, &force.lin));
        LaneForce { ang, lin: cross(&self.ang, &force.lin) }
    }

    /// Power of a force along this motion: `ω·n + v·f`.
    #[inline(always)]
    pub fn dot(&self, force: &LaneForce<V>) -> V {
        dot(&self.ang, &force.ang) + dot(&self.lin, &force.lin)
    }
}

impl<V: Lane> LaneForce<V> {
    /// None.
    #[inline(always)]
    pub fn zero(zero: V) -> Self {
        Self { ang: [zero; 3], lin: [zero; 3] }
    }
}

impl<V: Lane> LanePlacement<V> {
    /// A motion given in the parent, expressed in the child: `ω' = Rᵀω`, `v' = Rᵀ(v + ω × p)`.
    #[inline(always)]
    pub fn motion_to_child(&self, motion: &LaneMotion<V>) -> LaneMotion<V> {
        let lin = sum(&motion.lin, &cross(&motion.ang, &self.origin));
        LaneMotion { ang: self.turned(&motion.ang), lin: self.turned(&lin) }
    }

    /// A force given in the child, expressed in the parent: `f' = R f`, `n' = R n + p × f'`.
    #[inline(always)]
    pub fn force_to_parent(&self, force: &LaneForce<V>) -> LaneForce<V> {
        let lin = self.turned_back(&force.lin);
        LaneForce { ang: sum(&self.turned_back(&force.ang), &cross(&self.origin, &lin)), lin }
    }

    /// `R x`.
    #[inline(always)]
    fn turned_back(&self, x: &Three<V>) -> Three<V> {
        let [a, b, c] = &self.axes;
        [
            a[0] * x[0] + b[0] * x[1] + c[0] * x[2],
            a[1] * x[0] + b[1] * x[1] + c[1] * x[2],
            a[2] * x[0] + b[2] * x[1] + c[2] * x[2],
        ]
    }

    /// `Rᵀ x`.
    #[inline(always)]
    fn turned(&self, x: &Three<V>) -> Three<V> {
        let [a, b, c] = &self.axes;
        [dot(a, x), dot(b, x), dot(c, x)]
    }
}

impl From<&Motion> for LaneMotion<f64> {
    #[inline]
    fn from(motion: &Motion) -> Self {
        Self { ang: motion.ang.into(), lin: motion.lin.into() }
    }
}

impl From<LaneMotion<f64>> for Motion {
    #[inline]
    fn from(motion: LaneMotion<f64>) -> Self {
        Self { ang: motion.ang.into(), lin: motion.lin.into() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spatial::{Force, Placement};
    use nalgebra::Vector3;

    #[test]
    fn identity_one_lane_is_the_motion_itself() {
        let a = Motion::new(Vector3::new(0.3, -1.0, 2.0), Vector3::new(0.7, 0.1, -0.4));
        let b = Motion::new(Vector3::new(-0.2, 0.5, 1.1), Vector3::new(1.3, -0.6, 0.2));
        let (s, c) = libm::sincos(0.4);
        let placement = Placement::rotation_x(s, c).compose(&Placement::rotation_z(c, s));
        let placement = placement.compose(&Placement::translation(0.3, -0.2, 0.7));
        let axes = [0, 1, 2].map(|k| placement.rotation.column(k).into_owned().into());
        let lanes = LanePlacement { axes, origin: placement.translation.into() };
        let same = |found: LaneMotion<f64>, expected: Motion| {
            let expected = LaneMotion::from(&expected);
            let pairs = found.ang.iter().chain(&found.lin).zip(expected.ang.iter().chain(&expected.lin));
            assert!(pairs.clone().all(|(x, y)| (x - y).abs() < 1e-15), "{found:?} {expected:?}");
        };
        let (wide_a, wide_b) = (LaneMotion::from(&a), LaneMotion::from(&b));
        same(wide_a.cross(&wide_b), a.cross(&b));
        same(wide_a.plus(&wide_b).times(0.5), (a + b) * 0.5);
        same(lanes.motion_to_child(&wide_a), placement.motion_to_child(&a));
        same(LaneMotion::splat(1.0, &a), a);
        // A force is what it does along motions.
        let (force, of) = (Force::new(b.lin, a.ang), |f: &Force| LaneForce { ang: f.ang.into(), lin: f.lin.into() });
        let wide = of(&force);
        let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-15, "{found} {expected}");
        near(wide_a.dot(&wide), a.dot(&force));
        near(wide_b.dot(&wide_a.cross_force(&wide)), b.dot(&a.cross_force(&force)));
        near(wide_b.dot(&lanes.force_to_parent(&wide.times(0.5))), b.dot(&placement.force_to_parent(&(force * 0.5))));
        near(wide_b.dot(&wide.plus(&wide)), b.dot(&(force + force)));
    }
}
