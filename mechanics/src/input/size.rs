//! Every size that an input may ask for, each with its reason.

/// A size that an input may ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SizeLimit {
    /// Of what.
    pub what: &'static str,
    /// The most that is allowed.
    pub most: u64,
    /// Its unit, with a space before it; nothing for a number of things.
    pub unit: &'static str,
    /// Why not more.
    pub reason: &'static str,
}

/// An input asks for more than is allowed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{key} is {}{}, expected at most {}{}: {}", shown(*.found), limit.unit, limit.most, limit.unit, limit.reason)]
pub struct SizeError {
    /// What the input calls it.
    pub key: String,
    /// What was asked for.
    pub found: f64,
    /// What is allowed.
    pub limit: SizeLimit,
}

macro_rules! limits {
    ($($name:ident: $most:expr, $unit:literal, $what:literal, $reason:literal;)*) => {
        $(#[doc = concat!("What is allowed of ", $what, ".")]
        pub const $name: SizeLimit = SizeLimit { what: $what, most: $most, unit: $unit, reason: $reason };)*

        /// Every size that an input may ask for.
        pub const ALL: [SizeLimit; [$(stringify!($name)),*].len()] = [$($name),*];
    };
}

limits! {
    JOINTS: 100, "", "joints of a robot", "the reduction to base parameters takes seconds with 100 joints and minutes with several hundred";
    LINKS: 5_000, "", "links in a URDF or bodies in an MJCF",
        "chains are searched link by link, in a time that grows with the square of their number";
    HARMONICS: 200, "", "harmonics or knots of one joint",
        "the matrix of a search grows with their square, and no arm follows so many";
    RATE_HZ: 100_000, " Hz", "samples per second", "no joint controller is sampled faster";
    PERIOD_S: 100_000, " s", "one period of a motion", "a day has 86400 s";
    PERIOD_SAMPLES: 10_000_000, "", "samples of one period", "a period is held in memory, with 100 bytes and more for each sample";
    EXPERIMENT_SAMPLES: 1_000_000_000, "", "samples of an experiment",
        "a day at 10 kHz has fewer, and their recording takes 300 GB";
    HELD_SAMPLES: 20_000_000, "", "samples of an experiment that is held in memory (of a study, a calibration, a CSV)",
        "each takes 200 bytes of memory and more";
    DESIGNS: 10_000, "", "designs of a study, or starts of one design", "each takes seconds, and all are held in memory";
    RUNS: 1_000_000, "", "runs of a study: those of all designs under all conditions",
        "each takes kilobytes on the disk, and intervals are drawn a thousand times from all of them";
    TRUTHS: 10_000, "", "truths of a study that are drawn at random",
        "each is scored along all validation trajectories before the first run";
    ROBOTS: 8, "", "robots of one study", "each is a whole study, and no more can be told apart in a figure";
    VALIDATION_SAMPLES: 1_000_000, "", "samples of all validation trajectories together",
        "their regressor is held in memory, with kilobytes for each sample";
    THREADS: 1_024, "", "threads", "each takes memory of its own";
    TEXT_BYTES: 1 << 30, " bytes", "a text file", "it is held in memory, and its values with it";
    RECORDING_BYTES: 16 << 30, " bytes", "a recording or a journal", "it is held in memory, and its samples with it";
    LINE_BYTES: 1 << 16, " bytes", "one line of a CSV", "a thousand columns with all their digits are shorter";
    COLUMNS: 1_000, "", "columns of a CSV", "a robot of 100 joints has at most 401 columns, and each heading is compared with each";
    MESH_BYTES: 1 << 28, " bytes", "the file of a collision mesh", "it is held in memory, and only the hull of its points counts";
    MESH_POINTS: 5_000_000, "", "points of a collision mesh", "each is looked at when the hull is made";
    COLLISION_SHAPES: 500, "", "collision shapes of a robot", "the distance of each from each is watched along the whole motion";
}

impl SizeLimit {
    /// Checks what an input asks for under a key; what is no number is too large.
    ///
    /// # Errors
    /// [`SizeError`] with what was found, what is allowed and why.
    pub fn check(&self, key: &str, found: f64) -> Result<(), SizeError> {
        if found <= self.most as f64 { Ok(()) } else { Err(SizeError { key: key.to_owned(), found, limit: *self }) }
    }

    /// Checks a number of things.
    ///
    /// # Errors
    /// As [`SizeLimit::check`].
    pub fn check_count(&self, key: &str, found: usize) -> Result<(), SizeError> {
        self.check(key, found as f64)
    }
}

/// A number with its digits where there are not too many of them.
fn shown(found: f64) -> String {
    if found.abs() < 1e16 { found.to_string() } else { format!("{found:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_too_large_is_stated_with_the_limit_and_its_reason() {
        assert_eq!(RATE_HZ.check("rate_hz", 1e5), Ok(()));
        assert_eq!(
            RATE_HZ.check("rate_hz", 1e9).unwrap_err().to_string(),
            "rate_hz is 1000000000 Hz, expected at most 100000 Hz: no joint controller is sampled faster"
        );
        assert!(RUNS.check_count("runs", usize::MAX).unwrap_err().to_string().contains("1.8446744073709552e19"));
        assert!(RUNS.check("runs", f64::NAN).is_err() && RUNS.check("runs", f64::INFINITY).is_err());
    }

    #[test]
    fn every_limit_says_of_what_and_why() {
        for (i, limit) in ALL.iter().enumerate() {
            assert!(limit.most > 0 && !limit.what.is_empty() && !limit.reason.is_empty(), "{limit:?}");
            assert!(ALL[..i].iter().all(|other| other.what != limit.what), "{limit:?} is there twice");
        }
    }
}
