//! At most 160 instants of a log, and how well a fit explains them.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::mistake::Mistake;
use crate::base::{BaseError, Method, reduce};
use crate::linalg::transpose_product;
use crate::model::term::{COULOMB, VISCOUS};
use crate::model::{Columns, ParameterId, ParameterKind, Robot};
use crate::regressor::JointTorqueRegressor;
use crate::seed::Seed;
use crate::signal::Samples;

/// Instants that are looked at, at most.
const INSTANTS: usize = 160;
/// Least torque of a joint, as a part of the largest joint's, that its residual is compared with: below it, it is noise.
const LEAST_TORQUE: f64 = 0.02;
/// Added to the diagonal of the normal equations with columns of unit length: a motion that does not show a parameter is no
/// reason to fail.
const RIDGE: f64 = 1e-9;
/// What a joint beyond its limits adds to the cost.
const BEYOND_LIMITS: f64 = 0.3;
/// Standard deviations that a value must be below zero to count as below.
const DOUBT: f64 = 3.0;
/// A position limit counts as exceeded beyond this multiple of it, a torque limit beyond twice that.
const LIMIT_SLACK: f64 = 1.3;
/// A velocity limit counts as exceeded beyond this multiple of it: URDFs often state what a controller allows, not what the arm can do.
const SPEED_SLACK: f64 = 10.0;

/// One degree, rad.
pub(super) const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// States and torque at some instants, K × n each.
#[derive(Clone, Debug)]
pub(super) struct Instants {
    pub(super) q: Vec<f64>,
    pub(super) qd: Vec<f64>,
    pub(super) qdd: Vec<f64>,
    pub(super) tau: Vec<f64>,
    /// Torque of each joint that its residual is compared with, n. A correction changes it as it changes the torque: were it taken
    /// again afterwards, a larger torque of one joint would excuse the residuals of the others.
    scale: Vec<f64>,
}

/// The regressor of one robot, and which columns are fitted.
pub(super) struct Model {
    pub(super) robot: Robot,
    regressor: JointTorqueRegressor,
    kept: Vec<usize>,
    /// Joint and column of friction that cannot be below zero, and whether it is Coulomb's.
    friction: Vec<(usize, usize, bool)>,
}

impl Model {
    pub(super) fn new(robot: Robot, columns: Columns) -> Result<Self, BaseError> {
        // Mistakes do not hide behind friction of the load.
        let columns =
            columns.terms().filter(|term| term.entry().needs.is_motion()).fold(Columns::RIGID, Columns::with_term);
        let base = reduce(&robot, columns, Method::Structural, Seed::new(0))?;
        let regressor = JointTorqueRegressor::new(&robot, columns).map_err(BaseError::from)?;
        let friction = |(at, &column): (usize, &usize)| match base.parameters[column] {
            ParameterId { kind: ParameterKind::Term(term), index } if term == COULOMB || term == VISCOUS => {
                Some((index, at, term == COULOMB))
            }
            _ => None,
        };
        let friction = base.kept.iter().enumerate().filter_map(friction).collect();
        Ok(Self { robot, regressor, kept: base.kept, friction })
    }

    /// Rows of the base columns at one state, n × b.
    fn rows(&self, q: &[f64], qd: &[f64], qdd: &[f64], all: &mut [f64]) -> Vec<f64> {
        self.regressor.evaluate(q, qd, qdd, all);
        all.chunks_exact(self.regressor.cols()).flat_map(|row| self.kept.iter().map(move |&c| row[c])).collect()
    }

    /// Equations of some instants, each divided by the scale of its joint: W (K·n × b) and y.
    fn equations(&self, instants: &Instants) -> (DMatrix<f64>, DVector<f64>) {
        let (n, b) = (self.robot.dof(), self.kept.len());
        let count = instants.q.len() / n;
        let mut w = DMatrix::zeros(count * n, b);
        let mut y = DVector::zeros(count * n);
        let mut all = vec![0.0; n * self.regressor.cols()];
        for k in 0..count {
            let span = k * n..(k + 1) * n;
            let rows = self.rows(&instants.q[span.clone()], &instants.qd[span.clone()], &instants.qdd[span], &mut all);
            for (i, scale) in instants.scale.iter().enumerate() {
                for (c, value) in rows[i * b..(i + 1) * b].iter().enumerate() {
                    w[(k * n + i, c)] = value / scale;
                }
                y[k * n + i] = instants.tau[k * n + i] / scale;
            }
        }
        (w, y)
    }

    /// The parameters that explain the torque best; `None` where the equations have no answer.
    fn fit(&self, instants: &Instants) -> Option<Fit> {
        let (mut w, y) = self.equations(instants);
        let (rows, b) = w.shape();
        let lengths: Vec<f64> = w.column_iter().map(|c| c.norm()).map(|l| if l > 0.0 { l } else { 1.0 }).collect();
        for (mut column, length) in w.column_iter_mut().zip(&lengths) {
            column /= *length;
        }
        let mut normal = transpose_product(&w, &w);
        for c in 0..b {
            normal[(c, c)] += RIDGE;
        }
        let right = transpose_product(&w, &DMatrix::from_column_slice(rows, 1, y.as_slice()));
        let factor = Cholesky::new(normal)?;
        let scaled = factor.solve(&right.column(0).into_owned());
        let mut left = y;
        for (column, &value) in w.column_iter().zip(scaled.iter()) {
            left.axpy(-value, &column, 1.0);
        }
        let residual = left.norm_squared() / rows as f64;
        let beta = DVector::from_iterator(b, scaled.iter().zip(&lengths).map(|(beta, length)| beta / length));
        let noise = residual * rows as f64 / rows.saturating_sub(b).max(1) as f64;
        Some(Fit { beta, residual, noise, factor, lengths })
    }

    /// The cost J of a fit.
    pub(super) fn cost(&self, instants: &Instants) -> f64 {
        self.fit(instants)
            .map_or(f64::INFINITY, |fit| fit.residual + self.implausible(instants, &fit) + self.beyond_limits(instants))
    }

    /// The residual, as a part of each joint's torque, squared, on instants that were not fitted.
    pub(super) fn predicted(&self, fitted: &Instants, others: &Instants) -> f64 {
        let others = Instants { scale: fitted.scale.clone(), ..others.clone() };
        let (w, y) = self.equations(&others);
        self.fit(fitted).map_or(f64::INFINITY, |fit| (&y - w * fit.beta).norm_squared() / y.len().max(1) as f64)
    }

    /// How many joints have friction, at the RMS of their speed, that is below and above zero beyond doubt.
    pub(super) fn friction_signs(&self, instants: &Instants) -> (usize, usize) {
        let Some(fit) = self.fit(instants) else { return (0, 0) };
        let beyond = |of_each: &DVector<f64>| (of_each.dot(&fit.beta), DOUBT * fit.std(of_each));
        let all: Vec<(f64, f64)> = self.friction_of_joints(instants).iter().map(beyond).collect();
        let below = all.iter().filter(|(value, doubt)| value + doubt < 0.0).count();
        (below, all.iter().filter(|(value, doubt)| value - doubt > 0.0).count())
    }

    /// The combination of parameters that is the friction of each joint at the RMS of its speed.
    fn friction_of_joints(&self, instants: &Instants) -> Vec<DVector<f64>> {
        let mut friction = vec![DVector::zeros(self.kept.len()); self.robot.dof()];
        for &(joint, at, coulomb) in &self.friction {
            friction[joint][at] += if coulomb { 1.0 } else { rms(&instants.qd, joint, self.robot.dof()) };
        }
        friction
    }

    /// Friction that drives and inertia that is negative beyond doubt, as parts of each joint's torque, squared. A short log determines
    /// few combinations of the parameters, and then a sign says nothing.
    fn implausible(&self, instants: &Instants, fit: &Fit) -> f64 {
        let (n, b, scale) = (self.robot.dof(), self.kept.len(), &instants.scale);
        // What a combination is below zero beyond doubt.
        let below = |of_each: &DVector<f64>| {
            let value = of_each.dot(&fit.beta);
            if value < 0.0 { (value + DOUBT * fit.std(of_each)).min(0.0) } else { 0.0 }
        };
        let mut cost = 0.0;
        for (joint, of_each) in self.friction_of_joints(instants).iter().enumerate() {
            cost += (below(of_each) / scale[joint]).powi(2);
        }
        let (still, mut all) = (vec![0.0; n], vec![0.0; n * self.regressor.cols()]);
        let states: Vec<&[f64]> = instants.q.chunks_exact(n).step_by((instants.q.len() / n / 8).max(1)).collect();
        for i in 0..n {
            let mut unit = still.clone();
            unit[i] = 1.0;
            let mut mean = DVector::zeros(b);
            for q in &states {
                let moved = self.rows(q, &still, &unit, &mut all);
                let held = self.rows(q, &still, &still, &mut all);
                for (c, mean) in mean.iter_mut().enumerate() {
                    *mean += (moved[i * b + c] - held[i * b + c]) / states.len() as f64;
                }
            }
            cost += (below(&mean) * rms(&instants.qdd, i, n) / scale[i]).powi(2);
        }
        cost / n as f64
    }

    /// How far joints are beyond what they can do.
    pub(super) fn beyond_limits(&self, instants: &Instants) -> f64 {
        let n = self.robot.dof();
        let largest = |rows: &[f64], i: usize| rows.iter().skip(i).step_by(n).fold(0.0_f64, |a, x| a.max(x.abs()));
        let mut cost = 0.0;
        for (i, joint) in self.robot.joints().iter().enumerate() {
            let limits = &joint.limits;
            let range = limits.position.0.abs().max(limits.position.1.abs());
            let beyond = largest(&instants.q, i) > LIMIT_SLACK * range
                || largest(&instants.qd, i) > SPEED_SLACK * limits.velocity
                || largest(&instants.tau, i) > 2.0 * LIMIT_SLACK * limits.torque;
            cost += if beyond { BEYOND_LIMITS } else { 0.0 };
        }
        cost / n as f64
    }
}

/// A fit of the parameters, with columns of unit length.
struct Fit {
    /// The parameters, b.
    beta: DVector<f64>,
    /// Mean square of what is left, as a part of each joint's torque.
    residual: f64,
    /// Mean square of what is left, over the equations beyond the parameters.
    noise: f64,
    factor: Cholesky<f64, Dyn>,
    lengths: Vec<f64>,
}

impl Fit {
    /// Standard deviation of a combination of the parameters.
    fn std(&self, of_each: &DVector<f64>) -> f64 {
        let parts = of_each.iter().zip(&self.lengths).map(|(x, length)| x / length);
        let scaled = DVector::from_iterator(of_each.len(), parts);
        (self.noise * scaled.dot(&self.factor.solve(&scaled))).sqrt()
    }
}

/// RMS of one joint's entries of a table with n in a row.
pub(super) fn rms(rows: &[f64], i: usize, n: usize) -> f64 {
    let squares: f64 = rows.iter().skip(i).step_by(n).map(|x| x * x).sum();
    (squares / (rows.len() / n).max(1) as f64).sqrt()
}

/// RMS torque of each joint, n; not less than a part of the largest.
fn torque_scale(tau: &[f64], n: usize) -> Vec<f64> {
    let rms: Vec<f64> = (0..n).map(|i| rms(tau, i, n)).collect();
    let largest = rms.iter().copied().fold(0.0, f64::max);
    rms.iter().map(|x| x.max(LEAST_TORQUE * largest).max(f64::MIN_POSITIVE)).collect()
}

impl Instants {
    /// Blocks of samples that are spread over a log: the mean torque, and the states in the middle.
    pub(super) fn of(samples: &Samples) -> Self {
        let n = samples.dof();
        let step = samples.blocks().div_ceil(INSTANTS).max(1);
        let mean = samples.block_means(&samples.tau, n);
        let mut instants = Self { q: Vec::new(), qd: Vec::new(), qdd: Vec::new(), tau: Vec::new(), scale: Vec::new() };
        for m in (0..samples.blocks()).step_by(step) {
            let k = m * samples.block + samples.block / 2;
            instants.q.extend_from_slice(samples.states.q(k));
            instants.qd.extend_from_slice(samples.states.qd(k));
            instants.qdd.extend_from_slice(samples.states.qdd(k));
            instants.tau.extend_from_slice(&mean[m * n..(m + 1) * n]);
        }
        instants.scale = torque_scale(&instants.tau, n);
        instants
    }

    /// The first instants, and the last fifth of them.
    pub(super) fn split(&self) -> (Self, Self) {
        let n = self.scale.len();
        let at = self.q.len() / n * 4 / 5 * n;
        let part = |range: std::ops::Range<usize>| Self {
            q: self.q[range.clone()].to_vec(),
            qd: self.qd[range.clone()].to_vec(),
            qdd: self.qdd[range.clone()].to_vec(),
            tau: self.tau[range].to_vec(),
            scale: self.scale.clone(),
        };
        (part(0..at), part(at..self.q.len()))
    }

    /// These instants with a mistake undone.
    pub(super) fn corrected(&self, mistake: &Mistake, robot: &Robot) -> Self {
        let n = robot.dof();
        let mut out = self.clone();
        let gear: Vec<f64> = robot.joints().iter().map(|joint| joint.drive.gear).collect();
        let motion = |out: &mut Self, i: usize, factor: f64| {
            for rows in [&mut out.q, &mut out.qd, &mut out.qdd] {
                rows.iter_mut().skip(i).step_by(n).for_each(|x| *x *= factor);
            }
        };
        let effort = |out: &mut Self, i: usize, factor: f64| {
            out.tau.iter_mut().skip(i).step_by(n).for_each(|x| *x *= factor);
            out.scale[i] *= factor.abs();
        };
        let swap = |rows: &mut [f64], [a, b]: [usize; 2]| {
            rows.chunks_exact_mut(n).for_each(|row| row.swap(a - 1, b - 1));
        };
        match *mistake {
            Mistake::Degrees => (0..n).for_each(|i| motion(&mut out, i, DEGREE)),
            Mistake::Radians => (0..n).for_each(|i| motion(&mut out, i, DEGREE.recip())),
            Mistake::PositionUnit { factor } => (0..n).for_each(|i| motion(&mut out, i, factor)),
            Mistake::MotorAngles => {
                (0..n).for_each(|i| motion(&mut out, i, gear[i].recip()));
                if let Some(inverse) = robot.coupling().and_then(|coupling| coupling.clone().try_inverse()) {
                    for rows in [&mut out.q, &mut out.qd, &mut out.qdd] {
                        *rows = mapped(rows, &inverse);
                    }
                }
            }
            Mistake::MotorTorques => {
                (0..n).for_each(|i| effort(&mut out, i, gear[i]));
                if let Some(coupling) = robot.coupling() {
                    out.tau = mapped(&out.tau, &coupling.transpose());
                    let squares: Vec<f64> = out.scale.iter().map(|scale| scale * scale).collect();
                    let squares = mapped(&squares, &coupling.transpose().map(|entry| entry * entry));
                    out.scale = squares.iter().map(|square| square.sqrt()).collect();
                }
            }
            Mistake::EffortUnit { factor } => (0..n).for_each(|i| effort(&mut out, i, factor)),
            Mistake::EffortsReversed { .. } => (0..n).for_each(|i| effort(&mut out, i, -1.0)),
            Mistake::PositionSign { joint } => motion(&mut out, joint - 1, -1.0),
            Mistake::EffortSign { joint } | Mistake::EitherSign { joint } => effort(&mut out, joint - 1, -1.0),
            Mistake::PositionsSwapped { joints } => {
                [&mut out.q, &mut out.qd, &mut out.qdd].into_iter().for_each(|rows| swap(rows, joints));
            }
            Mistake::EffortsSwapped { joints } => {
                [&mut out.tau, &mut out.scale].into_iter().for_each(|rows| swap(rows, joints));
            }
            Mistake::JointsSwapped { joints } => {
                let all = [&mut out.q, &mut out.qd, &mut out.qdd, &mut out.tau, &mut out.scale];
                all.into_iter().for_each(|rows| swap(rows, joints));
            }
            Mistake::PositionScale { joint, factor } => motion(&mut out, joint - 1, factor),
            Mistake::EffortScale { joint, factor } => effort(&mut out, joint - 1, factor),
            Mistake::ZeroOffset { joint, degrees } => {
                out.q.iter_mut().skip(joint - 1).step_by(n).for_each(|q| *q += degrees.to_radians());
            }
            // Nothing in the log itself is to be changed.
            Mistake::Gravity { .. }
            | Mistake::EffortsSmall { .. }
            | Mistake::NoEffort { .. }
            | Mistake::AtRest { .. } => {}
        }
        out
    }
}

/// The map applied to every row.
fn mapped(rows: &[f64], map: &DMatrix<f64>) -> Vec<f64> {
    let n = map.nrows();
    rows.chunks_exact(n)
        .flat_map(|row| (0..n).map(move |i| row.iter().enumerate().map(|(j, x)| map[(i, j)] * x).sum::<f64>()))
        .collect()
}
