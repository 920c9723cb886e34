//! Standard output, standard error, and who is looking.

use std::io::{ErrorKind, IsTerminal, Write};
use std::path::Path;

use armid_io::Error;
use armid_io::output::{self, pretty};
use miette::Result;

use super::{Answer, GlobalArguments};

/// Where answers and messages go.
#[derive(Debug)]
pub(crate) struct Console {
    global: GlobalArguments,
    terminal: bool,
}

impl Console {
    pub(crate) fn new(global: GlobalArguments) -> Self {
        Self { global, terminal: std::io::stderr().is_terminal() }
    }

    /// Does a program read standard output?
    pub(crate) fn json(&self) -> bool {
        self.global.json
    }

    pub(crate) fn verbose(&self) -> bool {
        self.global.verbose
    }

    /// Where `-o` points.
    pub(crate) fn output(&self) -> Option<&Path> {
        self.global.output.as_deref()
    }

    /// Is standard error a terminal, and is progress wanted?
    pub(crate) fn talks(&self) -> bool {
        self.terminal && !self.global.quiet
    }

    /// A message for the person who waits.
    pub(crate) fn note(&self, message: impl AsRef<str>) {
        if self.talks() {
            let _ = writeln!(std::io::stderr(), "{}", message.as_ref());
        }
    }

    /// A message that is printed always, under --quiet too.
    pub(crate) fn alarm(&self, message: &str) {
        let _ = writeln!(std::io::stderr(), "{message}");
    }

    /// What went wrong.
    pub(crate) fn fault(&self, report: &miette::Report) {
        let _ = writeln!(std::io::stderr(), "{report:?}");
    }

    /// The answer of a command that makes no file of its own: `-o` writes it there instead of standard output, as JSON
    /// where the name ends in `.json`; `--json` puts JSON on standard output in either case.
    pub(crate) fn answer(&self, answer: &Answer) -> Result<()> {
        if let Some(path) = self.output() {
            let as_json = self.json() || path.extension().is_some_and(|extension| extension == "json");
            let text = if as_json { pretty(&answer.json) } else { answer.text.clone() };
            output::write_text(path, &text)?;
            self.note(format!("wrote {}", path.display()));
            if !self.json() {
                return Ok(());
            }
        }
        self.show(answer)
    }

    /// The answer of a command whose result went into a file: to standard output, also with `-o`.
    pub(crate) fn show(&self, answer: &Answer) -> Result<()> {
        if self.json() { self.print(&pretty(&answer.json)) } else { self.print(&answer.text) }
    }

    /// Prints a text as it is. That nobody reads on (`armid … | head`) is no fault.
    pub(crate) fn print(&self, text: &str) -> Result<()> {
        let mut out = std::io::stdout().lock();
        match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => {
                Err(Error::new(format!("standard output cannot be written: {error}")).into())
            }
            _ => Ok(()),
        }
    }
}
