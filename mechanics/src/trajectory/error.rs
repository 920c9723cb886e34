//! Why a trajectory cannot be as specified.

/// Why a trajectory, or its file, cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum TrajectoryError {
    /// A trajectory file is not TOML, or a key or a value is not what the format has.
    #[error("line {line}, column {column}: {message}")]
    File { line: usize, column: usize, message: String },
    /// The period is not a finite number above zero.
    #[error("trajectory: period is {found} s, expected a finite number above zero")]
    Period { found: f64 },
    /// A length of a segment or of a change of speed is not a finite number above zero.
    #[error("trajectory: time is {found} s, expected a finite number above zero")]
    Time { found: f64 },
    /// There is no joint.
    #[error("trajectory: number of joints is 0, expected at least one")]
    NoJoint,
    /// There is no segment at constant speed.
    #[error("trajectory: number of segments is 0, expected at least one")]
    NoSegment,
    /// A coefficient, position or speed is not finite.
    #[error("trajectory: a coefficient of joint \"{joint}\" is {found}, expected a finite number")]
    NotFinite { joint: String, found: f64 },
    /// A joint has another number of amplitudes than the first one.
    #[error(
        "trajectory: joint \"{joint}\" has {a} values in a and {b} in b, expected {harmonics} in each, one for each harmonic"
    )]
    Amplitudes { joint: String, a: usize, b: usize, harmonics: usize },
    /// No spline of this degree is known.
    #[error("trajectory: degree is {found}, expected 3 or 5")]
    Degree { found: usize },
    /// A joint has too few values for a spline.
    #[error(
        "trajectory: number of values of joint \"{joint}\" is {found}, expected at least {} for degree {degree}",
        degree + 1
    )]
    Knots { joint: String, found: usize, degree: usize },
    /// A trajectory is of another family than the one that is asked for.
    #[error("trajectory: family is another one, expected {expected}")]
    OtherFamily { expected: &'static str },
    /// A joint's series has more harmonics than are asked for.
    #[error("trajectory: number of harmonics of joint \"{joint}\" is {found}, expected at most {most}")]
    Harmonics { joint: String, found: usize, most: usize },
    /// A joint has another number of coefficients than are asked for.
    #[error("trajectory: number of knots of joint \"{joint}\" is {found}, expected {expected}")]
    OtherKnots { joint: String, found: usize, expected: usize },
    /// A joint has another number of speeds than there are segments.
    #[error("trajectory: joint \"{joint}\" has {found} speeds, expected {segments}, one for each segment")]
    Speeds { joint: String, found: usize, segments: usize },
    /// A joint is elsewhere after one period.
    #[error("trajectory: joint \"{joint}\" is {distance:.3e} rad (m) away after a period, expected to come back")]
    NotPeriodic { joint: String, distance: f64 },
    /// A joint cannot reach its speed in the range that it may move in.
    #[error(
        "trajectory: range of joint \"{joint}\" is {range:.3} rad (m), expected more, to reach {speed:.3} rad/s (m/s) and \
         0.1 s at that speed"
    )]
    Range { joint: String, range: f64, speed: f64 },
}
