//! The engine's world with one arm in it: generated, put into a state, stepped.

use armid::model::{JointKind, Robot, StandardParameters};
use armid::spatial::{Inertia, Placement};
use nalgebra::{DMatrix, SymmetricEigen, Vector3};
use rapier3d_f64::glamx::{DMat3, DQuat};
use rapier3d_f64::prelude::{
    GenericJoint, GenericJointBuilder, JointAxesMask, MassProperties, Multibody, MultibodyJoint, MultibodyJointHandle,
    PhysicsWorld, Pose, RigidBodyBuilder, Rotation, Vector,
};

use super::RapierError;

/// Stiffness of the spring through which a torque acts: its own `−K q` is far below rounding, and as a power of two it
/// changes no digit of the torque.
const SPRING: f64 = 1.0 / (1_u128 << 64) as f64;

/// One joint of the engine.
#[derive(Clone, Copy, Debug)]
struct Axis {
    handle: MultibodyJointHandle,
    joint: GenericJoint,
    /// Its place among the engine's six coordinates of a joint.
    coordinate: usize,
}

/// A world with one arm.
pub(super) struct Engine {
    world: PhysicsWorld,
    axes: Vec<Axis>,
}

fn vector(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

fn rotation(r: &nalgebra::Matrix3<f64>) -> Rotation {
    let column = |i: usize| Vector::new(r[(0, i)], r[(1, i)], r[(2, i)]);
    DQuat::from_mat3(&DMat3::from_cols(column(0), column(1), column(2))).normalize()
}

fn pose(placement: &Placement) -> Pose {
    Pose::from_parts(vector(&placement.translation), rotation(&placement.rotation))
}

/// Mass, centre of mass, and the principal inertia in its own frame.
fn mass_properties(link: &Inertia) -> MassProperties {
    let com = link.com().unwrap_or_else(Vector3::zeros);
    let SymmetricEigen { mut eigenvectors, eigenvalues } = SymmetricEigen::new(link.about_com());
    if eigenvectors.determinant() < 0.0 {
        eigenvectors.column_mut(2).neg_mut();
    }
    MassProperties::with_principal_inertia_frame(vector(&com), link.mass, vector(&eigenvalues), rotation(&eigenvectors))
}

impl Engine {
    /// One body per link, each on a joint about or along z. `armature` is the diagonal that the engine adds to its
    /// mass matrix.
    pub(super) fn new(robot: &Robot, parameters: &StandardParameters, armature: &[f64]) -> Result<Self, RapierError> {
        for (index, link) in parameters.links.iter().enumerate() {
            link.check().map_err(|fault| RapierError::Link { link: index + 1, fault })?;
        }
        let mut world = PhysicsWorld::new();
        world.gravity = vector(&(robot.base().rotation * robot.gravity()));
        world.integration_parameters.num_solver_iterations = 1;
        let base = world.insert_body(RigidBodyBuilder::fixed().pose(pose(robot.base())));
        let mut bodies = vec![base];
        let mut axes = Vec::new();
        for (joint, link) in robot.joints().iter().zip(&parameters.links) {
            let (locked, coordinate) = match joint.kind {
                JointKind::Revolute => (JointAxesMask::ANG_Z, 5),
                JointKind::Prismatic => (JointAxesMask::LIN_Z, 2),
            };
            let joint = GenericJointBuilder::new(JointAxesMask::all().difference(locked))
                .local_frame1(pose(&joint.before))
                .local_frame2(pose(&joint.after.inverse()))
                .contacts_enabled(false)
                .build();
            let body = RigidBodyBuilder::dynamic().additional_mass_properties(mass_properties(link)).can_sleep(false);
            let body = world.insert_body(body);
            let handle = world
                .insert_multibody_joint(bodies[axes.len()], body, joint)
                .expect("a new body closes no loop of joints");
            bodies.push(body);
            axes.push(Axis { handle, joint, coordinate });
        }
        for &handle in &bodies {
            let body = &mut world.bodies[handle];
            body.recompute_mass_properties_from_colliders(&world.colliders);
        }
        let mut engine = Self { world, axes };
        engine.place();
        let arm = engine.arm_mut();
        arm.damping_mut().fill(0.0);
        arm.armature_mut().as_mut_slice().copy_from_slice(armature);
        Ok(engine)
    }

    fn arm(&self) -> &Multibody {
        self.world.multibody_joints.get(self.axes[0].handle).expect("the joint that was inserted").0
    }

    fn arm_mut(&mut self) -> &mut Multibody {
        self.world.multibody_joints.get_mut(self.axes[0].handle).expect("the joint that was inserted").0
    }

    /// Moves the bodies to where the coordinates say.
    fn place(&mut self) {
        let (arm, _) = self.world.multibody_joints.get_mut(self.axes[0].handle).expect("the joint that was inserted");
        arm.forward_kinematics(&self.world.bodies, true);
        arm.update_rigid_bodies(&mut self.world.bodies, true);
    }

    /// Puts the arm into a state; n each.
    pub(super) fn set_state(&mut self, q: &[f64], qd: &[f64]) {
        let joints: Vec<GenericJoint> = self.axes.iter().map(|axis| axis.joint).collect();
        let arm = self.arm_mut();
        // Link 0 is the base. A new joint has the coordinate 0, so that the displacement is the coordinate itself.
        for (i, joint) in joints.into_iter().enumerate() {
            arm.link_mut(i + 1).expect("one link per joint").joint = MultibodyJoint::new(joint, false);
        }
        arm.apply_displacements(q);
        arm.generalized_velocity_mut().as_mut_slice().copy_from_slice(qd);
        self.place();
    }

    /// Reads the state into `q` and `qd`; n each.
    pub(super) fn read_state(&self, q: &mut [f64], qd: &mut [f64]) {
        let arm = self.arm();
        for (i, axis) in self.axes.iter().enumerate() {
            q[i] = arm.link(i + 1).expect("one link per joint").joint().coords()[axis.coordinate];
        }
        for (own, velocity) in qd.iter_mut().zip(arm.generalized_velocity().iter()) {
            *own = *velocity;
        }
    }

    /// Sets what acts during the next step: torques, and an implicit damping `−damping q̇`; n each. `q` is the present
    /// state.
    pub(super) fn set_forces(&mut self, q: &[f64], torque: &[f64], damping: &[f64]) {
        let coordinates: Vec<usize> = self.axes.iter().map(|axis| axis.coordinate).collect();
        let arm = self.arm_mut();
        for (i, coordinate) in coordinates.into_iter().enumerate() {
            let joint = &mut arm.link_mut(i + 1).expect("one link per joint").joint;
            joint.set_spring(coordinate, SPRING, q[i] + torque[i] / SPRING);
        }
        arm.damping_mut().as_mut_slice().copy_from_slice(damping);
    }

    /// Advances by `dt` in one step.
    pub(super) fn step(&mut self, dt: f64) {
        self.world.integration_parameters.dt = dt;
        self.world.step();
    }

    /// Accelerations in the step before.
    pub(super) fn acceleration(&self, qdd: &mut [f64]) {
        for (own, a) in qdd.iter_mut().zip(self.arm().generalized_acceleration().iter()) {
            *own = *a;
        }
    }

    /// The engine's mass matrix at the present coordinates, armature included.
    pub(super) fn mass_matrix(&mut self) -> DMatrix<f64> {
        let (arm, _) = self.world.multibody_joints.get_mut(self.axes[0].handle).expect("the joint that was inserted");
        // This assembles the matrix without damping; its factors are then what is wanted.
        let _ = arm.dof_inverse_inertia(&self.world.bodies);
        let factors = arm.inv_augmented_mass();
        let mut matrix = factors.l() * factors.u();
        factors.p().inv_permute_rows(&mut matrix);
        matrix
    }
}

impl std::fmt::Debug for Engine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Engine").field("axes", &self.axes).finish_non_exhaustive()
    }
}
