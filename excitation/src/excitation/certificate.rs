//! What a trajectory is worth and how much of each limit it uses, computed from the trajectory alone.
//!
//! ```text
//! M = W_bᵀ W_b / rows      condition = √(λ_max/λ_min)(M)      log_det_information = ln det M      (Σ = 1)
//! ```
//! on a grid far finer than the optimiser's. Position, velocity and acceleration are held against their limits at the
//! true extrema of the series, torque at the refined peaks of the grid, so no grid can hide an excess. The figures of
//! the rigid base columns do not depend on what was optimised; those of the chosen columns end in `_all`.
//!
//! The bias susceptibility is what B. Armstrong, "On Finding Exciting Trajectories for Identification Experiments Involving
//! Systems with Nonlinear Dynamics", Int. J. Robotics Research 8(6), 1989, calls the susceptibility of estimates to bias by
//! unmodelled torque, here of parameters in reference units:
//!
//! ```text
//! β̂ = β + W_b⁺ e      ‖D⁻¹(β̂ − β)‖ ≤ s ‖e‖/√rows      s = √rows / σ_min(W_b D) = 1/√λ_min(D M D)
//! ```
//! for torque e (N·m, one entry for each torque row) that the model lacks, D the diagonal of the reference units. It bounds the
//! error by every e of that size, and one e, the left singular vector of σ_min, reaches the bound. What a given effect does
//! is not in it: how much torque the effect gives depends on the motion, and most of that torque lies in other directions.

use nalgebra::{DMatrix, SymmetricEigen};

use super::criterion::CriterionKind;
use super::effort::{Channel, EffortModel, InsideShare};
use super::error::{ExcitationError, same_joints};
use super::information::Information;
use super::limit_survey::{LimitSurvey, WorstCases, WorstLimitUse};
use super::problem::DesignProblem;
use crate::provenance::sha256;
use crate::trajectory::PeriodicTrajectory;

/// A base parameter that a trajectory identifies poorly.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct WeakParameter {
    /// Its name.
    pub name: String,
    /// Its deviation, as in [`Certificate::deviations`].
    #[serde(deserialize_with = "crate::plain::infinite::positive")]
    pub deviation: f64,
    /// That over the nominal value of the base parameter; `None` without nominal parameters.
    pub relative_deviation: Option<f64>,
    /// Its share in the least identifiable direction: the square of its entry in the eigenvector of the smallest
    /// eigenvalue of the information.
    pub share_of_weakest_direction: f64,
}

/// How many of the base parameters with the largest share in the weakest direction a certificate names.
const WEAKEST: usize = 5;

/// What a trajectory is worth, and that it is safe.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Certificate {
    /// Name of the robot.
    pub robot: String,
    /// SHA-256 of the robot file that it was made for; empty for a robot that no file describes.
    pub robot_sha256: String,
    /// SHA-256 of the trajectory as its file states it.
    pub trajectory_sha256: String,
    /// SHA-256 of the nominal parameters and their uncertainty; `None` where torque is not held.
    #[serde(default)]
    pub nominal_sha256: Option<String>,
    /// Largest norm of the error of the chosen base parameters in reference units per N·m RMS of torque that the model lacks,
    /// √rows/σ_min(W_b D), by least squares: see the module. `None` in a certificate of before it was computed; infinite where M
    /// is singular.
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "crate::plain::infinite::present_positive"
    )]
    pub bias_susceptibility: Option<f64>,
    /// Samples of one period on which it was computed.
    pub samples: usize,
    /// Length of the ramps that the efforts were computed with, s.
    pub ramp_s: Option<f64>,
    /// Condition number of the rigid base columns.
    #[serde(deserialize_with = "crate::plain::infinite::positive")]
    pub condition: f64,
    /// Condition number of the rigid base columns, scaled to unit length.
    #[serde(deserialize_with = "crate::plain::infinite::positive")]
    pub condition_scaled: f64,
    /// ln det(W_bᵀ W_b / rows) of the rigid base columns.
    #[serde(deserialize_with = "crate::plain::infinite::negative")]
    pub log_det_information: f64,
    /// Condition number of the chosen base columns.
    #[serde(deserialize_with = "crate::plain::infinite::positive")]
    pub condition_all: f64,
    /// Condition number of the chosen base columns, scaled to unit length.
    #[serde(deserialize_with = "crate::plain::infinite::positive")]
    pub condition_scaled_all: f64,
    /// ln det(W_bᵀ W_b / rows) of the chosen base columns.
    #[serde(deserialize_with = "crate::plain::infinite::negative")]
    pub log_det_information_all: f64,
    /// Eigenvalues of the information of the chosen base columns, per torque row, ascending.
    pub spectrum: Vec<f64>,
    /// Standard deviation of each chosen base parameter, √((M⁻¹)_ii), for torque noise of 1 N·m and the mean
    /// information of one torque row; a whole period's is smaller by √rows. In the parameter's unit; infinite where
    /// M is singular.
    #[serde(deserialize_with = "crate::plain::infinite::list")]
    pub deviations: Vec<f64>,
    /// The base parameters with the largest share in the least identifiable direction, largest first.
    pub weakest: Vec<WeakParameter>,
    /// Standard deviations of the nominal parameters' uncertainty that the efforts include; 0 without.
    pub uncertainty_multiple: f64,
    /// How often no effort limit is passed at any instant when parameters are drawn from their uncertainty.
    pub efforts_inside: Option<InsideShare>,
    /// Largest use of each kind of limit.
    pub worst_limit_use: WorstLimitUse,
    /// SHA-256 of all the rest, so that a change of any figure shows.
    #[serde(default, rename = "seal")]
    pub checksum: String,
    /// Where each limit of `worst_limit_use` is used most.
    pub worst: WorstCases,
}

impl Certificate {
    /// The certificate of any trajectory for the robot, the columns and the nominal parameters of a problem.
    ///
    /// # Errors
    /// [`ExcitationError::Joints`] if the trajectory is not one of as many joints as the robot has.
    pub fn new(problem: &DesignProblem, trajectory: &PeriodicTrajectory) -> Result<Self, ExcitationError> {
        let n = problem.robot().dof();
        same_joints(trajectory.dof(), n)?;
        let samples = problem.budget().certificate_samples;
        let regressor = problem.regressor(problem.robot())?;
        let kept = &problem.base().kept;
        let m = Information::of_period(regressor, kept, &vec![1.0; n], trajectory, samples);
        let rigid = problem.objective().rigid_positions();
        let m_rigid = m.select_rows(&rigid).select_columns(&rigid);
        let report = |kind: CriterionKind, m: &DMatrix<f64>| {
            let criterion = kind.criterion();
            criterion.report(criterion.evaluate(m, None).exact)
        };
        let timeline = problem.timeline(trajectory.period_s());
        let mut model = problem.efforts();
        let LimitSurvey { used, worst } =
            LimitSurvey::of(problem.robot(), trajectory, timeline, samples, model.as_mut());
        let efforts_inside = match (&mut model, &problem.limits().spread) {
            (Some(model), Some(_)) => {
                let channels = Channel::all(problem.robot());
                Some(model.inside(trajectory, timeline, &Channel::binding(&channels)))
            }
            _ => None,
        };
        let eigen = SymmetricEigen::new(m.clone());
        let mut spectrum: Vec<f64> = eigen.eigenvalues.iter().copied().collect();
        spectrum.sort_by(f64::total_cmp);
        let deviations = m.clone().cholesky().map_or_else(
            || vec![f64::INFINITY; kept.len()],
            |factor| factor.inverse().diagonal().iter().map(|variance| variance.sqrt()).collect(),
        );
        let weakest = weakest(problem, &eigen, &deviations);
        let certificate = Self {
            robot: problem.robot().name().to_owned(),
            robot_sha256: problem.robot().source_sha256().to_owned(),
            trajectory_sha256: sha256(&trajectory.to_toml()),
            nominal_sha256: model.as_ref().map(EffortModel::parameters_sha256),
            ramp_s: problem.limits().ramp_s,
            weakest,
            uncertainty_multiple: problem.limits().spread.as_ref().map_or(0.0, |spread| spread.multiple),
            efforts_inside,
            bias_susceptibility: Some(bias_susceptibility(&m, &problem.objective().units())),
            samples,
            condition: report(CriterionKind::Condition, &m_rigid),
            condition_scaled: report(CriterionKind::ConditionScaled, &m_rigid),
            log_det_information: report(CriterionKind::DOptimal, &m_rigid),
            condition_all: report(CriterionKind::Condition, &m),
            condition_scaled_all: report(CriterionKind::ConditionScaled, &m),
            log_det_information_all: report(CriterionKind::DOptimal, &m),
            spectrum,
            deviations,
            worst_limit_use: used,
            worst,
            checksum: String::new(),
        };
        Ok(certificate.with_checksum())
    }

    /// The certificate with the checksum of its content.
    pub(crate) fn with_checksum(self) -> Self {
        let checksum = self.content_checksum();
        Self { checksum, ..self }
    }

    /// Whether it is as it was when it was made.
    pub fn is_unchanged(&self) -> bool {
        self.checksum == self.content_checksum()
    }

    fn content_checksum(&self) -> String {
        let content = Self { checksum: String::new(), ..self.clone() };
        sha256(&toml::to_string(&content).expect("names, numbers and lists of them have a TOML form"))
    }
}

/// `1/√λ_min(D M D)` of the information of one torque row; infinite of a singular matrix.
fn bias_susceptibility(m: &DMatrix<f64>, units: &[f64]) -> f64 {
    let scaled = DMatrix::from_fn(m.nrows(), m.ncols(), |i, j| units[i] * m[(i, j)] * units[j]);
    let smallest = SymmetricEigen::new(scaled).eigenvalues.min();
    if smallest > 0.0 { 1.0 / smallest.sqrt() } else { f64::INFINITY }
}

/// The base parameters that make up the least identifiable direction.
fn weakest(
    problem: &DesignProblem,
    eigen: &SymmetricEigen<f64, nalgebra::Dyn>,
    deviations: &[f64],
) -> Vec<WeakParameter> {
    let direction = eigen.eigenvectors.column(eigen.eigenvalues.imin());
    let nominal = problem
        .limits()
        .nominal
        .as_ref()
        .map(|set| problem.base().beta(&set.vector(problem.robot(), problem.objective().columns)));
    let mut order: Vec<usize> = (0..direction.len()).collect();
    order.sort_by(|&x, &y| direction[y].abs().total_cmp(&direction[x].abs()).then(x.cmp(&y)));
    let names = problem.base().names();
    let describe = |i: usize| WeakParameter {
        name: names[i].clone(),
        deviation: deviations[i],
        relative_deviation: nominal
            .as_ref()
            .map(|beta| deviations[i] / beta[i].abs())
            .filter(|share| share.is_finite()),
        share_of_weakest_direction: direction[i] * direction[i],
    };
    order.into_iter().take(WEAKEST).map(describe).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains;
    use crate::excitation::{DesignBudget, DesignLimits};
    use crate::model::term::LOAD_FRICTION;
    use crate::model::{Columns, ColumnsError};
    use crate::regressor::JointTorqueRegressor;
    use crate::trajectory::table_one;

    fn problem(columns: Columns) -> DesignProblem {
        let mut problem =
            DesignProblem::new(chains::crs_a460(), columns, CriterionKind::Condition, DesignLimits::motion()).unwrap();
        problem
            .set_limits(DesignLimits { nominal: Some(chains::crs_a460_nominal()), ..DesignLimits::motion() })
            .unwrap();
        problem
    }

    #[test]
    fn published_figures_of_table_one() {
        // An independent computation (another rigid-body library, SciPy) found 210, 55 and 15.8 for the corrected
        // table on the 36 base columns, and at most 90 % of any limit (90.5 here).
        let mut problem = problem(Columns::RIGID);
        problem.set_budget(DesignBudget { certificate_samples: 1000, ..DesignBudget::default() }).unwrap();
        let certificate = Certificate::new(&problem, &table_one::corrected().into()).unwrap();
        assert!((certificate.condition - 210.5).abs() < 0.6, "{}", certificate.condition);
        assert!((certificate.condition_scaled - 55.4).abs() < 0.6, "{}", certificate.condition_scaled);
        assert!((certificate.log_det_information - 15.85).abs() < 0.1, "{}", certificate.log_det_information);
        let used = certificate.worst_limit_use;
        assert!(used.position.max(used.velocity).max(used.acceleration) < 0.91, "{used:?}");
        assert!(used.torque.unwrap() < 1.0, "{used:?}");
        assert!(certificate.deviations.iter().all(|deviation| deviation.is_finite()));
    }

    #[test]
    fn identity_information_figures_equal_those_of_the_stacked_regressor() {
        let mut problem = problem(Columns::RIGID_ROTOR_FRICTION);
        problem.set_budget(DesignBudget { certificate_samples: 400, ..DesignBudget::default() }).unwrap();
        let trajectory = table_one::corrected().into();
        let certificate = Certificate::new(&problem, &trajectory).unwrap();
        let regressor = JointTorqueRegressor::new(problem.robot(), problem.objective().columns).unwrap();
        let w = problem.base().select_columns(&regressor.stack(&trajectory.sample(400)));
        assert_eq!(w.ncols(), 58);
        assert!((certificate.condition_all / crate::linalg::condition(&w) - 1.0).abs() < 1e-9);
        assert!((certificate.condition_scaled_all / crate::linalg::condition_scaled(&w) - 1.0).abs() < 1e-9);
        let rigid = w.select_columns(&problem.objective().rigid_positions());
        assert_eq!(rigid.ncols(), 36);
        assert!((certificate.condition / crate::linalg::condition(&rigid) - 1.0).abs() < 1e-10);
        let rows = rigid.nrows() as f64;
        let log_det: f64 = crate::linalg::singular_values(&rigid).iter().map(|s| libm::log(s * s / rows)).sum();
        assert!((certificate.log_det_information - log_det).abs() < 1e-9);
    }

    #[test]
    fn identity_friction_of_the_load_is_judged_by_the_nominal_links() {
        let columns = Columns::RIGID_ROTOR_FRICTION.with_term(LOAD_FRICTION);
        let trajectory = table_one::corrected().into();
        let alone =
            DesignProblem::new(chains::crs_a460(), columns, CriterionKind::Condition, DesignLimits::motion()).unwrap();
        let refused = Certificate::new(&alone, &trajectory).unwrap_err();
        assert!(matches!(refused, ExcitationError::Columns(ColumnsError::Load { .. })), "{refused}");
        let mut problem = problem(columns);
        problem.set_budget(DesignBudget { certificate_samples: 400, ..DesignBudget::default() }).unwrap();
        let certificate = Certificate::new(&problem, &trajectory).unwrap();
        let nominal = chains::crs_a460_nominal();
        let regressor = JointTorqueRegressor::with_load(problem.robot(), columns, &nominal);
        let w = problem.base().select_columns(&regressor.stack(&trajectory.sample(400)));
        assert_eq!(w.ncols(), 64);
        assert!((certificate.condition_all / crate::linalg::condition(&w) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn analytic_bias_susceptibility_of_two_columns() {
        // W = [3 0; 0 4; 0 0], D = diag(2, 1/2): W D = diag(6, 2) over three rows, so that √3/2 is reached by e along the
        // second row: e = (0, √3, 0) has RMS 1 N·m and moves β_2 by √3/4, which is √3/2 units.
        let w = DMatrix::from_row_slice(3, 2, &[3.0, 0.0, 0.0, 4.0, 0.0, 0.0]);
        let m = w.tr_mul(&w) / 3.0;
        assert!((bias_susceptibility(&m, &[2.0, 0.5]) - 0.5 * 3.0_f64.sqrt()).abs() < 1e-15);
        // W = [1 1; 1 −1; 1 0]: σ² of W diag(1, 3) are the roots of x² − 21 x + 54, 3 and 18.
        let w = DMatrix::from_row_slice(3, 2, &[1.0, 1.0, 1.0, -1.0, 1.0, 0.0]);
        let m = w.tr_mul(&w) / 3.0;
        assert!((bias_susceptibility(&m, &[1.0, 3.0]) - 1.0).abs() < 1e-15);
        // numpy 2.4: w = sin(arange(1, 7)).reshape(3, 2); sqrt(3)/svd(w @ diag([0.1, 0.02]), compute_uv=False)[1]
        let w = DMatrix::from_row_iterator(3, 2, (1..7).map(|k| libm::sin(f64::from(k))));
        let m = w.tr_mul(&w) / 3.0;
        let found = bias_susceptibility(&m, &[0.1, 0.02]);
        assert!((found / 89.104_252_906_821_67 - 1.0).abs() < 1e-12, "{found}");
        assert_eq!(bias_susceptibility(&DMatrix::zeros(2, 2), &[1.0, 1.0]), f64::INFINITY);
    }

    #[test]
    fn identity_the_bias_susceptibility_is_reached_by_one_unmodelled_torque_and_passed_by_none() {
        let mut problem = problem(Columns::RIGID_ROTOR_FRICTION);
        problem.set_budget(DesignBudget { certificate_samples: 200, ..DesignBudget::default() }).unwrap();
        let trajectory = table_one::corrected().into();
        let found = Certificate::new(&problem, &trajectory).unwrap().bias_susceptibility.unwrap();
        let regressor = JointTorqueRegressor::new(problem.robot(), problem.objective().columns).unwrap();
        let w = problem.base().select_columns(&regressor.stack(&trajectory.sample(200)));
        let units = problem.objective().units();
        let scaled = DMatrix::from_fn(w.nrows(), w.ncols(), |i, j| w[(i, j)] * units[j]);
        let svd = scaled.clone().svd(true, true);
        let rows = (w.nrows() as f64).sqrt();
        assert!((found * svd.singular_values.min() / rows - 1.0).abs() < 1e-8, "{found}");
        // The torque of the weakest direction, 1 N·m RMS, and others of that size.
        let worst = svd.u.as_ref().unwrap().column(svd.singular_values.imin()) * rows;
        let moved = |torque: &nalgebra::DVector<f64>| svd.solve(torque, 0.0).unwrap().norm();
        assert!((moved(&worst.into_owned()) / found - 1.0).abs() < 1e-6);
        for k in 1..20 {
            let torque = nalgebra::DVector::from_fn(w.nrows(), |i, _| libm::sin(f64::from(k) * 0.7 * i as f64));
            let share = moved(&(&torque * (rows / torque.norm()))) / found;
            assert!(share <= 1.0 + 1e-9, "{share}");
        }
    }

    #[test]
    fn identity_no_grid_of_samples_uses_more_than_the_certificate_says() {
        let problem = problem(Columns::RIGID);
        let trajectory = table_one::corrected().into();
        let used = Certificate::new(&problem, &trajectory).unwrap().worst_limit_use;
        let states = trajectory.sample(7919);
        let nominal = problem.limits().nominal.as_ref().unwrap();
        let mut dynamics = crate::dynamics::Dynamics::new(problem.robot(), nominal);
        let mut tau = vec![0.0; 6];
        let mut worst = [0.0_f64; 4];
        for k in 0..states.len() {
            dynamics.inverse(states.q(k), states.qd(k), states.qdd(k), &mut tau);
            for (j, joint) in problem.robot().joints().iter().enumerate() {
                let limits = &joint.limits;
                worst[0] = worst[0].max(states.q(k)[j].abs() / limits.position.1);
                worst[1] = worst[1].max(states.qd(k)[j].abs() / limits.velocity);
                worst[2] = worst[2].max(states.qdd(k)[j].abs() / limits.acceleration);
                worst[3] = worst[3].max(tau[j].abs() / limits.torque);
            }
        }
        let certified = [used.position, used.velocity, used.acceleration, used.torque.unwrap()];
        for (sampled, certified) in worst.into_iter().zip(certified) {
            // Torque peaks are refined to a thousandth of a sample of 2 ms; the others are exact.
            assert!(sampled <= certified + 1e-6 && certified - sampled < 1e-3, "{sampled} {certified}");
        }
    }
}
