//! What a base shows of a load on the last link.
//!
//! ```text
//! β_with = β_without + K_n θ        θ: the load's ten parameters in the frame of link n        K_n: the last link's columns of K
//! ```
//! Only base parameters of links and rotors change with a load; those of friction and offsets say nothing of it.

use nalgebra::DMatrix;

use super::method::Method;
use super::reduction::BaseReduction;
use crate::model::term::{Structure, Term};
use crate::model::{ParameterId, ParameterKind};

/// Natural sizes of the ten: a kilogram a decimetre away.
pub const LOAD_UNITS: [f64; 10] = [1.0, 0.1, 0.1, 0.1, 0.01, 0.01, 0.01, 0.01, 0.01, 0.01];

impl BaseReduction {
    /// Rows of the base that are made of inertias: of links and rotors.
    pub fn inertial_rows(&self) -> Vec<usize> {
        let is_inertia = |term: Term| term.entry().structure == Structure::Inertia;
        let inertial = |kind: ParameterKind| kind.term().is_none_or(is_inertia);
        (0..self.rank()).filter(|&row| inertial(self.parameters[self.kept[row]].kind)).collect()
    }

    /// Columns of the last link's ten among the parameters.
    pub fn columns_of_last_link(&self) -> Vec<usize> {
        let links = self.parameters.iter().filter(|id| id.kind == ParameterKind::M);
        let last = links.map(|id| id.index).max().unwrap_or(0);
        let of = |kind: ParameterKind| self.parameters.iter().position(|id| *id == ParameterId { kind, index: last });
        ParameterKind::LINK.into_iter().filter_map(of).collect()
    }

    /// What the inertial rows show of the ten of a load, as the reduction of one body.
    #[must_use]
    pub fn of_load(&self) -> Self {
        let (rows, columns) = (self.inertial_rows(), self.columns_of_last_link());
        let unit_of = |row: usize| {
            self.parameters[self.kept[row]].kind.link_place().map_or(LOAD_UNITS[4], |place| LOAD_UNITS[place])
        };
        let stack = DMatrix::from_fn(rows.len(), columns.len(), |i, j| {
            self.k[(rows[i], columns[j])] * LOAD_UNITS[j] / unit_of(rows[i])
        });
        let ids = ParameterKind::LINK.map(|kind| ParameterId { kind, index: 0 });
        Self::from_stack(&ids, &stack, Method::Structural).with_units(&LOAD_UNITS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::reduce;
    use crate::model::format::parse_robot;
    use crate::model::{Columns, bundled};
    use crate::seed::Seed;

    #[test]
    fn analytic_the_a460_shows_all_ten_of_a_load_and_a_planar_arm_four() {
        for (name, rank) in [("crs-a460", 10), ("planar-2r", 4)] {
            let robot = parse_robot(bundled().iter().find(|entry| entry.name == name).unwrap().robot).unwrap();
            let base = reduce(&robot, Columns::RIGID_ROTOR_FRICTION, Method::Structural, Seed::new(0)).unwrap();
            assert_eq!(base.of_load().rank(), rank, "{name}");
            assert_eq!(base.columns_of_last_link().len(), 10);
            // Three rows of each joint are viscous, Coulomb and offset.
            assert!(base.inertial_rows().len() <= base.rank() - 2 * robot.dof(), "{name}");
        }
    }
}
