//! Units in which errors of unlike parameters are added: declared by a study or taken as usual, never derived from the truth.

use super::parameter_id::ParameterKind;
use super::term::Structure;

/// The error that counts as one, for each kind of parameter.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReferenceUnits {
    /// Masses.
    pub mass_kg: f64,
    /// First moments.
    pub first_moment_kg_m: f64,
    /// Inertias of links and rotors.
    pub inertia_kg_m2: f64,
    /// Viscous friction.
    pub viscous_nm_s_rad: f64,
    /// Coulomb friction and offsets.
    pub torque_nm: f64,
}

impl Default for ReferenceUnits {
    /// What the studies of `experiments/` declare: 0.1 kg, 0.02 kg·m, 0.01 kg·m², 0.1 N·m·s/rad, 0.1 N·m.
    fn default() -> Self {
        Self { mass_kg: 0.1, first_moment_kg_m: 0.02, inertia_kg_m2: 0.01, viscous_nm_s_rad: 0.1, torque_nm: 0.1 }
    }
}

impl ReferenceUnits {
    /// The unit of one kind of parameter. For a term with none of its own: what makes the unit of torque with a law of 1.
    pub fn unit(&self, kind: ParameterKind) -> f64 {
        match kind {
            ParameterKind::M => self.mass_kg,
            ParameterKind::Mcx | ParameterKind::Mcy | ParameterKind::Mcz => self.first_moment_kg_m,
            ParameterKind::Term(term) => match term.entry().structure {
                Structure::Inertia => self.inertia_kg_m2,
                Structure::Viscous => self.viscous_nm_s_rad,
                Structure::Constant | Structure::Function { .. } => self.torque_nm,
            },
            _ => self.inertia_kg_m2,
        }
    }
}
