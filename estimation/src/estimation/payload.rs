//! What the last link carries: the difference between two estimates of one arm, with and without a load.
//!
//! ```text
//! β_with − β_without = K_n θ + e        e ~ (0, C_with + C_without)        θ: the load's ten parameters in the frame of link n
//! ```
//! K_n are the columns of the reduction that belong to the last link: a load that is fixed to it adds to its parameters and to
//! nothing else. Friction and offsets may differ between the logs: only base parameters of links and rotors are compared,
//! with the part of the covariances that is theirs. This is the generalised least-squares solution of both logs together.
//!
//! What of θ the motion can show follows from K_n; of the rest nothing is said. Where the base parameters scatter more than
//! their covariances say, intervals are widened by that factor. The consistent set is that of [`consistent_set`], for one body.

use nalgebra::{Cholesky, DMatrix, DVector, Vector3};

use super::consistent_set::{ConsistentSet, consistent_set};
use super::{BaseEstimate, Estimate, EstimationError, Termination};
use crate::base::{BaseReduction, Category, LOAD_UNITS};
use crate::linalg::product;
use crate::model::{JointKind, ParameterKind, StandardParameters};
use crate::spatial::Inertia;
use crate::statistics::{chi_squared_quantile, student_quantile};

/// Radius of gyration of a load of which nothing is known, m.
const GYRATION: f64 = 0.05;

/// Level of the test that the change of the arm is that of a load.
const CONFIDENCE: f64 = 0.95;

/// One of the load's ten parameters.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct PayloadParameter {
    /// Symbol: `m`, `mcx`, …, `Izz`.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// Estimate with its standard deviation and 95 % interval; `None` where the motion does not show it alone.
    pub shown: Option<PayloadValue>,
    /// Its value in the physically consistent set.
    pub consistent: f64,
}

/// A value that the motion shows.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct PayloadValue {
    /// The estimate.
    pub value: f64,
    /// Standard deviation.
    pub std: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
}

/// A load on the last link.
#[derive(Clone, Debug, PartialEq)]
pub struct Payload {
    /// The ten, in the frame of the last link.
    pub parameters: Vec<PayloadParameter>,
    /// The combinations of them that the motion shows, with their covariance.
    pub combinations: Estimate,
    /// What the combinations are made of: coefficients of the ten.
    pub base: BaseReduction,
    /// The body that agrees best with them.
    pub body: ConsistentSet,
    /// Squared distance of the change from that of any load, in standard deviations.
    pub chi_squared: f64,
    /// What it exceeds with a probability of 5 % where the covariances are right.
    pub chi_squared_limit: f64,
    /// Factor on the standard deviations, 1 where the change scatters no more than the covariances say.
    pub widened_by: f64,
}

impl Payload {
    /// The load as a body.
    #[must_use]
    pub fn inertia(&self) -> &Inertia {
        &self.body.parameters.links[0]
    }
}

/// The load by which an arm `with` it differs from the same arm `without`.
///
/// # Errors
/// [`EstimationError::OtherBase`] where an estimate is not one of this base, [`EstimationError::OtherRobot`] where they are of two
/// robots, [`EstimationError::NotDefinite`] where their covariances are none, [`EstimationError::NothingShared`] where the motion shows
/// nothing of a load.
pub fn payload(base: &BaseReduction, without: &Estimate, with: &Estimate) -> Result<Payload, EstimationError> {
    if without.robot != with.robot {
        let (first, second) = (without.robot.clone(), with.robot.clone());
        return Err(EstimationError::OtherRobot { first, second });
    }
    for estimate in [without, with] {
        if estimate.names() != base.names() {
            return Err(EstimationError::OtherBase { found: estimate.names(), expected: base.names() });
        }
    }
    let change = Change::between(base, without, with);
    let load = base.of_load();
    if load.rank() == 0 {
        return Err(EstimationError::NothingShared);
    }
    let freedom = without.degrees_of_freedom.min(with.degrees_of_freedom);
    let fitted = change.fitted(base, &load)?;
    let combinations = estimate(with, &load, &fitted, freedom);
    let body = consistent_set(&load, &combinations, &guess(&load, &combinations))?;
    let shown = |column: usize| -> Option<PayloadValue> {
        let row = load.kept.iter().position(|&kept| kept == column)?;
        let found = &combinations.base[row];
        (load.categories[column] == Category::Identifiable).then_some(PayloadValue {
            value: found.value,
            std: found.std,
            ci95: found.ci95,
        })
    };
    let consistent = body.parameters.links[0].to_array();
    let parameters = ParameterKind::LINK
        .iter()
        .enumerate()
        .map(|(column, kind)| PayloadParameter {
            name: kind.symbol().to_owned(),
            unit: kind.unit(JointKind::Revolute),
            shown: shown(column),
            consistent: consistent[column],
        })
        .collect();
    Ok(Payload {
        parameters,
        combinations,
        base: load,
        body,
        chi_squared: fitted.chi_squared,
        chi_squared_limit: fitted.limit,
        widened_by: fitted.widened_by,
    })
}

/// The change of the base parameters of links and rotors.
struct Change {
    /// Which rows of the base they are.
    rows: Vec<usize>,
    /// β_with − β_without.
    values: DVector<f64>,
    /// C_with + C_without.
    covariance: DMatrix<f64>,
}

/// The load's combinations, fitted to a change.
struct Fitted {
    values: DVector<f64>,
    covariance: DMatrix<f64>,
    chi_squared: f64,
    limit: f64,
    widened_by: f64,
}

impl Change {
    fn between(base: &BaseReduction, without: &Estimate, with: &Estimate) -> Self {
        let rows = base.inertial_rows();
        let values = with.beta() - without.beta();
        let covariance = with.covariance_matrix() + without.covariance_matrix();
        Self {
            values: DVector::from_iterator(rows.len(), rows.iter().map(|&row| values[row])),
            covariance: DMatrix::from_fn(rows.len(), rows.len(), |i, j| covariance[(rows[i], rows[j])]),
            rows,
        }
    }

    /// Generalised least squares on the combinations that the base shows.
    fn fitted(&self, base: &BaseReduction, load: &BaseReduction) -> Result<Fitted, EstimationError> {
        let (rows, rank) = (self.rows.len(), load.rank());
        let std = self.covariance.diagonal().map(f64::sqrt);
        let scaled = DMatrix::from_fn(rows, rows, |i, j| self.covariance[(i, j)] / (std[i] * std[j]));
        let Some(factor) = Cholesky::new(scaled) else { return Err(EstimationError::NotDefinite) };
        let lower = factor.l();
        let columns = base.columns_of_last_link();
        let k = DMatrix::from_fn(rows, rank, |i, j| {
            base.k[(self.rows[i], columns[load.kept[j]])] * LOAD_UNITS[load.kept[j]] / std[i]
        });
        let d = DMatrix::from_fn(rows, 1, |i, _| self.values[i] / std[i]);
        let (Some(a), Some(y)) = (lower.solve_lower_triangular(&k), lower.solve_lower_triangular(&d)) else {
            return Err(EstimationError::NotDefinite);
        };
        let Some(normal) = Cholesky::new(product(&a.transpose(), &a)) else {
            return Err(EstimationError::NotDefinite);
        };
        let inverse = normal.inverse();
        let solution = product(&inverse, &product(&a.transpose(), &y));
        let residual = &y - product(&a, &solution);
        let chi_squared = residual.iter().map(|r| r * r).sum::<f64>();
        let freedom = (rows - rank) as f64;
        let widened_by = if freedom > 0.0 { (chi_squared / freedom).sqrt().max(1.0) } else { 1.0 };
        let unit = |j: usize| LOAD_UNITS[load.kept[j]];
        Ok(Fitted {
            values: DVector::from_fn(rank, |j, _| solution[(j, 0)] * unit(j)),
            covariance: DMatrix::from_fn(rank, rank, |i, j| {
                inverse[(i, j)] * unit(i) * unit(j) * widened_by * widened_by
            }),
            chi_squared,
            limit: if freedom > 0.0 { chi_squared_quantile(CONFIDENCE, freedom) } else { 0.0 },
            widened_by,
        })
    }
}

/// The combinations as an estimate of one body.
fn estimate(of: &Estimate, load: &BaseReduction, fitted: &Fitted, freedom: f64) -> Estimate {
    let t = student_quantile(0.975, freedom);
    let parameter = |(row, name): (usize, String)| {
        let (value, std) = (fitted.values[row], fitted.covariance[(row, row)].max(0.0).sqrt());
        let unit = load.parameters[load.kept[row]].kind.unit(JointKind::Revolute).to_owned();
        BaseEstimate { name, value, std, ci95: [value - t * std, value + t * std], unit, declared_std: 0.0 }
    };
    Estimate {
        columns: "rigid".to_owned(),
        base: load.names().into_iter().enumerate().map(parameter).collect(),
        covariance: fitted.covariance.row_iter().map(|row| row.iter().copied().collect()).collect(),
        standard: None,
        consistent: None,
        degrees_of_freedom: freedom,
        findings: Vec::new(),
        termination: Termination::Direct,
        ..of.clone()
    }
}

/// A body of the estimated mass where it is estimated to be.
fn guess(load: &BaseReduction, combinations: &Estimate) -> StandardParameters {
    let of = |kind: ParameterKind| {
        let row = load.kept.iter().position(|&column| load.parameters[column].kind == kind)?;
        Some(&combinations.base[row])
    };
    let mass = of(ParameterKind::M).map_or(1.0, |m| m.value.max(m.std).max(1e-3));
    let far = |kind: ParameterKind| of(kind).map_or(0.0, |moment| (moment.value / mass).clamp(-0.5, 0.5));
    let centre = Vector3::new(far(ParameterKind::Mcx), far(ParameterKind::Mcy), far(ParameterKind::Mcz));
    let about_centre = nalgebra::Matrix3::from_diagonal_element(mass * GYRATION * GYRATION);
    let mut guess = StandardParameters::zero(1);
    guess.links[0] = Inertia::from_com(mass, centre, about_centre);
    guess
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{Method, reduce};
    use crate::chains::{ChainRecipe, random_inertia};
    use crate::chains::{crs_a460, crs_a460_nominal};
    use crate::estimation::consistent_set::fixtures::estimate_of;
    use crate::model::term::{COULOMB, OFFSET};
    use crate::model::{Columns, Robot};
    use crate::seed::Seed;
    use rand::Rng;
    use rand_distr::{Distribution, StandardNormal};

    const COLUMNS: Columns = Columns::RIGID_ROTOR_FRICTION;

    /// Two estimates of an arm, the second with a load and other friction; each scattered by its standard deviations times `noise`.
    fn two(
        robot: &Robot,
        parameters: &StandardParameters,
        load: &Inertia,
        noise: f64,
        rng: &mut impl Rng,
    ) -> (BaseReduction, Estimate, Estimate) {
        let base = reduce(robot, COLUMNS, Method::Structural, Seed::new(0)).unwrap();
        let mut loaded = parameters.clone();
        let last = loaded.links.last_mut().unwrap();
        let sum: Vec<f64> = last.to_array().iter().zip(load.to_array()).map(|(a, b)| a + b).collect();
        *last = Inertia::from_array(&sum.try_into().unwrap());
        for drive in &mut loaded.drives {
            drive[COULOMB] *= 1.3;
            drive[OFFSET] += 0.2;
        }
        let mut draw = |parameters: &StandardParameters| {
            let beta = base.beta(&parameters.vector(robot, COLUMNS));
            let b = beta.len();
            // Correlated: R Rᵀ of a random R near the identity, in units of the parameters.
            let size =
                |row: usize| base.parameters[base.kept[row]].kind.link_place().map_or(0.01, |place| LOAD_UNITS[place]);
            let mixing = DMatrix::from_fn(b, b, |i, j| {
                let x: f64 = StandardNormal.sample(rng);
                0.02 * size(i) * if i == j { 1.0 } else { 0.2 * x }
            });
            let white = DMatrix::from_fn(b, 1, |_, _| StandardNormal.sample(rng));
            let scattered = &beta + (&mixing * white).column(0) * noise;
            estimate_of(&base, &scattered, &(&mixing * mixing.transpose()))
        };
        let (without, with) = (draw(parameters), draw(&loaded));
        (base, without, with)
    }

    #[test]
    fn identity_the_load_is_found_without_noise() {
        let mut rng = Seed::new(31).stream("payload", 0);
        let load = random_inertia(&mut rng);
        let (base, without, with) = two(&crs_a460(), &crs_a460_nominal(), &load, 0.0, &mut rng);
        let found = payload(&base, &without, &with).unwrap();
        assert_eq!(found.base.rank(), 10);
        assert!(found.chi_squared < 1e-12 && found.widened_by == 1.0, "{}", found.chi_squared);
        for (parameter, expected) in found.parameters.iter().zip(load.to_array()) {
            let shown = parameter.shown.unwrap();
            assert!(
                (shown.value - expected).abs() < 1e-9 && (parameter.consistent - expected).abs() < 1e-6,
                "{parameter:?}"
            );
            assert!(shown.ci95[0] < expected && expected < shown.ci95[1]);
        }
    }

    /// 7 joints, some prismatic: what K reveals of the last link is found, and 95 % intervals hold the truth at 95 %.
    #[test]
    fn intervals_cover_and_the_body_is_consistent() {
        let mut rng = Seed::new(32).stream("payload", 0);
        let mut recipe = ChainRecipe::new(7);
        recipe.prismatic = 0.0;
        let (robot, parameters) = recipe.draw(&mut rng);
        let (mut inside, mut all, mut rejected) = (0, 0, 0);
        for _ in 0..60 {
            let load = random_inertia(&mut rng);
            let (base, without, with) = two(&robot, &parameters, &load, 1.0, &mut rng);
            let found = payload(&base, &without, &with).unwrap();
            assert!(found.inertia().check().is_ok());
            rejected += usize::from(found.chi_squared > found.chi_squared_limit);
            for (parameter, expected) in found.parameters.iter().zip(load.to_array()) {
                let Some(shown) = parameter.shown else { continue };
                all += 1;
                inside += usize::from(shown.ci95[0] <= expected && expected <= shown.ci95[1]);
            }
        }
        // 600 intervals at 95 % that are correlated in tens; widened ones cover a little more.
        let share = f64::from(inside as u32) / f64::from(all as u32);
        assert!(all == 600 && share > 0.93 && rejected < 10, "{share} of {all}, {rejected} rejected");
    }

    /// Where the change scatters w times as far as the covariances say, intervals are those of covariances w² as large.
    #[test]
    fn identity_widened_intervals_are_those_of_covariances_that_say_so() {
        let mut rng = Seed::new(34).stream("payload", 0);
        let load = random_inertia(&mut rng);
        let (base, without, mut with) = two(&crs_a460(), &crs_a460_nominal(), &load, 1.0, &mut rng);
        with.base[0].value += 50.0 * with.base[0].std;
        let found = payload(&base, &without, &with).unwrap();
        let factor = found.widened_by;
        assert!(factor > 2.0);
        let larger = |estimate: Estimate| {
            let covariance = estimate.covariance_matrix() * (factor * factor);
            estimate.with_covariance(&covariance)
        };
        let other = payload(&base, &larger(without), &larger(with)).unwrap();
        assert!((other.widened_by - 1.0).abs() < 1e-9, "{}", other.widened_by);
        for (found, other) in found.combinations.base.iter().zip(&other.combinations.base) {
            assert!((found.std / other.std - 1.0).abs() < 1e-9, "{}: {} {}", found.name, found.std, other.std);
        }
    }

    #[test]
    fn published_intervals_have_the_fewer_degrees_of_freedom() {
        let mut rng = Seed::new(35).stream("payload", 0);
        let load = random_inertia(&mut rng);
        let (base, without, with) = two(&crs_a460(), &crs_a460_nominal(), &load, 0.0, &mut rng);
        for (first, second) in [(8.0, 1e9), (1e9, 8.0)] {
            let of = |estimate: &Estimate, degrees_of_freedom| Estimate { degrees_of_freedom, ..estimate.clone() };
            let found = payload(&base, &of(&without, first), &of(&with, second)).unwrap();
            for shown in found.parameters.iter().filter_map(|parameter| parameter.shown) {
                // Student's t at 0.975 with 8 degrees of freedom.
                let half = 0.5 * (shown.ci95[1] - shown.ci95[0]);
                assert!((half / shown.std - 2.306_004).abs() < 1e-5, "{}", half / shown.std);
            }
        }
    }

    #[test]
    fn a_planar_arm_shows_four_combinations_and_what_is_no_load_is_told() {
        let mut rng = Seed::new(33).stream("payload", 0);
        let robot = crate::chains::planar_2r();
        let mut parameters = StandardParameters::zero(2);
        parameters.links = vec![random_inertia(&mut rng), random_inertia(&mut rng)];
        let load = random_inertia(&mut rng);
        let (base, without, with) = two(&robot, &parameters, &load, 0.0, &mut rng);
        let found = payload(&base, &without, &with).unwrap();
        let shown: Vec<&str> = found.parameters.iter().filter(|p| p.shown.is_some()).map(|p| p.name.as_str()).collect();
        // Out of the plane nothing turns or weighs.
        assert_eq!(shown, ["m", "mcx", "mcy", "Izz"]);
        assert!(found.inertia().check().is_ok());
        // The first link of a 6-axis arm changes: no load on the last one.
        let (robot, parameters) = (crs_a460(), crs_a460_nominal());
        let (base, without, mut with) = two(&robot, &parameters, &load, 0.0, &mut rng);
        with.base[0].value += 50.0 * with.base[0].std;
        let found = payload(&base, &without, &with).unwrap();
        assert!(found.chi_squared > found.chi_squared_limit && found.widened_by > 2.0, "{}", found.chi_squared);
        let other = Estimate { robot: "other".to_owned(), ..with };
        assert!(matches!(payload(&base, &without, &other), Err(EstimationError::OtherRobot { .. })));
    }
}
