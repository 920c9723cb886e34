//! Table II of `radkhah2007`: the 32 parameters of the CRS A460 that its authors printed.
//!
//! The names read `m2*rcx_2` for the first moment `mcx2`. 31 of the 32 lie in the base set of the arm's standard-DH
//! model, walked link by link from left to right. The 32nd, `m4*rcy_4`, does not: with standard DH, y4 lies along
//! joint axis 4 and `mcy4` goes into `mcz3` (a mass on an axis cannot be distinguished from one on the link before it). `mcz4`,
//! absent from the table, does, so `rcy` reads as a misprint for `rcz`. With it, the four base parameters that the
//! table leaves out are `Ixx2`, `Iyy4`, `Ixx5` and `Iyy5`: the "4 out of the 36" without reasonable values.
//!
//! The values are not physically consistent as they stand: a result of its time to show beside others, never a truth.

use crate::model::{ParameterId, ParameterKind};

/// One entry of Table II.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableTwoRow {
    /// The name as printed.
    pub printed: &'static str,
    /// The value as printed: kg, kg·m or kg·m².
    pub value: f64,
    /// The parameter that the printed name says.
    pub as_printed: ParameterId,
    /// The parameter that is meant: another one where the name is a misprint.
    pub parameter: ParameterId,
}

/// Table II, column by column, top to bottom.
pub fn table_two() -> Vec<TableTwoRow> {
    use ParameterKind::{Ixx, Ixy, Ixz, Iyy, Iyz, Izz, M, Mcx, Mcy, Mcz};
    let id = |kind, link: usize| ParameterId { kind, index: link - 1 };
    let row = |printed, kind, link, value| TableTwoRow {
        printed,
        value,
        as_printed: id(kind, link),
        parameter: if (kind, link) == (Mcy, 4) { id(Mcz, 4) } else { id(kind, link) },
    };
    vec![
        row("I_yy1", Iyy, 1, 4.5870),
        row("m_2", M, 2, 17.3190),
        row("m2*rcx_2", Mcx, 2, -6.4811),
        row("m2*rcy_2", Mcy, 2, 1.5141),
        row("m2*rcz_2", Mcz, 2, -0.7113),
        row("I_xy2", Ixy, 2, 0.2604),
        row("I_yz2", Iyz, 2, 1.4234),
        row("m3*rcx_3", Mcx, 3, -1.1787),
        row("m3*rcz_3", Mcz, 3, 1.4229),
        row("I_xx3", Ixx, 3, 1.5213),
        row("I_yy3", Iyy, 3, 1.0473),
        row("I_xy3", Ixy, 3, -1.0187),
        row("I_xz3", Ixz, 3, -0.2617),
        row("I_yz3", Iyz, 3, -0.9041),
        row("m4*rcx_4", Mcx, 4, -0.1602),
        row("m4*rcy_4", Mcy, 4, -1.2604),
        row("I_xx4", Ixx, 4, 1.1344),
        row("I_xy4", Ixy, 4, 0.2872),
        row("I_xz4", Ixz, 4, 0.6251),
        row("I_yz4", Iyz, 4, 0.0593),
        row("m5*rcx_5", Mcx, 5, -0.8743),
        row("m5*rcz_5", Mcz, 5, -0.2604),
        row("I_xy5", Ixy, 5, -0.5673),
        row("I_xz5", Ixz, 5, 0.0145),
        row("I_yz5", Iyz, 5, 0.7508),
        row("m6*rcx_6", Mcx, 6, 0.7508),
        row("m6*rcy_6", Mcy, 6, -0.0221),
        row("I_xx6", Ixx, 6, 0.6623),
        row("I_zz6", Izz, 6, 0.4579),
        row("I_xy6", Ixy, 6, 0.5240),
        row("I_xz6", Ixz, 6, 0.6552),
        row("I_yz6", Iyz, 6, 0.3980),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{Method, reduce};
    use crate::conformance::chains;
    use crate::model::Columns;
    use crate::seed::Seed;

    #[test]
    fn published_table_two_is_the_base_set_but_for_a_misprint() {
        let base = reduce(&chains::crs_a460(), Columns::RIGID, Method::Structural, Seed::new(1)).unwrap();
        let names = base.names();
        let table = table_two();
        assert_eq!(table.len(), 32);
        let outside: Vec<&str> =
            table.iter().filter(|row| !names.contains(&row.as_printed.to_string())).map(|row| row.printed).collect();
        assert_eq!(outside, ["m4*rcy_4"]);
        assert!(table.iter().all(|row| names.contains(&row.parameter.to_string())));
        let missing: Vec<&String> =
            names.iter().filter(|name| !table.iter().any(|row| row.parameter.to_string() == **name)).collect();
        assert_eq!(missing, ["Ixx2", "Iyy4", "Ixx5", "Iyy5"]);
        assert_eq!(table.iter().filter(|row| row.parameter != row.as_printed).count(), 1);
    }
}
