//! Axes that stand along y or z of their link's frame, whose products with the zeros of the axis are left out.

use super::body::BodyRegressor;
use crate::lanes::Lane;
use crate::spatial::{LaneMotion, Motion};

/// A revolute joint's axis in its link's frame, `S = (± e_m, lever e_{3−m})` with components counted from 0: m = 1 or 2.
///
/// So it stands in frames of DH tables with right angles. The bits are those of all products: what is left out is `0 · x` and
/// `x + 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StraightAxis {
    pub(super) along: Along,
    sign: f64,
    /// m.
    lever: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Along {
    Y,
    Z,
}

/// [`StraightAxis::along`] as a number for the compiler.
pub(super) const Y: usize = 1;
pub(super) const Z: usize = 2;

impl StraightAxis {
    /// That of this axis, if it is such a one.
    pub(super) fn of(axis: &Motion) -> Option<Self> {
        let (n, f) = (&axis.ang, &axis.lin);
        let straight = |m: usize| n[m].abs() == 1.0 && n.x == 0.0 && n[3 - m] == 0.0 && f.x == 0.0 && f[m] == 0.0;
        let along = |along: Along, m: usize| straight(m).then(|| Self { along, sign: n[m], lever: f[3 - m] });
        along(Along::Y, Y).or_else(|| along(Along::Z, Z))
    }

    /// Velocity and acceleration of the link from those that it has with its joint at rest: `v + S q̇`, and with this sum
    /// `a + S q̈ + v × S q̇`.
    #[inline(always)]
    pub(super) fn moved<V: Lane>(
        &self,
        motion: (LaneMotion<V>, LaneMotion<V>),
        qd: V,
        qdd: V,
    ) -> (LaneMotion<V>, LaneMotion<V>) {
        match self.along {
            Along::Y => self.moved_along::<V, Y>(motion, qd, qdd),
            Along::Z => self.moved_along::<V, Z>(motion, qd, qdd),
        }
    }

    #[inline(always)]
    fn moved_along<V: Lane, const M: usize>(
        &self,
        (mut v, mut a): (LaneMotion<V>, LaneMotion<V>),
        qd: V,
        qdd: V,
    ) -> (LaneMotion<V>, LaneMotion<V>) {
        let (next, last, arm) = ((M + 1) % 3, (M + 2) % 3, 3 - M);
        let (sign, lever) = (qd.splat(self.sign), qd.splat(self.lever));
        let (turn, slide) = (sign * qd, lever * qd);
        v.ang[M] = v.ang[M] + turn;
        v.lin[arm] = v.lin[arm] + slide;
        a.ang[M] = a.ang[M] + sign * qdd;
        a.lin[arm] = a.lin[arm] + lever * qdd;
        a.ang[next] = a.ang[next] + v.ang[last] * turn;
        a.ang[last] = a.ang[last] - v.ang[next] * turn;
        // ω × lever e_arm + v × e_m.
        let (w, u) = (&v.ang, &v.lin);
        if M == Z {
            a.lin[0] = a.lin[0] + (u[1] * turn - w[2] * slide);
            a.lin[1] = a.lin[1] - u[0] * turn;
            a.lin[2] = a.lin[2] + w[0] * slide;
        } else {
            a.lin[0] = a.lin[0] + (w[1] * slide - u[2] * turn);
            a.lin[1] = a.lin[1] - w[0] * slide;
            a.lin[2] = a.lin[2] + u[0] * turn;
        }
        (v, a)
    }

    /// [`BodyRegressor::entry`] of the joint's own link, for an axis along M.
    #[inline(always)]
    pub(super) fn entry<V: Lane, const M: usize>(&self, body: &BodyRegressor<V>, c: usize) -> V {
        let arm = 3 - M;
        let (sign, lever) = (body.b[0].splat(self.sign), body.b[0].splat(self.lever));
        match c {
            0 => body.b[arm] * lever,
            1..=3 => {
                let (c, next, last) = (c - 1, c % 3, (c + 1) % 3);
                let by_force = body.moment[arm][c] * lever;
                if last == M {
                    body.b[next] * sign + by_force
                } else if next == M {
                    by_force - body.b[last] * sign
                } else {
                    by_force
                }
            }
            _ => body.inertia[M][c - 4] * sign,
        }
    }

    /// [`BodyRegressor::project`] of the joint's own link.
    #[inline(always)]
    pub(super) fn project<V: Lane>(&self, body: &BodyRegressor<V>) -> [V; 10] {
        match self.along {
            Along::Y => self.project_along::<V, Y>(body),
            Along::Z => self.project_along::<V, Z>(body),
        }
    }

    #[inline(always)]
    fn project_along<V: Lane, const M: usize>(&self, body: &BodyRegressor<V>) -> [V; 10] {
        [
            self.entry::<V, M>(body, 0),
            self.entry::<V, M>(body, 1),
            self.entry::<V, M>(body, 2),
            self.entry::<V, M>(body, 3),
            self.entry::<V, M>(body, 4),
            self.entry::<V, M>(body, 5),
            self.entry::<V, M>(body, 6),
            self.entry::<V, M>(body, 7),
            self.entry::<V, M>(body, 8),
            self.entry::<V, M>(body, 9),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains;
    use crate::seed::Seed;

    #[test]
    fn identity_a_straight_axis_has_the_bits_of_any_other() {
        let mut rng = Seed::new(19).stream("axes", 0);
        let mut draw = || {
            let (ang, lin, _) = chains::random_state(&mut rng, 3);
            LaneMotion { ang: [ang[0], ang[1], ang[2]], lin: [lin[0], lin[1], lin[2]] }
        };
        for (sign, lever) in [(1.0, 0.0), (1.0, 0.3), (-1.0, 0.0), (-1.0, -0.7)] {
            for m in [Y, Z] {
                let mut axis = Motion::zero();
                (axis.ang[m], axis.lin[3 - m]) = (sign, lever);
                let straight = StraightAxis::of(&axis).expect("it stands along y or z");
                let (v, a, s) = (draw(), draw(), LaneMotion::from(&axis));
                let (qd, qdd) = (0.7, -3.1);
                let rate = s.times(qd);
                let expected_v = v.plus(&rate);
                let expected_a = a.plus(&s.times(qdd)).plus(&expected_v.cross(&rate));
                let body = BodyRegressor::in_lanes(&expected_v, &expected_a);
                let (moved, entries) = (straight.moved((v, a), qd, qdd), straight.project(&body));
                assert_eq!((moved.0.ang, moved.0.lin), (expected_v.ang, expected_v.lin));
                assert_eq!((moved.1.ang, moved.1.lin), (expected_a.ang, expected_a.lin));
                assert_eq!(entries, body.project(&s));
            }
        }
        let mut leaning = Motion::zero();
        (leaning.ang.y, leaning.ang.z) = (0.6, 0.8);
        assert_eq!(StraightAxis::of(&leaning), None);
    }
}
