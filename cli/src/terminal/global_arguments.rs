//! What every command takes.

use std::path::PathBuf;

/// What every command takes.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct GlobalArguments {
    /// Print the answer as JSON, and nothing else, on standard output
    #[arg(long, global = true, help_heading = "Output")]
    pub(crate) json: bool,
    /// No messages and no progress bars
    #[arg(short, long, global = true, conflicts_with = "verbose", help_heading = "Output")]
    pub(crate) quiet: bool,
    /// More detail
    #[arg(short, long, global = true, help_heading = "Output")]
    pub(crate) verbose: bool,
    /// Output file or folder, or - for standard output
    #[arg(short, long, global = true, value_name = "PATH", help_heading = "Output")]
    pub(crate) output: Option<PathBuf>,
}
