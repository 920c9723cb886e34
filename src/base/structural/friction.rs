//! What velocity reveals: viscous and Coulomb friction of joints and of coupled motors.
//!
//! ```text
//! τ_v = (diag(Fv) + Σ_k Fvm_k c_k c_kᵀ) q̇          τ_c = Σ_t Fc_t d_t tanh(d_tᵀ q̇ / v_t)         d_t = e_i or c_k
//! ```
//! with c_k row k of the coupling matrix. The matrix entries of the first are revealed each; in the second, smooth
//! signs of forms `d/v` that are neither equal nor opposite are independent functions (plain signs, where v is zero,
//! of directions), so the terms of one form add up.

use nalgebra::DVector;

use crate::base::geometry::Geometry;
use crate::model::{ParameterId, ParameterKind};

/// Two forms are the same when they differ by less than this fraction of their length.
const SAME_FORM: f64 = 1e-9;

/// The functionals of φ (each of length p) which friction torques reveal.
pub(super) fn functionals(geometry: &Geometry, parameters: &[ParameterId]) -> Vec<Vec<f64>> {
    let n = geometry.dof();
    let coupling = geometry.scaled_coupling();
    let direction = |id: ParameterId| -> DVector<f64> {
        match id.kind {
            ParameterKind::Fvm | ParameterKind::Fcm => coupling.row(id.index).transpose(),
            _ => DVector::from_fn(n, |i, _| if i == id.index { 1.0 } else { 0.0 }),
        }
    };
    let of_kind = |kinds: [ParameterKind; 2]| {
        parameters.iter().copied().enumerate().filter(move |(_, id)| kinds.contains(&id.kind))
    };
    let mut rows = Vec::new();
    for i in 0..n {
        for j in i..n {
            let mut row = vec![0.0; parameters.len()];
            for (column, id) in of_kind([ParameterKind::Fv, ParameterKind::Fvm]) {
                let d = direction(id);
                row[column] = d[i] * d[j];
            }
            rows.push(row);
        }
    }
    let mut groups: Vec<Group> = Vec::new();
    for (column, id) in of_kind([ParameterKind::Fc, ParameterKind::Fcm]) {
        let d = direction(id);
        let velocity = geometry.coulomb_velocity[id.index] / geometry.coordinate_unit(id.index);
        let plain = velocity <= 0.0;
        let form = if plain { d.normalize() } else { &d / velocity };
        let found = groups.iter_mut().find_map(|group| Some((group.sign_of(&form, plain)?, group)));
        match found {
            Some((sign, group)) => group.members.push((column, d * sign)),
            None => groups.push(Group { form, plain, members: vec![(column, d)] }),
        }
    }
    for group in groups {
        for i in 0..n {
            let mut row = vec![0.0; parameters.len()];
            for (column, d) in &group.members {
                row[*column] = d[i];
            }
            rows.push(row);
        }
    }
    rows
}

/// The Coulomb terms of one form.
struct Group {
    /// `d/v` of the smooth sign, or the direction of `d` where the sign is plain.
    form: DVector<f64>,
    /// Whether the sign is plain.
    plain: bool,
    /// Columns and directions `d`, turned where the form is opposite.
    members: Vec<(usize, DVector<f64>)>,
}

impl Group {
    /// 1 if a form is that of the group, −1 if it is its opposite.
    fn sign_of(&self, form: &DVector<f64>, plain: bool) -> Option<f64> {
        let same = |other: &DVector<f64>| (other - &self.form).norm() <= SAME_FORM * self.form.norm();
        match (plain == self.plain, same(form), same(&-form)) {
            (true, true, _) => Some(1.0),
            (true, _, true) => Some(-1.0),
            _ => None,
        }
    }
}
