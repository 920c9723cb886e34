//! A whole mapping from its text.

use super::{ColumnMap, Quantity};
use crate::error::Error;
use crate::suggestion;

/// Which columns of a log mean what.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mapping {
    /// One entry for each quantity, in the order of [`Quantity`].
    pub columns: Vec<ColumnMap>,
    /// The topic of joint states; `None` takes the usual one or the only one.
    pub topic: Option<String>,
}

impl Mapping {
    /// Reads a mapping, as `--map` has it.
    ///
    /// ```
    /// use armid_io::log::{Mapping, Quantity};
    /// let mapping = Mapping::parse("t=time_ms, q=joint_[1-6]_pos deg, current=actual_current_[1-6]")?;
    /// assert_eq!(mapping.columns(Quantity::Position).map(|map| map.columns.as_str()), Some("joint_[1-6]_pos"));
    /// # Ok::<(), armid_io::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error`] that says which entry is at fault and what was expected.
    pub fn parse(text: &str) -> Result<Self, Error> {
        let entries = entries(text);
        Self::of_entries(entries.iter().map(|(key, value)| (key.as_str(), value.as_str())))
            .map_err(|fault| Error::new(format!("the mapping \"{text}\": {fault}")).help(EXAMPLE))
    }

    /// Reads a map from keys and what they are mapped to.
    ///
    /// # Errors
    /// A sentence.
    pub(crate) fn of_entries<'a>(entries: impl IntoIterator<Item = (&'a str, &'a str)>) -> Result<Self, String> {
        let mut mapping = Self::default();
        for (key, value) in entries {
            if key == TOPIC && mapping.topic.is_none() && !value.is_empty() {
                mapping.topic = Some(value.to_owned());
                continue;
            }
            let keys: Vec<&str> = Quantity::ALL.iter().map(|quantity| quantity.key()).chain([TOPIC]).collect();
            let Some(quantity) = Quantity::ALL.into_iter().find(|quantity| quantity.key() == key) else {
                let expected = suggestion::help(key, &keys);
                return Err(format!("found \"{key}\"; {expected}"));
            };
            if mapping.columns(quantity).is_some() {
                return Err(format!("\"{key}\" occurs twice, expected each once"));
            }
            mapping.columns.push(ColumnMap::parse(quantity, value)?);
        }
        mapping.columns.sort_by_key(|map| map.quantity);
        if mapping.columns.is_empty() && mapping.topic.is_some() {
            return Ok(mapping);
        }
        if mapping.columns(Quantity::Position).is_none() {
            return Err("q is missing, expected the columns of the positions".to_owned());
        }
        let efforts: Vec<&str> =
            mapping.columns.iter().map(|map| map.quantity).filter(|of| of.is_effort()).map(Quantity::key).collect();
        match efforts[..] {
            [] => Err("expected the columns of current, of tau, or of q_cmd with gains".to_owned()),
            [_] => Ok(mapping),
            [ref first @ .., last] => Err(format!("found {} and {last}, expected one of them", first.join(", "))),
        }
    }

    /// The columns of a quantity, where the mapping has them.
    pub fn columns(&self, quantity: Quantity) -> Option<&ColumnMap> {
        self.columns.iter().find(|map| map.quantity == quantity)
    }

    /// The text that [`Self::parse`] reads it from.
    pub fn text(&self) -> String {
        let topic = self.topic.iter().map(|topic| format!("{TOPIC}={topic}"));
        let columns = self.columns.iter().map(|map| format!("{}={}", map.quantity.key(), map.text()));
        topic.chain(columns).collect::<Vec<_>>().join(", ")
    }

    /// Whether the mapping names files: then the files of a log stand side by side.
    pub fn names_files(&self) -> bool {
        self.columns.iter().any(|map| map.file.is_some())
    }
}

/// The key of a topic.
const TOPIC: &str = "topic";

const EXAMPLE: &str = "for example: t=time_ms ms, q=joint_[1-6]_pos deg, current=actual_current_[1-6] mA";

/// Keys and values of `key=value, key=value`: a comma inside quotes or brackets is text, and so is one that no key follows.
fn entries(text: &str) -> Vec<(String, String)> {
    let (mut parts, mut part, mut quoted, mut depth) = (Vec::new(), String::new(), false, 0_i32);
    for c in text.chars() {
        match c {
            '"' => quoted = !quoted,
            '[' => depth += 1,
            ']' => depth -= 1,
            ',' if !quoted && depth <= 0 => {
                parts.push(std::mem::take(&mut part));
                continue;
            }
            _ => {}
        }
        part.push(c);
    }
    parts.push(part);
    parts
        .iter()
        .filter(|part| !part.trim().is_empty())
        .map(|part| {
            let (key, value) = part.split_once('=').unwrap_or((part, ""));
            (key.trim().to_owned(), value.trim().to_owned())
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::Mapping;
    use crate::log::mapping::Quantity;

    #[test]
    fn entries_are_read_in_any_order() {
        let mapping = Mapping::parse("tau=\"torque, [1-2]\" Nm, q=p[1-2], t=time_ms").unwrap();
        let columns: Vec<&str> = mapping.columns.iter().map(|map| map.columns.as_str()).collect();
        assert_eq!(columns, ["time_ms", "p[1-2]", "torque, [1-2]"]);
        assert!(!mapping.names_files() && mapping.columns(Quantity::Velocity).is_none());
        assert!(Mapping::parse("q=a:p[1-2], tau=b:p[1-2]").unwrap().names_files());
    }

    #[test]
    fn identity_a_mapping_is_read_back_from_its_text() {
        for text in [
            "topic=/arm/joint_states, q=j[1-2] deg motor gear=32/-45.5 offset_deg=0/90, current=i[1-2] mA constant=0.05",
            "t=t, q=x[1-2] deg, q_cmd=c[1-2] deg offset_deg=0/90 kp=100/50 kd=2 delay_ms=4 unknown=delay/kp2/zero1",
            "t=time_ms ms, q='joint 1'/'joint 2' sign=1/-1 offset_deg=0.1, tau=pos:tau[1-2] % rated=2.5",
        ] {
            let mapping = Mapping::parse(text).unwrap();
            let again = Mapping::parse(&mapping.text()).unwrap();
            assert_eq!(again.text(), mapping.text());
            assert_eq!((again.topic.clone(), again.columns.len()), (mapping.topic.clone(), mapping.columns.len()));
            for (a, b) in again.columns.iter().zip(&mapping.columns) {
                let offsets = |map: &crate::log::ColumnMap| map.offset.clone().unwrap_or_default();
                assert!(offsets(a).iter().zip(offsets(b)).all(|(a, b)| (a - b).abs() < 1e-13));
                assert_eq!((&a.columns, &a.gear, &a.sign, &a.unit), (&b.columns, &b.gear, &b.sign, &b.unit));
                assert_eq!((&a.kp, &a.kd, a.delay_s, &a.unknown), (&b.kp, &b.kd, b.delay_s, &b.unknown));
            }
        }
        let topic = Mapping::parse("topic=/joint_states").unwrap();
        assert_eq!((topic.topic.as_deref(), topic.columns.len()), (Some("/joint_states"), 0));
    }

    #[test]
    fn what_is_missing_or_unknown_is_said() {
        for (text, wanted) in [
            ("t=t, tau=x[1-2]", "q is missing"),
            ("t=t, q=x[1-2]", "expected the columns of current, of tau, or of q_cmd"),
            ("q=x, tau=z, q_cmd=y kp=1 kd=0", "found tau and q_cmd"),
            ("q=x, current=y, tau=z", "found current and tau"),
            ("q=x, q=y, tau=z", "\"q\" occurs twice"),
            ("q=x, curent=y", "did you mean \"current\"?"),
        ] {
            let fault = Mapping::parse(text).unwrap_err().to_string();
            assert!(fault.contains(wanted), "{text}: {fault}");
        }
    }
}
