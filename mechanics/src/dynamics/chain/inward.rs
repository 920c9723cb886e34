//! The sweep from the tip to the base: forces and composite inertias.

use super::link::{Link, Twist};
use super::pose::{ANY, PARALLEL, Pose, RIGHT, Wrench, splat};
use crate::lanes::Lane;
use crate::spatial::{Three, sum};

/// First and second moments of what a link carries, kg·m and kg·m².
#[derive(Clone, Copy, Debug)]
pub struct Moments<V> {
    pub(super) first: Three<V>,
    /// xx, xy, xz, yy, yz, zz.
    pub(super) second: [V; 6],
}

/// What the sweep carries from frame to frame.
#[derive(Clone, Copy, Debug)]
pub struct Inward<V> {
    /// What the motion of all links from here on needs.
    wrench: Wrench<V>,
    /// Moments of all of them, as if held together.
    carried: Moments<V>,
}

/// Rotates the plane (a, b; b, d) of a symmetric matrix.
#[inline(always)]
fn turn<V: Lane>(sin: V, cos: V, a: V, b: V, d: V) -> (V, V, V) {
    let w = cos * (a - d) - sin * (b + b);
    (d + cos * w, b + sin * w, a - cos * w)
}

impl<V: Lane> Moments<V> {
    /// Of one link, for as many runs as `one` is of.
    #[inline(always)]
    pub fn of(one: V, link: &Link) -> Self {
        let s = &link.second;
        Self {
            first: splat(one, &link.first),
            second: [
                one.splat(s[0]),
                one.splat(s[1]),
                one.splat(s[2]),
                one.splat(s[3]),
                one.splat(s[4]),
                one.splat(s[5]),
            ],
        }
    }

    /// About the link's origin, about the origin of the frame before and in its axes, added to `to`.
    #[inline(always)]
    fn gather<const TWIST: u8>(&self, link: &Link, pose: &Pose<V>, to: &mut Self) {
        let [xx, xy, xz, yy, yz, zz] = self.second;
        let (xx, xy, yy) = turn(pose.sin, pose.cos, xx, xy, yy);
        let (xz, yz) = (pose.cos * xz - pose.sin * yz, pose.sin * xz + pose.cos * yz);
        let [xy, xz, yy, yz, zz] = match TWIST {
            PARALLEL => [xy, xz, yy, yz, zz],
            RIGHT => [-xz, xy, zz, -yz, yy],
            _ => {
                let (sa, ca) = (pose.sin.splat(link.sin), pose.sin.splat(link.cos));
                let (yy, yz, zz) = turn(sa, ca, yy, yz, zz);
                [ca * xy - sa * xz, sa * xy + ca * xz, yy, yz, zz]
            }
        };
        let mut first = pose.inward::<TWIST>(link, &self.first);
        let mut second = [xx, xy, xz, yy, yz, zz];
        if !link.meets {
            let p = pose.origin;
            let mut k = first;
            if link.outboard != 0.0 {
                let (mass, half) = (pose.sin.splat(link.outboard), pose.sin.splat(0.5 * link.outboard));
                for j in 0..3 {
                    k[j] = first[j] + half * p[j];
                    first[j] = first[j] + mass * p[j];
                }
            }
            let two = pose.sin.splat(2.0);
            second[0] = xx + two * k[0] * p[0];
            second[1] = xy + (k[0] * p[1] + k[1] * p[0]);
            second[3] = yy + two * k[1] * p[1];
            if TWIST == ANY {
                second[2] = xz + (k[0] * p[2] + k[2] * p[0]);
                second[4] = yz + (k[1] * p[2] + k[2] * p[1]);
                second[5] = zz + two * k[2] * p[2];
            } else {
                second[2] = xz + k[2] * p[0];
                second[4] = yz + k[2] * p[1];
            }
        }
        for j in 0..6 {
            to.second[j] = to.second[j] + second[j];
        }
        for j in 0..3 {
            to.first[j] = to.first[j] + first[j];
        }
    }
}

impl<V: Lane> Inward<V> {
    /// At the last link, before its wrench is taken.
    #[inline(always)]
    pub fn begin(one: V, last: &Link) -> Self {
        let none = [one.splat(0.0); 3];
        Self { wrench: (none, none), carried: Moments::of(one, last) }
    }

    /// Takes what the motion of the link here needs.
    #[inline(always)]
    pub fn take(&mut self, (n, f): &Wrench<V>) {
        self.wrench = (sum(&self.wrench.0, n), sum(&self.wrench.1, f));
    }

    /// What its joint takes of it.
    #[inline(always)]
    pub fn effort(&self, link: &Link) -> V {
        link.along(&self.wrench)
    }

    /// The wrench that accelerates the joint of this link alone, `I^C S`.
    #[inline(always)]
    pub fn column(&self, link: &Link) -> Wrench<V> {
        let (h, s) = (&self.carried.first, &self.carried.second);
        let zero = h[0].splat(0.0);
        if link.prismatic {
            ([h[1], -h[0], zero], [zero, zero, zero.splat(link.outboard)])
        } else {
            ([-s[2], -s[4], s[0] + s[3]], [-h[1], h[0], zero])
        }
    }

    /// Goes on to the link before, with `columns` of this link and all after it.
    #[inline(always)]
    pub fn next(&mut self, link: &Link, pose: &Pose<V>, before: &Link, columns: &mut [Wrench<V>]) {
        match link.twist {
            Twist::Any => self.step::<ANY>(link, pose, before, columns),
            Twist::Parallel => self.step::<PARALLEL>(link, pose, before, columns),
            Twist::Right => self.step::<RIGHT>(link, pose, before, columns),
        }
    }

    #[inline(always)]
    fn step<const TWIST: u8>(&mut self, link: &Link, pose: &Pose<V>, before: &Link, columns: &mut [Wrench<V>]) {
        self.wrench = pose.carry::<TWIST>(link, &self.wrench);
        for column in columns {
            *column = pose.carry::<TWIST>(link, column);
        }
        let mut next = Moments::of(pose.sin, before);
        self.carried.gather::<TWIST>(link, pose, &mut next);
        self.carried = next;
    }
}
