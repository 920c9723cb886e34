//! What the torque terms reveal that are functions of their own: friction of every kind, springs.
//!
//! ```text
//! τ_v = (diag(Fv) + Σ_k Fvm_k c_k c_kᵀ) q̇          τ_f = Σ_t φ_t d_t f(d_tᵀ x / s_t)         d_t = e_i or c_k
//! ```
//! with c_k row k of the coupling matrix. The matrix entries of the first, viscous friction, are revealed each. In the
//! second, one function `f` of forms `d/s` that are neither equal nor opposite gives independent functions (plain signs,
//! where s is zero, of directions), so the terms of one form add up; so are different functions independent of each
//! other, and of what the links contribute: no sign of a velocity, and no multiple of a coordinate along itself, is
//! among the harmonics of a mass matrix or of gravity.

use nalgebra::DVector;

use crate::base::geometry::Geometry;
use crate::model::ParameterId;
use crate::model::term::{Structure, Term};

/// Two forms are the same when they differ by less than this fraction of their length.
const SAME_FORM: f64 = 1e-9;

/// The functionals of φ (each of length p) which these terms reveal.
pub(super) fn functionals(geometry: &Geometry, parameters: &[ParameterId]) -> Vec<Vec<f64>> {
    let n = geometry.dof();
    let coupling = geometry.scaled_coupling();
    let direction = |term: Term, index: usize| -> DVector<f64> {
        if term.is_motors() {
            coupling.row(index).transpose()
        } else {
            DVector::from_fn(n, |i, _| if i == index { 1.0 } else { 0.0 })
        }
    };
    let terms = || {
        let terms = parameters.iter().enumerate().filter_map(|(column, id)| Some((column, id.kind.term()?, id.index)));
        terms.map(|(column, term, index)| (column, term, index, geometry.structure(term, index)))
    };
    let viscous = terms().filter(|(.., structure)| *structure == Structure::Viscous);
    let viscous: Vec<_> = viscous.map(|(column, term, index, _)| (column, direction(term, index))).collect();
    let mut rows = Vec::new();
    for i in 0..n {
        for j in i..n {
            push_row(&mut rows, parameters.len(), viscous.iter().map(|(column, d)| (*column, d[i] * d[j])));
        }
    }
    let mut groups: Vec<Group> = Vec::new();
    for (column, term, index, structure) in terms() {
        let Structure::Function { family, odd } = structure else { continue };
        let d = direction(term, index);
        let form = Form::new(&d, &geometry.scales(term, index));
        let found = groups.iter_mut().find_map(|group| Some((group.sign_of(family, &form, odd)?, group)));
        match found {
            Some((sign, group)) => group.members.push((column, d * sign)),
            None => groups.push(Group { family, form, members: vec![(column, d)] }),
        }
    }
    for group in groups {
        for i in 0..n {
            push_row(&mut rows, parameters.len(), group.members.iter().map(|(column, d)| (*column, d[i])));
        }
    }
    rows
}

/// Adds the row with these entries, unless all are zero.
fn push_row(rows: &mut Vec<Vec<f64>>, width: usize, entries: impl Iterator<Item = (usize, f64)>) {
    let mut row = Vec::new();
    for (column, entry) in entries.filter(|&(_, entry)| entry != 0.0) {
        row.resize(width, 0.0);
        row[column] = entry;
    }
    if !row.is_empty() {
        rows.push(row);
    }
}

/// What a function is applied to: `d/s` for each of its scales, or the direction of `d` where the scale is zero.
struct Form {
    forms: Vec<DVector<f64>>,
    plain: Vec<bool>,
}

impl Form {
    fn new(d: &DVector<f64>, scales: &[f64]) -> Self {
        let plain: Vec<bool> = scales.iter().map(|&scale| scale <= 0.0).collect();
        let of = |(scale, plain): (&f64, &bool)| if *plain { d.normalize() } else { d / *scale };
        let forms = if scales.is_empty() { vec![d.clone()] } else { scales.iter().zip(&plain).map(of).collect() };
        Self { forms, plain }
    }

    fn is(&self, other: &Self, sign: f64) -> bool {
        self.plain == other.plain
            && self.forms.iter().zip(&other.forms).all(|(a, b)| (a - b * sign).norm() <= SAME_FORM * b.norm())
    }
}

/// The terms of one function and one form.
struct Group {
    family: &'static str,
    form: Form,
    /// Columns and directions `d`, turned where the form is opposite and the function odd.
    members: Vec<(usize, DVector<f64>)>,
}

impl Group {
    /// The sign with which a term of this function and form belongs in the group.
    fn sign_of(&self, family: &'static str, form: &Form, odd: bool) -> Option<f64> {
        match (family == self.family, form.is(&self.form, 1.0), form.is(&self.form, -1.0)) {
            (true, true, _) => Some(1.0),
            (true, _, true) => Some(if odd { -1.0 } else { 1.0 }),
            _ => None,
        }
    }
}
