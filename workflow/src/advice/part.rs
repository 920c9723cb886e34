//! The part of the parameters that a purpose is about.
//!
//! ```text
//! friction    e = U⁻¹ (β̂ − β) in the rows of friction and offsets
//! payload     e = (U_r⁻¹ K_n U_θ)⁺ U_r⁻¹ (β̂ − β)_r      r the rows that are made of inertias, K_n the last link's columns of K
//! error = ‖e‖ / √rank                                     U the reference units
//! ```
//! An error of the arm's parameters that looks like a load at the last link is one of the load. What two logs of one arm have in common
//! cancels in their difference, so this is an upper bound of what errors of the model do.

use armid::base::{BaseReduction, Method, reduce};
use armid::model::{Columns, ReferenceUnits, Robot};
use armid::seed::Seed;
use armid::study::{Purpose, StudyResult};
use armid_io::Error;
use nalgebra::{DMatrix, DVector};

/// Singular values below this share of the largest are zero: directions of a load that the arm does not show.
const NOTHING: f64 = 1e-9;

/// What maps errors of the base parameters to those that count, r × b.
#[derive(Clone, Debug)]
pub(super) struct Part {
    map: DMatrix<f64>,
    rank: usize,
}

impl Part {
    /// That of a purpose; `None` where a metric of the study is what counts.
    ///
    /// # Errors
    /// [`Error`] where the robot has no such parameters.
    pub(super) fn of(purpose: Purpose, robot: &Robot, result: &StudyResult) -> Result<Option<Self>, Error> {
        if !matches!(purpose, Purpose::Friction | Purpose::Payload) {
            return Ok(None);
        }
        let columns = Columns::parse_estimable(&result.plan.identification.columns).map_err(Error::new)?;
        let base = reduce(robot, columns, Method::Structural, Seed::new(0)).map_err(Error::new)?;
        let units = &result.plan.reference;
        Ok(Some(if purpose == Purpose::Friction { Self::friction(&base, units) } else { Self::payload(&base, units)? }))
    }

    fn friction(base: &BaseReduction, units: &ReferenceUnits) -> Self {
        let inertial = base.inertial_rows();
        let rows: Vec<usize> = (0..base.rank()).filter(|row| !inertial.contains(row)).collect();
        let of = |i: usize, j: usize| if rows[i] == j { 1.0 / unit(base, units, j) } else { 0.0 };
        Self { map: DMatrix::from_fn(rows.len(), base.rank(), of), rank: rows.len() }
    }

    fn payload(base: &BaseReduction, units: &ReferenceUnits) -> Result<Self, Error> {
        let (rows, columns) = (base.inertial_rows(), base.columns_of_last_link());
        let of_load = |i: usize, j: usize| {
            base.k[(rows[i], columns[j])] * units.unit(base.parameters[columns[j]].kind) / unit(base, units, rows[i])
        };
        let svd = DMatrix::from_fn(rows.len(), columns.len(), of_load).svd(true, true);
        let least = NOTHING * svd.singular_values.max();
        let rank = svd.rank(least);
        let inverse = svd.pseudo_inverse(least).map_err(Error::new)?;
        let mut map = DMatrix::zeros(columns.len(), base.rank());
        for (i, &row) in rows.iter().enumerate() {
            map.set_column(row, &(inverse.column(i) / unit(base, units, row)));
        }
        Ok(Self { map, rank })
    }

    /// The error that counts, of errors of the base parameters.
    pub(super) fn error(&self, errors: &[f64]) -> f64 {
        (&self.map * DVector::from_column_slice(errors)).norm() / (self.rank.max(1) as f64).sqrt()
    }
}

/// The reference unit of a base parameter.
fn unit(base: &BaseReduction, units: &ReferenceUnits, row: usize) -> f64 {
    units.unit(base.parameters[base.kept[row]].kind)
}

#[cfg(test)]
mod tests {
    use super::*;
    use armid::model::format::ChainEnds;
    use armid_io::robot;

    /// Adding a load to the last link moves the base by K_n θ, which has to be seen as θ; friction has to see nothing of it.
    #[test]
    fn analytic_a_load_is_seen_as_itself_and_not_as_friction() {
        let arm = robot::load("crs-a460", &ChainEnds::default(), None).unwrap().robot;
        let base = reduce(&arm, Columns::RIGID_ROTOR_FRICTION, Method::Structural, Seed::new(0)).unwrap();
        let units = ReferenceUnits {
            mass_kg: 0.1,
            first_moment_kg_m: 0.02,
            inertia_kg_m2: 0.01,
            viscous_nm_s_rad: 0.1,
            torque_nm: 0.1,
        };
        let load = [0.2, 0.02, -0.04, 0.0, 0.01, 0.0, 0.0, 0.01, 0.0, 0.03];
        let mut phi = DVector::zeros(base.parameters.len());
        for (column, value) in base.columns_of_last_link().into_iter().zip(load) {
            phi[column] = value;
        }
        let moved = base.beta(&phi);
        // In units: 2, 1, −2, 0, 1, 0, 0, 1, 0, 3.
        let expected = (20.0_f64 / 10.0).sqrt();
        let found = Part::payload(&base, &units).unwrap().error(moved.as_slice());
        assert!((found / expected - 1.0).abs() < 1e-9, "{found}");
        let friction = Part::friction(&base, &units);
        assert_eq!(friction.error(moved.as_slice()), 0.0);
        assert_eq!(friction.rank, 18);
    }
}
