//! One `[[drive]]` of a parameter file: which joint, where the numbers come from, and a number for each key.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, MapAccess, Visitor};
use toml::Spanned;

use super::reading::Number;
use super::shape_parameters;
use super::term_keys::term_keys;

/// Key of the torque constant of the motor.
pub(super) const TORQUE_CONSTANT: &str = "torque_constant_nm_a";
/// Keys of the motor's circuit.
pub(super) const CIRCUIT: [&str; 3] = ["resistance_ohm", "inductance_h", "brush_drop_v"];

/// The table as it stands in the file; every key of it is known.
pub(super) struct DriveTable {
    pub(super) joint: Spanned<String>,
    pub(super) source: Option<String>,
    numbers: Vec<(String, Number)>,
}

impl DriveTable {
    /// Every number with its key, in the order of the file.
    pub(super) fn numbers(&self) -> impl Iterator<Item = (&str, &Number)> {
        self.numbers.iter().map(|(key, number)| (key.as_str(), number))
    }

    /// The number of one key.
    pub(super) fn number(&self, key: &str) -> Option<&Number> {
        self.numbers().find(|(own, _)| *own == key).map(|(_, number)| number)
    }
}

/// The keys of numbers: of every term and its law, and of the motor.
fn number_keys() -> impl Iterator<Item = &'static str> {
    term_keys().chain(shape_parameters::all().map(|shape| shape.key)).chain([TORQUE_CONSTANT]).chain(CIRCUIT)
}

struct Key(String);

impl<'de> Deserialize<'de> for Key {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        if ["joint", "source"].into_iter().chain(number_keys()).any(|key| key == name) {
            return Ok(Self(name));
        }
        let keys: Vec<String> =
            ["joint", "source"].into_iter().chain(number_keys()).map(|key| format!("`{key}`")).collect();
        Err(D::Error::custom(format!("unknown field `{name}`, expected one of {}", keys.join(", "))))
    }
}

impl<'de> Deserialize<'de> for DriveTable {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Table;
        impl<'de> Visitor<'de> for Table {
            type Value = DriveTable;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table of a drive")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let (mut joint, mut source, mut numbers) = (None, None, Vec::new());
                while let Some(Key(key)) = map.next_key()? {
                    match key.as_str() {
                        "joint" => joint = Some(map.next_value()?),
                        "source" => source = Some(map.next_value()?),
                        _ => numbers.push((key, map.next_value()?)),
                    }
                }
                let joint = joint.ok_or_else(|| A::Error::missing_field("joint"))?;
                Ok(DriveTable { joint, source, numbers })
            }
        }
        deserializer.deserialize_map(Table)
    }
}
