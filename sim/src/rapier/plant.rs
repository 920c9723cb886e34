//! The engine behind the trait that every plant has.

use armid::model::term::ROTOR;
use std::num::NonZeroU32;

use armid::dynamics::TorqueTerms;
use armid::experiment::{Plant, PlantError};
use armid::model::{Columns, Robot, StandardParameters};
use nalgebra::DMatrix;

use super::RapierError;
use super::engine::Engine;
use super::rotors::CoupledRotors;
use super::term_forces::TermForces;

/// Steps of the engine in one step of the plant, by default: the engine's own default.
pub const DEFAULT_SUBSTEPS: NonZeroU32 = NonZeroU32::new(4).expect("four is not zero");

/// So short a step, s, that what the engine treats implicitly is below 1e-9 of the acceleration.
const INSTANT: f64 = 1.0 / (1_u64 << 40) as f64;

/// A serial arm in the engine rapier (see the module).
///
/// ```
/// use armid::conformance::chains;
/// use armid::experiment::Plant;
/// use armid::seed::Seed;
/// use armid_sim::{AnalyticPlant, RapierPlant};
/// // Two engines, one arm: a hundredth of a second in steps of 0.1 ms.
/// let (robot, parameters) = chains::random_robot(&mut Seed::new(1).stream("chains", 0), 3);
/// let mut own = AnalyticPlant::new(&robot, &parameters).unwrap();
/// let mut other = RapierPlant::new(&robot, &parameters).unwrap();
/// for _ in 0..100 {
///     own.step(&[1.0, -1.0, 0.5], 1e-4).unwrap();
///     other.step(&[1.0, -1.0, 0.5], 1e-4).unwrap();
/// }
/// for (a, b) in own.state().0.iter().zip(other.state().0) {
///     assert!((a - b).abs() < 1e-5);
/// }
/// ```
#[derive(Debug)]
pub struct RapierPlant {
    engine: Engine,
    terms: TermForces,
    rotors: Option<CoupledRotors>,
    substeps: NonZeroU32,
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    taken: Vec<f64>,
    damping: Vec<f64>,
    applied: Vec<f64>,
    torque: Vec<f64>,
    model: Model,
    /// The engine switches bodies off whose state is no longer a number: it must be built anew.
    broken: bool,
}

/// What the engine is built from.
#[derive(Debug)]
struct Model {
    robot: Robot,
    parameters: StandardParameters,
    armature: Vec<f64>,
}

impl Model {
    fn engine(&self) -> Result<Engine, RapierError> {
        Engine::new(&self.robot, &self.parameters, &self.armature)
    }
}

impl RapierPlant {
    /// The arm with these, true, parameters; at rest at zero.
    ///
    /// # Errors
    /// [`RapierError`] where the parameters are not the robot's own, a link's inertia is not that of a body, a rotor's
    /// is negative, or a plant cannot simulate one of the torque terms.
    pub fn new(robot: &Robot, parameters: &StandardParameters) -> Result<Self, RapierError> {
        let n = robot.dof();
        let found = parameters.links.len().min(parameters.drives.len());
        if found != n {
            return Err(RapierError::Parameters { found, expected: n });
        }
        for (joint, drive) in robot.joints().iter().zip(&parameters.drives) {
            if drive[ROTOR].is_nan() || drive[ROTOR] < 0.0 {
                return Err(RapierError::Rotor { joint: joint.name.clone(), rotor: drive[ROTOR] });
            }
        }
        let rotors = TorqueTerms::new(robot, Columns::RIGID_ROTOR).inertia(parameters);
        let armature = rotors.diagonal().iter().copied().collect();
        let model = Model { robot: robot.clone(), parameters: parameters.clone(), armature };
        let zeros = || vec![0.0; n];
        let mut plant = Self {
            engine: model.engine()?,
            terms: TermForces::new(robot, parameters)?,
            rotors: CoupledRotors::new(&rotors),
            substeps: DEFAULT_SUBSTEPS,
            q: zeros(),
            qd: zeros(),
            qdd: zeros(),
            taken: zeros(),
            damping: zeros(),
            applied: zeros(),
            torque: zeros(),
            model,
            broken: false,
        };
        plant.reset(&zeros(), &zeros());
        Ok(plant)
    }

    /// Returns this arm, each of its steps made of this many steps of the engine. The error is inverse to their number.
    #[must_use]
    pub const fn with_substeps(mut self, substeps: NonZeroU32) -> Self {
        self.substeps = substeps;
        self
    }

    /// The engine's own mass matrix in the present state, rotors included, n × n.
    ///
    /// The rotors are those that the plant gives to the engine; the links are assembled by the engine from its bodies.
    pub fn mass_matrix(&mut self) -> DMatrix<f64> {
        let mass = self.engine.mass_matrix();
        match &self.rotors {
            Some(rotors) => mass + rotors.rest(),
            None => mass,
        }
    }

    /// Joint accelerations under the efforts `tau` in the present state, by the engine; n each. The state stays.
    ///
    /// # Panics
    /// If a slice has another length than n.
    pub fn acceleration(&mut self, tau: &[f64], qdd: &mut [f64]) {
        let (q, qd) = (self.q.clone(), self.qd.clone());
        self.advance(tau, INSTANT);
        qdd.copy_from_slice(&self.qdd);
        self.reset(&q, &qd);
    }

    /// One step of the engine.
    fn advance(&mut self, tau: &[f64], h: f64) {
        if self.rotors.as_ref().is_some_and(|rotors| !rotors.knows_bias()) {
            let (q, qd) = (self.q.clone(), self.qd.clone());
            self.push(tau, h);
            self.engine.set_state(&q, &qd);
            self.engine.read_state(&mut self.q, &mut self.qd);
        }
        self.push(tau, h);
    }

    fn push(&mut self, tau: &[f64], h: f64) {
        self.terms.evaluate(&self.q, &self.qd, &mut self.taken, &mut self.damping);
        for i in 0..self.q.len() {
            // What acts at the present velocity, and what the engine gets besides its damping.
            self.applied[i] = tau[i] - self.taken[i];
            self.torque[i] = self.applied[i] + self.damping[i] * self.qd[i];
        }
        let mass = self.rotors.as_mut().map(|rotors| {
            let mut mass = self.engine.mass_matrix();
            for (i, damping) in self.damping.iter().enumerate() {
                mass[(i, i)] += h * damping;
            }
            for (i, extra) in rotors.torque(&mass, &self.applied).iter().enumerate() {
                self.torque[i] += extra;
                self.applied[i] += extra;
            }
            mass
        });
        self.engine.set_forces(&self.q, &self.torque, &self.damping);
        self.engine.step(h);
        self.engine.read_state(&mut self.q, &mut self.qd);
        self.engine.acceleration(&mut self.qdd);
        if let (Some(rotors), Some(mass)) = (&mut self.rotors, mass) {
            rotors.observe(&mass, &self.applied, &self.qdd);
        }
    }
}

impl Plant for RapierPlant {
    fn dof(&self) -> usize {
        self.q.len()
    }

    fn state(&self) -> (&[f64], &[f64]) {
        (&self.q, &self.qd)
    }

    fn reset(&mut self, q: &[f64], qd: &[f64]) {
        if self.broken {
            self.engine = self.model.engine().expect("what was built before can be built again");
            self.broken = false;
        }
        self.engine.set_state(q, qd);
        self.q.copy_from_slice(q);
        self.qd.copy_from_slice(qd);
        if let Some(rotors) = &mut self.rotors {
            rotors.reset();
        }
    }

    fn step(&mut self, tau: &[f64], dt: f64) -> Result<(), PlantError> {
        if let Some(joint) = tau.iter().position(|tau| !tau.is_finite()) {
            return Err(PlantError::NotFinite { joint: joint + 1, quantity: "effort", value: tau[joint] });
        }
        let h = dt / f64::from(self.substeps.get());
        for _ in 0..self.substeps.get() {
            self.advance(tau, h);
            if let Some(fault) = PlantError::of_state(&self.q, &self.qd) {
                self.broken = true;
                return Err(fault);
            }
        }
        Ok(())
    }
}
