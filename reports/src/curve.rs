//! The points of a line as one text, with a space between two: short, and read by any program.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serializer};

pub(crate) fn serialize<S: Serializer>(values: &[f64], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&values.iter().map(|value| written(*value)).collect::<Vec<_>>().join(" "))
}

pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<f64>, D::Error> {
    let text = String::deserialize(deserializer)?;
    let number =
        |word: &str| word.parse().map_err(|_| D::Error::custom(format!("found \"{word}\", expected a number")));
    text.split_whitespace().map(number).collect()
}

/// The shorter of both ways to write a number, each of which reads back to the same bits.
fn written(value: f64) -> String {
    let (plain, scientific) = (value.to_string(), format!("{value:e}"));
    if scientific.len() < plain.len() { scientific } else { plain }
}

#[cfg(test)]
mod tests {
    use crate::TorqueTrace;

    #[test]
    fn identity_a_line_reads_back_to_the_same_bits() {
        let values = vec![0.0, -0.0, 0.1235, -98_770.0, 1.5e-9, f64::MAX];
        let line =
            TorqueTrace { joint: "a".to_owned(), times: Vec::new(), predicted: values.clone(), measured: values };
        let text = serde_json::to_string(&line).unwrap();
        assert!(text.contains("\"0 -0 0.1235 -98770 1.5e-9 "), "{text}");
        let read: TorqueTrace = serde_json::from_str(&text).unwrap();
        assert_eq!(read, line);
        assert!(
            serde_json::from_str::<TorqueTrace>(&text.replace("0.1235", "x"))
                .unwrap_err()
                .to_string()
                .contains("\"x\"")
        );
    }
}
