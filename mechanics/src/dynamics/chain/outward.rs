//! The sweep from the base to the tip: motions, and what they need.

use super::inward::Moments;
use super::link::{Link, Twist};
use super::pose::{ANY, PARALLEL, Pose, RIGHT, Wrench, splat};
use crate::lanes::Lane;
use crate::spatial::{Three, sum};

/// Motion of the link that the sweep has come to.
#[derive(Clone, Copy, Debug)]
pub struct Outward<V> {
    /// Angular velocity and acceleration, rad/s and rad/s².
    w: Three<V>,
    wd: Three<V>,
    /// Acceleration of the frame's origin, less gravity, m/s².
    a: Three<V>,
    /// `[ω̇]× + [ω]×²`.
    u: [Three<V>; 3],
}

impl<V: Lane> Outward<V> {
    /// The first link, behind a base that does not turn, at velocity `v` and acceleration `by` of its joint; and the effort that its own
    /// motion needs. `lift` is that of [`Links`](super::Links).
    #[inline(always)]
    pub fn first(link: &Link, pose: &Pose<V>, v: V, by: Option<V>, lift: &[f64; 3]) -> (Self, V) {
        let zero = v.splat(0.0);
        let none = [zero; 3];
        let mut a = pose.turn_back(&splat(v, lift));
        if link.prismatic {
            if let Some(by) = by {
                a[2] = a[2] + by;
            }
            return (Self { w: none, wd: none, a, u: [none; 3] }, v.splat(link.mass) * a[2]);
        }
        let square = -(v * v);
        let mut effort = v.splat(link.first[0]) * a[1] - v.splat(link.first[1]) * a[0];
        let (mut wd, mut u) = (none, [[square, zero, zero], [zero, square, zero], none]);
        if let Some(by) = by {
            effort = effort + v.splat(link.second[0] + link.second[3]) * by;
            (wd[2], u[0][1], u[1][0]) = (by, -by, by);
        }
        (Self { w: [zero, zero, v], wd, a, u }, effort)
    }

    /// Goes on to the next link, whose joint has velocity `v` and acceleration `by`, and gives the wrench that its motion needs.
    #[inline(always)]
    pub fn next(&mut self, link: &Link, pose: &Pose<V>, v: V, by: Option<V>) -> Wrench<V> {
        match link.twist {
            Twist::Any => self.step::<ANY>(link, pose, v, by),
            Twist::Parallel => self.step::<PARALLEL>(link, pose, v, by),
            Twist::Right => self.step::<RIGHT>(link, pose, v, by),
        }
    }

    #[inline(always)]
    fn step<const TWIST: u8>(&mut self, link: &Link, pose: &Pose<V>, v: V, by: Option<V>) -> Wrench<V> {
        if !link.meets {
            let (u, p) = (&self.u, &pose.origin);
            for j in 0..3 {
                let mut moved = u[j][0] * p[0] + u[j][1] * p[1];
                if TWIST == ANY {
                    moved = moved + u[j][2] * p[2];
                }
                self.a[j] = self.a[j] + moved;
            }
        }
        self.a = pose.outward::<TWIST>(link, &self.a);
        self.w = pose.outward::<TWIST>(link, &self.w);
        self.wd = pose.outward::<TWIST>(link, &self.wd);
        let Self { w, wd, a, .. } = self;
        if link.prismatic {
            let twice = v + v;
            a[0] = a[0] + w[1] * twice;
            a[1] = a[1] - w[0] * twice;
            if let Some(by) = by {
                a[2] = a[2] + by;
            }
        } else {
            wd[0] = wd[0] + w[1] * v;
            wd[1] = wd[1] - w[0] * v;
            w[2] = w[2] + v;
            if let Some(by) = by {
                wd[2] = wd[2] + by;
            }
        }
        let (xx, yy, zz) = (w[0] * w[0], w[1] * w[1], w[2] * w[2]);
        let (xy, xz, yz) = (w[0] * w[1], w[0] * w[2], w[1] * w[2]);
        let u = [
            [-(yy + zz), xy - wd[2], xz + wd[1]],
            [xy + wd[2], -(xx + zz), yz - wd[0]],
            [xz - wd[1], yz + wd[0], -(xx + yy)],
        ];
        self.u = u;
        let a = &self.a;
        let Moments { first: h, second: s } = Moments::of(v, link);
        // Rows of U Σ, whose last column has no Σ_zz behind a revolute joint, and of U m c.
        let row = |x: &Three<V>, y: &Three<V>| x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
        let short = |x: &Three<V>, y: &Three<V>| x[0] * y[0] + x[1] * y[1];
        let rows = [[s[0], s[1], s[2]], [s[1], s[3], s[4]], [s[2], s[4], s[5]]];
        let mut force = [short(&u[0], &h), short(&u[1], &h), short(&u[2], &h)];
        let (mut yz, mut xz) = (short(&u[1], &rows[2]), short(&u[0], &rows[2]));
        let (yx, xy) = (row(&u[1], &rows[0]), row(&u[0], &rows[1]));
        let (zx, zy) = (row(&u[2], &rows[0]), row(&u[2], &rows[1]));
        let mut moment = [h[1] * a[2], -(h[0] * a[2]), h[0] * a[1] - h[1] * a[0]];
        if link.prismatic {
            let mass = v.splat(link.mass);
            for j in 0..3 {
                force[j] = force[j] + (u[j][2] * h[2] + mass * a[j]);
            }
            (yz, xz) = (yz + u[1][2] * s[5], xz + u[0][2] * s[5]);
            (moment[0], moment[1]) = (moment[0] - h[2] * a[1], moment[1] + h[2] * a[0]);
        }
        (sum(&moment, &[zy - yz, xz - zx, yx - xy]), force)
    }
}
