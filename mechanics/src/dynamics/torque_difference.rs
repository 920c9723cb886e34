//! How much the torques of two models of one arm differ inside its limits.

use rand::RngExt;

use super::model::Dynamics;
use crate::model::{JointKind, Robot, StandardParameters};
use crate::seed::Seed;

/// Range of a coordinate that nothing bounds, rad or m; speed, rad/s or m/s; acceleration, rad/s² or m/s².
const UNBOUNDED: [f64; 3] = [1.0, 2.0, 10.0];

/// Torque by one model less that by another, over random states.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct TorqueDifference {
    /// Number of states.
    pub states: usize,
    /// RMS of each joint's difference, N·m (N), n.
    pub rms: Vec<f64>,
    /// The largest of each joint, N·m (N), n.
    pub largest: Vec<f64>,
    /// RMS of each joint's difference over the RMS of its torque by the first model, n.
    pub relative_rms: Vec<f64>,
}

impl TorqueDifference {
    /// `τ_a − τ_b` at so many states, equally distributed inside the limits of `a`. Where the first has none, a revolute joint
    /// goes round once and a prismatic one 1 m to either side, at up to 2 rad/s and 10 rad/s² (m).
    ///
    /// ```
    /// # use armid_mechanics as armid;
    /// use armid::chains::planar_2r;
    /// use armid::dynamics::TorqueDifference;
    /// use armid::model::StandardParameters;
    /// use armid::model::term::VISCOUS;
    /// let robot = planar_2r();
    /// let frictionless = StandardParameters::zero(2);
    /// let mut parameters = frictionless.clone();
    /// parameters.drives[1][VISCOUS] = 3.0;
    /// let found = TorqueDifference::new((&robot, &parameters), (&robot, &frictionless), 50);
    /// assert!(found.largest[0] == 0.0 && found.largest[1] > 0.0 && found.relative_rms == [0.0, 1.0]);
    /// ```
    ///
    /// # Panics
    /// If the models have unlike numbers of joints.
    #[must_use]
    pub fn new(a: (&Robot, &StandardParameters), b: (&Robot, &StandardParameters), states: usize) -> Self {
        let n = a.0.dof();
        assert_eq!(n, b.0.dof(), "models with as many joints");
        let (mut first, mut second) = (Dynamics::new(a.0, a.1), Dynamics::new(b.0, b.1));
        let mut rng = Seed::new(0).stream("torque difference", 0);
        let (mut tau, mut other) = (vec![0.0; n], vec![0.0; n]);
        let (mut all, mut rms, mut largest) = (vec![0.0; n], vec![0.0; n], vec![0.0_f64; n]);
        for _ in 0..states {
            let mut of_each = |range: &dyn Fn(usize) -> (f64, f64)| -> Vec<f64> {
                let draw = |i| {
                    let (low, high) = range(i);
                    low + (high - low) * rng.random_range(0.0..1.0)
                };
                (0..n).map(draw).collect()
            };
            let joints = a.0.joints();
            let within = |limit: f64, otherwise: f64| {
                let bound = if limit.is_finite() { limit } else { otherwise };
                (-bound, bound)
            };
            let q = of_each(&|i| {
                let (low, high) = joints[i].limits.position;
                let otherwise = if joints[i].kind == JointKind::Revolute { std::f64::consts::PI } else { UNBOUNDED[0] };
                if (high - low).is_finite() { (low, high) } else { (-otherwise, otherwise) }
            });
            let qd = of_each(&|i| within(joints[i].limits.velocity, UNBOUNDED[1]));
            let qdd = of_each(&|i| within(joints[i].limits.acceleration, UNBOUNDED[2]));
            first.inverse(&q, &qd, &qdd, &mut tau);
            second.inverse(&q, &qd, &qdd, &mut other);
            for i in 0..n {
                let off = tau[i] - other[i];
                all[i] += tau[i] * tau[i];
                rms[i] += off * off;
                largest[i] = largest[i].max(off.abs());
            }
        }
        let count = states.max(1) as f64;
        let relative_rms = rms.iter().zip(&all).map(|(off, all)| (off / all.max(f64::MIN_POSITIVE)).sqrt()).collect();
        Self { states, rms: rms.iter().map(|sum| (sum / count).sqrt()).collect(), largest, relative_rms }
    }
}
