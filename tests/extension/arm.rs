//! An arm of one's own: in the law suite, and identified.

use armid::conformance::arm_laws::{self, ArmTolerance};
use armid::conformance::chains::planar_2r;
use armid::dynamics::Dynamics;
use armid::estimation::{EstimatorKind, Identification};
use armid::experiment::{Arm, ArmError, Command, Ending, ExperimentPlan, RawSample, Recording, Rest, Sink, record};
use armid::model::term::{COULOMB, OFFSET, ROTOR, VISCOUS};
use armid::model::{Columns, DriveParameters, EffortInterface, Robot, StandardParameters};
use armid::seed::Seed;
use armid::signal::{Processing, process};
use armid::spatial::Inertia;
use armid::trajectory::{FourierJoint, FourierTrajectory};
use nalgebra::{Matrix3, Vector3};
use rand::RngExt;

/// An arm that follows its command exactly, and whose torque sensors have an error of their own at every sample.
#[derive(Clone)]
pub(crate) struct Exact {
    robot: Robot,
    truth: StandardParameters,
    /// Largest error of a torque, N·m.
    error: f64,
}

impl Exact {
    /// With sensors that have no error.
    pub(crate) fn new(robot: Robot) -> Self {
        let mut truth = StandardParameters::zero(robot.dof());
        for (index, link) in truth.links.iter_mut().enumerate() {
            let side = 0.2 - 0.05 * index as f64;
            *link = Inertia::from_com(3.0, Vector3::new(-side, 0.02, 0.0), Matrix3::from_diagonal_element(0.03));
        }
        truth.drives.fill(DriveParameters::from_iter([(ROTOR, 0.2), (VISCOUS, 1.5), (COULOMB, 2.0), (OFFSET, 0.3)]));
        Self { robot, truth, error: 0.0 }
    }
}

impl Arm for Exact {
    fn perform(&mut self, plan: &ExperimentPlan, sink: &mut dyn Sink) -> Result<Ending, ArmError> {
        let (n, layout) = (self.robot.dof(), plan.check(self.robot.dof())?);
        sink.begin(&Recording {
            effort_unit: EffortInterface::Torque,
            ..Recording::empty(&self.robot, "", plan, &layout, None)
        });
        let (command, mut dynamics) = (Command::new(plan, &layout), Dynamics::new(&self.robot, &self.truth));
        let mut rng = Seed::new(8).stream("torque sensors", 0);
        let [mut q, mut qd, mut qdd, mut tau] = [(); 4].map(|()| vec![0.0; n]);
        for index in 0..layout.samples() {
            let (t, phase) = (index as f64 / plan.rate_hz, layout.phase(index));
            command.evaluate(t, &mut q, &mut qd, &mut qdd);
            dynamics.inverse(&q, &qd, &qdd, &mut tau);
            tau.iter_mut().for_each(|tau| *tau += self.error * rng.random_range(-1.0..=1.0));
            let sample = RawSample { index, t, phase, q: &q, effort: &tau, voltage: &[], link_q: &[], command: &q };
            if sink.sample(&sample).ends() {
                return Ok(Ending::Stopped { t, phase, rest: Rest::Simulated });
            }
        }
        Ok(Ending::Completed)
    }
}

fn plan() -> ExperimentPlan {
    let joint = |name: &str, a: [f64; 3], b: [f64; 3], q0: f64| FourierJoint {
        name: name.to_owned(),
        a: a.to_vec(),
        b: b.to_vec(),
        q0,
    };
    let joints = vec![
        joint("shoulder", [0.8, -0.9, 0.4], [0.2, 0.5, -0.8], 0.1),
        joint("elbow", [-0.5, 1.0, 0.7], [0.9, -0.3, 0.6], -0.3),
    ];
    let trajectory = FourierTrajectory::new(5.0, joints).expect("a trajectory with a harmonic");
    ExperimentPlan { settle_s: 0.2, ramp_s: 1.0, periods: 4, ..ExperimentPlan::new(trajectory) }
}

#[test]
fn an_arm_from_outside_obeys_the_laws() {
    arm_laws::check(&plan(), &ArmTolerance::SIMULATED, || Exact::new(planar_2r())).unwrap();
    let noisy = || Exact { error: 0.5, ..Exact::new(planar_2r()) };
    arm_laws::check(&plan(), &ArmTolerance { tracking: 0.0, ..ArmTolerance::SIMULATED }, noisy).unwrap();
}

#[test]
fn an_arm_from_outside_is_identified() {
    let robot = planar_2r().with_spec(|spec| spec.effort = EffortInterface::Torque).unwrap();
    let identification = Identification::new(&robot, Columns::RIGID_ROTOR_FRICTION).unwrap();
    let mut errors = Vec::new();
    for error in [0.0, 0.5] {
        let mut arm = Exact { error, ..Exact::new(robot.clone()) };
        let exact = identification.base().beta(&arm.truth.vector(&robot, Columns::RIGID_ROTOR_FRICTION));
        let (recording, ending) = record(&mut arm, &plan()).unwrap();
        assert!(ending.is_complete());
        let samples = process(&recording, &robot, &Processing::default()).unwrap();
        let estimate = identification.estimate(&samples, EstimatorKind::Ols.estimator()).unwrap();
        errors.push((estimate.beta() - &exact).amax());
        if error > 0.0 {
            // Each within five of its own standard deviations: 1e-6 of false alarms for each of some ten.
            for ((found, exact), deviation) in estimate.beta().iter().zip(&exact).zip(estimate.std().iter()) {
                assert!((found - exact).abs() < 5.0 * deviation, "{found} {exact} {deviation}");
            }
        }
    }
    // What is left without an error is that of the derivatives where Coulomb friction turns over.
    assert!(errors[0] < 1e-3 && errors[1] > errors[0], "{errors:?}");
}
