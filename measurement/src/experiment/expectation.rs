//! What a check before the first motion asks for.

use std::fmt;

/// What a check asks for; its `Display` ends the sentence "found …, expected …".
///
/// ```
/// # use armid_measurement as armid;
/// use armid::experiment::Expectation;
/// let expected = Expectation::Between { low: -1.5, high: 1.5, unit: "rad", remedy: "" };
/// assert_eq!(expected.to_string(), "-1.5000 to 1.5000 rad");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Expectation {
    /// A setting in its range.
    Range {
        /// Where the range begins.
        low: f64,
        /// Whether `low` itself is possible.
        inclusive: bool,
        /// Largest value that is possible.
        high: f64,
    },
    /// A number between two limits, both possible.
    Between {
        /// Lower limit.
        low: f64,
        /// Upper limit.
        high: f64,
        /// Their unit.
        unit: &'static str,
        /// What to do; may be empty.
        remedy: &'static str,
    },
    /// A number not above a limit.
    AtMost {
        /// The limit.
        limit: f64,
        /// Its unit.
        unit: &'static str,
        /// What to do; may be empty.
        remedy: &'static str,
    },
    /// A number not below a limit.
    AtLeast {
        /// The limit.
        limit: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// A joint of this name.
    Joint(String),
    /// One of these words of the robot.
    OneOf(Vec<String>),
    /// A state of the arm, in words.
    State(&'static str),
}

/// A remedy behind a semicolon, where there is one.
fn end(f: &mut fmt::Formatter<'_>, remedy: &str) -> fmt::Result {
    if remedy.is_empty() { Ok(()) } else { write!(f, "; {remedy}") }
}

impl fmt::Display for Expectation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Range { low, inclusive: true, high } => write!(f, "{low} or more, at most {high}"),
            Self::Range { low, inclusive: false, high } => write!(f, "more than {low}, at most {high}"),
            Self::Between { low, high, unit, remedy } => {
                write!(f, "{low:.4} to {high:.4} {unit}")?;
                end(f, remedy)
            }
            Self::AtMost { limit, unit, remedy } => {
                write!(f, "at most {limit} {unit}")?;
                end(f, remedy)
            }
            Self::AtLeast { limit, unit } => write!(f, "at least {limit} {unit}"),
            Self::Joint(name) => write!(f, "one called \"{name}\""),
            Self::OneOf(words) => {
                for (k, word) in words.iter().enumerate() {
                    write!(f, "{}\"{word}\"", if k > 0 { " or " } else { "" })?;
                }
                Ok(())
            }
            Self::State(state) => f.write_str(state),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn golden_each_expectation_ends_a_sentence() {
        let sentences = [
            (Expectation::Range { low: 0.0, inclusive: false, high: 20.0 }, "more than 0, at most 20"),
            (Expectation::Range { low: 0.0, inclusive: true, high: 45.0 }, "0 or more, at most 45"),
            (
                Expectation::Between { low: -1.0, high: 1.0, unit: "rad", remedy: "bring it back by hand" },
                "-1.0000 to 1.0000 rad; bring it back by hand",
            ),
            (Expectation::AtMost { limit: 250.0, unit: "mm/s", remedy: "" }, "at most 250 mm/s"),
            (Expectation::AtLeast { limit: 500.0, unit: "Hz" }, "at least 500 Hz"),
            (Expectation::Joint("wrist".to_owned()), "one called \"wrist\""),
            (Expectation::OneOf(vec!["a".to_owned(), "b".to_owned()]), "\"a\" or \"b\""),
            (Expectation::State("a homed arm"), "a homed arm"),
        ];
        for (expected, sentence) in sentences {
            assert_eq!(expected.to_string(), sentence);
        }
    }
}
