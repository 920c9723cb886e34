//! The stacked linear equations of one experiment.

use std::borrow::Cow;
use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use super::error::EstimationError;
use super::load_friction;
use crate::base::{BaseReduction, Category};
use crate::linalg::product::add_product;
use crate::linalg::{BlockWhitening, LeastSquaresError};
use crate::model::{Columns, Drive, ParameterId, Robot, StandardParameters};
use crate::provenance::Provenance;
use crate::regressor::JointTorqueRegressor;
use crate::signal::{NoiseModel, Samples};

/// Largest entry of a column in the equations, over that in all rows, below which they do not show its parameter: what is fitted to
/// traces of it says nothing of the rows in which it acts.
pub(super) const LEAST_SHARE: f64 = 1e-3;

/// `y = W_b β + ε` over M blocks of samples of n joints: row `k n + i` is joint i, mean over block k.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// W_b, (n·M) × b.
    pub regressor: DMatrix<f64>,
    /// Joint torque, n·M.
    pub y: DVector<f64>,
    /// Which rows are equations, n·M; the others are zero in both.
    pub used: Vec<bool>,
    /// Number of joints n.
    pub dof: usize,
    /// Name of the robot.
    pub robot: String,
    /// Unit of each joint's torque, n.
    pub units: Vec<String>,
    /// Which columns are estimated.
    pub columns: Columns,
    /// Shape parameters of the laws of each joint that are not their defaults, by their keys in the robot file, n.
    pub shape: Vec<BTreeMap<String, f64>>,
    /// The reduction to base parameters.
    pub base: BaseReduction,
    /// Unit of each base parameter, b.
    pub parameter_units: Vec<String>,
    /// Noise of y, where it was measured as scatter over periods.
    pub noise: Option<NoiseModel>,
    /// Covariance of one raw sample of torque, n × n; `None` as above.
    pub torque_covariance: Option<DMatrix<f64>>,
    /// The parameters at which equations with friction of the load are linearised, b; `None` where the equations are linear.
    pub linear_at: Option<DVector<f64>>,
    /// Whether the instants are one period, so that the last is followed by the first.
    pub periodic: bool,
    /// Periods that were averaged.
    pub periods: usize,
    /// Version, robot and seed that produced the samples.
    pub provenance: Option<Provenance>,
}

impl Observation {
    /// Evaluates the regressor at the samples' states and keeps the base columns. Friction of the load has that of the regressor; where the
    /// load follows from the estimate, [`observe`](super::observe) makes the equations.
    ///
    /// # Errors
    /// [`EstimationError::Count`] or [`EstimationError::OtherParameters`] where robot, regressor, reduction and samples do
    /// not belong together; [`EstimationError::TooFewEquations`] where there are fewer equations than parameters;
    /// [`EstimationError::NothingActs`] where there is no parameter;
    /// [`EstimationError::OutsideOfEquations`] where a parameter acts in rows alone that are none.
    pub fn new(
        robot: &Robot,
        regressor: &JointTorqueRegressor,
        base: &BaseReduction,
        samples: &Samples,
    ) -> Result<Self, EstimationError> {
        Self::checked(robot, regressor, base, samples, None)
    }

    /// The equations of a fit, linearised `at` these parameters where they must be.
    pub(super) fn checked(
        robot: &Robot,
        regressor: &JointTorqueRegressor,
        base: &BaseReduction,
        samples: &Samples,
        at: Option<&DVector<f64>>,
    ) -> Result<Self, EstimationError> {
        let (equations, b) = (samples.used.iter().filter(|used| **used).count(), base.rank());
        if samples.dof() == robot.dof() && equations < b {
            return Err(EstimationError::TooFewEquations { equations, parameters: b });
        }
        if b == 0 {
            return Err(EstimationError::NothingActs { equations });
        }
        let (own, left_out) = Self::stacked(robot, regressor, base, samples, at)?;
        own.check_shown(&left_out, |_| true)?;
        Ok(own)
    }

    /// The equations show the parameters that are asked for, of which the rows that are none have these largest entries.
    ///
    /// # Errors
    /// [`EstimationError::OutsideOfEquations`] where one acts in rows alone that are none.
    pub(super) fn check_shown(
        &self,
        left_out: &[f64],
        is_asked_for: impl Fn(ParameterId) -> bool,
    ) -> Result<(), EstimationError> {
        for (j, (column, &left_out)) in self.regressor.column_iter().zip(left_out).enumerate() {
            let id = self.base.parameters[self.base.kept[j]];
            // Mostly the first entries decide.
            if left_out > 0.0 && is_asked_for(id) && !column.iter().any(|entry| entry.abs() >= LEAST_SHARE * left_out) {
                let share = column.amax() / left_out;
                return Err(EstimationError::OutsideOfEquations { parameter: id.to_string(), share });
            }
        }
        Ok(())
    }

    /// The equations, of which there may be few, linearised `at` these parameters where they must be; and the largest entry of each column in
    /// the rows that are none.
    pub(super) fn stacked(
        robot: &Robot,
        regressor: &JointTorqueRegressor,
        base: &BaseReduction,
        samples: &Samples,
        at: Option<&DVector<f64>>,
    ) -> Result<(Self, Vec<f64>), EstimationError> {
        let n = robot.dof();
        EstimationError::unless_equal("joints of the regressor", regressor.rows(), n)?;
        EstimationError::unless_equal("joints of the samples", samples.dof(), n)?;
        if base.parameters != regressor.parameters() {
            let (found, expected) = (base.parameters.len(), regressor.cols());
            return Err(EstimationError::OtherParameters { found, expected });
        }
        EstimationError::unless_equal("marks of used equations", samples.used.len(), samples.blocks() * n)?;
        let mut y = DVector::from_vec(samples.block_means(&samples.tau, n));
        let mut w = match at {
            Some(beta) => load_friction::linearised(regressor, base, samples, beta, &mut y),
            None => regressor.stack_means(&samples.states, &base.kept, samples.block),
        };
        if samples.torque_band_hz.is_some() {
            filter_friction(regressor, base, samples, &mut w)?;
        }
        let mut left_out = vec![0.0_f64; w.ncols()];
        for (row, _) in samples.used.iter().enumerate().filter(|(_, used)| !**used) {
            for (largest, entry) in left_out.iter_mut().zip(w.row_mut(row).iter_mut()) {
                *largest = largest.max(std::mem::take(entry).abs());
            }
            y[row] = 0.0;
        }
        let unit = |id: ParameterId| id.kind.unit(robot.joints()[id.index].kind).to_owned();
        let own = Self {
            regressor: w,
            y,
            used: samples.used.clone(),
            dof: n,
            robot: robot.name().to_owned(),
            units: samples.units.clone(),
            columns: regressor.columns(),
            shape: shapes(robot, regressor.columns()),
            linear_at: at.cloned(),
            base: base.clone(),
            parameter_units: base.kept.iter().map(|&j| base.parameters[j]).map(unit).collect(),
            noise: samples.noise.clone(),
            torque_covariance: samples.torque_covariance.clone(),
            periodic: samples.period_s.is_some(),
            periods: samples.periods,
            provenance: samples.provenance.clone(),
        };
        Ok((own, left_out))
    }

    /// The regressor of the equations, with the load at which they are linearised.
    pub(super) fn joint_regressor(&self, robot: &Robot) -> JointTorqueRegressor {
        let regressor = JointTorqueRegressor::with_load(robot, self.columns, &StandardParameters::zero(robot.dof()));
        match &self.linear_at {
            Some(beta) => regressor.with_links(&load_friction::standard(&self.base, beta)[..10 * robot.dof()]),
            None => regressor,
        }
    }

    /// Number of blocks M.
    pub fn samples(&self) -> usize {
        self.y.len() / self.dof
    }

    /// Number of equations: used rows.
    pub fn equations(&self) -> usize {
        self.used.iter().filter(|used| **used).count()
    }

    /// These equations without those that are given up.
    pub(super) fn without(&self, given_up: impl Fn(usize) -> bool) -> Cow<'_, Self> {
        let used: Vec<bool> = (0..self.y.len()).map(|row| self.used[row] && !given_up(row)).collect();
        if used == self.used {
            return Cow::Borrowed(self);
        }
        let mut kept = Self { used, ..self.clone() };
        kept.blank();
        Cow::Owned(kept)
    }

    /// These equations with further columns (n·M × as many) behind their own, each of a parameter and unit.
    pub(super) fn with_columns(&self, columns: &DMatrix<f64>, ids: &[ParameterId], units: &[String]) -> Self {
        let (rows, b, added) = (self.y.len(), self.base.rank(), ids.len());
        let mut regressor = DMatrix::zeros(rows, b + added);
        regressor.columns_mut(0, b).copy_from(&self.regressor);
        regressor.columns_mut(b, added).copy_from(columns);
        let mut base = self.base.clone();
        let p = base.parameters.len();
        let mut k = DMatrix::zeros(b + added, p + added);
        k.view_mut((0, 0), (b, p)).copy_from(&base.k);
        k.view_mut((b, p), (added, added)).fill_with_identity();
        base.k = k;
        base.kept.extend(p..p + added);
        base.categories.extend(std::iter::repeat_n(Category::Identifiable, added));
        base.parameters.extend(ids);
        let mut parameter_units = self.parameter_units.clone();
        parameter_units.extend(units.iter().cloned());
        Self { regressor, base, parameter_units, ..self.clone() }
    }

    /// `y − W_b β`, n·M; zero in rows that are no equation.
    pub fn residual(&self, beta: &DVector<f64>) -> DVector<f64> {
        let mut residual = self.y.clone();
        let negative: Vec<f64> = beta.iter().map(|value| -value).collect();
        add_product(self.regressor.as_slice(), &negative, self.y.len(), residual.as_mut_slice());
        residual
    }

    /// `Σ^{-½} x` of a vector with an entry for each row, by the weights of its blocks.
    pub(super) fn white(&self, weights: &BlockWhitening, x: &DVector<f64>) -> Result<DVector<f64>, LeastSquaresError> {
        let column = DMatrix::from_column_slice(x.len(), 1, x.as_slice());
        Ok(weights.clone().whiten(&column, &self.used)?.column(0).into_owned())
    }

    /// Sets all rows that are no equation to zero.
    pub(super) fn blank(&mut self) {
        for (row, _) in self.used.iter().enumerate().filter(|(_, used)| !**used) {
            self.regressor.row_mut(row).fill(0.0);
            self.y[row] = 0.0;
        }
    }

    /// An error of the equations, with the name of a column that the trajectory does not excite.
    pub(super) fn named(&self, error: LeastSquaresError) -> EstimationError {
        match error {
            LeastSquaresError::Dependent { column, independent, least } => {
                let parameter = self.base.names()[column].clone();
                EstimationError::NotExcited { parameter, independent, least }
            }
            other => other.into(),
        }
    }
}

/// Puts the columns of friction that turns round with velocity behind the low pass of the torque.
fn filter_friction(
    regressor: &JointTorqueRegressor,
    base: &BaseReduction,
    samples: &Samples,
    w: &mut DMatrix<f64>,
) -> Result<(), EstimationError> {
    let n = samples.dof();
    let turns = |column: usize| {
        let term = base.parameters[column].kind.term();
        term.is_some_and(|term| !term.entry().needs.load && term.entry().shapes.iter().any(|shape| shape.smooths))
    };
    for (place, &column) in base.kept.iter().enumerate().filter(|(_, column)| turns(**column)) {
        let rows: Vec<f64> = regressor.stack_means(&samples.states, &[column], 1).data.into();
        let rows = samples.filtered_as_torque(rows, n)?;
        w.set_column(place, &DVector::from_vec(samples.block_means(&rows, n)));
    }
    Ok(())
}

/// The shape parameters of the laws of these columns that are not their defaults, joint by joint.
fn shapes(robot: &Robot, columns: Columns) -> Vec<BTreeMap<String, f64>> {
    let of = |drive: &Drive| {
        let stated = columns.shapes().into_iter().map(|shape| (shape, drive.shape(&shape)));
        stated
            .filter(|(shape, value)| *value != shape.default)
            .map(|(shape, value)| (shape.key.to_owned(), value))
            .collect()
    };
    robot.joints().iter().map(|joint| of(&joint.drive)).collect()
}
