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

/// Joints of a robot.
pub const JOINTS: SizeLimit = SizeLimit {
    what: "joints of a robot",
    most: 40,
    unit: "",
    reason: "the reduction to base parameters takes seconds with 40 joints and minutes with 100",
};

/// Links in the file of a tree.
pub const LINKS: SizeLimit = SizeLimit {
    what: "links in a URDF or bodies in an MJCF",
    most: 5_000,
    unit: "",
    reason: "chains are searched link by link, in a time that grows with the square of their number",
};

/// Harmonics, or knots, of one joint.
pub const HARMONICS: SizeLimit = SizeLimit {
    what: "harmonics or knots of one joint",
    most: 200,
    unit: "",
    reason: "the matrix of a search grows with their square, and no arm follows so many",
};

/// Samples per second.
pub const RATE_HZ: SizeLimit = SizeLimit {
    what: "samples per second",
    most: 100_000,
    unit: " Hz",
    reason: "no joint controller is sampled faster",
};

/// One period of a motion.
pub const PERIOD_S: SizeLimit =
    SizeLimit { what: "one period of a motion", most: 100_000, unit: " s", reason: "a day has 86400 s" };

/// Samples of one period.
pub const PERIOD_SAMPLES: SizeLimit = SizeLimit {
    what: "samples of one period",
    most: 10_000_000,
    unit: "",
    reason: "a period is held in memory, with 100 bytes and more for each sample",
};

/// Samples of an experiment that goes into a file as it is performed.
pub const EXPERIMENT_SAMPLES: SizeLimit = SizeLimit {
    what: "samples of an experiment",
    most: 1_000_000_000,
    unit: "",
    reason: "a day at 10 kHz has fewer, and their recording takes 300 GB",
};

/// Samples of an experiment that is held in memory.
pub const HELD_SAMPLES: SizeLimit = SizeLimit {
    what: "samples of an experiment that is held in memory (of a study, a calibration, a CSV)",
    most: 20_000_000,
    unit: "",
    reason: "each takes 200 bytes of memory and more",
};

/// Designs of a study, or starts of a design.
pub const DESIGNS: SizeLimit = SizeLimit {
    what: "designs of a study, or starts of one design",
    most: 10_000,
    unit: "",
    reason: "each takes seconds, and all are held in memory",
};

/// Runs of a study.
pub const RUNS: SizeLimit = SizeLimit {
    what: "runs of a study: those of all designs under all conditions",
    most: 1_000_000,
    unit: "",
    reason: "each takes kilobytes on the disk, and intervals are drawn a thousand times from all of them",
};

/// Truths of a study that are drawn at random.
pub const TRUTHS: SizeLimit = SizeLimit {
    what: "truths of a study that are drawn at random",
    most: 10_000,
    unit: "",
    reason: "each is scored along all validation trajectories before the first run",
};

/// Robots of one study.
pub const ROBOTS: SizeLimit = SizeLimit {
    what: "robots of one study",
    most: 8,
    unit: "",
    reason: "each is a whole study, and no more can be told apart in a figure",
};

/// Samples on which torque predictions are tested.
pub const VALIDATION_SAMPLES: SizeLimit = SizeLimit {
    what: "samples of all validation trajectories together",
    most: 1_000_000,
    unit: "",
    reason: "their regressor is held in memory, with kilobytes for each sample",
};

/// Threads that a study may use.
pub const THREADS: SizeLimit =
    SizeLimit { what: "threads", most: 1_024, unit: "", reason: "each takes memory of its own" };

/// A text that is read whole.
pub const TEXT_BYTES: SizeLimit = SizeLimit {
    what: "a text file",
    most: 1 << 30,
    unit: " bytes",
    reason: "it is held in memory, and its values with it",
};

/// A recording that is read whole.
pub const RECORDING_BYTES: SizeLimit = SizeLimit {
    what: "a recording or a journal",
    most: 16 << 30,
    unit: " bytes",
    reason: "it is held in memory, and its samples with it",
};

/// One line of a table.
pub const LINE_BYTES: SizeLimit = SizeLimit {
    what: "one line of a CSV",
    most: 1 << 16,
    unit: " bytes",
    reason: "a thousand columns with all their digits are shorter",
};

/// Columns of a table.
pub const COLUMNS: SizeLimit = SizeLimit {
    what: "columns of a CSV",
    most: 1_000,
    unit: "",
    reason: "a robot of 40 joints has at most 161 columns, and each heading is compared with each",
};

/// The file of a collision mesh.
pub const MESH_BYTES: SizeLimit = SizeLimit {
    what: "the file of a collision mesh",
    most: 1 << 28,
    unit: " bytes",
    reason: "it is held in memory, and only the hull of its points counts",
};

/// Points of a collision mesh.
pub const MESH_POINTS: SizeLimit = SizeLimit {
    what: "points of a collision mesh",
    most: 5_000_000,
    unit: "",
    reason: "each is looked at when the hull is made",
};

/// Collision shapes of a robot.
pub const COLLISION_SHAPES: SizeLimit = SizeLimit {
    what: "collision shapes of a robot",
    most: 500,
    unit: "",
    reason: "the distance of each from each is watched along the whole motion",
};

/// Every size that an input may ask for.
pub const ALL: [SizeLimit; 21] = [
    JOINTS,
    LINKS,
    HARMONICS,
    RATE_HZ,
    PERIOD_S,
    PERIOD_SAMPLES,
    EXPERIMENT_SAMPLES,
    HELD_SAMPLES,
    DESIGNS,
    RUNS,
    TRUTHS,
    ROBOTS,
    VALIDATION_SAMPLES,
    THREADS,
    TEXT_BYTES,
    RECORDING_BYTES,
    LINE_BYTES,
    COLUMNS,
    MESH_BYTES,
    MESH_POINTS,
    COLLISION_SHAPES,
];

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
