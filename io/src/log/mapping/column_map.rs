//! One quantity of a log: its columns, and how their values become those of the joints.

use armid::estimation::ServoPart;

use super::{Quantity, Unit};
use crate::error::Error;
use crate::suggestion;

/// The columns of one quantity.
///
/// ```text
/// at the joints   x_joint = sign · unit · x + offset
/// at the motors   x_motor = sign · unit · x / gear (efforts: times gear),  then the coupling of the robot's motors,  + offset
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnMap {
    /// What they hold.
    pub quantity: Quantity,
    /// The file that holds them: its name, with or without folder and ending; `None` where only one can be meant.
    pub file: Option<String>,
    /// Headings, or `#` and the number of a column from one; `[1-6]` stands for the joints; several with `/` between them.
    pub columns: String,
    /// Their unit; `None` takes the one that the heading ends with, else SI.
    pub unit: Option<Unit>,
    /// Whether they are those of the motors.
    pub motor: bool,
    /// Motor turns per joint turn, one for all or one for each; `None` takes the robot's. Below zero where the motor turns
    /// the other way.
    pub gear: Option<Vec<f64>>,
    /// +1 or −1, one for all or one for each.
    pub sign: Option<Vec<f64>>,
    /// What is added at the joint, rad (m), one for all or one for each.
    pub offset: Option<Vec<f64>>,
    /// N·m of motor torque per ampere, one for all or one for each.
    pub constant: Option<Vec<f64>>,
    /// What 100 % are, in A or N·m, one for all or one for each.
    pub rated: Option<Vec<f64>>,
    /// Of commands: N·m/rad (N/m) of torque per error, one for all or one for each.
    pub kp: Option<Vec<f64>>,
    /// Of commands: N·m·s/rad (N·s/m) of torque per speed, one for all or one for each.
    pub kd: Option<Vec<f64>>,
    /// Of commands: time after which they act, s.
    pub delay_s: Option<f64>,
    /// Of commands: which of these numbers are guesses, and which zeros are to be found.
    pub unknown: Option<Vec<ServoPart>>,
}

/// What may stand behind the columns.
const WORDS: [&str; 13] = [
    "a unit",
    "motor",
    "gear=…",
    "sign=…",
    "offset=…",
    "offset_deg=…",
    "offset_rad=…",
    "constant=…",
    "rated=…",
    "kp=…",
    "kd=…",
    "delay_ms=…",
    "unknown=…",
];

impl ColumnMap {
    /// The columns of a quantity by their headings, in SI units at the joints.
    pub fn new(quantity: Quantity, columns: impl Into<String>) -> Self {
        Self {
            quantity,
            file: None,
            columns: columns.into(),
            unit: None,
            motor: false,
            gear: None,
            sign: None,
            offset: None,
            constant: None,
            rated: None,
            kp: None,
            kd: None,
            delay_s: None,
            unknown: None,
        }
    }

    /// Reads what stands behind `q=`.
    ///
    /// # Errors
    /// A sentence that says what was found and what was expected.
    pub fn parse(quantity: Quantity, text: &str) -> Result<Self, String> {
        let key = quantity.key();
        let mut words = words(text).into_iter();
        let first = words.next().ok_or_else(|| format!("{key}: found nothing, expected columns"))?;
        let mut map = Self::new(quantity, first.clone());
        if let Some((file, columns)) = first.rsplit_once(':') {
            (map.file, map.columns) = (Some(file.to_owned()), columns.to_owned());
        }
        let mut offset_unit = None;
        let is_command = quantity == Quantity::Command;
        let is_position = is_command || quantity == Quantity::Position;
        for word in words {
            match word.split_once('=') {
                None if word == "motor" && !matches!(quantity, Quantity::Time | Quantity::Command) => map.motor = true,
                None => map.unit = Some(Self::unit(quantity, &word)?),
                Some(("gear", values)) => map.gear = Some(list(key, "gear", values, |gear| gear != 0.0)?),
                Some(("sign", values)) => map.sign = Some(signs(key, values)?),
                Some((name @ ("offset" | "offset_deg" | "offset_rad"), values)) if is_position => {
                    offset_unit = match name {
                        "offset_deg" => Some(Unit::Deg),
                        "offset_rad" => Some(Unit::Rad),
                        _ => None,
                    };
                    map.offset = Some(list(key, name, values, |_| true)?);
                }
                Some(("constant", values)) if quantity == Quantity::Current => {
                    map.constant = Some(list(key, "constant", values, |constant| constant > 0.0)?);
                }
                Some(("kp", values)) if is_command => map.kp = Some(list(key, "kp", values, |kp| kp > 0.0)?),
                Some(("kd", values)) if is_command => map.kd = Some(list(key, "kd", values, |kd| kd >= 0.0)?),
                Some(("delay_ms", value)) if is_command => {
                    let [delay_ms] = list(key, "delay_ms", value, |delay| delay >= 0.0)?[..] else {
                        return Err(format!("{key}: delay_ms is \"{value}\", expected one number"));
                    };
                    map.delay_s = Some(1e-3 * delay_ms);
                }
                Some(("unknown", names)) if is_command => {
                    let part = |name: &str| {
                        ServoPart::parse(name.trim()).ok_or_else(|| {
                            format!(
                                "{key}: unknown is \"{}\", expected delay, kp1, kd1 or zero1, the number being a joint's, with / between them",
                                name.trim()
                            )
                        })
                    };
                    map.unknown = Some(names.split('/').map(part).collect::<Result<_, _>>()?);
                }
                Some(("rated", values)) => map.rated = Some(list(key, "rated", values, |rated| rated > 0.0)?),
                Some((name, _)) => {
                    let near = suggestion::nearest(
                        name,
                        ["gear", "sign", "offset", "constant", "rated", "kp", "kd", "delay_ms", "unknown"],
                    )
                    .map_or_else(String::new, |near| format!("; did you mean \"{near}=\"?"));
                    return Err(format!("{key}: found \"{word}\", expected {}{near}", WORDS.join(", ")));
                }
            }
        }
        // An offset without a unit of its own is in that of the columns.
        let unit = offset_unit.or(map.unit).unwrap_or(quantity.units()[0]);
        for offset in map.offset.iter_mut().flatten() {
            *offset *= unit.si();
        }
        if is_command && (map.kp.is_none() || map.kd.is_none()) {
            return Err(format!(
                "{key}: torque is kp (q_cmd − q) − kd qd, expected the gains of the servo: kp=… (N·m/rad) and kd=… (N·m·s/rad), 0 \
                 where it has none; without a known gain or load, twice the gains and twice the inertias move alike"
            ));
        }
        if (map.unit == Some(Unit::Percent)) != map.rated.is_some() {
            return Err(format!("{key}: % and rated=… belong together, expected both or neither"));
        }
        if map.gear.is_some() && !map.motor && quantity != Quantity::Current {
            return Err(format!("{key}: gear=… needs values at the motors, expected the word motor beside it"));
        }
        if quantity == Quantity::Current && (map.gear.is_some() || map.motor) && map.constant.is_none() {
            return Err(format!(
                "{key}: gear=… of a current needs constant=… (N·m/A); without both the robot's are taken"
            ));
        }
        Ok(map)
    }

    /// What a value in this unit is multiplied with, joint by joint: sign, unit and, where it is stated, gear, constant and rated
    /// value.
    ///
    /// # Errors
    /// [`Error`] where a list is neither of one value nor of `n`.
    pub(crate) fn factors(&self, unit: Unit, n: usize) -> Result<Vec<f64>, Error> {
        let of_each = |list: &Option<Vec<f64>>, what| self.of_each(list.as_deref(), 1.0, what, n);
        let (sign, gear) = (of_each(&self.sign, "sign")?, of_each(&self.gear, "gear")?);
        let (constant, rated) = (of_each(&self.constant, "constant")?, of_each(&self.rated, "rated")?);
        let is_effort = matches!(self.quantity, Quantity::Torque | Quantity::Current);
        let factor = |i: usize| {
            let gear = if is_effort { gear[i] } else { gear[i].recip() };
            unit.si() * sign[i] * gear * constant[i] * rated[i]
        };
        Ok((0..n).map(factor).collect())
    }

    /// What is added at the joints, rad (m); none where nothing is.
    ///
    /// # Errors
    /// As [`Self::factors`].
    pub(crate) fn offsets(&self, n: usize) -> Result<Vec<f64>, Error> {
        let offset = self.of_each(self.offset.as_deref(), 0.0, "offset", n)?;
        Ok(if offset.iter().all(|x| *x == 0.0) { Vec::new() } else { offset })
    }

    /// One value for each joint.
    pub(crate) fn of_each(
        &self,
        list: Option<&[f64]>,
        otherwise: f64,
        what: &str,
        n: usize,
    ) -> Result<Vec<f64>, Error> {
        match list {
            None => Ok(vec![otherwise; n]),
            Some([one]) => Ok(vec![*one; n]),
            Some(list) if list.len() == n => Ok(list.to_vec()),
            Some(list) => {
                let (key, count) = (self.quantity.key(), list.len());
                Err(Error::new(format!("{key}: {what} has {count} values, expected 1 or {n}, one for each joint")))
            }
        }
    }

    /// The map as [`Self::parse`] reads it, behind its key.
    pub(crate) fn text(&self) -> String {
        let quoted = |text: &str| {
            if text.contains(char::is_whitespace) { format!("'{text}'") } else { text.to_owned() }
        };
        let mut words = vec![match &self.file {
            Some(file) => quoted(&format!("{file}:{}", self.columns)),
            None => quoted(&self.columns),
        }];
        words.extend(self.unit.map(|unit| unit.name().to_owned()));
        words.extend(self.motor.then(|| "motor".to_owned()));
        let degrees: Option<Vec<f64>> =
            self.offset.as_deref().map(|list| list.iter().map(|x| x.to_degrees()).collect());
        // An offset that is held in rad (m) is in the unit that a rotation or a translation is stated in.
        let in_degrees = !matches!(self.unit, Some(Unit::M | Unit::Mm));
        let offset = if in_degrees { ("offset_deg", &degrees) } else { ("offset_rad", &self.offset) };
        let delay_ms = self.delay_s.map(|delay| vec![1e3 * delay]);
        for (name, list) in [
            ("gear", &self.gear),
            ("sign", &self.sign),
            offset,
            ("constant", &self.constant),
            ("rated", &self.rated),
            ("kp", &self.kp),
            ("kd", &self.kd),
            ("delay_ms", &delay_ms),
        ] {
            if let Some(list) = list {
                // Twelve digits: what rounding adds to degrees is not written.
                let number = |x: &f64| format!("{x:.12}").parse::<f64>().unwrap_or(*x).to_string();
                words.push(format!("{name}={}", list.iter().map(number).collect::<Vec<_>>().join("/")));
            }
        }
        if let Some(unknown) = &self.unknown {
            words.push(format!("unknown={}", unknown.iter().map(ToString::to_string).collect::<Vec<_>>().join("/")));
        }
        words.join(" ")
    }

    fn unit(quantity: Quantity, word: &str) -> Result<Unit, String> {
        Unit::parse(word, quantity.units()).ok_or_else(|| {
            let names: Vec<&str> = quantity.units().iter().map(|unit| unit.name()).collect();
            format!(
                "{}: found \"{word}\", expected one of the units {}, or {}",
                quantity.key(),
                names.join(", "),
                WORDS[1..].join(", ")
            )
        })
    }
}

/// Words of a text; quotes keep blanks together, and so do brackets.
fn words(text: &str) -> Vec<String> {
    let (mut words, mut word, mut quoted) = (Vec::new(), String::new(), false);
    for c in text.chars() {
        match c {
            '"' | '\'' => quoted = !quoted,
            c if c.is_whitespace() && !quoted => {
                if !word.is_empty() {
                    words.push(std::mem::take(&mut word));
                }
            }
            c => word.push(c),
        }
    }
    if !word.is_empty() {
        words.push(word);
    }
    words
}

/// Numbers with `/` between them.
fn list(key: &str, name: &str, text: &str, allowed: fn(f64) -> bool) -> Result<Vec<f64>, String> {
    text.split('/')
        .map(|value| match value.trim().parse::<f64>() {
            Ok(value) if value.is_finite() && allowed(value) => Ok(value),
            _ => Err(format!("{key}: {name} is \"{}\", expected numbers with / between them", value.trim())),
        })
        .collect()
}

/// Signs as `+-+`, `+/-/+` or `1/-1/1`.
fn signs(key: &str, text: &str) -> Result<Vec<f64>, String> {
    let signs: String =
        if text.split('/').all(|part| part.len() == 1) { text.replace('/', "") } else { text.to_owned() };
    if signs.chars().all(|c| c == '+' || c == '-') && !signs.is_empty() {
        return Ok(signs.chars().map(|c| if c == '+' { 1.0 } else { -1.0 }).collect());
    }
    list(key, "sign", text, |sign| sign.abs() == 1.0)
}

#[cfg(test)]
mod tests {
    use super::ColumnMap;
    use crate::log::mapping::{Quantity, Unit};

    #[test]
    fn words_behind_the_columns_are_read() {
        let map =
            ColumnMap::parse(Quantity::Position, "pos:Joint_[1-3] deg motor gear=32/45/-48 offset=0/90/0").unwrap();
        assert_eq!((map.file.as_deref(), map.columns.as_str()), (Some("pos"), "Joint_[1-3]"));
        assert_eq!((map.unit, map.motor, map.gear), (Some(Unit::Deg), true, Some(vec![32.0, 45.0, -48.0])));
        assert!((map.offset.unwrap()[1] - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
        let map = ColumnMap::parse(Quantity::Torque, "\"motor torque [1-2]\" sign=+-").unwrap();
        assert_eq!((map.columns.as_str(), map.sign), ("motor torque [1-2]", Some(vec![1.0, -1.0])));
        for (text, signs) in
            [("-", vec![-1.0]), ("-/-", vec![-1.0; 2]), ("+/-", vec![1.0, -1.0]), ("1/-1", vec![1.0, -1.0])]
        {
            let map = ColumnMap::parse(Quantity::Torque, &format!("tau[1-2] sign={text}")).unwrap();
            assert_eq!(map.sign, Some(signs), "{text}");
        }
    }

    #[test]
    fn what_makes_no_sense_is_said() {
        for (quantity, text, wanted) in [
            (Quantity::Position, "", "q: found nothing, expected columns"),
            (Quantity::Position, "p A", "q: found \"A\", expected one of the units rad, deg"),
            (Quantity::Position, "p gaer=3", "did you mean \"gear=\"?"),
            (Quantity::Position, "p gear=3", "expected the word motor"),
            (Quantity::Position, "p motor gear=0", "gear is \"0\""),
            (Quantity::Position, "p sign=2", "sign is \"2\""),
            (Quantity::Current, "i %", "% and rated=… belong together"),
            (Quantity::Current, "i gear=100", "needs constant=…"),
            (Quantity::Torque, "i offset=3", "found \"offset=3\""),
            (Quantity::Torque, "i kp=3", "found \"kp=3\""),
            (Quantity::Command, "c deg kp=3", "expected the gains of the servo"),
            (Quantity::Command, "c deg kp=0 kd=1", "kp is \"0\""),
            (Quantity::Command, "c motor kp=3 kd=1", "found \"motor\""),
            (Quantity::Command, "c kp=3 kd=1 delay_ms=1/2", "expected one number"),
            (Quantity::Command, "c kp=3 kd=1 unknown=delay/lag", "unknown is \"lag\", expected delay, kp1"),
            (Quantity::Torque, "i unknown=delay", "found \"unknown=delay\""),
        ] {
            let fault = ColumnMap::parse(quantity, text).unwrap_err();
            assert!(fault.contains(wanted), "{text}: {fault}");
        }
    }
}
