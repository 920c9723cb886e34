//! MuJoCo as a plant: its forward dynamics, the core's friction, and a choice of integrators.

use armid::dynamics::check_simulable;
use armid::experiment::{Plant, PlantError};
use armid::model::{Robot, StandardParameters};

use super::term_forces::TermForces;
use super::{MujocoError, MujocoModel, MujocoStepper};

/// Largest `λ h` of a part of a step, `λ` the rate at which friction makes velocities decay; explicit Runge–Kutta is
/// stable up to 2.78, Euler up to 2.
const STIFFNESS: f64 = 0.8;
/// More parts than this a step never has.
const MOST_PARTS: usize = 64;

/// How a step is taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MujocoScheme {
    /// Runge–Kutta of order 4 around MuJoCo's forward dynamics, friction evaluated at each of its four stages: order 4.
    #[default]
    Stages,
    /// MuJoCo's own Runge–Kutta. It takes generalised forces as constant over a step, so friction is that at the step's
    /// beginning: order 4 without friction, order 1 with it.
    HeldRungeKutta,
    /// MuJoCo's own semi-implicit Euler, friction at the step's beginning: order 1.
    HeldEuler,
}

/// A robot simulated by MuJoCo.
///
/// ```
/// use armid::conformance::chains;
/// use armid::experiment::Plant;
/// use armid::model::StandardParameters;
/// use armid::spatial::Inertia;
/// use armid_sim::MujocoPlant;
/// use nalgebra::{Matrix3, Vector3};
/// // Two bars that hang straight down stay where they are.
/// let robot = chains::planar_2r();
/// let mut bars = StandardParameters::zero(2);
/// for link in &mut bars.links {
///     *link = Inertia::from_com(1.0, Vector3::new(-0.2, 0.0, 0.0), Matrix3::from_diagonal_element(0.01));
/// }
/// let mut plant = MujocoPlant::new(&robot, &bars).unwrap_or_else(|fault| panic!("{fault}"));
/// plant.reset(&[-std::f64::consts::FRAC_PI_2, 0.0], &[0.0; 2]);
/// plant.step(&[0.0; 2], 1e-3).unwrap();
/// assert!(plant.state().1.iter().all(|v| v.abs() < 1e-14));
/// ```
#[derive(Clone, Debug)]
pub struct MujocoPlant {
    model: MujocoModel,
    forces: TermForces,
    scheme: MujocoScheme,
    substeps: usize,
    work: Workspace,
}

/// Vectors of length n; the last two n × n.
#[derive(Clone, Debug)]
struct Workspace {
    /// State at the beginning of a step.
    q: Vec<f64>,
    qd: Vec<f64>,
    /// State of a stage.
    stage_q: Vec<f64>,
    stage_qd: Vec<f64>,
    /// Weighted sums of the stages' velocities and accelerations.
    sum_q: Vec<f64>,
    sum_qd: Vec<f64>,
    applied: Vec<f64>,
    change: Vec<f64>,
    identity: Vec<f64>,
    inverse: Vec<f64>,
}

impl Workspace {
    fn new(n: usize) -> Self {
        let zeros = vec![0.0; n];
        let mut identity = vec![0.0; n * n];
        for i in 0..n {
            identity[i * n + i] = 1.0;
        }
        Self {
            q: zeros.clone(),
            qd: zeros.clone(),
            stage_q: zeros.clone(),
            stage_qd: zeros.clone(),
            sum_q: zeros.clone(),
            sum_qd: zeros.clone(),
            applied: zeros.clone(),
            change: zeros,
            inverse: identity.clone(),
            identity,
        }
    }
}

impl MujocoPlant {
    /// The arm with these, true, parameters; at rest at zero.
    ///
    /// # Errors
    /// [`MujocoError`] where there is no library, MuJoCo cannot simulate these parameters, or has no way to
    /// simulate one of the torque terms.
    pub fn new(robot: &Robot, parameters: &StandardParameters) -> Result<Self, MujocoError> {
        check_simulable(robot, parameters)?;
        Ok(Self {
            model: MujocoModel::new(robot, parameters)?,
            forces: TermForces::new(robot, parameters),
            scheme: MujocoScheme::default(),
            substeps: 1,
            work: Workspace::new(robot.dof()),
        })
    }

    /// Returns this plant with another way of taking a step.
    #[must_use]
    pub fn with_scheme(mut self, scheme: MujocoScheme) -> Self {
        self.scheme = scheme;
        self
    }

    /// Returns this plant with each step divided into this many equal ones, at least one.
    #[must_use]
    pub fn with_substeps(mut self, substeps: usize) -> Self {
        self.substeps = substeps.max(1);
        self
    }

    /// Joint accelerations under the efforts `tau` in the present state; n each.
    ///
    /// # Panics
    /// If a slice has another length than n.
    pub fn acceleration(&mut self, tau: &[f64], qdd: &mut [f64]) {
        let (q, qd) = self.model.state();
        self.forces.apply(tau, q, qd, &mut self.work.applied);
        self.model.apply(&self.work.applied);
        qdd.copy_from_slice(self.model.forward());
    }

    /// One step of length `h`, or several where friction is stiff.
    fn substep(&mut self, tau: &[f64], h: f64) {
        self.accelerate(tau);
        let parts = self.parts(h);
        let h = h / parts as f64;
        for part in 0..parts {
            if part > 0 {
                self.accelerate(tau);
            }
            match self.scheme {
                MujocoScheme::Stages => self.stages(tau, h),
                MujocoScheme::HeldRungeKutta => self.model.advance(MujocoStepper::RungeKutta, h),
                MujocoScheme::HeldEuler => self.model.advance(MujocoStepper::Euler, h),
            }
        }
    }

    /// Forward dynamics of the present state.
    fn accelerate(&mut self, tau: &[f64]) {
        let (q, qd) = self.model.state();
        self.forces.apply(tau, q, qd, &mut self.work.applied);
        self.model.apply(&self.work.applied);
        self.model.forward();
    }

    /// How many parts a step of length `h` needs.
    fn parts(&mut self, h: f64) -> usize {
        let work = &mut self.work;
        // Half again as much as the acceleration at the beginning promises.
        for (change, a) in work.change.iter_mut().zip(self.model.acceleration()) {
            *change = 1.5 * a.abs() * h;
        }
        let (q, qd) = self.model.state();
        if self.forces.coarse_decay(q, qd, &work.change) * h <= STIFFNESS {
            return 1;
        }
        self.model.solve_mass(&work.identity, &mut work.inverse);
        let (q, qd) = self.model.state();
        let rate = self.forces.decay(q, qd, &work.change, &work.inverse);
        // NaN becomes one part; the caller finds the state not finite.
        ((rate * h / STIFFNESS).ceil().min(MOST_PARTS as f64) as usize).max(1)
    }

    /// The classical method of order 4, its first stage computed already:
    /// `y ← y + h/6 (k₁ + 2k₂ + 2k₃ + k₄)`, `y = (q, q̇)`, `k = (q̇, q̈)`.
    fn stages(&mut self, tau: &[f64], h: f64) {
        let n = self.model.dof();
        let (q, qd) = self.model.state();
        self.work.q.copy_from_slice(q);
        self.work.qd.copy_from_slice(qd);
        for (stage, (weight, ahead)) in [(1.0, 0.5 * h), (2.0, 0.5 * h), (2.0, h), (1.0, 0.0)].into_iter().enumerate() {
            if stage > 0 {
                self.accelerate(tau);
            }
            let (_, v) = self.model.state();
            let a = self.model.acceleration();
            let w = &mut self.work;
            for i in 0..n {
                let (first_q, first_qd) = if stage == 0 { (0.0, 0.0) } else { (w.sum_q[i], w.sum_qd[i]) };
                (w.sum_q[i], w.sum_qd[i]) = (first_q + weight * v[i], first_qd + weight * a[i]);
                (w.stage_q[i], w.stage_qd[i]) = (w.q[i] + ahead * v[i], w.qd[i] + ahead * a[i]);
            }
            if stage == 3 {
                for i in 0..n {
                    w.stage_q[i] = w.q[i] + h / 6.0 * w.sum_q[i];
                    w.stage_qd[i] = w.qd[i] + h / 6.0 * w.sum_qd[i];
                }
            }
            self.model.set_state(&self.work.stage_q, &self.work.stage_qd);
        }
    }
}

impl Plant for MujocoPlant {
    fn dof(&self) -> usize {
        self.model.dof()
    }

    fn state(&self) -> (&[f64], &[f64]) {
        self.model.state()
    }

    fn reset(&mut self, q: &[f64], qd: &[f64]) {
        self.model.reset();
        self.model.set_state(q, qd);
    }

    fn step(&mut self, tau: &[f64], dt: f64) -> Result<(), PlantError> {
        let h = dt / self.substeps as f64;
        for _ in 0..self.substeps {
            self.substep(tau, h);
        }
        let (q, qd) = self.model.state();
        if let Some(fault) = PlantError::of_state(q, qd) {
            return Err(fault);
        }
        match self.model.singular() {
            0 => Ok(()),
            count => Err(PlantError::Engine {
                engine: "MuJoCo",
                reason: format!("found a singular mass matrix {count} times, expected one that can be inverted"),
            }),
        }
    }
}
