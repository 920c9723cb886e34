//! How a command ends, and what it answers.

use std::process::ExitCode;

/// How a command ended where its input was good.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ending {
    /// Done.
    Done,
    /// The work ran, and its verdict is negative.
    Negative,
    /// Interrupted; what was finished is kept.
    Interrupted,
    /// An arm was asked to stop, and was not seen at rest.
    NotConfirmed,
}

impl Ending {
    pub(crate) fn exit_code(self) -> ExitCode {
        ExitCode::from(match self {
            Self::Done => 0,
            Self::Negative => 1,
            Self::Interrupted => 130,
            Self::NotConfirmed => 3,
        })
    }
}

/// One answer in its two forms: for a person, and for a program.
#[derive(Clone, Debug)]
pub(crate) struct Answer {
    /// Tables and sentences that read well at 100 columns.
    pub(crate) text: String,
    /// The keys of the contract.
    pub(crate) json: serde_json::Value,
}
