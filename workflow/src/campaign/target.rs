//! How well something must be known.

use std::fmt;
use std::str::FromStr;

use armid_io::Error;

/// What a target is of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A base parameter, by its name.
    Parameter(String),
    /// Predicted torque on the usual evaluation motions.
    Torque,
    /// One of the ten parameters of the load, by its symbol.
    Payload(String),
}

/// A quantity, and the half width that its interval may have: `Fc2 <= 0.1`, `torque <= 3 %` or `payload.mass <= 1 %`.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Target {
    /// What it is of.
    pub quantity: Quantity,
    /// The number as it was written.
    bound: f64,
    /// Whether that is a share of the value, in percent.
    pub is_share: bool,
}

/// What the load's parameters are called before `payload.`.
const OF_LOAD: &str = "payload.";

impl Target {
    /// The largest half width, in the unit of the quantity or as a share of its value.
    pub fn limit(&self) -> f64 {
        if self.is_share { self.bound / 100.0 } else { self.bound }
    }

    /// Whether it is of the load.
    pub const fn is_of_load(&self) -> bool {
        matches!(self.quantity, Quantity::Payload(_))
    }

    /// What it is of, as it was written.
    pub fn name(&self) -> String {
        match &self.quantity {
            Quantity::Parameter(name) => name.clone(),
            Quantity::Torque => "torque".to_owned(),
            Quantity::Payload(symbol) if symbol == "m" => format!("{OF_LOAD}mass"),
            Quantity::Payload(symbol) => format!("{OF_LOAD}{symbol}"),
        }
    }
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} <= {}{}", self.name(), self.bound, if self.is_share { " %" } else { "" })
    }
}

impl FromStr for Target {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let refused = |expected: &str| Err(Error::new(format!("the target is \"{text}\", expected {expected}")));
        let Some((name, bound)) = text.split_once("<=").map(|(name, bound)| (name.trim(), bound.trim())) else {
            return refused("a form such as \"Fc2 <= 0.1\", \"torque <= 3 %\" or \"payload.mass <= 1 %\"");
        };
        let (number, is_share) = bound.strip_suffix('%').map_or((bound, false), |number| (number.trim_end(), true));
        let Some(bound) = number.parse::<f64>().ok().filter(|bound| bound.is_finite() && *bound > 0.0) else {
            return refused("a finite number above zero behind <=, with % where it is a share");
        };
        let quantity = match (name, name.strip_prefix(OF_LOAD)) {
            ("" | OF_LOAD, _) => return refused("the name of a quantity before <="),
            ("torque", _) if !is_share => return refused("torque in percent of its RMS value, as \"torque <= 3 %\""),
            ("torque", _) => Quantity::Torque,
            (_, Some("mass")) => Quantity::Payload("m".to_owned()),
            (_, Some(symbol)) => Quantity::Payload(symbol.to_owned()),
            (parameter, None) => Quantity::Parameter(parameter.to_owned()),
        };
        Ok(Self { quantity, bound, is_share })
    }
}

impl From<Target> for String {
    fn from(target: Target) -> Self {
        target.to_string()
    }
}

impl TryFrom<String> for Target {
    type Error = Error;

    fn try_from(text: String) -> Result<Self, Error> {
        text.parse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn targets_of_a_campaign_are_read_and_written() {
        for (text, quantity, limit) in [
            ("Fc2 <= 0.1", Quantity::Parameter("Fc2".to_owned()), 0.1),
            ("torque <= 3 %", Quantity::Torque, 0.03),
            ("payload.mass <= 1.5 %", Quantity::Payload("m".to_owned()), 0.015),
            ("payload.mcx <= 0.01", Quantity::Payload("mcx".to_owned()), 0.01),
        ] {
            let target: Target = text.parse().unwrap();
            assert_eq!((&target.quantity, target.limit()), (&quantity, limit));
            assert_eq!(target.to_string(), text);
        }
        assert_eq!("Fc2<=10%".parse::<Target>().unwrap().to_string(), "Fc2 <= 10 %");
    }

    #[test]
    fn what_is_no_target_of_a_campaign_is_refused() {
        for (text, expected) in [
            ("Fc2 < 0.1", "a form such as"),
            ("Fc2 <= much", "a finite number"),
            ("Fc2 <= -1", "above zero"),
            (" <= 1", "the name of a quantity"),
            ("torque <= 0.1", "torque in percent"),
            ("payload. <= 0.1", "the name of a quantity"),
        ] {
            let fault = text.parse::<Target>().unwrap_err().to_string();
            assert!(fault.contains(text) && fault.contains(expected), "{fault}");
        }
    }
}
