//! Which motions can reach a link: the axes of the joints before it, gravity, and the motion of the base.
//!
//! Seen from link j, the axis of an earlier joint i is a polynomial S_i(q) in the coordinates between them. Its
//! coefficients are collected as rows `(label | motion)`: the constant one carries the label of its joint, for the
//! constants that a drive adds to H_ij; the moving ones carry none. Gravity has a label of its own.

use nalgebra::{Vector3, Vector6};

use super::span::basis;
use crate::base::geometry::Geometry;
use crate::model::JointKind;
use crate::spatial::{Motion, Placement};

/// How the base of the robot moves; its motion is prescribed and known, the force on it is not measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum BaseMotion {
    /// It stands.
    #[default]
    Fixed,
    /// It moves along x and y and turns about z of its own frame, like a mobile platform.
    Planar,
    /// It moves in all six degrees of freedom.
    Free,
}

crate::input::named! { BaseMotion { Fixed: "fixed", Planar: "planar", Free: "moving" } }

impl BaseMotion {
    /// The directions in which the base moves, in its own frame.
    pub(crate) fn directions(self) -> Vec<Motion> {
        let indices: &[usize] = match self {
            Self::Fixed => &[],
            Self::Planar => &[2, 3, 4],
            Self::Free => &[0, 1, 2, 3, 4, 5],
        };
        indices.iter().map(|&k| to_motion(&Vector6::from_fn(|i, _| if i == k { 1.0 } else { 0.0 }))).collect()
    }
}

/// The motions that reach one link.
pub(super) struct Attainable {
    /// Labels: one per joint, and one for gravity.
    labels: usize,
    /// `(label | motion)` rows, in the frame of the link.
    rows: Vec<Vec<f64>>,
}

impl Attainable {
    /// What reaches the base: gravity, and the base's own motion.
    pub(super) fn at_base(geometry: &Geometry, motion: BaseMotion) -> Self {
        let labels = geometry.dof() + 1;
        let mut this = Self { labels, rows: Vec::new() };
        // Gravity acts as an acceleration of the base against it.
        let up = Motion::new(Vector3::zeros(), -geometry.gravity);
        let turns = motion.directions().into_iter().filter(|direction| direction.ang != Vector3::zeros());
        let (constant, moving) = match motion {
            BaseMotion::Fixed => (up, Vec::new()),
            BaseMotion::Planar => about_z(&up),
            BaseMotion::Free => (Motion::zero(), turns.map(|turn| Motion::new(Vector3::zeros(), turn.ang)).collect()),
        };
        this.push(Some(labels - 1), &constant);
        let moving = moving.into_iter().filter(|_| up != Motion::zero());
        for direction in moving.chain(motion.directions()) {
            this.push(None, &direction);
        }
        this.reduce();
        this
    }

    /// What reaches the link beyond joint `j`: what reached the one before, as the joint moves it, and the joint's axis.
    pub(super) fn beyond(&self, geometry: &Geometry, j: usize, axis: &Motion) -> Self {
        let (kind, before, after) = (geometry.kinds[j], &geometry.before[j], &geometry.after[j]);
        let mut next = Self { labels: self.labels, rows: Vec::new() };
        for row in &self.rows {
            let (constant, moving) = parts(kind, before, after, &self.motion(row));
            let mut labelled = row[..self.labels].to_vec();
            labelled.extend(to_six(&constant));
            next.rows.push(labelled);
            for part in moving {
                next.push(None, &part);
            }
        }
        next.push(Some(j), axis);
        next.reduce();
        next
    }

    /// The rows as labels and motions.
    pub(super) fn iter(&self) -> impl Iterator<Item = (&[f64], Motion)> {
        self.rows.iter().map(|row| (&row[..self.labels], self.motion(row)))
    }

    fn motion(&self, row: &[f64]) -> Motion {
        to_motion(&Vector6::from_column_slice(&row[self.labels..]))
    }

    fn push(&mut self, label: Option<usize>, motion: &Motion) {
        let mut row = vec![0.0; self.labels];
        if let Some(label) = label {
            row[label] = 1.0;
        }
        row.extend(to_six(motion));
        self.rows.push(row);
    }

    fn reduce(&mut self) {
        self.rows = basis(&self.rows, self.labels + 6);
    }
}

/// The constant and the moving parts of a motion given before a joint, seen from beyond it.
fn parts(kind: JointKind, before: &Placement, after: &Placement, motion: &Motion) -> (Motion, Vec<Motion>) {
    let at_joint = before.motion_to_child(motion);
    let (constant, moving) = match kind {
        JointKind::Revolute => about_z(&at_joint),
        // exp(−ẑ q ×) v = (ω, v + q ω × ẑ)
        JointKind::Prismatic => (at_joint, vec![Motion::new(Vector3::zeros(), at_joint.ang.cross(&Vector3::z()))]),
    };
    (after.motion_to_child(&constant), moving.iter().map(|part| after.motion_to_child(part)).collect())
}

/// Parts of a motion seen from a frame that turns about z: what lies along z stays, the rest goes with cos q and sin q.
fn about_z(motion: &Motion) -> (Motion, Vec<Motion>) {
    let along = |v: &Vector3<f64>| Vector3::new(0.0, 0.0, v.z);
    let across = |v: &Vector3<f64>| Vector3::new(v.x, v.y, 0.0);
    let turned = |v: &Vector3<f64>| Vector3::new(v.y, -v.x, 0.0);
    let constant = Motion::new(along(&motion.ang), along(&motion.lin));
    let cosine = Motion::new(across(&motion.ang), across(&motion.lin));
    let sine = Motion::new(turned(&motion.ang), turned(&motion.lin));
    (constant, vec![cosine, sine])
}

fn to_six(motion: &Motion) -> [f64; 6] {
    let (w, v) = (&motion.ang, &motion.lin);
    [w.x, w.y, w.z, v.x, v.y, v.z]
}

fn to_motion(six: &Vector6<f64>) -> Motion {
    Motion::new(Vector3::new(six[0], six[1], six[2]), Vector3::new(six[3], six[4], six[5]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_parts_add_up_to_the_motion_seen_from_beyond() {
        let (s, c) = libm::sincos(0.4);
        let before = Placement::rotation_x(s, c).compose(&Placement::translation(0.1, -0.3, 0.2));
        let after = Placement::translation(0.5, 0.2, -0.1).compose(&Placement::rotation_y(c, s));
        let motion = Motion::new([0.3, -0.2, 0.9].into(), [1.1, 0.4, -0.6].into());
        let q: f64 = -0.61;
        let (sin, cos) = libm::sincos(q);
        for (kind, moved, weights) in [
            (JointKind::Revolute, Placement::rotation_z(sin, cos), vec![cos, sin]),
            (JointKind::Prismatic, Placement::translation(0.0, 0.0, q), vec![q]),
        ] {
            let expected = before.compose(&moved).compose(&after).motion_to_child(&motion);
            let (mut sum, moving) = parts(kind, &before, &after, &motion);
            for (part, &weight) in moving.iter().zip(&weights) {
                sum += *part * weight;
            }
            assert!((sum.ang - expected.ang).norm() < 1e-15 && (sum.lin - expected.lin).norm() < 1e-15);
        }
    }
}
