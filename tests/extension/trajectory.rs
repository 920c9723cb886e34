//! A family of trajectories of one's own: each member in the law suite, the family in its own, a design in it, and an
//! experiment that performs the design.

use std::f64::consts::TAU;
use std::sync::Arc;

use armid::conformance::chains::planar_2r;
use armid::conformance::{family_laws, trajectory_laws};
use armid::excitation::{
    CriterionKind, DesignBudget, DesignLimits, DesignProblem, DesignSpace, design, verify_certificate,
};
use armid::experiment::{ExperimentPlan, record};
use armid::model::Columns;
use armid::seed::Seed;
use armid::trajectory::{
    Curve, CustomTrajectory, PeriodicMotion, PeriodicTrajectory, ShapeFunctions, Trajectory, TrajectoryError,
    TrajectoryFamily, TrigonometricPolynomial,
};
use serde::Serialize;

use super::arm::Exact;

/// Odd harmonics alone: the second half of the period is the first, turned over about the mean position, so that forces
/// that do not change their sign with the motion average out.
///
/// ```text
/// q = q0 + Σ_l s_l sin (2l − 1)θ + c_l cos (2l − 1)θ
/// ```
#[derive(Clone, Debug, Serialize)]
struct OddSeries {
    family: &'static str,
    period_s: f64,
    joint: Vec<OddJoint>,
}

/// The coefficients of one joint, rad: `(s_1, c_1, …, s_H, c_H, q0)`.
#[derive(Clone, Debug, Serialize)]
struct OddJoint {
    name: String,
    x: Vec<f64>,
}

/// Sine and cosine of `hθ`, differentiated so many times with respect to time.
fn pair(h: usize, omega: f64, phase: f64, order: usize) -> [f64; 2] {
    let quarter = TAU / 4.0 * order as f64;
    let size = (h as f64 * omega).powi(i32::try_from(order).expect("a small number"));
    let (s, c) = (h as f64 * phase + quarter).sin_cos();
    [size * s, size * c]
}

impl Trajectory for OddSeries {
    fn dof(&self) -> usize {
        self.joint.len()
    }

    fn period_s(&self) -> f64 {
        self.period_s
    }

    fn evaluate(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        for (order, out) in [q, qd, qdd].into_iter().enumerate() {
            for (joint, out) in out.iter_mut().enumerate() {
                *out = self.curve(joint, order).value(TAU * t / self.period_s);
            }
        }
    }
}

impl PeriodicMotion for OddSeries {
    fn names(&self) -> Vec<&str> {
        self.joint.iter().map(|joint| joint.name.as_str()).collect()
    }

    fn curve(&self, joint: usize, order: usize) -> Curve {
        let x = &self.joint[joint].x;
        let (pairs, q0) = x.split_at(x.len() - 1);
        let highest = pairs.len().max(2) - 1;
        let (mut cosine, mut sine) = (vec![0.0; highest], vec![0.0; highest]);
        for (l, pair_of) in pairs.chunks_exact(2).enumerate() {
            let h = 2 * l + 1;
            // At phase zero the derivative of s sin + c cos is its cosine part, a quarter of a turn later its sine part.
            let [s0, c0] = pair(h, TAU / self.period_s, 0.0, order);
            cosine[h - 1] = pair_of[0] * s0 + pair_of[1] * c0;
            sine[h - 1] = pair_of[0] * c0 - pair_of[1] * s0;
        }
        Curve::Trigonometric(TrigonometricPolynomial { mean: if order == 0 { q0[0] } else { 0.0 }, cosine, sine })
    }

    fn adjust(&mut self, joint: usize, factor: f64, shift: f64) {
        let (q0, pairs) = self.joint[joint].x.split_last_mut().expect("a mean position");
        pairs.iter_mut().for_each(|x| *x *= factor);
        *q0 += shift;
    }

    fn slow_down(&mut self, part: f64) {
        self.period_s /= part;
    }
}

#[derive(Debug)]
struct OddFamily;

#[derive(Debug)]
struct OddShapes {
    omega: f64,
    harmonics: usize,
}

impl TrajectoryFamily for OddFamily {
    fn name(&self) -> &'static str {
        "odd-series"
    }

    fn shape(&self, period_s: f64, harmonics: usize) -> Arc<dyn ShapeFunctions> {
        Arc::new(OddShapes { omega: TAU / period_s, harmonics })
    }

    fn trajectory(&self, period_s: f64, joints: Vec<(String, Vec<f64>)>) -> PeriodicTrajectory {
        let joint = joints.into_iter().map(|(name, x)| OddJoint { name, x }).collect();
        CustomTrajectory::new(OddSeries { family: self.name(), period_s, joint }).into()
    }

    fn coefficients(
        &self,
        trajectory: &PeriodicTrajectory,
        joint: usize,
        harmonics: usize,
    ) -> Result<Vec<f64>, TrajectoryError> {
        let other = TrajectoryError::OtherFamily { expected: self.name() };
        let PeriodicTrajectory::Custom(custom) = trajectory else { return Err(other) };
        let OddJoint { name, x } = &custom.downcast_ref::<OddSeries>().ok_or(other)?.joint[joint];
        let (found, most) = (x.len() / 2, harmonics);
        if found == most { Ok(x.clone()) } else { Err(TrajectoryError::Harmonics { joint: name.clone(), found, most }) }
    }
}

impl ShapeFunctions for OddShapes {
    fn count(&self) -> usize {
        2 * self.harmonics + 1
    }

    fn grid(&self) -> usize {
        12 * 2 * self.harmonics
    }

    fn fill(&self, phase: f64, order: usize, out: &mut [f64]) {
        for (l, out) in out.chunks_exact_mut(2).enumerate() {
            out.copy_from_slice(&pair(2 * l + 1, self.omega, phase, order));
        }
        out[2 * self.harmonics] = if order == 0 { 1.0 } else { 0.0 };
    }

    fn constant(&self) -> Vec<f64> {
        let mut still = vec![0.0; self.count()];
        still[2 * self.harmonics] = 1.0;
        still
    }
}

#[test]
fn a_trajectory_from_outside_obeys_the_laws() {
    family_laws::check(&OddFamily).unwrap();
    let joint = |name: &str, x: [f64; 5]| OddJoint { name: name.to_owned(), x: x.to_vec() };
    let joint = vec![joint("shoulder", [0.3, -0.1, 0.05, 0.1, 0.2]), joint("elbow", [0.1, 0.2, -0.2, 0.0, -0.4])];
    trajectory_laws::check(&OddSeries { family: "odd-series", period_s: 4.0, joint }).unwrap();
}

#[test]
fn a_design_in_a_family_from_outside_keeps_the_limits_and_is_performed() {
    let robot = planar_2r();
    let mut problem =
        DesignProblem::new(robot.clone(), Columns::RIGID, CriterionKind::DOptimal, DesignLimits::motion()).unwrap();
    let family: Arc<dyn TrajectoryFamily> = Arc::new(OddFamily);
    problem.set_space(DesignSpace::new(family, 4.0, vec![3, 2])).unwrap();
    problem.set_budget(DesignBudget { evaluations: 60, certificate_samples: 500, ..DesignBudget::default() }).unwrap();
    let made = design(&problem, Seed::new(1), 0).unwrap();
    assert!(made.termination.is_feasible(), "{:?}", made.termination);
    assert!(made.value > made.history[0].value + 1.0, "{:?}", made.history);
    assert_eq!(verify_certificate(&robot, &made.trajectory, &made.certificate, None), Ok(()));
    let PeriodicTrajectory::Custom(custom) = &made.trajectory else { panic!("{:?}", made.trajectory) };
    let own: &OddSeries = custom.downcast_ref().expect("a member of the family");
    assert!(custom.to_toml().contains("family = \"odd-series\"") && made.trajectory.to_toml() == custom.to_toml());
    // Half a period later the motion is turned over.
    let states = made.trajectory.sample(200);
    for k in 0..100 {
        for (j, joint) in own.joint.iter().enumerate() {
            let q0 = joint.x[joint.x.len() - 1];
            assert!((states.q(k)[j] - q0 + (states.q(k + 100)[j] - q0)).abs() < 1e-12);
        }
    }
    let plan = ExperimentPlan { settle_s: 0.1, ramp_s: 0.5, periods: 1, ..ExperimentPlan::new(made.trajectory) };
    let (recording, ending) = record(&mut Exact::new(robot), &plan).unwrap();
    assert!(ending.is_complete() && recording.trajectory == plan.trajectory && recording.periods() == 1);
}
