//! The shapes of a residual, and their tests.

use nalgebra::{DMatrix, DVector};

use super::shape::{Against, Point, ResidualShape};
use super::whiteness::{Whiteness, probability};
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::estimation::factorisation::Factorisation;
use crate::estimation::observation::Observation;
use crate::estimation::residual::residual_noise;
use crate::linalg::BlockWhitening;
use crate::linalg::product::{add_product, transposed_product};
use crate::model::{JointKind, Robot};
use crate::signal::Samples;
use crate::statistics::{holm_adjusted, student_p_value, student_quantile};

/// Part of a shape that must be left beside the model for it to be named: of a smaller one nearly all is what inertia and weight give,
/// and any error of these, multiplied by as much, passes for it.
const BESIDE_THE_MODEL: f64 = 0.05;

/// Share of the power of a joint's residual from which on a shape is named: less matters to nobody.
const LEAST_SHARE: f64 = 0.05;

/// Parts of the record in which a shape is fitted again, and those in which it must have the same sign.
const PARTS: usize = 5;
const ALIKE_PARTS: usize = 4;

/// Part of the variance of a joint's position that its acceleration explains from which on a spring cannot be told from an inertia: the
/// motion is of one harmonic.
const ONE_HARMONIC: f64 = 0.9;

/// Level of the tests, over all joints and shapes of a figure.
const LEVEL: f64 = 0.05;

/// A shape that the residual of a joint has.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Trend {
    /// Which joint, from zero.
    pub joint: usize,
    /// Which shape.
    pub shape: ResidualShape,
    /// Its coefficient.
    pub slope: f64,
    /// 95 % interval of that.
    pub ci95: [f64; 2],
    /// Unit of it.
    pub unit: String,
    /// p-value, adjusted over all joints and shapes that were tested against the same variable.
    pub p_adjusted: f64,
    /// Share of the power of the joint's residual that it takes with it.
    pub share: f64,
}

impl Trend {
    /// The sentence that it supports.
    pub fn sentence(&self, joint: &str) -> String {
        let [course, cause] = self.shape.words(self.slope > 0.0);
        format!(
            "{joint}: the residual {course}, by {} ({} to {}) {}, as {cause} would show ({}; {:.0} % of the residual's power).",
            three(self.slope),
            three(self.ci95[0]),
            three(self.ci95[1]),
            self.unit,
            probability(self.p_adjusted),
            100.0 * self.share
        )
    }
}

/// The residual of one joint, equation by equation.
#[derive(Clone, Debug, PartialEq)]
pub struct JointTrace {
    /// Times, s.
    pub times: Vec<f64>,
    /// Measured less predicted torque.
    pub residual: Vec<f64>,
    /// Velocity.
    pub velocity: Vec<f64>,
    /// What the links take, by the estimate.
    pub load: Vec<f64>,
    /// Position.
    pub position: Vec<f64>,
    /// Acceleration.
    pub acceleration: Vec<f64>,
}

/// What the residual of an estimate's own equations shows.
#[derive(Clone, Debug, PartialEq)]
pub struct ResidualTrends {
    /// Its shapes at 5 %, of each joint and variable at most one, those of the largest share first.
    pub trends: Vec<Trend>,
    /// What it was tested for, and how many tests each adjustment is over.
    pub tested: Vec<(Against, usize)>,
    /// Autocorrelation of each joint; `None` where there are too few equations.
    pub whiteness: Vec<Option<Whiteness>>,
    /// The residuals.
    pub traces: Vec<JointTrace>,
    /// Whether the torque has no noise, so that nothing was tested.
    pub noise_free: bool,
}

impl ResidualTrends {
    /// Sentences on what the residual follows of a variable, the largest share first; one that says so where it follows nothing.
    pub fn sentences(&self, against: Against, joints: &[String]) -> Vec<String> {
        if self.noise_free {
            return vec!["This log has no noise: a residual of rounding and filters has no shape to name.".to_owned()];
        }
        let Some((_, tests)) = self.tested.iter().find(|(tested, _)| *tested == against) else {
            return vec!["Periods were averaged: nothing is said of a drift over the record.".to_owned()];
        };
        let of = self.trends.iter().filter(|trend| trend.shape.against() == against);
        let all: Vec<String> = of.map(|trend| trend.sentence(&joints[trend.joint])).collect();
        if !all.is_empty() {
            return all;
        }
        let name = against.name();
        vec![format!("No joint's residual follows {name}, at 5 % over all {tests} joints and shapes that were tried.")]
    }

    /// Sentences on the autocorrelation, joint by joint.
    pub fn whiteness_sentences(&self, joints: &[String]) -> Vec<String> {
        let of = joints.iter().zip(&self.whiteness);
        of.filter_map(|(joint, of)| of.as_ref().map(|of| of.sentence(joint))).collect()
    }
}

/// Of each joint the least probable, where its adjusted p-value is below the level.
fn strongest(mut all: Vec<Trend>, joints: usize) -> Vec<Trend> {
    let p: Vec<f64> = all.iter().map(|trend| trend.p_adjusted).collect();
    for (trend, adjusted) in all.iter_mut().zip(holm_adjusted(&p)) {
        trend.p_adjusted = adjusted;
    }
    let of = |joint: usize| {
        let own =
            all.iter().filter(|trend| trend.joint == joint && trend.p_adjusted < LEVEL && trend.share >= LEAST_SHARE);
        own.max_by(|a, b| a.share.total_cmp(&b.share)).cloned()
    };
    (0..joints).filter_map(of).collect()
}

/// The part of β that is of links.
fn of_links(observation: &Observation, beta: &DVector<f64>) -> DVector<f64> {
    DVector::from_fn(beta.len(), |row, _| {
        let id = observation.base.parameters[observation.base.kept[row]];
        if id.kind.link_place().is_some() { beta[row] } else { 0.0 }
    })
}

/// Tests of what residuals of estimates of the same equations show.
#[derive(Clone, Debug)]
pub struct ResidualTests {
    observation: Observation,
    kinds: Vec<JointKind>,
    /// One over the RMS of each joint's residual of ordinary least squares, squared; zero where a joint has none.
    weights: Vec<f64>,
    /// (WᵀPW)⁻¹.
    inverse: DMatrix<f64>,
}

impl ResidualTests {
    /// Tests on the equations of one experiment with this robot.
    ///
    /// # Errors
    /// [`EstimationError`] where least squares of the equations have no answer.
    pub fn new(robot: &Robot, observation: Observation) -> Result<Self, EstimationError> {
        let n = observation.dof;
        let equations = Factorisation::new(&observation)?;
        let covariance = equations.residual_covariance(equations.least_squares()?.solution());
        let of = |joint: usize| {
            let variance: f64 = covariance[(joint, joint)];
            if variance > 0.0 { variance.recip() } else { 0.0 }
        };
        let weights: Vec<f64> = (0..n).map(of).collect();
        let shown = DMatrix::from_diagonal(&DVector::from_fn(n, |joint, _| {
            if weights[joint] > 0.0 { weights[joint].recip() } else { 1.0 }
        }));
        let inverse = equations.weighted(&BlockWhitening::new(&shown)?)?.inverse_information();
        let kinds = robot.joints().iter().map(|joint| joint.kind).collect();
        Ok(Self { observation, kinds, weights, inverse })
    }

    /// Tests the residual of each estimate that was made from these equations, with the states of `samples`. Shapes that no estimate moves
    /// are freed of the model once for all.
    ///
    /// # Errors
    /// [`EstimationError::Count`] or [`EstimationError::UnknownParameter`] where equations, samples and estimates are not of each other.
    pub fn trends(&self, samples: &Samples, estimates: &[Estimate]) -> Result<Vec<ResidualTrends>, EstimationError> {
        let n = self.observation.dof;
        let used: Vec<Vec<usize>> = (0..n).map(|joint| self.used_rows(joint)).collect();
        let of_estimates: Vec<Left> =
            estimates.iter().map(|one| self.left(samples, &used, one)).collect::<Result<_, _>>()?;
        let noise_free = samples.is_noise_free();
        // The averaged period has no beginning and no end.
        let is_tested = |against| !(noise_free || against == Against::Time && self.observation.periodic);
        let tested: Vec<Against> = Against::ALL.into_iter().filter(|&against| is_tested(against)).collect();
        let shapes = || ResidualShape::ALL.iter().copied().filter(|shape| is_tested(shape.against()));
        let (of_load, others): (Vec<_>, Vec<_>) = shapes().partition(|shape| shape.against() == Against::Load);
        let mut all = vec![vec![Vec::new(); tested.len()]; estimates.len()];
        for (joint, rows) in used.iter().enumerate().filter(|(_, rows)| !rows.is_empty()) {
            let mut of_all: Option<Vec<Beside>> = None;
            for (own, all) in of_estimates.iter().zip(&mut all) {
                let trace = &own.traces[joint];
                let of_all = of_all.get_or_insert_with(|| self.beside(joint, rows, trace, &others));
                for shape in of_all.iter().chain(&self.beside(joint, rows, trace, &of_load)) {
                    let place = tested.iter().position(|against| *against == shape.shape.against());
                    let place = place.expect("a shape that is tested");
                    all[place].extend(self.trend(joint, rows, shape, &own.left));
                }
            }
        }
        let of_one = |(Left { traces, whiteness, .. }, all): (Left, Vec<Vec<Trend>>)| {
            let tested = tested.iter().zip(&all).map(|(&against, all)| (against, all.len())).collect();
            let mut trends: Vec<Trend> = all.into_iter().flat_map(|all| strongest(all, n)).collect();
            trends.sort_by(|a, b| b.share.total_cmp(&a.share));
            ResidualTrends { trends, tested, whiteness, traces, noise_free }
        };
        Ok(of_estimates.into_iter().zip(all).map(of_one).collect())
    }

    /// What an estimate leaves of each joint's equations, the rows `used`.
    fn left(&self, samples: &Samples, used: &[Vec<usize>], estimate: &Estimate) -> Result<Left, EstimationError> {
        let observation = &self.observation;
        EstimationError::unless_equal("blocks of the samples", samples.blocks(), observation.samples())?;
        let n = observation.dof;
        let names = observation.base.names();
        if let Some(other) = estimate.base.iter().find(|parameter| !names.contains(&parameter.name)) {
            return Err(EstimationError::UnknownParameter { parameter: other.name.clone() });
        }
        // An estimator may leave parameters out: they are zero.
        let value = |name: &String| estimate.base.iter().find(|parameter| parameter.name == *name);
        let beta = DVector::from_fn(names.len(), |j, _| value(&names[j]).map_or(0.0, |parameter| parameter.value));
        let residual = observation.residual(&beta);
        let load = self.torque(of_links(observation, &beta));
        let means = |values: &[f64]| samples.block_means(values, n);
        let states = &samples.states;
        let [position, velocity, acceleration] = [&states.q, &states.qd, &states.qdd].map(|values| means(values));
        let step_s = samples.block as f64 / samples.rate_hz;
        let traces = used.iter().map(|rows| {
            let of = |values: &[f64]| rows.iter().map(|&row| values[row]).collect::<Vec<f64>>();
            JointTrace {
                times: rows.iter().map(|&row| (row / n) as f64 * step_s).collect(),
                residual: of(residual.as_slice()),
                velocity: of(&velocity),
                load: of(load.as_slice()),
                position: of(&position),
                acceleration: of(&acceleration),
            }
        });
        let traces = traces.collect();
        let mut whiteness: Vec<Option<Whiteness>> = (0..n)
            .map(|joint| {
                let rows = (joint..observation.used.len()).step_by(n);
                let known: Vec<Option<f64>> = rows.map(|row| observation.used[row].then_some(residual[row])).collect();
                Whiteness::of(&known, step_s)
            })
            .collect();
        let p: Vec<f64> = whiteness.iter().flatten().map(|of| of.p_adjusted).collect();
        for (of, adjusted) in whiteness.iter_mut().flatten().zip(holm_adjusted(&p)) {
            of.p_adjusted = adjusted;
        }
        let left = self.beside_the_model(DMatrix::from_column_slice(residual.len(), 1, residual.as_slice()));
        Ok(Left { traces, whiteness, left: left.column(0).into_owned() })
    }

    /// Rows of a joint that are equations.
    fn used_rows(&self, joint: usize) -> Vec<usize> {
        let used = &self.observation.used;
        (joint..used.len()).step_by(self.observation.dof).filter(|&row| used[row]).collect()
    }

    fn weighted(&self, mut x: DMatrix<f64>) -> DMatrix<f64> {
        for mut column in x.column_iter_mut() {
            column.iter_mut().zip(self.weights.iter().cycle()).for_each(|(x, weight)| *x *= weight);
        }
        x
    }

    /// `W β`.
    fn torque(&self, beta: DVector<f64>) -> DVector<f64> {
        let w = &self.observation.regressor;
        let mut torque = DVector::zeros(w.nrows());
        add_product(w.as_slice(), beta.as_slice(), w.nrows(), torque.as_mut_slice());
        torque
    }

    /// `x − W (WᵀPW)⁻¹ WᵀP x`, twice, since the normal equations lose digits.
    fn beside_the_model(&self, mut x: DMatrix<f64>) -> DMatrix<f64> {
        let w = self.observation.regressor.as_slice();
        for _ in 0..2 {
            let rows = x.nrows();
            let seen = transposed_product(w, self.weighted(x.clone()).as_slice(), rows);
            let taken = -&self.inverse * seen;
            add_product(w, taken.as_slice(), rows, x.as_mut_slice());
        }
        x
    }

    /// Shapes in the `rows` of one joint without what the model has of them. Left out are those that the model has, and of which the joint shows
    /// nothing.
    fn beside(&self, joint: usize, rows: &[usize], trace: &JointTrace, shapes: &[ResidualShape]) -> Vec<Beside> {
        let (Some(first), Some(last)) = (trace.times.first(), trace.times.last()) else { return Vec::new() };
        let length = (last - first).max(f64::MIN_POSITIVE);
        let speed_rms = (power(&trace.velocity) / rows.len() as f64).sqrt();
        let mut x = DMatrix::zeros(self.observation.y.len(), shapes.len());
        for (k, &row) in rows.iter().enumerate() {
            let point = Point {
                time: (trace.times[k] - first) / length - 0.5,
                velocity: trace.velocity[k],
                speed_rms,
                load: trace.load[k],
                position: trace.position[k],
            };
            for (column, shape) in shapes.iter().enumerate() {
                x[(row, column)] = shape.value(&point);
            }
        }
        let sizes: Vec<f64> = x.column_iter().map(|x| x.norm()).collect();
        let beside = self.beside_the_model(x);
        let weighted = self.weighted(beside.clone());
        let is_inertia = || explained(&trace.position, &trace.acceleration) > ONE_HARMONIC;
        let is_shown = |column: usize| {
            sizes[column] > 0.0
                && self.weights[joint] > 0.0
                && beside.column(column).norm() > BESIDE_THE_MODEL * sizes[column]
                && !(shapes[column] == ResidualShape::Spring && is_inertia())
        };
        let of = |column: usize| {
            let (beside, weighted) = (beside.column(column), weighted.columns(column, 1));
            let information = weighted.column(0).dot(&beside);
            let (beside, weighted) = (beside.into_owned(), weighted.into_owned());
            Beside { shape: shapes[column], beside, weighted, information }
        };
        (0..shapes.len()).filter(|&column| is_shown(column)).map(of).collect()
    }

    /// One shape in the `rows` of one joint, of which the model leaves `left`, r̃; `None` where the joint shows nothing of it.
    fn trend(&self, joint: usize, rows: &[usize], shape: &Beside, left: &DVector<f64>) -> Option<Trend> {
        let Beside { shape, beside, weighted: columns, information } = shape;
        let z = columns.column(0);
        let slope = z.dot(left) / information;
        let part = |rows: &[usize]| rows.iter().map(|&row| z[row] * left[row]).sum::<f64>();
        let alike = rows.chunks(rows.len().div_ceil(PARTS)).filter(|rows| part(rows) * slope > 0.0).count();
        if alike < ALIKE_PARTS {
            return None;
        }
        // A shape that is in the residual is no noise: slow ones would pass for a long correlation.
        let noise = residual_noise(&self.observation, &(left - beside * slope));
        let variance = z.dot(&noise.apply(columns).column(0));
        let (std, freedom) = (variance.max(0.0).sqrt() / information, noise.degrees_of_freedom);
        let t = student_quantile(0.5 + 0.5 * 0.95, freedom);
        let p_adjusted = student_p_value(slope / std, freedom);
        if !p_adjusted.is_finite() {
            return None;
        }
        let own: Vec<f64> = rows.iter().map(|&row| left[row]).collect();
        let rest: Vec<f64> = rows.iter().map(|&row| left[row] - slope * beside[row]).collect();
        let share = 1.0 - power(&rest) / power(&own).max(f64::MIN_POSITIVE);
        let unit = shape.unit(self.kinds[joint]);
        let (shape, ci95) = (*shape, [slope - t * std, slope + t * std]);
        Some(Trend { joint, shape, slope, ci95, unit, p_adjusted, share })
    }
}

/// What an estimate leaves of its equations.
struct Left {
    traces: Vec<JointTrace>,
    whiteness: Vec<Option<Whiteness>>,
    /// r̃.
    left: DVector<f64>,
}

/// A shape of one joint without what the model has of it.
struct Beside {
    shape: ResidualShape,
    /// x̃.
    beside: DVector<f64>,
    /// P x̃, one column.
    weighted: DMatrix<f64>,
    /// x̃ᵀ P x̃.
    information: f64,
}

fn power(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum()
}

/// Part of the variance of one quantity that another explains.
fn explained(x: &[f64], by: &[f64]) -> f64 {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
    let (x_mean, by_mean) = (mean(x), mean(by));
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for (x, y) in x.iter().zip(by) {
        let (x, y) = (x - x_mean, y - by_mean);
        (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
    }
    xy * xy / (xx * yy).max(f64::MIN_POSITIVE)
}

/// Three digits.
fn three(value: f64) -> String {
    let size = value.abs();
    if (1e-3..1e4).contains(&size) {
        let digits = (2 - libm::floor(libm::log10(size)) as i32).clamp(0, 6) as usize;
        format!("{value:.digits$}")
    } else {
        format!("{value:.2e}")
    }
}
