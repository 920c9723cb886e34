//! The simulator that is always there.

use std::marker::PhantomData;

use armid::dynamics::{TermError, check_simulable};
use armid::experiment::{Plant, PlantError};
use armid::model::{Robot, StandardParameters};

use super::chain::Chain;
use super::integrator::{self, State, Workspace};
use super::team::{Advance, InTurn, Members, OnLanes, Side};

/// A serial arm of rigid links with rotors and friction, integrated by Runge–Kutta of order 4 (see the module).
///
/// ```
/// use armid::conformance::chains;
/// use armid::experiment::Plant;
/// use armid::model::StandardParameters;
/// use armid::spatial::Inertia;
/// use armid_sim::AnalyticPlant;
/// use nalgebra::{Matrix3, Vector3};
/// // Two bars that hang straight down stay where they are.
/// let robot = chains::planar_2r();
/// let mut bars = StandardParameters::zero(2);
/// for link in &mut bars.links {
///     *link = Inertia::from_com(1.0, Vector3::new(-0.2, 0.0, 0.0), Matrix3::from_diagonal_element(0.01));
/// }
/// let mut plant = AnalyticPlant::new(&robot, &bars).unwrap();
/// plant.reset(&[-std::f64::consts::FRAC_PI_2, 0.0], &[0.0; 2]);
/// plant.step(&[0.0; 2], 1e-3).unwrap();
/// assert!(plant.state().1.iter().all(|v| v.abs() < 1e-15));
/// ```
#[derive(Debug)]
pub struct AnalyticPlant {
    arm: Box<dyn Arm>,
}

/// Why a robot cannot be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum AnalyticError {
    /// Too many joints.
    #[error("the robot has {dof} joints, expected at most {MOST_JOINTS}")]
    Dof { dof: usize },
    /// The parameters are of another robot.
    #[error("the parameters are of {found} links, expected the robot's {expected}")]
    Parameters { found: usize, expected: usize },
    /// A parameter by which the motion has no derivative that is known.
    #[error(
        "{parameter}: no derivative of the motion by it, expected a parameter whose torque follows from the motion"
    )]
    Derivative { parameter: String },
    /// A torque term that the plant cannot simulate.
    #[error(transparent)]
    Term(#[from] TermError),
}

/// The largest number of joints.
pub const MOST_JOINTS: usize = 8;

impl AnalyticPlant {
    /// The arm with these, true, parameters; at rest at zero.
    ///
    /// # Errors
    /// [`AnalyticError`] where the robot has more than [`MOST_JOINTS`] joints, the parameters are not its own, or
    /// a plant cannot simulate one of the torque terms.
    pub fn new(robot: &Robot, parameters: &StandardParameters) -> Result<Self, AnalyticError> {
        let dof = robot.dof();
        let found = parameters.links.len().min(parameters.drives.len());
        if found != dof {
            return Err(AnalyticError::Parameters { found, expected: dof });
        }
        check_simulable(robot, parameters)?;
        let arm: Box<dyn Arm> = match dof {
            1 => Box::new(Jointed::<1, InTurn>::new(robot, parameters)),
            2 => Box::new(Jointed::<2, InTurn>::new(robot, parameters)),
            3 => Box::new(Jointed::<3, InTurn>::new(robot, parameters)),
            4 => Box::new(Jointed::<4, InTurn>::new(robot, parameters)),
            5 => Box::new(Jointed::<5, InTurn>::new(robot, parameters)),
            6 => Box::new(Jointed::<6, OnLanes>::new(robot, parameters)),
            7 => Box::new(Jointed::<7, OnLanes>::new(robot, parameters)),
            8 => Box::new(Jointed::<8, InTurn>::new(robot, parameters)),
            _ => return Err(AnalyticError::Dof { dof }),
        };
        Ok(Self { arm })
    }

    pub(super) fn members(&self, runs: usize) -> Box<dyn Members> {
        self.arm.members(runs)
    }

    /// Joint accelerations under the efforts `tau` in the present state, by this plant's own equations; n each.
    ///
    /// # Panics
    /// If a slice has another length than n.
    pub fn acceleration(&mut self, tau: &[f64], qdd: &mut [f64]) {
        let _ = self.definite_acceleration(tau, qdd);
    }

    /// Accelerations of the joints; returns whether the mass matrix in the present state is positive definite, without which they mean nothing.
    ///
    /// # Panics
    /// If a slice has another length than n.
    pub fn definite_acceleration(&mut self, tau: &[f64], qdd: &mut [f64]) -> bool {
        self.arm.acceleration(tau, qdd)
    }
}

impl Clone for AnalyticPlant {
    fn clone(&self) -> Self {
        Self { arm: self.arm.boxed() }
    }
}

impl Plant for AnalyticPlant {
    fn dof(&self) -> usize {
        self.state().0.len()
    }

    fn state(&self) -> (&[f64], &[f64]) {
        self.arm.state()
    }

    fn reset(&mut self, q: &[f64], qd: &[f64]) {
        self.arm.reset(q, qd);
    }

    fn step(&mut self, tau: &[f64], dt: f64) -> Result<(), PlantError> {
        self.arm.step(tau, dt);
        let (q, qd) = self.arm.state();
        PlantError::of_state(q, qd).map_or(Ok(()), Err)
    }
}

/// A number of joints that is known when this is compiled, behind one that is not.
trait Arm: std::fmt::Debug + Send + Sync {
    fn state(&self) -> (&[f64], &[f64]);
    fn reset(&mut self, q: &[f64], qd: &[f64]);
    fn step(&mut self, tau: &[f64], dt: f64);
    fn acceleration(&mut self, tau: &[f64], qdd: &mut [f64]) -> bool;
    fn boxed(&self) -> Box<dyn Arm>;
    fn members(&self, runs: usize) -> Box<dyn Members>;
}

#[derive(Debug)]
struct Jointed<const N: usize, A> {
    chain: Chain<N>,
    state: State<N, f64>,
    workspace: Workspace<N, f64>,
    advance: PhantomData<fn() -> A>,
}

impl<const N: usize, A> Jointed<N, A> {
    fn new(robot: &Robot, parameters: &StandardParameters) -> Self {
        let state = State { q: [0.0; N], v: [0.0; N] };
        Self { chain: Chain::new(robot, parameters), state, workspace: Workspace::nothing(0.0), advance: PhantomData }
    }
}

fn fixed<const N: usize>(tau: &[f64]) -> [f64; N] {
    let mut out = [0.0; N];
    out.copy_from_slice(tau);
    out
}

impl<const N: usize, A: Advance> Arm for Jointed<N, A> {
    fn state(&self) -> (&[f64], &[f64]) {
        (&self.state.q, &self.state.v)
    }

    fn reset(&mut self, q: &[f64], qd: &[f64]) {
        self.state = State { q: fixed(q), v: fixed(qd) };
    }

    fn step(&mut self, tau: &[f64], dt: f64) {
        integrator::step_alone(&self.chain, &mut self.state, &fixed(tau), dt, &mut self.workspace);
    }

    fn acceleration(&mut self, tau: &[f64], qdd: &mut [f64]) -> bool {
        let Self { chain, state, workspace: Workspace { room, .. }, .. } = self;
        qdd.copy_from_slice(&chain.accelerate_alone(&state.q, &state.v, &fixed(tau), room));
        room.rigid.factor.is_positive()
    }

    fn boxed(&self) -> Box<dyn Arm> {
        Box::new(Self {
            chain: self.chain.clone(),
            state: self.state,
            workspace: self.workspace.clone(),
            advance: PhantomData,
        })
    }

    fn members(&self, runs: usize) -> Box<dyn Members> {
        Box::new(Side::<N, A>::new(&self.chain, &self.state, runs))
    }
}
