//! Why a record cannot be processed.

/// Why a record cannot be turned into samples.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SignalError {
    /// A series has another length than the layout of the record asks for.
    #[error("{quantity}: {found} values, expected a multiple of {block} ({of}), at least {least}")]
    Length {
        /// Which series.
        quantity: &'static str,
        /// What was found.
        found: usize,
        /// What the layout asks for whole multiples of.
        block: usize,
        /// What such a block is.
        of: &'static str,
        /// Fewest values that can be processed.
        least: usize,
    },
    /// A series has not as many values as another.
    #[error("{quantity}: {found} values, expected {expected}, as many as {other}")]
    Unequal {
        /// Which series.
        quantity: &'static str,
        /// What was found.
        found: usize,
        /// Which other series.
        other: &'static str,
        /// Its values.
        expected: usize,
    },
    /// A value is NaN or infinite.
    #[error("{quantity} of joint {joint}: sample {sample} is {value}, expected a finite number")]
    NotFinite {
        /// Which series.
        quantity: &'static str,
        /// Joint, from one.
        joint: usize,
        /// Sample, from zero.
        sample: usize,
        /// What was found.
        value: f64,
    },
    /// A period is not a whole number of samples.
    #[error("a period of {period_s} s at {rate_hz} Hz is {found} samples, expected a whole number of at least {least}")]
    PeriodSamples {
        /// Period, s.
        period_s: f64,
        /// Sampling rate, Hz.
        rate_hz: f64,
        /// Samples in one period.
        found: f64,
        /// Fewest samples that can be processed.
        least: usize,
    },
    /// Too few samples per period are wanted.
    #[error("{found} samples per period wanted, expected at least {least}")]
    TooFewSamples {
        /// What was wanted.
        found: usize,
        /// The fewest that can be processed.
        least: usize,
    },
    /// The record cannot be thinned to the wanted number of samples.
    #[error(
        "{found} samples per period wanted, expected at least {least} for the commanded harmonics, from a divisor of {of}"
    )]
    Decimation {
        /// What was wanted.
        found: usize,
        /// Fewest samples that show the commanded harmonics.
        least: usize,
        /// Samples of one recorded period.
        of: usize,
    },
    /// A cut-off frequency outside what the sampling rate allows.
    #[error("cut-off frequency is {found} Hz, expected above 0 and below half the sampling rate, {nyquist} Hz")]
    Cutoff {
        /// What was wanted, Hz.
        found: f64,
        /// Half the sampling rate, Hz.
        nyquist: f64,
    },
    /// A setting has a value that makes no sense.
    #[error("{setting} is {found}, expected {expected}")]
    Setting {
        /// Which setting.
        setting: &'static str,
        /// What was found.
        found: String,
        /// What is possible.
        expected: &'static str,
    },
    /// No period was recorded to its end.
    #[error("{found} samples were recorded, expected at least the {expected} of one period")]
    NoPeriods {
        /// Samples of the recorded phase.
        found: usize,
        /// Samples in one period.
        expected: usize,
    },
    /// No experiment to join.
    #[error("no experiment, expected at least one")]
    NoExperiment,
    /// Experiments whose efforts have other units, or other numbers of joints.
    #[error("joints: found efforts in {}, expected {} as in the first experiment", found.join(" "), first.join(" "))]
    JointUnits {
        /// What was found, one for each joint.
        found: Vec<String>,
        /// What the first one has.
        first: Vec<String>,
    },
    /// Experiments at other rates.
    #[error("sampling rate: found {found} Hz, expected {first} Hz as in the first experiment")]
    Rates {
        /// What was found, Hz.
        found: f64,
        /// What the first one has, Hz.
        first: f64,
    },
    /// Experiments in other blocks.
    #[error("samples in a block: found {found}, expected {first} as in the first experiment")]
    Blocks {
        /// What was found.
        found: usize,
        /// What the first one has.
        first: usize,
    },
    /// The record belongs to another robot.
    #[error("the record has {found} joints, the robot has {expected}")]
    Joints {
        /// Joints in the record.
        found: usize,
        /// Joints of the robot.
        expected: usize,
    },
}

/// Checks that every value of a row-major series is a finite number.
pub(super) fn check_finite(quantity: &'static str, values: &[f64], dof: usize) -> Result<(), SignalError> {
    match values.iter().position(|value| !value.is_finite()) {
        Some(at) => Err(SignalError::NotFinite { quantity, joint: at % dof + 1, sample: at / dof, value: values[at] }),
        None => Ok(()),
    }
}
