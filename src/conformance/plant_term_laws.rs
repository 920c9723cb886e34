//! What every plant obeys with every torque term: what is simulated is what the regressor says.
//!
//! ```text
//! τ = Y(q, q̇, q̈) φ,  φ = (links, one term)        plant at (q, q̇) under τ:  dq̇/dt = q̈
//! ```
//! The parameters are those of the links and of the one term, so that no other can hide what is missing.
//!
//! - A term of the motion alone is in the plant: from random states, the velocity under the torque that the regressor asks
//!   for an acceleration grows at this acceleration. The rate is extrapolated to steps of no length, so that an engine of any
//!   order is judged by its equations of motion.
//! - A term of the transmitted torque or of temperature is in no plant: the servo of an [`ActualArm`] holds it around the
//!   plant. Along an experiment the effort of the motors is the regressor times the parameters, at the middle of each step.
//!   A gear begins cold, and an experiment of seconds leaves it so: the column of a term of temperature is zero.

use rand::RngExt;

use super::chains::{ChainRecipe, random_state};
use super::law_error::LawError;
use crate::dynamics::Dynamics;
use crate::excitation::radkhah2007_start;
use crate::experiment::{ActualArm, Discarding, Effects, ExperimentPlan, Next, Plant, Servo};
use crate::model::term::Term;
use crate::model::{Columns, Robot, StandardParameters};
use crate::regressor::JointTorqueRegressor;
use crate::seed::{Seed, Stream};

/// How exact an engine claims to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TermTolerance {
    /// Rate of the velocity against the acceleration, relative to the largest one.
    pub acceleration: f64,
    /// Effort of the motors along an experiment against the regressor, root mean square, relative to that of the term.
    pub effort: f64,
}

impl TermTolerance {
    /// A method of order 4 on equations of motion that are exact but for rounding: what is left is the third power of the
    /// step, 1e-4 s, times a friction's rate of decay, up to some hundred 1/s. A torque that is held over a servo step of
    /// 1 ms lags by half of one behind a load that turns over within a second.
    pub const FOURTH_ORDER: Self = Self { acceleration: 1e-5, effort: 0.03 };
    /// A method of order 1, whose state after a reset is off by 1e-9 or so: divided by the step, and that of a whole step
    /// along an experiment.
    pub const FIRST_ORDER: Self = Self { acceleration: 1e-3, effort: 0.1 };
}

/// Random arms that each term is shown on.
const ARMS: u64 = 6;

/// Random arms that perform an experiment.
const EXPERIMENTS: u64 = 2;

/// States of each.
const STATES: usize = 4;

/// The longest step, s; the others are a half and a quarter of it.
const STEP: f64 = 1e-4;

/// How far above its tolerance a term must show, so that a plant without it is found.
const SHOWN: f64 = 30.0;

/// Checks one term, of the list or from outside, in one kind of plant, which `make` builds anew each time.
///
/// ```text
/// for &term in Term::ALL {
///     plant_term_laws::check(term, &TermTolerance::FOURTH_ORDER, |r, p| MyPlant::new(r, p))?;
/// }
/// ```
///
/// # Errors
/// [`LawError`]: the first law that does not hold, with what was found.
pub fn check<P: Plant>(
    term: Term,
    tolerance: &TermTolerance,
    make: impl Fn(&Robot, &StandardParameters) -> P,
) -> Result<(), LawError> {
    if !term.entry().needs.is_motion() {
        return (0..EXPERIMENTS).try_for_each(|run| Arm::draw(term, run).effort(tolerance, &make));
    }
    let mut shown: f64 = 0.0;
    for run in 0..ARMS {
        shown = shown.max(Arm::draw(term, run).acceleration(tolerance, &make)?);
    }
    let law = "a term shows in the accelerations of an arm";
    let expected = SHOWN * tolerance.acceleration;
    LawError::unless(law, shown >= expected, format!("{shown:e}"), format!("{expected:e} or more"))
}

/// An arm of links and one term.
struct Arm {
    term: Term,
    robot: Robot,
    parameters: StandardParameters,
    rng: Stream,
}

impl Arm {
    fn draw(term: Term, run: u64) -> Self {
        let mut rng = Seed::new(6).stream("plant term laws", run);
        let coupled = term.is_motors() || run.is_multiple_of(2);
        let (robot, parameters) = ChainRecipe { coupled, tilted: true, ..ChainRecipe::new(3) }.draw(&mut rng);
        // A speed or a place at which a law turns over stands where the random states are, so that the term shows.
        let drives = robot.joints().iter().map(|joint| {
            let mut drive = joint.drive.clone();
            for shape in term.entry().shapes.iter().filter(|shape| !shape.smooths) {
                drive.shapes.insert(shape.key.to_owned(), rng.random_range(0.5..1.5));
            }
            drive
        });
        let drives = drives.collect();
        let robot = robot.with_drives(drives);
        let mut parameters = parameters.links_alone();
        for (index, drive) in parameters.drives.iter_mut().enumerate() {
            if term.is_at(&robot, index) {
                // A share of the transmitted torque, or a coefficient in its unit.
                let size = if term.entry().needs.load { 0.1 } else { 1.0 };
                drive[term] = size * rng.random_range(0.5..1.0);
            }
        }
        Self { term, robot, parameters, rng }
    }

    fn columns(&self) -> Columns {
        Columns::RIGID.with_term(self.term)
    }

    /// The efforts that the regressor gives, and those of the links alone.
    fn predicted(&self, regressor: &JointTorqueRegressor, (q, qd, qdd): (&[f64], &[f64], &[f64])) -> [Vec<f64>; 2] {
        let (n, p) = (regressor.rows(), regressor.cols());
        let mut y = vec![0.0; n * p];
        regressor.evaluate(q, qd, qdd, &mut y);
        let phi = self.parameters.vector(&self.robot, self.columns());
        [p, 10 * n].map(|count| {
            y.chunks_exact(p).map(|row| row.iter().zip(&phi).take(count).map(|(y, phi)| y * phi).sum()).collect()
        })
    }

    /// Checks accelerations, and returns how much of them the term makes, at most.
    fn acceleration<P: Plant>(
        &self,
        tolerance: &TermTolerance,
        make: impl Fn(&Robot, &StandardParameters) -> P,
    ) -> Result<f64, LawError> {
        let law = "under the torque of the regressor the velocity grows at the acceleration";
        let regressor = JointTorqueRegressor::with_load(&self.robot, self.columns(), &self.parameters);
        let mut links = Dynamics::new(&self.robot, &self.parameters.links_alone());
        let (mut plant, mut rng) = (make(&self.robot, &self.parameters), self.rng.clone());
        let n = self.robot.dof();
        let mut shown: f64 = 0.0;
        for _ in 0..STATES {
            let (q, mut qd, qdd) = random_state(&mut rng, n);
            // Beyond the speeds at which a friction turns over, where its slope is steepest.
            qd.iter_mut().for_each(|qd| *qd = (qd.abs() + 0.3).copysign(*qd));
            let [tau, _] = self.predicted(&regressor, (&q, &qd, &qdd));
            let mut rate = |dt: f64| -> Result<Vec<f64>, LawError> {
                plant.reset(&q, &qd);
                plant.step(&tau, dt).map_err(|fault| LawError::failed(law, &fault, "a plant that goes on"))?;
                Ok(plant.state().1.iter().zip(&qd).map(|(after, before)| (after - before) / dt).collect())
            };
            let rates = [rate(STEP)?, rate(STEP / 2.0)?, rate(STEP / 4.0)?];
            let mut without = vec![0.0; n];
            links.forward(&q, &qd, &tau, &mut without);
            let size = qdd.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
            for i in 0..n {
                // Twice extrapolated: the errors of the first and the second power of the step cancel.
                let [first, second] = [2.0 * rates[1][i] - rates[0][i], 2.0 * rates[2][i] - rates[1][i]];
                let found = (4.0 * second - first) / 3.0;
                LawError::unless_at_most(law, (found - qdd[i]).abs() / size, tolerance.acceleration)?;
                shown = shown.max((without[i] - qdd[i]).abs() / size);
            }
        }
        Ok(shown)
    }

    /// Checks the effort of the motors along an experiment.
    fn effort<P: Plant>(
        &self,
        tolerance: &TermTolerance,
        make: impl Fn(&Robot, &StandardParameters) -> P,
    ) -> Result<(), LawError> {
        let law = "along an experiment the effort of the motors is the regressor times the parameters";
        let broken = |found: String| LawError { law, found, expected: "an experiment".into() };
        let trajectory = radkhah2007_start(&self.robot, 4.0, 2, Seed::new(6), 0).map_err(|e| broken(e.to_string()))?;
        let plan = ExperimentPlan { settle_s: 0.1, ramp_s: 0.5, periods: 1, ..ExperimentPlan::new(trajectory) };
        let plan = ExperimentPlan { discarded_periods: 0, ..plan };
        let actual = ActualArm::new(&Effects::none(), &self.robot, &self.parameters);
        let mut plant = make(actual.robot(), actual.parameters());
        let idle = make(actual.robot(), actual.parameters());
        let servo = Servo::new(&self.robot, &self.parameters.links_alone(), idle).map_err(|e| broken(e.to_string()))?;
        let mut cycle = servo.with_effects(actual).cycle(&plan).map_err(|e| broken(e.to_string()))?;
        let regressor = JointTorqueRegressor::with_load(&self.robot, self.columns(), &self.parameters);
        let n = self.robot.dof();
        plant.reset(cycle.start(), &vec![0.0; n]);
        let (parts, mut errors, mut sizes) = (cycle.parts(), 0.0, 0.0);
        let dt = cycle.dt() / parts as f64;
        loop {
            let (q, qd) = plant.state();
            if let Next::End(ending) = cycle.advance(q, qd, &mut Discarding, &mut |_| {}) {
                LawError::unless(law, ending.is_complete(), format!("{ending:?}"), "an experiment to its end")?;
                break;
            }
            let motors = cycle.tau().to_vec();
            for _ in 0..parts {
                let (q, qd) = plant.state();
                let before = [q.to_vec(), qd.to_vec()];
                cycle.push(q, qd);
                plant.step(cycle.tau(), dt).map_err(|fault| broken(fault.to_string()))?;
                let (q, qd) = plant.state();
                let middle = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| 0.5 * (x + y)).collect::<Vec<f64>>();
                let qdd: Vec<f64> = qd.iter().zip(&before[1]).map(|(after, before)| (after - before) / dt).collect();
                let (q, qd) = (middle(q, &before[0]), middle(qd, &before[1]));
                let [with, without] = self.predicted(&regressor, (&q, &qd, &qdd));
                for i in 0..n {
                    errors += (with[i] - motors[i]) * (with[i] - motors[i]);
                    // A warm gear would take as much as the coefficient times the speed.
                    let size = if self.term.entry().needs.warmth {
                        self.parameters.drives[i][self.term] * qd[i]
                    } else {
                        with[i] - without[i]
                    };
                    sizes += size * size;
                }
            }
        }
        LawError::unless_at_most(law, (errors / sizes).sqrt(), tolerance.effort)
    }
}
