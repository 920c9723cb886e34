//! Why a trajectory cannot be as specified.

/// Why a trajectory, or its file, cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TrajectoryError {
    /// A trajectory file is not TOML, or a key or a value is not what the format has.
    #[error("line {line}, column {column}: {message}")]
    File {
        /// Line of the fault, from one.
        line: usize,
        /// Column of the fault, from one, in characters.
        column: usize,
        /// What was found and what was expected.
        message: String,
    },
    /// The period is not a finite number above zero.
    #[error("trajectory: period is {found} s, expected a finite number above zero")]
    Period {
        /// The period, s.
        found: f64,
    },
    /// A length of a segment or of a change of speed is not a finite number above zero.
    #[error("trajectory: time is {found} s, expected a finite number above zero")]
    Time {
        /// The length, s.
        found: f64,
    },
    /// There is no joint.
    #[error("trajectory: number of joints is 0, expected at least one")]
    NoJoint,
    /// There is no segment at constant speed.
    #[error("trajectory: number of segments is 0, expected at least one")]
    NoSegment,
    /// A coefficient, position or speed is not finite.
    #[error("trajectory: a coefficient of joint \"{joint}\" is {found}, expected a finite number")]
    NotFinite {
        /// Name of the joint.
        joint: String,
        /// The number.
        found: f64,
    },
    /// A joint has another number of amplitudes than the first one.
    #[error(
        "trajectory: joint \"{joint}\" has {a} values in a and {b} in b, expected {harmonics} in each, one for each harmonic"
    )]
    Amplitudes {
        /// Name of the joint.
        joint: String,
        /// Its amplitudes a.
        a: usize,
        /// Its amplitudes b.
        b: usize,
        /// Harmonics of the first joint.
        harmonics: usize,
    },
    /// No spline of this degree is known.
    #[error("trajectory: degree is {found}, expected 3 or 5")]
    Degree {
        /// The degree.
        found: usize,
    },
    /// A joint has too few values for a spline.
    #[error(
        "trajectory: number of values of joint \"{joint}\" is {found}, expected at least {} for degree {degree}",
        degree + 1
    )]
    Knots {
        /// Name of the joint.
        joint: String,
        /// Its values, one for each knot.
        found: usize,
        /// Degree of the spline.
        degree: usize,
    },
    /// A trajectory is of another family than the one that is asked for.
    #[error("trajectory: family is another one, expected {expected}")]
    OtherFamily {
        /// Name of the family that is asked for.
        expected: &'static str,
    },
    /// A joint's series has more harmonics than are asked for.
    #[error("trajectory: number of harmonics of joint \"{joint}\" is {found}, expected at most {most}")]
    Harmonics {
        /// Name of the joint.
        joint: String,
        /// Harmonics of the trajectory.
        found: usize,
        /// Harmonics that are asked for.
        most: usize,
    },
    /// A joint has another number of coefficients than are asked for.
    #[error("trajectory: number of knots of joint \"{joint}\" is {found}, expected {expected}")]
    OtherKnots {
        /// Name of the joint.
        joint: String,
        /// Knots of the trajectory.
        found: usize,
        /// Knots that are asked for.
        expected: usize,
    },
    /// A joint has another number of speeds than there are segments.
    #[error("trajectory: joint \"{joint}\" has {found} speeds, expected {segments}, one for each segment")]
    Speeds {
        /// Name of the joint.
        joint: String,
        /// Its speeds.
        found: usize,
        /// Number of segments.
        segments: usize,
    },
    /// A joint is elsewhere after one period.
    #[error("trajectory: joint \"{joint}\" is {distance:.3e} rad (m) away after a period, expected to come back")]
    NotPeriodic {
        /// Name of the joint.
        joint: String,
        /// How far from where it began, rad (m).
        distance: f64,
    },
    /// A joint cannot reach its speed in the range that it may move in.
    #[error(
        "trajectory: range of joint \"{joint}\" is {range:.3} rad (m), expected more, to reach {speed:.3} rad/s (m/s) and \
         0.1 s at that speed"
    )]
    Range {
        /// Name of the joint.
        joint: String,
        /// Length of the range, rad (m).
        range: f64,
        /// The speed, rad/s (m/s).
        speed: f64,
    },
}
