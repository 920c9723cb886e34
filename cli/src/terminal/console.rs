//! Standard output, standard error, and who is looking.

use std::io::{ErrorKind, IsTerminal, Write};
use std::path::{Path, PathBuf};

use armid_io::Error;
use armid_io::output::{self, pretty};
use miette::Result;

use super::{Answer, Destination, GlobalArguments, Writes};

/// Where answers and messages go.
#[derive(Debug)]
pub(crate) struct Console {
    /// What was asked of every command.
    pub(crate) global: GlobalArguments,
    destination: Option<Destination>,
    terminal: bool,
}

impl Console {
    pub(crate) fn new(global: GlobalArguments) -> Self {
        Self { global, destination: None, terminal: std::io::stderr().is_terminal() }
    }

    /// This console for a command that writes so; where `-o` points is looked at here, before it works.
    pub(crate) fn writing(&self, writes: Writes) -> Result<Self> {
        let path = self.global.output.as_deref();
        let destination = path.map(|path| writes.destination(path, self.global.json)).transpose()?;
        Ok(Self { global: self.global.clone(), destination, terminal: self.terminal })
    }

    /// The file or folder that `-o` names, links followed.
    pub(crate) fn output(&self) -> Option<&Path> {
        self.destination.as_ref()?.path()
    }

    /// The file or folder that `-o` names, or another place where there is no `-o`.
    pub(crate) fn output_or<E>(&self, otherwise: impl FnOnce() -> Result<PathBuf, E>) -> Result<PathBuf, E> {
        self.output().map_or_else(otherwise, |path| Ok(path.to_path_buf()))
    }

    /// Is `-o` standard output?
    pub(crate) fn to_standard_output(&self) -> bool {
        self.destination == Some(Destination::StandardOutput)
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

    /// What went wrong, and the commands that help on, where what went wrong names none.
    pub(crate) fn fault(&self, report: &miette::Report, next_step: &str) {
        let mut errors = std::io::stderr();
        let _ = writeln!(errors, "{report:?}");
        let names_one = |text: &dyn std::fmt::Display| text.to_string().contains("`armid ");
        if !names_one(report) && !report.help().is_some_and(|help| names_one(&help)) {
            let _ = writeln!(errors, "  next: {next_step}");
        }
    }

    /// The answer of a command that makes no file of its own: `-o` writes it there instead of standard output, as JSON
    /// where the name ends in `.json`, and `-o -` is that; `--json` puts JSON on standard output in either case.
    pub(crate) fn answer(&self, answer: &Answer) -> Result<()> {
        if let Some(path) = self.output() {
            let as_json = self.global.json || path.extension().is_some_and(|extension| extension == "json");
            let text = if as_json { pretty(&answer.json) } else { answer.text.clone() };
            output::write_text(path, &text)?;
            self.note(format!("wrote {}", path.display()));
            if !self.global.json {
                return Ok(());
            }
        }
        self.print_answer(answer)
    }

    /// Where the one text of a command beside its answer goes: where `-o` says, or into the file `otherwise`.
    pub(crate) fn text_or(&self, otherwise: impl FnOnce() -> Result<PathBuf, Error>) -> Result<Destination> {
        match &self.destination {
            Some(destination) => Ok(destination.clone()),
            None => Ok(Destination::File(otherwise()?)),
        }
    }

    /// Writes the one text of a command beside its answer.
    pub(crate) fn deliver(&self, to: &Destination, text: &str) -> Result<()> {
        match to {
            Destination::StandardOutput => self.print(text),
            Destination::File(path) => Ok(output::write_text(path, text)?),
        }
    }

    /// The answer of a command whose result went into a file: to standard output, unless the result went there.
    pub(crate) fn show(&self, answer: &Answer) -> Result<()> {
        if self.to_standard_output() {
            self.note(answer.text.trim_end());
            return Ok(());
        }
        self.print_answer(answer)
    }

    /// The answer of a command whose result is JSON: it goes where `-o` says, and the answer to standard output.
    pub(crate) fn deliver_json(&self, answer: &Answer) -> Result<()> {
        if self.to_standard_output() {
            self.print(&pretty(&answer.json))?;
        }
        if let Some(path) = self.output() {
            output::write_text(path, &pretty(&answer.json))?;
            self.note(format!("wrote {}", path.display()));
        }
        self.show(answer)
    }

    fn print_answer(&self, answer: &Answer) -> Result<()> {
        if self.global.json { self.print(&pretty(&answer.json)) } else { self.print(&answer.text) }
    }

    /// Prints a text as it is. A reader that ends early (`armid … | head`) is not an error.
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
