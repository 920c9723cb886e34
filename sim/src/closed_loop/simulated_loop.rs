//! The closed loop along the plans of recordings, for any parameters.

use std::sync::{Arc, OnceLock};

use armid::dynamics::States;
use armid::estimation::{
    ClosedLoop, ClosedLoopError, ClosedLoopInterval, ClosedLoopIntervals, ClosedLoopMotion, ClosedLoopNode,
    ClosedLoopReference, ClosedLoopSlopes,
};
use armid::experiment::{ArmError, CommandTable, ExperimentPlan, JointLoop, Sensing};
use armid::model::{ParameterId, Robot, StandardParameters};
use armid::observer::Observer;
use armid::seed::Seed;
use nalgebra::DMatrix;

use super::bodies::{Body, SlopedBody};
use super::commanded::CommandLoop;
use super::intervals::{self, Walker};
use super::period_mean::Period;
use super::walk::{Motion, go_on, mean_period};
use crate::AnalyticPlant;
use crate::analytic::sloped_arm;

/// The analytic plant under a robot's servo, along plans.
///
/// ```
/// use armid::estimation::{ClosedLoop, ClosedLoopReference};
/// use armid::experiment::ExperimentPlan;
/// use armid::model::bundled;
/// use armid::model::format::{parse_nominal, parse_robot};
/// use armid::observer::Unobserved;
/// use armid::trajectory::{FourierJoint, FourierTrajectory};
/// let entry = bundled().iter().find(|entry| entry.name == "planar-2r").unwrap();
/// let robot = parse_robot(entry.robot)?;
/// let nominal = parse_nominal(entry.nominal, &robot)?.parameters;
/// let series = |name: &str| FourierJoint { name: name.into(), a: vec![0.2], b: vec![0.1], q0: 0.0 };
/// let joints = robot.joints().iter().map(|joint| series(&joint.name)).collect();
/// let plan = ExperimentPlan::new(FourierTrajectory { period_s: 1.0, joints });
/// let closed_loop = armid_sim::closed_loop(&robot, &nominal, ClosedLoopReference::Plans(&[plan]))?;
/// assert_eq!(closed_loop.motion(&nominal, &Unobserved)?.states.len(), 1000);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct SimulatedLoop {
    robot: Robot,
    nominal: StandardParameters,
    plans: Vec<ExperimentPlan>,
    joints: JointLoop,
    /// Made when they are first asked for.
    motions: OnceLock<Vec<Motion>>,
}

/// The closed loop of a robot along plans, whose servo's gains are placed on nominal parameters, or along the commands of logs: what
/// [`armid::estimation::ClosedLoopFactory`] asks for.
///
/// # Errors
/// [`ClosedLoopError::Unsimulable`] where the plant cannot simulate the robot, or its servo not perform a plan.
pub fn closed_loop(
    robot: &Robot,
    nominal: &StandardParameters,
    reference: ClosedLoopReference<'_>,
) -> Result<Arc<dyn ClosedLoop>, ClosedLoopError> {
    Ok(match reference {
        ClosedLoopReference::Plans(plans) => Arc::new(SimulatedLoop::new(robot, nominal, plans)?),
        ClosedLoopReference::Commands(servo, samples) => Arc::new(CommandLoop::new(robot, nominal, servo, samples)?),
    })
}

fn unsimulable(reason: &impl ToString) -> ClosedLoopError {
    ClosedLoopError::Unsimulable { reason: reason.to_string() }
}

impl SimulatedLoop {
    /// See [`closed_loop`].
    ///
    /// # Errors
    /// As there.
    pub fn new(robot: &Robot, nominal: &StandardParameters, plans: &[ExperimentPlan]) -> Result<Self, ClosedLoopError> {
        AnalyticPlant::new(robot, nominal).map_err(|fault| unsimulable(&fault))?;
        let joints = JointLoop::new(robot, nominal, &Sensing::ideal(), Seed::new(0), 0);
        let joints = joints.map_err(|fault| unsimulable(&fault))?;
        for plan in plans {
            plan.check(robot.dof()).map_err(|fault| unsimulable(&fault))?;
            let ratio = robot.servo().rate_hz / plan.rate_hz;
            if ratio < 0.5 || (ratio - ratio.round()).abs() > 1e-9 * ratio {
                let (servo_hz, rate_hz) = (robot.servo().rate_hz, plan.rate_hz);
                return Err(unsimulable(&ArmError::Rate { servo_hz, rate_hz }));
            }
        }
        let motions = OnceLock::new();
        Ok(Self { robot: robot.clone(), nominal: nominal.clone(), plans: plans.to_vec(), joints, motions })
    }

    /// The plans as the servo sees them.
    fn motions(&self) -> &[Motion] {
        self.motions.get_or_init(|| {
            let motion = |plan: &ExperimentPlan| {
                let layout = plan.layout().ok()?;
                let per_sample = (self.robot.servo().rate_hz / plan.rate_hz).round() as usize;
                let table = CommandTable::new(plan, &layout, per_sample);
                Some(Motion { layout, table, per_sample })
            };
            // Checked when this was made.
            self.plans.iter().filter_map(motion).collect()
        })
    }

    fn plant(&self, parameters: &StandardParameters) -> Result<AnalyticPlant, ClosedLoopError> {
        AnalyticPlant::new(&self.robot, parameters).map_err(|fault| unsimulable(&fault))
    }

    /// The mean periods of all plans, one after the other.
    fn periods(
        &self,
        parameters: &StandardParameters,
        body: impl Fn() -> Result<Box<dyn Body>, ClosedLoopError>,
        block: usize,
        observer: &dyn Observer,
    ) -> Result<Vec<Period>, ClosedLoopError> {
        let mut plant = self.plant(parameters)?;
        let motions = self.motions().iter();
        motions
            .map(|motion| {
                mean_period(&self.robot, motion, self.joints.clone(), (&mut plant, &mut *body()?), block, observer)
            })
            .collect()
    }

    fn joined(&self, periods: &mut [Period]) -> ClosedLoopMotion {
        let mut table = |k: usize| -> Vec<f64> { periods.iter_mut().flat_map(|p| std::mem::take(&mut p[k])).collect() };
        let (q, qd, qdd, tau) = (table(0), table(1), table(2), table(3));
        ClosedLoopMotion { states: States { dof: self.robot.dof(), q, qd, qdd }, tau }
    }
}

impl ClosedLoop for SimulatedLoop {
    fn nominal(&self) -> &StandardParameters {
        &self.nominal
    }

    fn motion(
        &self,
        parameters: &StandardParameters,
        observer: &dyn Observer,
    ) -> Result<ClosedLoopMotion, ClosedLoopError> {
        let body = || -> Result<Box<dyn Body>, ClosedLoopError> { Ok(Box::new(self.plant(parameters)?)) };
        Ok(self.joined(&mut self.periods(parameters, body, 1, observer)?))
    }

    fn slopes(
        &self,
        parameters: &StandardParameters,
        by: &[ParameterId],
        block: usize,
        observer: &dyn Observer,
    ) -> Result<(ClosedLoopMotion, ClosedLoopSlopes), ClosedLoopError> {
        let (n, d) = (self.robot.dof(), by.len());
        let body = || -> Result<Box<dyn Body>, ClosedLoopError> {
            let arm = sloped_arm(&self.robot, parameters, by, 0).map_err(|fault| unsimulable(&fault))?;
            Ok(Box::new(SlopedBody::new(arm, n, d)))
        };
        let mut periods = self.periods(parameters, body, block, observer)?;
        let mut slopes = |k: usize| {
            let rows: Vec<f64> = periods.iter_mut().flat_map(|period| std::mem::take(&mut period[k])).collect();
            DMatrix::from_row_slice(rows.len() / d.max(1), d, &rows) / block as f64
        };
        let slopes = ClosedLoopSlopes { q: slopes(4), tau: slopes(5) };
        Ok((self.joined(&mut periods), slopes))
    }

    fn in_intervals(&self) -> Option<&dyn ClosedLoopIntervals> {
        Some(self)
    }
}

impl ClosedLoopIntervals for SimulatedLoop {
    fn nodes(&self, states: &States, tau: &[f64], block: usize, apart: usize) -> Vec<ClosedLoopNode> {
        let mut first = 0;
        let mut nodes = Vec::new();
        for motion in self.motions() {
            nodes.extend(intervals::nodes(motion, self.joints.clone(), (states, tau, first), block, apart));
            first += motion.layout.period_samples;
        }
        nodes
    }

    fn intervals(
        &self,
        parameters: &StandardParameters,
        by: &[ParameterId],
        block: usize,
        nodes: &[ClosedLoopNode],
        observer: &dyn Observer,
    ) -> Result<Vec<ClosedLoopInterval>, ClosedLoopError> {
        let state = nodes.first().map_or(0, |node| node.state.len());
        let mut walker = Walker {
            robot: &self.robot,
            plant: self.plant(parameters)?,
            arm: sloped_arm(&self.robot, parameters, by, state).map_err(|fault| unsimulable(&fault))?,
            joints: self.joints.clone(),
            parameters: by.len(),
        };
        let mut motions = self.motions().iter();
        let (mut motion, mut first, mut next) = (motions.next(), 0, 0);
        let mut found = Vec::with_capacity(nodes.len());
        for (k, node) in nodes.iter().enumerate() {
            if k == 0 || !node.follows {
                // The recording whose blocks these are.
                while let Some(own) = motion {
                    next = first + own.layout.period_samples / block;
                    if node.blocks.start < next {
                        break;
                    }
                    (motion, first) = (motions.next(), next);
                }
            }
            let missing = ClosedLoopError::Samples { found: next * block, expected: node.blocks.end * block };
            go_on(observer, 10 * k, 10 * nodes.len())?;
            found.push(walker.interval(motion.ok_or(missing)?, (node, first), block)?);
        }
        Ok(found)
    }
}
