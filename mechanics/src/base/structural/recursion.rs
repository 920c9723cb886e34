//! The walk from the base to the last link.

use nalgebra::{DMatrix, Vector3};

use super::functions;
use super::harmonics::{Functional, Harmonics, inner_product};
use super::motion::{Attainable, BaseMotion};
use super::span::{EchelonRows, basis};
use crate::base::geometry::Geometry;
use crate::base::method::Method;
use crate::base::reduction::BaseReduction;
use crate::model::term::Structure;
use crate::model::{JointKind, ParameterId};
use crate::spatial::Motion;

/// Parameters of a link.
const TEN: usize = 10;

/// The reduction of a robot of this geometry, its base moving as stated.
///
/// A functional is a row over the base's own ten parameters and φ. Those of the base are nuisances: it pushes back on
/// a moving base with a force that nobody measures, so only functionals without them are revealed.
pub(in crate::base) fn reduce(geometry: &Geometry, parameters: &[ParameterId], motion: BaseMotion) -> BaseReduction {
    let terms: Vec<(usize, usize, Structure)> = (TEN..)
        .zip(parameters)
        .filter_map(|(column, id)| Some((column, id.index, geometry.structure(id.kind.term()?, id.index))))
        .collect();
    let width = TEN + parameters.len();
    let coupling = geometry.scaled_coupling();

    // ½ V₀ᵀ I[ρ_0(q)] V₀ with V₀ the base's own motion: its slope in q is torque, its constant part is not.
    let directions = motion.directions();
    let mut fresh = Vec::new();
    for (a, v) in directions.iter().enumerate() {
        for w in &directions[a..] {
            fresh.push(row_at(width, 0, &inner_product(v, w)));
        }
    }
    let mut rows = EchelonRows::default();
    rows.add(&fresh, width);
    let mut attainable = Attainable::at_base(geometry, motion);
    for j in 0..geometry.dof() {
        let axis = axis(geometry, j);
        attainable = attainable.beyond(geometry, j, &axis);
        // What has its pivot among the terms may lose it to the next link.
        let mut fresh = rows.split_off(TEN * (geometry.dof() + 1));
        fresh.extend(carry_over(geometry, j, &mut rows, width));
        for (labels, v) in attainable.iter() {
            let mut row = row_at(width, j + 1, &inner_product(&v, &axis));
            let (gravity, joints) = labels.split_last().expect("there is a label for gravity");
            for (i, &label) in joints.iter().enumerate().filter(|(_, label)| **label != 0.0) {
                for &(column, k, _) in terms.iter().filter(|&&(_, _, structure)| structure == Structure::Inertia) {
                    row[column] += label * coupling[(k, i)] * coupling[(k, j)];
                }
            }
            for &(column, k, _) in terms.iter().filter(|&&(_, _, structure)| structure == Structure::Constant) {
                row[column] += if k == j { *gravity } else { 0.0 };
            }
            fresh.push(row);
        }
        rows.add(&fresh, width);
    }
    let mut fresh = rows.split_off(TEN * (geometry.dof() + 1));
    for functional in functions::functionals(geometry, parameters) {
        let mut row = vec![0.0; TEN];
        row.extend(functional);
        fresh.push(row);
    }
    rows.add(&fresh, width);
    let revealed: Vec<(usize, Vec<f64>)> = rows.finish().filter(|&(pivot, _)| pivot >= TEN).collect();
    let kept = revealed.iter().map(|&(pivot, _)| pivot - TEN).collect();
    let k = DMatrix::from_fn(revealed.len(), parameters.len(), |row, column| revealed[row].1[TEN + column]);
    let reduction = BaseReduction::from_echelon(parameters, kept, k, Method::Structural);
    BaseReduction { base_motion: motion, ..reduction.with_units(&geometry.units(parameters)) }
}

/// The axis of joint j in the frame of its link.
fn axis(geometry: &Geometry, j: usize) -> Motion {
    let (z, zero) = (Vector3::z(), Vector3::zeros());
    let at_joint = match geometry.kinds[j] {
        JointKind::Revolute => Motion::new(z, zero),
        JointKind::Prismatic => Motion::new(zero, z),
    };
    geometry.after[j].motion_to_child(&at_joint)
}

/// Functionals of everything from link j on (`slot` j holds their value on it) as functionals of what lies beyond
/// joint j: the constant part goes on with the row; each moving part is a row of its own, which is returned. The parts of a
/// basis of the values on link j span those of all rows.
fn carry_over(geometry: &Geometry, j: usize, rows: &mut EchelonRows, width: usize) -> Vec<Vec<f64>> {
    let harmonics = Harmonics::of(geometry.kinds[j], &geometry.before[j], &geometry.after[j]);
    let (on_link, beyond) = (TEN * j..TEN * (j + 1), TEN * (j + 1)..TEN * (j + 2));
    let values: Vec<Vec<f64>> = rows.iter().map(|row| row[on_link.clone()].to_vec()).collect();
    for row in rows.iter_mut() {
        let constant = harmonics.constant_part(&Functional::from_column_slice(&row[on_link.clone()]));
        row[beyond.clone()].copy_from_slice(constant.as_slice());
    }
    let values = basis(&values, TEN);
    let values: Vec<Functional> = values.iter().map(|value| Functional::from_column_slice(value)).collect();
    let parts = values.iter().flat_map(|value| harmonics.moving_parts(value));
    parts.map(|part| row_at(width, j + 1, &part)).collect()
}

/// A row that is zero but for one link; slot 0 is the base.
fn row_at(width: usize, slot: usize, functional: &Functional) -> Vec<f64> {
    let mut row = vec![0.0; width];
    row[TEN * slot..TEN * (slot + 1)].copy_from_slice(functional.as_slice());
    row
}
