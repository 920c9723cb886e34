//! How fast a motion is performed, and what a real arm must have done before it may be faster.

use std::path::{Path, PathBuf};

use armid_io::Error;
use armid_io::recording::Notes;
use miette::Result;

use super::Experiment;

/// Part of a limit that a slower motion uses: the rest is for the servo and the encoders.
const REDUCED: f64 = 0.9;

/// A part of the speed that a motion was designed for.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub(crate) struct Speed(f64);

impl Speed {
    pub(crate) const FULL: Self = Self(1.0);

    /// The steps of a first run, in order: each needs a recording of the one before.
    pub(crate) const STEPS: [Self; 3] = [Self(0.1), Self(0.5), Self(1.0)];

    pub(crate) const fn part(self) -> f64 {
        self.0
    }

    /// This speed, or as much of it as is needed to stay below a limit where the designed speed is at `used` of it.
    pub(crate) fn below(self, used: f64) -> Self {
        if used * self.0 > REDUCED { Self(REDUCED / used) } else { self }
    }

    /// This speed, or the next below it at which a period of `period_s`, whole at `rate_hz`, stays a whole number of
    /// samples when it is slowed. A period that is not whole is left for the plan to refuse.
    pub(crate) fn in_whole_samples(self, period_s: f64, rate_hz: f64) -> Self {
        let (designed, slowed) = (period_s * rate_hz, period_s * rate_hz / self.0);
        let is_whole = |samples: f64| (samples - samples.round()).abs() <= 1e-9 * samples;
        if !is_whole(designed) || is_whole(slowed) { self } else { Self(designed.round() / slowed.ceil()) }
    }

    /// The speed up to which a real arm must have performed this motion before.
    pub(crate) fn needs(self) -> Option<Self> {
        Self::STEPS.into_iter().rev().find(|step| *step < self)
    }
}

impl std::fmt::Display for Speed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} %", (1e4 * self.0).round() / 1e2)
    }
}

impl std::str::FromStr for Speed {
    type Err = String;

    /// `10%`, `10 %` or `0.1`.
    fn from_str(text: &str) -> Result<Self, String> {
        let (number, scale) = text.trim().strip_suffix('%').map_or((text.trim(), 1.0), |number| (number.trim(), 100.0));
        let part = number.parse::<f64>().map(|number| number / scale);
        match part {
            Ok(part) if part > 0.0 && part <= 1.0 => Ok(Self(part)),
            _ => Err(format!("\"{text}\", expected a part of the designed speed, such as 10% or 0.1, at most 100%")),
        }
    }
}

/// Where the recording of one step of a first run goes: `R-10.mcap` for `R.mcap`, and `R.mcap` itself at full speed.
pub(crate) fn step_path(path: &Path, speed: Speed) -> PathBuf {
    if speed == Speed::FULL {
        return path.to_path_buf();
    }
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let ending = path.extension().map(|ending| format!(".{}", ending.to_string_lossy())).unwrap_or_default();
    path.with_file_name(format!("{stem}-{:.0}{ending}", 100.0 * speed.part()))
}

/// A real arm may go at this speed: it performed the same motion before, at the step below.
pub(crate) fn check_earlier(experiment: &Experiment, speed: Speed, motion: &str, earlier: &[PathBuf]) -> Result<()> {
    let Some(needed) = speed.needs() else { return Ok(()) };
    let mut reasons = Vec::new();
    for path in earlier {
        match objection(&Notes::read(path)?, experiment, needed, motion) {
            None => return Ok(()),
            Some(reason) => reasons.push(format!("{}: {reason}", path.display())),
        }
    }
    let mut message =
        format!("{speed} of the speed needs an earlier run of this motion on this arm at {needed} or more");
    if !reasons.is_empty() {
        message = format!("{message}; {}", reasons.join("; "));
    }
    let help = "--first-run does 10 %, 50 % and 100 % in order; --earlier R.mcap names a run that was done";
    Err(Error::new(message).help(help).into())
}

/// Why a recording does not show that a real arm performed a motion at `needed` or more.
fn objection(notes: &Notes, experiment: &Experiment, needed: Speed, motion: &str) -> Option<String> {
    let note = |key: &str| notes.beginning.get(key).map(String::as_str);
    let speed = note("speed").and_then(|speed| speed.parse::<f64>().ok()).filter(|speed| speed.is_finite());
    if note("arm") != Some(experiment.arm.name()) {
        Some(format!("was recorded on arm {}", note("arm").unwrap_or("unknown")))
    } else if !notes.is_complete() {
        Some("was not completed".to_owned())
    } else if note("robot_file") != Some(experiment.planned.robot.text.content.as_ref()) {
        Some("is of another robot file".to_owned())
    } else if note("motion") != Some(motion) {
        Some("is of another motion".to_owned())
    } else {
        match speed {
            // A recording that does not state its speed does not count.
            None => Some("does not state its speed".to_owned()),
            Some(speed) if speed < needed.part() - 1e-9 => Some(format!("went at {} %", 100.0 * speed)),
            Some(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arms::ArmKind;

    #[test]
    fn speeds_are_read_and_shown() {
        for (text, part) in [("10%", 0.1), ("50 %", 0.5), ("0.25", 0.25), ("100%", 1.0)] {
            assert_eq!(text.parse::<Speed>().unwrap().part(), part);
        }
        for text in ["0", "110%", "fast", "-1", "nan", ""] {
            assert!(text.parse::<Speed>().is_err(), "{text}");
        }
        assert_eq!((Speed(0.1).to_string(), Speed::FULL.to_string()), ("10 %".to_owned(), "100 %".to_owned()));
    }

    #[test]
    fn analytic_each_speed_needs_the_step_below() {
        for (speed, needed) in
            [(0.05, None), (0.1, None), (0.3, Some(0.1)), (0.5, Some(0.1)), (0.6, Some(0.5)), (1.0, Some(0.5))]
        {
            assert_eq!(Speed(speed).needs(), needed.map(Speed), "{speed}");
        }
    }

    #[test]
    fn analytic_a_slowed_period_is_rounded_up_to_whole_samples() {
        // 10 s at 1 kHz and 30 %: 33333.3 samples become 33334.
        let speed = Speed(0.3).in_whole_samples(10.0, 1000.0);
        assert!((speed.part() - 10_000.0 / 33_334.0).abs() < 1e-15 && speed < Speed(0.3));
        for part in [0.1, 0.25, 0.5, 1.0] {
            assert_eq!(Speed(part).in_whole_samples(10.0, 1000.0).part().to_bits(), part.to_bits());
        }
        // The plan says what is wrong with a period of 1000.5 samples.
        assert_eq!(Speed(0.3).in_whole_samples(1.0005, 1000.0), Speed(0.3));
    }

    #[test]
    fn a_recording_that_does_not_say_its_speed_is_no_permission() {
        let mut experiment = Experiment::load("00-paper").unwrap();
        experiment.arm = ArmKind::Ros2;
        let robot = experiment.planned.robot.text.content.to_string();
        let with = |speed: Option<&str>| {
            let mut notes = Notes::default();
            for (key, value) in [("arm", "ros2"), ("robot_file", robot.as_str()), ("motion", "M")] {
                notes.beginning.insert(key.to_owned(), value.to_owned());
            }
            speed.map(|speed| notes.beginning.insert("speed".to_owned(), speed.to_owned()));
            notes.ending.insert("ending".to_owned(), "completed".to_owned());
            objection(&notes, &experiment, Speed(0.1), "M")
        };
        assert_eq!(with(Some("0.1")), None);
        for silent in [None, Some("nan"), Some("fast")] {
            assert_eq!(with(silent).as_deref(), Some("does not state its speed"), "{silent:?}");
        }
        assert_eq!(with(Some("0.05")).as_deref(), Some("went at 5 %"));
    }

    #[test]
    fn steps_are_recorded_side_by_side() {
        let path = Path::new("out/R.mcap");
        assert_eq!(step_path(path, Speed(0.1)), Path::new("out/R-10.mcap"));
        assert_eq!(step_path(path, Speed::FULL), path);
        assert_eq!(step_path(Path::new("R"), Speed(0.5)), Path::new("R-50"));
    }
}
