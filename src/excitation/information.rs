//! From a trajectory's variables to a criterion of its information, and back along exact derivatives.
//!
//! ```text
//! x → (q, q̇, q̈)_k → W_b → M = (1/rows) W_bᵀ Σ⁻¹ W_b + M_prior → f(M)
//! S = ∂f/∂M      G = ∂f/∂W_b = (2/rows) Σ⁻¹ W_b S      ∂f/∂(q, q̇, q̈)_k by the regressor's adjoint      ∂f/∂x = Bᵀ …
//! ```
//! Row i of a sample has entries only for the links that joint i carries and for its own drive, so M is gathered and
//! G made joint by joint on those columns alone.

use nalgebra::DMatrix;

use super::criterion::Criterion;
use super::optimiser::Objective;
use super::sampled::SampledBasis;
use super::{DesignProblem, ExcitationError, PeriodicTrajectory};
use crate::dynamics::States;
use crate::regressor::JointTorqueRegressor;

/// The rows of one joint over all samples, on the columns where they can differ from zero.
#[derive(Clone, Debug)]
struct JointRows {
    /// Position of each column among the kept ones.
    columns: Vec<usize>,
    /// The rows, N × w row-major, already divided by the joint's noise.
    rows: Vec<f64>,
    /// 1/σ of the joint.
    weight: f64,
}

/// The information of a sampled trajectory on the base columns.
#[derive(Clone, Debug)]
pub struct Information {
    regressor: JointTorqueRegressor,
    /// Kept columns of the regressor.
    kept: Vec<usize>,
    joints: Vec<JointRows>,
    samples: usize,
    /// One sample of the regressor, n × p.
    sample: Vec<f64>,
    prior: Option<DMatrix<f64>>,
}

impl Information {
    /// The information on the `kept` columns of `regressor`, of trajectories with `samples` samples, with rows divided
    /// by the noise `sigma` of each joint (n; all ones for an unweighted criterion), and `prior` added (b × b, per
    /// torque row).
    #[must_use]
    pub fn new(
        regressor: JointTorqueRegressor,
        kept: &[usize],
        samples: usize,
        sigma: &[f64],
        prior: Option<DMatrix<f64>>,
    ) -> Self {
        let (n, p) = (regressor.rows(), regressor.cols());
        let pattern = pattern(&regressor);
        let joints = (0..n)
            .map(|i| {
                let columns: Vec<usize> = (0..kept.len()).filter(|&c| pattern[i * p + kept[c]]).collect();
                JointRows { rows: vec![0.0; samples * columns.len()], columns, weight: 1.0 / sigma[i] }
            })
            .collect();
        Self { regressor, kept: kept.to_vec(), joints, samples, sample: vec![0.0; n * p], prior }
    }

    /// Number of base columns b.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.kept.len()
    }

    /// The information matrix of sampled states, b × b, per torque row.
    ///
    /// # Panics
    /// If there are not as many samples as the rows have room for.
    pub fn gather(&mut self, states: &States) -> DMatrix<f64> {
        assert_eq!(states.len(), self.samples, "samples of the motion");
        let (n, p, count, b) = (self.regressor.rows(), self.regressor.cols(), self.samples, self.kept.len());
        for k in 0..count {
            self.regressor.evaluate(states.q(k), states.qd(k), states.qdd(k), &mut self.sample);
            for (i, joint) in self.joints.iter_mut().enumerate() {
                let width = joint.columns.len();
                let row = &self.sample[i * p..(i + 1) * p];
                for (entry, &c) in joint.rows[k * width..(k + 1) * width].iter_mut().zip(&joint.columns) {
                    *entry = joint.weight * row[self.kept[c]];
                }
            }
        }
        let mut m = self.prior.clone().unwrap_or_else(|| DMatrix::zeros(b, b));
        let per_row = 1.0 / (n * count) as f64;
        for joint in &self.joints {
            let width = joint.columns.len();
            let gram = gram(&joint.rows, width);
            for (r, &row) in joint.columns.iter().enumerate() {
                for (c, &column) in joint.columns.iter().enumerate().skip(r) {
                    m[(column, row)] += per_row * gram[r * width + c];
                }
            }
        }
        for c in 0..b {
            for r in c + 1..b {
                m[(c, r)] = m[(r, c)];
            }
        }
        m
    }

    /// The gradient with respect to the last states, which must be handed in again, from `S = ∂f/∂M` (b × b,
    /// symmetric).
    pub fn pull_back(&self, states: &States, s: &DMatrix<f64>, sensitivity: &mut States) {
        let (n, p, count) = (self.regressor.rows(), self.regressor.cols(), self.samples);
        let factor = 2.0 / (n * count) as f64;
        let inner: Vec<Vec<f64>> = self
            .joints
            .iter()
            .map(|joint| {
                let width = joint.columns.len();
                let mut part = vec![0.0; width * width];
                for (r, &row) in joint.columns.iter().enumerate() {
                    for (c, &column) in joint.columns.iter().enumerate() {
                        part[r * width + c] = factor * joint.weight * s[(row, column)];
                    }
                }
                part
            })
            .collect();
        sensitivity.q.fill(0.0);
        sensitivity.qd.fill(0.0);
        sensitivity.qdd.fill(0.0);
        let mut g = vec![0.0; n * p];
        let mut row = vec![0.0; self.kept.len()];
        for k in 0..count {
            for (i, (joint, inner)) in self.joints.iter().zip(&inner).enumerate() {
                let width = joint.columns.len();
                let out = &mut row[..width];
                out.fill(0.0);
                let w = &joint.rows[k * width..(k + 1) * width];
                for (&w, s) in w.iter().zip(inner.chunks_exact(width)) {
                    for (out, s) in out.iter_mut().zip(s) {
                        *out += w * s;
                    }
                }
                for (&value, &c) in out.iter().zip(&joint.columns) {
                    g[i * p + self.kept[c]] = value;
                }
            }
            let range = k * n..(k + 1) * n;
            self.regressor.adjoint(
                states.q(k),
                states.qd(k),
                states.qdd(k),
                &g,
                &mut sensitivity.q[range.clone()],
                &mut sensitivity.qd[range.clone()],
                &mut sensitivity.qdd[range],
            );
        }
    }
}

/// Where a regressor can differ from zero, n × p: where it does at a state in general position.
fn pattern(regressor: &JointTorqueRegressor) -> Vec<bool> {
    let (n, p) = (regressor.rows(), regressor.cols());
    let mut pattern = vec![false; n * p];
    let mut y = vec![0.0; n * p];
    for run in 0..4 {
        let draw = |offset: f64| -> Vec<f64> {
            (0..n).map(|j| libm::sin(1.0 + 1.7 * run as f64 + offset + 2.3 * j as f64)).collect()
        };
        regressor.evaluate(&draw(0.0), &draw(0.7), &draw(1.9), &mut y);
        for (known, y) in pattern.iter_mut().zip(&y) {
            *known |= *y != 0.0;
        }
    }
    pattern
}

/// Upper triangle of RᵀR for rows of this width, row-major; four rows at a time, in a fixed order.
fn gram(rows: &[f64], width: usize) -> Vec<f64> {
    let mut gram = vec![0.0; width * width];
    let mut blocks = rows.chunks_exact(4 * width);
    for block in &mut blocks {
        let (w0, rest) = block.split_at(width);
        let (w1, rest) = rest.split_at(width);
        let (w2, w3) = rest.split_at(width);
        for c in 0..width {
            let (f0, f1, f2, f3) = (w0[c], w1[c], w2[c], w3[c]);
            let out = &mut gram[c * width + c..(c + 1) * width];
            let (w0, w1, w2, w3) = (&w0[c..], &w1[c..], &w2[c..], &w3[c..]);
            for (i, out) in out.iter_mut().enumerate() {
                *out += (f0 * w0[i] + f1 * w1[i]) + (f2 * w2[i] + f3 * w3[i]);
            }
        }
    }
    for row in blocks.remainder().chunks_exact(width) {
        for c in 0..width {
            for (out, w) in gram[c * width + c..(c + 1) * width].iter_mut().zip(&row[c..]) {
                *out += row[c] * w;
            }
        }
    }
    gram
}

/// A criterion of the information as a function of the variables.
pub struct InformationObjective {
    information: Information,
    sampled: SampledBasis,
    states: States,
    slopes: States,
    criterion: Box<dyn Criterion>,
    sensitivity: DMatrix<f64>,
    m: DMatrix<f64>,
    exact: f64,
}

impl InformationObjective {
    /// This criterion on this information of this family of trajectories.
    #[must_use]
    pub fn new(information: Information, sampled: SampledBasis, criterion: Box<dyn Criterion>) -> Self {
        let b = information.columns();
        let (n, samples) = (sampled.basis().dof(), sampled.samples());
        Self {
            information,
            sampled,
            states: States::with_len(n, samples),
            slopes: States::with_len(n, samples),
            criterion,
            sensitivity: DMatrix::zeros(b, b),
            m: DMatrix::zeros(b, b),
            exact: f64::INFINITY,
        }
    }

    /// Another criterion on the same information.
    pub fn change(&mut self, criterion: Box<dyn Criterion>) {
        self.criterion = criterion;
    }

    /// The information matrix of the last point.
    #[must_use]
    pub const fn matrix(&self) -> &DMatrix<f64> {
        &self.m
    }
}

impl InformationObjective {
    /// The criterion at the last point, without any smoothing.
    #[must_use]
    pub const fn exact(&self) -> f64 {
        self.exact
    }
}

impl Objective for InformationObjective {
    fn value(&mut self, x: &[f64]) -> f64 {
        self.gather(x);
        let score = self.criterion.evaluate(&self.m, Some(&mut self.sensitivity));
        self.exact = score.exact;
        score.value
    }

    fn gradient(&mut self, gradient: &mut [f64]) {
        self.information.pull_back(&self.states, &self.sensitivity, &mut self.slopes);
        self.sampled.pull_back(&self.slopes, gradient);
    }
}

/// Coulomb columns of the optimiser turn over this part of the speed limit, if the drive's own law is sharper.
///
/// A sample that crosses a reversal flips a sharp sign, and the criterion would jump with every sample. The
/// certificate always uses the drive's own law.
const COULOMB_PART: f64 = 0.05;

/// The regressor that the optimiser sees.
fn smoothed_regressor(problem: &DesignProblem) -> Result<JointTorqueRegressor, ExcitationError> {
    let robot = problem.robot.clone().with_joints(|joint| {
        let speed = joint.limits.velocity;
        if speed.is_finite() {
            joint.drive.coulomb_velocity = joint.drive.coulomb_velocity.max(COULOMB_PART * speed);
        }
    })?;
    Ok(JointTorqueRegressor::new(&robot, problem.columns))
}

impl DesignProblem {
    /// The information of one torque row of a trajectory on the base columns (b × b), weighted by the problem's noise
    /// and without its prior: what a later problem takes as prior, times how much longer this experiment was.
    ///
    /// # Errors
    /// [`ExcitationError::Trajectory`] if the trajectory is of another number of joints than the robot.
    pub fn information(&self, trajectory: &PeriodicTrajectory) -> Result<DMatrix<f64>, ExcitationError> {
        let n = self.robot.dof();
        if trajectory.dof() != n {
            return Err(ExcitationError::Trajectory {
                quantity: "number of joints".into(),
                found: trajectory.dof().to_string(),
                expected: n.to_string(),
            });
        }
        let noise = self.sigma.clone().unwrap_or_else(|| vec![1.0; n]);
        let mut information = Information::new(smoothed_regressor(self)?, &self.base.kept, self.samples, &noise, None);
        Ok(information.gather(&trajectory.sample(self.samples)))
    }
}

impl InformationObjective {
    /// The objective of a problem, with its criterion smoothed to `sharpness` where it has kinks.
    pub(crate) fn of(problem: &DesignProblem, sharpness: f64) -> Result<Self, ExcitationError> {
        let regressor = smoothed_regressor(problem)?;
        let sampled = SampledBasis::new(problem.basis()?, problem.samples);
        let prior = problem.prior.clone().filter(|_| problem.criterion.is_weighted());
        let information = Information::new(regressor, &problem.base.kept, problem.samples, &problem.row_noise(), prior);
        Ok(Self::new(information, sampled, problem.criterion.smooth(sharpness)))
    }

    /// The information at `x`.
    fn gather(&mut self, x: &[f64]) {
        self.sampled.states(x, &mut self.states);
        self.m = self.information.gather(&self.states);
    }

    /// The value at `x`, without what a gradient needs.
    #[cfg(test)]
    fn value_alone(&mut self, x: &[f64]) -> f64 {
        self.gather(x);
        self.criterion.evaluate(&self.m, None).value
    }

    /// The criterion at `x`, without any smoothing and without a gradient.
    pub(crate) fn exact_at(&mut self, x: &[f64]) -> f64 {
        self.gather(x);
        self.exact = self.criterion.evaluate(&self.m, None).exact;
        self.exact
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::{CriterionKind, Family, fixtures, paper_start};
    use crate::model::Columns;
    use crate::seed::Seed;

    fn problem(columns: Columns, kind: CriterionKind) -> DesignProblem {
        let mut problem = DesignProblem::new(fixtures::crs_a460(), columns, kind).unwrap();
        problem.samples = 40;
        problem.sigma = Some(vec![0.3, 0.5, 0.2, 0.1, 0.1, 0.05]);
        problem
    }

    #[test]
    fn identity_gradient_matches_central_differences() {
        for family in Family::ALL {
            for kind in CriterionKind::ALL {
                // All columns with one family, the rigid ones with the others.
                let columns = if family == Family::Fourier { Columns::RigidRotorFriction } else { Columns::Rigid };
                let mut problem = problem(columns, kind);
                problem.family = family;
                problem.harmonics = vec![5, 5, 5, 3, 3, 4];
                let b = problem.base.rank();
                problem.prior = Some(DMatrix::identity(b, b) * 0.01);
                let mut objective = InformationObjective::of(&problem, 6.0).unwrap();
                let start = problem.start(Seed::new(1), 0).unwrap();
                let x = problem.basis().unwrap().coefficients(&start).unwrap();
                let mut gradient = vec![0.0; x.len()];
                objective.value(&x);
                objective.gradient(&mut gradient);
                let size = gradient.iter().fold(0.0_f64, |a, g| a.max(g.abs()));
                for i in (0..x.len()).step_by(11) {
                    let at = |h: f64, objective: &mut InformationObjective| {
                        let mut moved = x.clone();
                        moved[i] += h;
                        objective.value_alone(&moved)
                    };
                    // Fourth-order differences leave 1e-9 of rounding and 1e-8 of truncation.
                    let h = 1e-4;
                    let near = at(h, &mut objective) - at(-h, &mut objective);
                    let far = at(2.0 * h, &mut objective) - at(-2.0 * h, &mut objective);
                    let difference = (8.0 * near - far) / (12.0 * h);
                    let error = (difference - gradient[i]).abs() / size;
                    assert!(error < 1e-7, "{kind:?} {family:?} {columns:?} variable {i}: {error}");
                }
            }
        }
    }

    #[test]
    fn identity_information_equals_the_weighted_stack() {
        let problem = problem(Columns::RigidRotorFriction, CriterionKind::DOptimal);
        let sigma = problem.sigma.clone().unwrap();
        let start = paper_start(&problem.robot, 10.0, 5, Seed::new(1), 3).unwrap();
        let regressor = JointTorqueRegressor::new(&problem.robot, problem.columns);
        let mut information = Information::new(regressor.clone(), &problem.base.kept, 40, &sigma, None);
        let m = information.gather(&start.sample(40));
        let mut w = problem.base.select_columns(&regressor.stack(&start.sample(40)));
        for (r, mut row) in w.row_iter_mut().enumerate() {
            row /= sigma[r % 6];
        }
        let expected = w.tr_mul(&w) / w.nrows() as f64;
        assert!((m - &expected).norm() < 1e-13 * expected.norm());
    }
}
