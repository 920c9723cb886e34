//! Why a record cannot be processed.

/// Why a record cannot be turned into samples.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum SignalError {
    /// A series has another length than the layout of the record asks for.
    #[error("{quantity}: {found} values, expected a multiple of {block} ({of}), at least {least}")]
    Length { quantity: &'static str, found: usize, block: usize, of: &'static str, least: usize },
    /// A series has not as many values as another.
    #[error("{quantity}: {found} values, expected {expected}, as many as {other}")]
    Unequal { quantity: &'static str, found: usize, other: &'static str, expected: usize },
    /// A value is NaN or infinite.
    #[error("{quantity} of joint {joint}: sample {sample} is {value}, expected a finite number")]
    NotFinite { quantity: &'static str, joint: usize, sample: usize, value: f64 },
    /// A period is not a whole number of samples.
    #[error("a period of {period_s} s at {rate_hz} Hz is {found} samples, expected a whole number of at least {least}")]
    PeriodSamples { period_s: f64, rate_hz: f64, found: f64, least: usize },
    /// Too few samples per period are wanted.
    #[error("{found} samples per period wanted, expected at least {least}")]
    TooFewSamples { found: usize, least: usize },
    /// The record cannot be thinned to the wanted number of samples.
    #[error(
        "{found} samples per period wanted, expected at least {least} for the commanded harmonics, from a divisor of {of}"
    )]
    Decimation { found: usize, least: usize, of: usize },
    /// A cut-off frequency outside what the sampling rate allows.
    #[error("cut-off frequency is {found} Hz, expected above 0 and below half the sampling rate, {nyquist} Hz")]
    Cutoff { found: f64, nyquist: f64 },
    /// A setting has a value that makes no sense.
    #[error("{setting} is {found}, expected {expected}")]
    Setting { setting: &'static str, found: String, expected: &'static str },
    /// No period was recorded to its end.
    #[error("{found} samples were recorded, expected at least the {expected} of one period")]
    NoPeriods { found: usize, expected: usize },
    /// No experiment to join.
    #[error("no experiment, expected at least one")]
    NoExperiment,
    /// Experiments whose efforts have other units, or other numbers of joints.
    #[error("joints: found efforts in {}, expected {} as in the first experiment", found.join(" "), first.join(" "))]
    JointUnits { found: Vec<String>, first: Vec<String> },
    /// Experiments at other rates.
    #[error("sampling rate: found {found} Hz, expected {first} Hz as in the first experiment")]
    Rates { found: f64, first: f64 },
    /// Experiments in other blocks.
    #[error("samples in a block: found {found}, expected {first} as in the first experiment")]
    Blocks { found: usize, first: usize },
    /// The record belongs to another robot.
    #[error("the record has {found} joints, the robot has {expected}")]
    Joints { found: usize, expected: usize },
}

/// What is found of a setting is outside of what it may be.
pub(super) fn refused<T>(
    setting: &'static str,
    found: impl ToString,
    expected: &'static str,
) -> Result<T, SignalError> {
    Err(SignalError::Setting { setting, found: found.to_string(), expected })
}

/// Checks that every value of a row-major series is a finite number.
pub(super) fn check_finite(quantity: &'static str, values: &[f64], dof: usize) -> Result<(), SignalError> {
    // Nearly always all are, which is found without a branch at each.
    let all = values.chunks(64).all(|some| some.iter().fold(true, |all, value| all & value.is_finite()));
    match (!all).then(|| values.iter().position(|value| !value.is_finite())).flatten() {
        Some(at) => Err(SignalError::NotFinite { quantity, joint: at % dof + 1, sample: at / dof, value: values[at] }),
        None => Ok(()),
    }
}
