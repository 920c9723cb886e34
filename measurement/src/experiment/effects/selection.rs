//! Which effects an arm has, and how strong.

use std::collections::BTreeMap;
use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, MapAccess, Visitor};
use serde::ser::{Serialize, SerializeMap, Serializer};

use super::kind::EffectKind;
use super::level::Level;
use crate::seed::Seed;

/// The key of the seed among the effects.
const SEED: &str = "seed";

/// The effects of one arm, each with its magnitude; none unless said otherwise.
///
/// In TOML a table of names with a magnitude, in the effect's own unit, or a level:
///
/// ```
/// # use armid_measurement as armid;
/// use armid::experiment::{EffectKind, Effects, Level};
/// let text = "stribeck = 'realistic'\nelasticity = 4.5   # mrad\nseed = 7";
/// let effects: Effects = toml::from_str(text).unwrap();
/// assert_eq!(effects.magnitude(EffectKind::Stribeck), EffectKind::Stribeck.magnitude(Level::Realistic));
/// assert_eq!(effects.magnitude(EffectKind::Elasticity), 4.5);
/// assert_eq!(effects.magnitude(EffectKind::Backlash), 0.0);
/// assert_eq!(effects.to_string(), "stribeck realistic, elasticity 4.5 mrad");
/// ```
/// What belongs to one arm and not to one run (the sign of each torque constant's error, the phase of each encoder's
/// disc) is drawn from `seed`: equal seeds are the same arm.
#[derive(Clone, Debug, PartialEq)]
pub struct Effects {
    magnitudes: BTreeMap<EffectKind, f64>,
    /// Which arm it is.
    pub seed: Seed,
}

impl Default for Effects {
    fn default() -> Self {
        Self::none()
    }
}

impl Effects {
    /// No effect at all: the arm that the identification model describes.
    pub const fn none() -> Self {
        Self { magnitudes: BTreeMap::new(), seed: Seed::new(0) }
    }

    /// Returns this selection with one effect at a magnitude, in its unit; 0 switches it off.
    ///
    /// # Panics
    /// If the magnitude is below zero, above [`EffectEntry::most`](super::EffectEntry::most), or no number.
    #[must_use]
    pub fn with_effect(mut self, kind: EffectKind, magnitude: f64) -> Self {
        if let Some(expected) = fault(kind, magnitude) {
            panic!("{} is {magnitude}, expected {expected}", kind.name());
        }
        if magnitude > 0.0 {
            self.magnitudes.insert(kind, magnitude);
        } else {
            self.magnitudes.remove(&kind);
        }
        self
    }

    /// One effect alone.
    pub fn only(kind: EffectKind, level: Level) -> Self {
        Self::none().with_effect(kind, kind.magnitude(level))
    }

    /// Returns these effects on another arm.
    #[must_use]
    pub const fn with_seed(mut self, seed: Seed) -> Self {
        self.seed = seed;
        self
    }

    /// Returns these effects and the others. The others count where both have an effect or a seed.
    #[must_use]
    pub fn overridden_by(&self, others: &Self) -> Self {
        let mut both = self.clone();
        both.magnitudes.extend(&others.magnitudes);
        if others.seed.value() != 0 {
            both.seed = others.seed;
        }
        both
    }

    /// Magnitude of one effect in its unit; 0 where it is off.
    pub fn magnitude(&self, kind: EffectKind) -> f64 {
        self.magnitudes.get(&kind).copied().unwrap_or(0.0)
    }

    /// Whether an effect is there.
    pub fn has(&self, kind: EffectKind) -> bool {
        self.magnitudes.contains_key(&kind)
    }

    /// Whether there is none.
    pub fn is_none(&self) -> bool {
        self.magnitudes.is_empty()
    }

    /// The effects that are there, with their magnitudes.
    pub fn iter(&self) -> impl Iterator<Item = (EffectKind, f64)> + '_ {
        self.magnitudes.iter().map(|(&kind, &magnitude)| (kind, magnitude))
    }
}

/// What would be possible where a magnitude is not.
fn fault(kind: EffectKind, magnitude: f64) -> Option<String> {
    let entry = kind.entry();
    let unit = if entry.unit.is_empty() { String::new() } else { format!(" {}", entry.unit) };
    if !(0.0..=entry.most).contains(&magnitude) {
        return Some(format!("a number from 0 to {}{unit}", entry.most));
    }
    (kind == EffectKind::CurrentDelay && magnitude.fract() != 0.0).then(|| "a whole number of steps".to_owned())
}

impl fmt::Display for Effects {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_none() {
            return f.write_str("none");
        }
        for (i, (kind, magnitude)) in self.iter().enumerate() {
            let comma = if i > 0 { ", " } else { "" };
            match kind.level(magnitude) {
                Some(level) => write!(f, "{comma}{} {}", kind.name(), level.name())?,
                None => write!(f, "{comma}{} {magnitude} {}", kind.name(), kind.entry().unit)?,
            }
        }
        Ok(())
    }
}

impl Serialize for Effects {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for (kind, magnitude) in self.iter() {
            match kind.level(magnitude) {
                Some(level) => map.serialize_entry(kind.name(), level.name())?,
                None => map.serialize_entry(kind.name(), &magnitude)?,
            }
        }
        if self.seed.value() != 0 {
            map.serialize_entry(SEED, &self.seed)?;
        }
        map.end()
    }
}

/// A magnitude as it is written: a number in the effect's unit, or a level.
struct Magnitude(EffectKind);

impl<'de> serde::de::DeserializeSeed<'de> for Magnitude {
    type Value = f64;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<f64, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl Visitor<'_> for Magnitude {
    type Value = f64;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a magnitude of {}, \"realistic\" or \"severe\"", self.0.name())
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<f64, E> {
        let name = self.0.name();
        fault(self.0, value).map_or(Ok(value), |e| Err(E::custom(format!("{name} is {value}, expected {e}"))))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<f64, E> {
        self.visit_f64(value as f64)
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<f64, E> {
        self.visit_f64(value as f64)
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<f64, E> {
        let level = Level::parse(value).ok_or_else(|| {
            E::custom(format!("{} is \"{value}\", expected a magnitude, \"realistic\" or \"severe\"", self.0.name()))
        })?;
        Ok(self.0.magnitude(level))
    }
}

struct Table;

impl<'de> Visitor<'de> for Table {
    type Value = Effects;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table of effects")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Effects, A::Error> {
        let mut effects = Effects::none();
        while let Some(key) = map.next_key::<Key>()? {
            match key {
                Key::Seed => effects.seed = map.next_value()?,
                Key::Effect(kind) => {
                    effects = effects.with_effect(kind, map.next_value_seed(Magnitude(kind))?);
                }
            }
        }
        Ok(effects)
    }
}

enum Key {
    Seed,
    Effect(EffectKind),
}

impl<'de> Deserialize<'de> for Key {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        if name == SEED {
            return Ok(Self::Seed);
        }
        EffectKind::parse(&name).map(Self::Effect).ok_or_else(|| {
            let names: Vec<&str> = EffectKind::ALL.iter().map(|kind| kind.name()).collect();
            D::Error::custom(format!("unknown effect `{name}`, expected one of {}, {SEED}", names.join(", ")))
        })
    }
}

impl<'de> Deserialize<'de> for Effects {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Table)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identity_text_and_back() {
        for level in Level::ALL {
            for &kind in EffectKind::ALL {
                let effects = Effects::only(kind, level).with_effect(EffectKind::Tool, 0.125).with_seed(Seed::new(3));
                let text = toml::to_string(&effects).unwrap();
                assert_eq!(toml::from_str::<Effects>(&text).unwrap(), effects, "{text}");
            }
        }
        assert!(toml::from_str::<Effects>("").unwrap().is_none());
    }

    #[test]
    fn what_is_impossible_is_named_with_its_place() {
        for (text, words, place) in [
            ("tool = 0.1\nstribek = 0.3", "unknown effect `stribek`", 11),
            ("tool = 0.1\nstribeck = 'mild'", "stribeck is \"mild\", expected a magnitude", 22),
            ("tool = 0.1\nstribeck = -0.3", "stribeck is -0.3, expected a number from 0 to 2", 22),
            ("elasticity = nan", "expected a number from 0 to 30 mrad", 13),
            ("current-delay = 1.5", "expected a whole number of steps", 16),
            ("stribeck = [1]", "expected a magnitude of stribeck", 11),
        ] {
            let fault = toml::from_str::<Effects>(text).unwrap_err();
            assert!(fault.message().contains(words), "{fault}");
            assert_eq!(fault.span().map(|span| span.start), Some(place), "{fault}");
        }
    }

    #[test]
    fn effects_of_two_sources_are_joined_and_the_later_counts() {
        let of = |text: &str| toml::from_str::<Effects>(text).unwrap();
        let both = of("tool = 0.5\nbacklash = 1.0").overridden_by(&of("tool = 0.2\nseed = 4"));
        assert_eq!(both, of("tool = 0.2\nbacklash = 1.0\nseed = 4"));
    }
}
