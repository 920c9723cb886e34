//! What is uncertain about an arm and leaves no trace in a recording of it.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Standard deviations that whoever writes the robot file knows from elsewhere (type B of the *Guide to the Expression of Uncertainty
/// in Measurement*, JCGM 100:2008, 4.3): a data sheet, a calibration, how warm a gear gets. None where nothing is stated.
///
/// - `torque_constant`: of each motor's torque constant and gear, independent of the others, relative.
/// - `current_lag_s`: by how much the torque of each motor lags behind its measured current, independent of the others.
/// - `viscous`, `coulomb`, `offset_nm`: by how much the coefficient that a recording shows differs from the one that is meant, of each
///   joint or motor independent of the others; a share of the value, the offset's an amount. A gear that was warm, a converter's
///   offset.
///
/// An error of that kind is explained whole by other values of the parameters, so that no residual shows it.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::model::DeclaredUncertainty;
/// let declared: DeclaredUncertainty = toml::from_str("torque_constant = 0.02\nviscous = 0.2")?;
/// assert_eq!((declared.std("torque_constant"), declared.std("coulomb")), (0.02, 0.0));
/// assert!(toml::from_str::<DeclaredUncertainty>("gravity = 0.1").is_err());
/// # Ok::<(), toml::de::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "BTreeMap<String, f64>")]
pub struct DeclaredUncertainty(BTreeMap<String, f64>);

impl DeclaredUncertainty {
    /// Key of the torque constants.
    pub const TORQUE_CONSTANT: &'static str = "torque_constant";

    /// Key of the lag between current and torque.
    pub const CURRENT_LAG: &'static str = "current_lag_s";

    /// Every key; those of terms are the keys of their priors.
    pub const KEYS: [&'static str; 5] = [Self::TORQUE_CONSTANT, Self::CURRENT_LAG, "viscous", "coulomb", "offset_nm"];

    /// Checks keys and numbers.
    ///
    /// # Errors
    /// [`DeclaredUncertaintyError`] with the key.
    pub fn new(stated: BTreeMap<String, f64>) -> Result<Self, DeclaredUncertaintyError> {
        for (key, &found) in &stated {
            if !Self::KEYS.contains(&key.as_str()) {
                return Err(DeclaredUncertaintyError::Unknown { found: key.clone() });
            }
            if !(found.is_finite() && found >= 0.0) {
                return Err(DeclaredUncertaintyError::Amount { key: key.clone(), found });
            }
        }
        Ok(Self(stated))
    }

    /// The standard deviation under a key; zero where it is not stated.
    pub fn std(&self, key: &str) -> f64 {
        self.0.get(key).copied().unwrap_or(0.0)
    }

    /// Whether nothing is uncertain.
    pub fn is_none(&self) -> bool {
        self.0.values().all(|&std| std == 0.0)
    }
}

impl TryFrom<BTreeMap<String, f64>> for DeclaredUncertainty {
    type Error = DeclaredUncertaintyError;

    fn try_from(stated: BTreeMap<String, f64>) -> Result<Self, Self::Error> {
        Self::new(stated)
    }
}

/// Why an uncertainty cannot be declared so.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum DeclaredUncertaintyError {
    /// No key has this name.
    #[error("unknown field `{found}`, expected one of {}", DeclaredUncertainty::KEYS.map(|key| format!("`{key}`")).join(", "))]
    Unknown { found: String },
    /// A standard deviation is no finite number from zero on.
    #[error("{key} is {found}, expected a finite number not below zero")]
    Amount { key: String, found: f64 },
}
