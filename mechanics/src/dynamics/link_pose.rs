//! The pose of a link in the one before, with everything that does not change worked out beforehand.

use nalgebra::{Matrix3, Vector3};

use super::link_step::{LinkStep, QuarterTurns, RightStep, Shift};
use crate::lanes::{Lane, sin_cos};
use crate::model::{Joint, JointKind};
use crate::spatial::{LanePlacement, Placement};

/// `T(q) = before · J(q) · after` as twelve numbers that are linear in two functions of q:
///
/// ```text
/// T(q) = constant + x(q) · first + y(q) · second        x, y = cos q, sin q  (revolute)  or  q, 0  (prismatic)
/// ```
/// The right angles of a DH table leave zeros and ones in the three parts, so a product that vanishes by geometry still
/// vanishes to the last bit.
#[derive(Clone, Copy, Debug)]
pub struct LinkPose {
    kind: JointKind,
    constant: [f64; 12],
    first: [f64; 12],
    second: [f64; 12],
    /// Where all angles but the joint's own are right.
    right: Option<(QuarterTurns, Shift)>,
}

impl LinkPose {
    /// The pose that this joint gives its link.
    pub fn new(joint: &Joint) -> Self {
        let (before, after) = (&joint.before, &joint.after);
        let z = Vector3::z();
        // The part of the joint's rotation that stays, those along cos and sin, and its translation per coordinate.
        let (stays, along_x, along_y, slide) = match joint.kind {
            JointKind::Revolute => (
                Matrix3::from_diagonal(&z),
                Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 0.0)),
                z.cross_matrix(),
                Vector3::zeros(),
            ),
            JointKind::Prismatic => (Matrix3::identity(), Matrix3::zeros(), Matrix3::zeros(), z),
        };
        let part = |turn: &Matrix3<f64>, shift: Vector3<f64>| {
            let rotation = before.rotation * turn;
            numbers(&(rotation * after.rotation), &(rotation * after.translation + shift))
        };
        let parts = [
            part(&stays, before.translation),
            part(&along_x, before.rotation * slide),
            part(&along_y, Vector3::zeros()),
        ];
        let [constant, first, second] = parts;
        let [stays, along_x, along_y] = parts.map(|part| Matrix3::from_column_slice(&part[..9]));
        let right = QuarterTurns::of(&stays, &along_x, &along_y)
            .map(|turns| (turns, Shift::of(parts.map(|part| [part[9], part[10], part[11]]))));
        Self { kind: joint.kind, constant, first, second, right }
    }

    /// The pose at coordinate `q`, rad or m.
    #[inline]
    pub fn placement(&self, q: f64) -> Placement {
        let LanePlacement { axes: [x, y, z], origin } = self.in_full(self.turn(q));
        Placement {
            rotation: Matrix3::new(x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]),
            translation: origin.into(),
        }
    }

    /// `[x, y]`, the two functions of q.
    #[inline(always)]
    pub(crate) fn turn<V: Lane>(&self, q: V) -> [V; 2] {
        match self.kind {
            JointKind::Revolute => {
                let (sine, cosine) = sin_cos(q);
                [cosine, sine]
            }
            JointKind::Prismatic => [q, q.splat(0.0)],
        }
    }

    /// Pose of the link from sine and cosine of q.
    #[inline(always)]
    pub(crate) fn turn_of(&self, q: f64, sine: f64, cosine: f64) -> [f64; 2] {
        match self.kind {
            JointKind::Revolute => [cosine, sine],
            JointKind::Prismatic => [q, 0.0],
        }
    }

    /// The poses of several samples, from `[x, y]`.
    #[inline(always)]
    pub(crate) fn in_lanes<V: Lane>(&self, [x, y]: [V; 2]) -> LinkStep<V> {
        match self.right {
            Some((turns, shift)) => {
                let (cosine, sine) = turns.turn(x, y);
                let zero = [x.splat(0.0); 3];
                let origin = if shift == Shift::Nowhere { zero } else { self.three(9, x, y) };
                LinkStep::Right(RightStep { turns, shift, cosine, sine, origin })
            }
            None => LinkStep::Any(self.in_full([x, y])),
        }
    }

    /// The same with all products, which forces need too.
    #[inline(always)]
    pub(crate) fn in_full<V: Lane>(&self, [x, y]: [V; 2]) -> LanePlacement<V> {
        LanePlacement {
            axes: [self.three(0, x, y), self.three(3, x, y), self.three(6, x, y)],
            origin: self.three(9, x, y),
        }
    }

    /// Three numbers of the pose. Functions, since a closure that is not inlined is compiled without the processor's lanes.
    #[inline(always)]
    fn three<V: Lane>(&self, k: usize, x: V, y: V) -> [V; 3] {
        [self.number(k, x, y), self.number(k + 1, x, y), self.number(k + 2, x, y)]
    }

    #[inline(always)]
    fn number<V: Lane>(&self, k: usize, x: V, y: V) -> V {
        x.splat(self.constant[k]) + x * x.splat(self.first[k]) + y * x.splat(self.second[k])
    }
}

fn numbers(rotation: &Matrix3<f64>, translation: &Vector3<f64>) -> [f64; 12] {
    std::array::from_fn(|k| if k < 9 { rotation.as_slice()[k] } else { translation[k - 9] })
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;
    use crate::chains;
    use crate::seed::Seed;
    use crate::spatial::LaneMotion;

    #[test]
    fn identity_right_angles_have_the_bits_of_all_products() {
        let mut right = HashMap::new();
        for run in 0..100 {
            let mut rng = Seed::new(17).stream("right angles", run);
            let (robot, _) = chains::random_robot(&mut rng, 9);
            for joint in robot.joints() {
                let pose = LinkPose::new(joint);
                if let Some(form) = pose.right {
                    *right.entry(format!("{form:?}")).or_insert(0) += 1;
                }
                let (x, w, v) = chains::random_state(&mut rng, 3);
                let motion = LaneMotion { ang: [w[0], w[1], w[2]], lin: [v[0], v[1], v[2]] };
                let turn = pose.turn(x[0]);
                let found = pose.in_lanes(turn).motion_to_child(&motion);
                let expected = pose.in_full(turn).motion_to_child(&motion);
                assert_eq!((found.ang, found.lin), (expected.ang, expected.lin), "{:?}", pose.right);
            }
        }
        assert!(right.len() > 10, "{right:?}");
    }

    #[test]
    fn identity_pose_is_that_of_the_joint() {
        for run in 0..20 {
            let mut rng = Seed::new(16).stream("poses", run);
            let (robot, _) = chains::random_robot(&mut rng, 6);
            let (q, _, _) = chains::random_state(&mut rng, 6);
            for (joint, &q) in robot.joints().iter().zip(&q) {
                let (found, expected) = (LinkPose::new(joint).placement(q), joint.placement(q));
                assert!((found.rotation - expected.rotation).amax() < 1e-15);
                assert!((found.translation - expected.translation).amax() < 1e-15);
            }
        }
    }
}
