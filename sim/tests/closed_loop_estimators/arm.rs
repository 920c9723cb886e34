//! An arm, what is known of it, and what is true.

use std::sync::Arc;

use armid::base::{BaseReduction, Method, reduce};
use armid::estimation::{ClosedLoop, Estimate, EstimationProblem, EstimatorKind, Observation, closed_loop_of};
use armid::experiment::{ExperimentPlan, Recording, Sensing, Servo, record};
use armid::model::format::{parse_nominal, parse_parameters, parse_robot};
use armid::model::{Columns, Robot, StandardParameters, bundled};
use armid::regressor::JointTorqueRegressor;
use armid::seed::Seed;
use armid::signal::Samples;
use armid::study::radkhah2007::table_one;
use armid::study::truth_text;
use armid::trajectory::FourierTrajectory;
use armid_sim::{AnalyticPlant, closed_loop};
use nalgebra::DVector;

pub(crate) const COLUMNS: Columns = Columns::RIGID_ROTOR_FRICTION;

/// See above.
pub(crate) struct Arm {
    pub(crate) robot: Robot,
    pub(crate) nominal: StandardParameters,
    pub(crate) truth: StandardParameters,
    pub(crate) regressor: JointTorqueRegressor,
    pub(crate) base: BaseReduction,
}

impl Arm {
    pub(crate) fn new(name: &str) -> Self {
        let entry = bundled().iter().find(|entry| entry.name == name).unwrap();
        let robot = parse_robot(entry.robot).unwrap();
        Self {
            nominal: parse_nominal(entry.nominal, &robot).unwrap().parameters,
            truth: parse_parameters(truth_text(name).unwrap(), &robot, true).unwrap().parameters,
            regressor: JointTorqueRegressor::new(&robot, COLUMNS).expect("columns of motion"),
            base: reduce(&robot, COLUMNS, Method::Structural, Seed::new(1)).unwrap(),
            robot,
        }
    }

    pub(crate) fn beta(&self) -> DVector<f64> {
        self.base.beta(&self.truth.vector(&self.robot, COLUMNS))
    }

    pub(crate) fn record(&self, plan: &ExperimentPlan, sensing: Sensing, run: u64) -> Recording {
        let plant = AnalyticPlant::new(&self.robot, &self.truth).unwrap();
        let servo = Servo::new(&self.robot, &self.nominal, plant).unwrap();
        record(&mut servo.with_sensing(sensing).with_seed(Seed::new(5), run), plan).unwrap().0
    }

    pub(crate) fn closed_loop(&self, recording: &Recording) -> Arc<dyn ClosedLoop> {
        closed_loop_of(Some(closed_loop), &self.robot, Some(&self.nominal), &[Some(recording)]).unwrap()
    }

    pub(crate) fn estimate(&self, kind: EstimatorKind, recording: &Recording, samples: &Samples) -> Estimate {
        self.estimate_from(None, kind, recording, samples)
    }

    pub(crate) fn estimate_from(
        &self,
        start: Option<&StandardParameters>,
        kind: EstimatorKind,
        recording: &Recording,
        samples: &Samples,
    ) -> Estimate {
        let observation = Observation::new(&self.robot, &self.regressor, &self.base, samples).unwrap();
        let known = self.closed_loop(recording);
        let problem = EstimationProblem {
            robot: Some(&self.robot),
            samples: Some(samples),
            nominal: Some(&self.nominal),
            closed_loop: Ok(&*known),
            ..EstimationProblem::new(&observation)
        };
        kind.estimator().estimate(&EstimationProblem { start, ..problem }).unwrap()
    }

    pub(crate) fn error(&self, estimate: &Estimate) -> f64 {
        (estimate.beta() - self.beta()).norm() / self.beta().norm()
    }
}

/// `radkhah2007`'s motion at a part of its speed and another period, about the middle of an arm's range.
pub(crate) fn gentle(robot: &Robot, period_s: f64, part: f64) -> FourierTrajectory {
    let table = table_one::corrected();
    let joints = robot.joints().iter().zip(&table.joints).map(|(joint, series)| {
        let (low, high) = joint.limits.position;
        let mut series = series.clone();
        series.name.clone_from(&joint.name);
        series.q0 = if (high - low).is_finite() { 0.5 * (low + high) } else { 0.0 };
        series.a.iter_mut().chain(&mut series.b).for_each(|amplitude| *amplitude *= part);
        series
    });
    FourierTrajectory { period_s, joints: joints.collect() }
}

/// A short experiment.
pub(crate) fn short(robot: &Robot) -> ExperimentPlan {
    ExperimentPlan {
        settle_s: 0.1,
        ramp_s: 0.4,
        rate_hz: 500.0,
        ..ExperimentPlan::new(gentle(robot, 1.0, 0.8)).with_periods(3)
    }
}

/// A slower one, along which processing finds velocity and acceleration well.
pub(crate) fn slow(robot: &Robot) -> ExperimentPlan {
    ExperimentPlan { settle_s: 0.1, ramp_s: 1.0, ..ExperimentPlan::new(gentle(robot, 5.0, 0.8)).with_periods(3) }
}
