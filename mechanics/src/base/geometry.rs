//! What a reduction needs of a robot, in units in which everything is of size 1.

use nalgebra::{DMatrix, Vector3};

use crate::model::term::{Structure, Term};
use crate::model::{DhConvention, DhRow, Drive, JointKind, ParameterId, ParameterKind, Robot};
use crate::spatial::Placement;

/// The geometry of a serial chain with lengths in units of [`Geometry::length`].
///
/// The unit is a power of two near the longest offset between joints: dividing by it costs no bit, and a rank decided
/// in these units is the same for an arm of metres and one of millimetres.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Geometry {
    /// Kind of each joint.
    pub(super) kinds: Vec<JointKind>,
    /// Placement before each joint.
    pub(super) before: Vec<Placement>,
    /// Placement after each joint.
    pub(super) after: Vec<Placement>,
    /// Where the placements come from, lengths in m.
    pub(super) dh: Vec<Option<(DhConvention, DhRow)>>,
    /// Direction of gravity in the base frame: of length 1, or zero.
    pub(super) gravity: Vector3<f64>,
    /// `q_motor = C q`, n × n; the identity where motors are not coupled.
    pub(super) coupling: DMatrix<f64>,
    /// The drives, for the shape parameters of torque laws.
    pub(super) drives: Vec<Drive>,
    /// Unit of length, m.
    pub(super) length: f64,
    /// Unit of frequency, rad/s: `√(g / length)`, so that gravity and motion weigh the same.
    pub(super) frequency: f64,
}

impl Geometry {
    /// The geometry of a robot.
    pub(super) fn of(robot: &Robot) -> Self {
        let joints = robot.joints();
        let longest = joints
            .iter()
            .flat_map(|joint| [joint.before.translation.norm(), joint.after.translation.norm()])
            .fold(0.0, f64::max);
        let length = if longest > 0.0 { libm::ldexp(1.0, libm::frexp(longest).1) } else { 1.0 };
        let g = robot.gravity().norm();
        let dof = robot.dof();
        Self {
            kinds: joints.iter().map(|joint| joint.kind).collect(),
            before: joints.iter().map(|joint| shrink(&joint.before, length)).collect(),
            after: joints.iter().map(|joint| shrink(&joint.after, length)).collect(),
            dh: joints.iter().map(|joint| joint.dh).collect(),
            gravity: if g > 0.0 { robot.gravity() / g } else { Vector3::zeros() },
            coupling: robot.coupling().cloned().unwrap_or_else(|| DMatrix::identity(dof, dof)),
            drives: joints.iter().map(|joint| joint.drive.clone()).collect(),
            length,
            frequency: if g > 0.0 { (g / length).sqrt() } else { 1.0 },
        }
    }

    /// Number of joints.
    pub(super) fn dof(&self) -> usize {
        self.kinds.len()
    }

    /// Size of the coordinate of joint `i`: 1 rad, or the unit of length.
    pub(super) fn coordinate_unit(&self, i: usize) -> f64 {
        match self.kinds[i] {
            JointKind::Revolute => 1.0,
            JointKind::Prismatic => self.length,
        }
    }

    /// C in these units: a motor has the coordinate unit of the joint of its number.
    pub(super) fn scaled_coupling(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.dof(), self.dof(), |k, i| {
            self.coupling[(k, i)] * self.coordinate_unit(i) / self.coordinate_unit(k)
        })
    }

    /// How the structural reduction sees a term at joint or motor `index`.
    pub(super) fn structure(&self, term: Term, index: usize) -> Structure {
        term.law().structure_at(&self.drives[index].shapes_of(term))
    }

    /// The shape parameters of a term at joint or motor `index`, in these units.
    pub(super) fn scales(&self, term: Term, index: usize) -> Vec<f64> {
        let shapes = term.entry().shapes.iter();
        shapes.map(|parameter| self.drives[index].shape(parameter) / self.coordinate_unit(index)).collect()
    }

    /// Size of a parameter of this robot in SI units, for a mass of 1 kg.
    pub(super) fn unit(&self, id: ParameterId) -> f64 {
        use ParameterKind::{Ixx, Ixy, Ixz, Iyy, Iyz, Izz, M, Mcx, Mcy, Mcz, Term};
        match id.kind {
            M => 1.0,
            Mcx | Mcy | Mcz => self.length,
            Ixx | Ixy | Ixz | Iyy | Iyz | Izz => self.length * self.length,
            Term(term) => {
                let (coordinate, dimension) = (self.coordinate_unit(id.index), term.entry().dimension);
                let inertia = self.length * self.length / (coordinate * coordinate);
                // An effort is an inertia times a coordinate over s²; the law takes its own powers away.
                let efforts = 1 - dimension.effort;
                let size = times(1.0, inertia, efforts);
                let size = times(size, coordinate, efforts - dimension.coordinate);
                times(size, self.frequency, 2 * efforts - dimension.per_time)
            }
        }
    }

    /// Sizes of these parameters.
    pub(super) fn units(&self, parameters: &[ParameterId]) -> Vec<f64> {
        parameters.iter().map(|&id| self.unit(id)).collect()
    }

    /// Size of the effort of joint `i`, N·m or N.
    pub(super) fn effort_unit(&self, i: usize) -> f64 {
        self.length * self.length * self.frequency * self.frequency / self.coordinate_unit(i)
    }
}

/// `x · factorᵏ`, one multiplication or division after the other.
fn times(x: f64, factor: f64, power: i32) -> f64 {
    (0..power.unsigned_abs()).fold(x, |x, _| if power > 0 { x * factor } else { x / factor })
}

fn shrink(placement: &Placement, length: f64) -> Placement {
    Placement::new(placement.rotation, placement.translation / length)
}
