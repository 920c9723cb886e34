//! The trajectory file: TOML text to a Fourier trajectory and back.
//!
//! ```text
//! period_s = 10.0
//! harmonics = 5
//!
//! [[joint]]
//! name = "joint1"
//! a = [0.156, …]      # rad/s, one for each harmonic
//! b = [0.088, …]      # rad/s
//! q0 = 0.0            # rad
//! ```

use std::ops::Range;

use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::{ExcitationError, FourierJoint, FourierTrajectory};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileIn {
    period_s: Spanned<f64>,
    harmonics: Spanned<usize>,
    joint: Spanned<Vec<JointIn>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct JointIn {
    name: Spanned<String>,
    a: Spanned<Vec<f64>>,
    b: Spanned<Vec<f64>>,
    q0: Spanned<f64>,
}

#[derive(Serialize)]
struct FileOut<'a> {
    period_s: f64,
    harmonics: usize,
    joint: &'a [FourierJoint],
}

impl FourierTrajectory {
    /// Reads a trajectory file.
    ///
    /// # Errors
    /// [`ExcitationError::File`] with line and column if the text is not TOML, has a key that the format does not
    /// have or lacks one, if a joint's `a` or `b` has another length than `harmonics`, if a joint's name occurs twice,
    /// or if a number is not finite or the period not positive.
    pub fn from_toml(text: &str) -> Result<Self, ExcitationError> {
        let file: FileIn =
            toml::from_str(text).map_err(|fault| at(text, fault.span().unwrap_or(0..0), fault.message()))?;
        let period_s = *file.period_s.get_ref();
        if !(period_s.is_finite() && period_s > 0.0) {
            let message = format!("period_s is {period_s}, expected a finite number above zero, s");
            return Err(at(text, file.period_s.span(), &message));
        }
        let harmonics = *file.harmonics.get_ref();
        if harmonics == 0 {
            return Err(at(text, file.harmonics.span(), "harmonics is 0, expected at least 1"));
        }
        if file.joint.get_ref().is_empty() {
            return Err(at(text, file.joint.span(), "no joint, expected one [[joint]] for each of the robot"));
        }
        let mut joints: Vec<FourierJoint> = Vec::new();
        for joint in file.joint.into_inner() {
            let name = joint.name.get_ref().clone();
            if joints.iter().any(|other| other.name == name) {
                let message = format!("joint name \"{name}\" occurs twice, expected each name once");
                return Err(at(text, joint.name.span(), &message));
            }
            for (key, values) in [("a", &joint.a), ("b", &joint.b)] {
                let found = values.get_ref().len();
                if found != harmonics {
                    let message = format!(
                        "{key} of joint \"{name}\" has {found} values, expected {harmonics}, one for each harmonic"
                    );
                    return Err(at(text, values.span(), &message));
                }
                if let Some(value) = values.get_ref().iter().find(|value| !value.is_finite()) {
                    let message = format!("{key} of joint \"{name}\" has the value {value}, expected finite rad/s");
                    return Err(at(text, values.span(), &message));
                }
            }
            if !joint.q0.get_ref().is_finite() {
                let message = format!("q0 of joint \"{name}\" is {}, expected finite rad", joint.q0.get_ref());
                return Err(at(text, joint.q0.span(), &message));
            }
            joints.push(FourierJoint {
                name,
                a: joint.a.into_inner(),
                b: joint.b.into_inner(),
                q0: joint.q0.into_inner(),
            });
        }
        Self::new(period_s, joints)
    }

    /// Writes a trajectory file; [`Self::from_toml`] reads the same bits back.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let file = FileOut { period_s: self.period_s, harmonics: self.harmonics(), joint: &self.joints };
        toml::to_string(&file).expect("numbers, strings and lists of numbers always have a TOML form")
    }
}

/// A fault at the first byte of a span.
fn at(text: &str, span: Range<usize>, message: &str) -> ExcitationError {
    let before = text.get(..span.start).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |position| position + 1);
    ExcitationError::File {
        line: before.matches('\n').count() + 1,
        column: before[line_start..].chars().count() + 1,
        message: message.trim_end().replace('\n', ", "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::table_one;

    #[test]
    fn identity_written_trajectory_reads_back_to_the_last_bit() {
        for trajectory in [table_one::printed(), table_one::corrected()] {
            let text = trajectory.to_toml();
            assert!(text.starts_with("period_s = 10.0\nharmonics = 5\n\n[[joint]]\nname = "), "{text}");
            assert_eq!(FourierTrajectory::from_toml(&text).unwrap(), trajectory);
        }
    }

    #[test]
    fn faults_carry_line_and_column() {
        let good =
            "period_s = 10.0\nharmonics = 2\n\n[[joint]]\nname = \"Ä\"\na = [1.0, 2.0]\nb = [0.0, 1.0]\nq0 = 0.1\n";
        assert!(FourierTrajectory::from_toml(good).is_ok());
        let twice = format!("{good}\n{}", &good[good.find("[[").unwrap()..]);
        for (text, line, column, words) in [
            (good.replace("10.0", "-1.0"), 1, 12, "period_s is -1"),
            (good.replace("= 2\n", "= 0\n"), 2, 13, "harmonics is 0"),
            (good.replace("q0 = 0.1", "q0 = inf"), 8, 6, "q0 of joint \"Ä\" is inf"),
            (good.replace("[1.0, 2.0]", "[1.0]"), 6, 5, "a of joint \"Ä\" has 1 values, expected 2"),
            (good.replace("[0.0, 1.0]", "[nan, 1.0]"), 7, 5, "b of joint \"Ä\" has the value NaN"),
            (good.replace("q0", "q1"), 8, 1, "unknown field `q1`"),
            (good.replace("q0 = 0.1", ""), 4, 1, "missing field `q0`"),
            (good.replace("period_s = 10.0", "period_s = "), 1, 12, ""),
            (twice, 11, 8, "joint name \"Ä\" occurs twice"),
        ] {
            let fault = FourierTrajectory::from_toml(&text).unwrap_err();
            let ExcitationError::File { line: l, column: c, message } = &fault else { panic!("{fault}") };
            assert!((*l, *c) == (line, column) && message.contains(words), "{fault} for\n{text}");
        }
    }
}
