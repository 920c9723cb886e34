//! The trajectory file: TOML text to a periodic motion and back.
//!
//! ```text
//! # family = "fourier-quintic" where the polynomial is added; the plain series has no such key
//! period_s = 10.0
//! harmonics = 5
//!
//! [[joint]]
//! name = "joint1"
//! a = [0.156, …]      # rad/s, one for each harmonic
//! b = [0.088, …]      # rad/s
//! q0 = 0.0            # rad
//!
//! family = "b-spline"
//! period_s = 10.0
//! degree = 3          # or 5
//!
//! [[joint]]
//! name = "joint1"
//! c = [0.1, …]        # rad, one for each knot
//!
//! family = "constant-speed"
//! change_s = 0.5      # from one speed to the next
//! stretch_s = [1.0, 1.0]
//!
//! [[joint]]
//! name = "joint1"
//! q0 = 0.0            # rad, where the first segment begins
//! speed = [0.5, -0.5] # rad/s, one for each segment
//! ```

use std::ops::Range;

use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::b_spline::{BSplineJoint, BSplineTrajectory};
use super::constant_speed::{ConstantSpeedJoint, ConstantSpeedTrajectory};
use super::error::TrajectoryError;
use super::fourier::{FourierJoint, FourierTrajectory};
use super::fourier_quintic::FourierQuinticTrajectory;
use super::periodic::PeriodicTrajectory;
use crate::input::size::HARMONICS;

/// The key that names the family.
#[derive(Deserialize)]
struct Header {
    family: Option<Spanned<String>>,
}

/// The names of the families that have a key of their own.
const FAMILIES: &str = "\"fourier\", \"fourier-quintic\", \"b-spline\", \"constant-speed\"";

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileIn {
    family: Option<Spanned<String>>,
    period_s: Spanned<f64>,
    harmonics: Spanned<usize>,
    joint: Spanned<Vec<JointIn>>,
    #[serde(rename = "certificate")]
    _certificate: Option<serde::de::IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct JointIn {
    name: Spanned<String>,
    a: Spanned<Vec<f64>>,
    b: Spanned<Vec<f64>>,
    q0: Spanned<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SplinesIn {
    #[serde(rename = "family")]
    _family: String,
    period_s: Spanned<f64>,
    degree: Spanned<usize>,
    joint: Spanned<Vec<SplineIn>>,
    #[serde(rename = "certificate")]
    _certificate: Option<serde::de::IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SplineIn {
    name: Spanned<String>,
    c: Spanned<Vec<f64>>,
}

#[derive(Serialize)]
struct FileOut<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    family: Option<&'static str>,
    period_s: f64,
    harmonics: usize,
    joint: &'a [FourierJoint],
}

#[derive(Serialize)]
struct SplinesOut<'a> {
    family: &'static str,
    period_s: f64,
    degree: usize,
    joint: &'a [BSplineJoint],
}

impl PeriodicTrajectory {
    /// Reads a trajectory file of any family.
    ///
    /// # Errors
    /// [`TrajectoryError::File`] with line and column if the text is not TOML, its `family` is not in the list, or it
    /// is not what the family's format has.
    pub fn from_toml(text: &str) -> Result<Self, TrajectoryError> {
        let header: Header = read(text)?;
        let family = header.family.as_ref().map_or("fourier", |family| family.get_ref().as_str());
        match family {
            "fourier" => FourierTrajectory::from_toml(text).map(Self::from),
            "fourier-quintic" => Ok(Self::from(FourierQuinticTrajectory::from(series(text, read(text)?)?))),
            "b-spline" => BSplineTrajectory::from_toml(text).map(Self::from),
            "constant-speed" => ConstantSpeedTrajectory::from_toml(text).map(Self::from),
            found => {
                let span = header.family.as_ref().map_or(0..0, Spanned::span);
                Err(at(text, span, &format!("family is \"{found}\", expected one of {FAMILIES}")))
            }
        }
    }

    /// Writes a trajectory file; [`Self::from_toml`] reads the same bits back.
    pub fn to_toml(&self) -> String {
        match self {
            Self::Fourier(series) => series.to_toml(),
            Self::FourierQuintic(motion) => series_to_toml(Some("fourier-quintic"), &motion.series),
            Self::BSpline(BSplineTrajectory { period_s, degree, joints }) => {
                write(&SplinesOut { family: "b-spline", period_s: *period_s, degree: *degree, joint: joints })
            }
            Self::ConstantSpeed(ConstantSpeedTrajectory { change_s, stretch_s, joints }) => {
                write(&SegmentsOut { family: "constant-speed", change_s: *change_s, stretch_s, joint: joints })
            }
            Self::Custom(motion) => motion.to_toml(),
        }
    }
}

/// Text to a value, faults with their place.
fn read<T: serde::de::DeserializeOwned>(text: &str) -> Result<T, TrajectoryError> {
    toml::from_str(text).map_err(|fault| at(text, fault.span().unwrap_or(0..0), fault.message()))
}

fn check_period(text: &str, period_s: &Spanned<f64>) -> Result<f64, TrajectoryError> {
    let found = *period_s.get_ref();
    if found.is_finite() && found > 0.0 {
        return Ok(found);
    }
    Err(at(text, period_s.span(), &format!("period_s is {found}, expected a finite number above zero, s")))
}

fn check_name<'a>(
    text: &str,
    name: &Spanned<String>,
    mut known: impl Iterator<Item = &'a String>,
) -> Result<String, TrajectoryError> {
    let found = name.get_ref();
    if known.any(|other| other == found) {
        let message = format!("joint name \"{found}\" occurs twice, expected each name once");
        return Err(at(text, name.span(), &message));
    }
    Ok(found.clone())
}

impl BSplineTrajectory {
    /// Reads a trajectory file.
    ///
    /// # Errors
    /// [`TrajectoryError::File`] with line and column if the text is not TOML, has a key that the format does not
    /// have or lacks one, or if a number is impossible.
    pub fn from_toml(text: &str) -> Result<Self, TrajectoryError> {
        let file: SplinesIn = read(text)?;
        let period_s = check_period(text, &file.period_s)?;
        let degree = *file.degree.get_ref();
        if degree != 3 && degree != 5 {
            return Err(at(text, file.degree.span(), &format!("degree is {degree}, expected 3 or 5")));
        }
        if file.joint.get_ref().is_empty() {
            return Err(at(text, file.joint.span(), "no joint, expected one [[joint]] for each of the robot"));
        }
        let mut joints: Vec<BSplineJoint> = Vec::new();
        for joint in file.joint.into_inner() {
            let name = check_name(text, &joint.name, joints.iter().map(|other| &other.name))?;
            let c = joint.c.get_ref();
            if c.len() <= degree || c.iter().any(|value| !value.is_finite()) {
                let message = format!(
                    "c of joint \"{name}\" has {} values, expected at least {} and each finite",
                    c.len(),
                    degree + 1
                );
                return Err(at(text, joint.c.span(), &message));
            }
            joints.push(BSplineJoint { name, c: joint.c.into_inner() });
        }
        Self::new(period_s, degree, joints)
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SegmentsIn {
    #[serde(rename = "family")]
    _family: String,
    change_s: f64,
    stretch_s: Vec<f64>,
    joint: Spanned<Vec<SegmentIn>>,
    #[serde(rename = "certificate")]
    _certificate: Option<serde::de::IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SegmentIn {
    name: Spanned<String>,
    q0: f64,
    speed: Vec<f64>,
}

#[derive(Serialize)]
struct SegmentsOut<'a> {
    family: &'static str,
    change_s: f64,
    stretch_s: &'a [f64],
    joint: &'a [ConstantSpeedJoint],
}

impl ConstantSpeedTrajectory {
    /// Reads a trajectory file.
    ///
    /// # Errors
    /// [`TrajectoryError::File`] with line and column if the text is not TOML, has a key that the format does not
    /// have or lacks one, or if a number is impossible.
    pub fn from_toml(text: &str) -> Result<Self, TrajectoryError> {
        let file: SegmentsIn = read(text)?;
        let whole = file.joint.span();
        let mut joints: Vec<ConstantSpeedJoint> = Vec::new();
        for joint in file.joint.into_inner() {
            let name = check_name(text, &joint.name, joints.iter().map(|other| &other.name))?;
            joints.push(ConstantSpeedJoint { name, q0: joint.q0, speed: joint.speed });
        }
        Self::new(file.change_s, file.stretch_s, joints).map_err(|fault| at(text, whole, &fault.to_string()))
    }
}

impl FourierTrajectory {
    /// Reads a trajectory file.
    ///
    /// # Errors
    /// [`TrajectoryError::File`] with line and column if the text is not TOML, has a key that the format does not
    /// have or lacks one, if a joint's `a` or `b` has another length than `harmonics`, if a joint's name occurs twice,
    /// or if a number is not finite or the period not positive.
    pub fn from_toml(text: &str) -> Result<Self, TrajectoryError> {
        let file: FileIn = read(text)?;
        if let Some(family) = file.family.as_ref().filter(|family| family.get_ref() != "fourier") {
            let message = format!("family is \"{}\", expected \"fourier\"", family.get_ref());
            return Err(at(text, family.span(), &message));
        }
        series(text, file)
    }

    /// Writes a trajectory file; [`Self::from_toml`] reads the same bits back.
    pub fn to_toml(&self) -> String {
        series_to_toml(None, self)
    }
}

/// The series of a file.
fn series(text: &str, file: FileIn) -> Result<FourierTrajectory, TrajectoryError> {
    let period_s = check_period(text, &file.period_s)?;
    let harmonics = *file.harmonics.get_ref();
    let at_harmonics = |message: &str| at(text, file.harmonics.span(), message);
    if harmonics == 0 {
        return Err(at_harmonics("harmonics is 0, expected at least 1"));
    }
    HARMONICS.check_count("harmonics", harmonics).map_err(|fault| at_harmonics(&fault.to_string()))?;
    if file.joint.get_ref().is_empty() {
        return Err(at(text, file.joint.span(), "no joint, expected one [[joint]] for each of the robot"));
    }
    let mut joints: Vec<FourierJoint> = Vec::new();
    for joint in file.joint.into_inner() {
        let name = check_name(text, &joint.name, joints.iter().map(|other| &other.name))?;
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
        joints.push(FourierJoint { name, a: joint.a.into_inner(), b: joint.b.into_inner(), q0: joint.q0.into_inner() });
    }
    FourierTrajectory::new(period_s, joints)
}

fn series_to_toml(family: Option<&'static str>, series: &FourierTrajectory) -> String {
    write(&FileOut { family, period_s: series.period_s, harmonics: series.harmonics(), joint: &series.joints })
}

fn write(file: &impl Serialize) -> String {
    toml::to_string(file).expect("numbers, strings and lists of numbers always have a TOML form")
}

/// A fault at the first byte of a span.
fn at(text: &str, span: Range<usize>, message: &str) -> TrajectoryError {
    let before = text.get(..span.start).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |position| position + 1);
    TrajectoryError::File {
        line: before.matches('\n').count() + 1,
        column: before[line_start..].chars().count() + 1,
        message: message.trim_end().replace('\n', ", "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::table_one;

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
            (format!("family = \"spline\"\n{good}"), 1, 10, "family is \"spline\", expected one of \"fourier\""),
        ] {
            let fault = PeriodicTrajectory::from_toml(&text).unwrap_err();
            let TrajectoryError::File { line: l, column: c, message } = &fault else { panic!("{fault}") };
            assert!((*l, *c) == (line, column) && message.contains(words), "{fault} for\n{text}");
        }
    }
    #[test]
    fn faults_in_splines_carry_line_and_column() {
        let good =
            "family = \"b-spline\"\nperiod_s = 4.0\ndegree = 3\n\n[[joint]]\nname = \"x\"\nc = [0.1, 0.2, 0.3, 0.4]\n";
        assert!(PeriodicTrajectory::from_toml(good).is_ok());
        for (text, line, column, words) in [
            (good.replace("= 3", "= 4"), 3, 10, "degree is 4, expected 3 or 5"),
            (good.replace("0.1, 0.2", "0.1"), 7, 5, "c of joint \"x\" has 3 values, expected at least 4"),
            (good.replace("4.0", "0.0"), 2, 12, "period_s is 0"),
            (good.replace("degree", "order"), 3, 1, "unknown field `order`"),
        ] {
            let fault = PeriodicTrajectory::from_toml(&text).unwrap_err();
            let TrajectoryError::File { line: l, column: c, message } = &fault else { panic!("{fault}") };
            assert!((*l, *c) == (line, column) && message.contains(words), "{fault} for\n{text}");
        }
    }
}
