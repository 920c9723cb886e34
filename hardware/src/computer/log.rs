//! What the robot controller commanded and did, step by step, in a file that is complete up to its last line at any time.

use std::fmt::Write as _;
use std::fs::File;
use std::io::Write as _;
use std::path::Path;

use super::Report;

/// A CSV with one line for each servo step: `t,doing,command1..n,current1..n,q1..n,event`. Commands are empty while the
/// motors are off. Each line is written at once, so that anything that kills the process leaves all lines before.
pub struct StepLog {
    file: Option<File>,
    line: String,
    dof: usize,
    fault: Option<std::io::Error>,
}

impl StepLog {
    /// A log in `path`, or none.
    ///
    /// # Errors
    /// Where the file cannot be made.
    pub fn create(path: Option<&Path>, dof: usize) -> std::io::Result<Self> {
        let file = path.map(File::create).transpose()?;
        let mut log = Self { file, line: String::with_capacity(512), dof, fault: None };
        log.line.push_str("t,doing");
        for column in ["command", "current", "q"] {
            for j in 1..=dof {
                let _ = write!(log.line, ",{column}{j}");
            }
        }
        log.line.push_str(",event\n");
        log.flush();
        Ok(log)
    }

    /// Writes one step.
    pub fn write(&mut self, report: &Report<'_>) {
        if self.file.is_none() {
            return;
        }
        self.line.clear();
        // Writing into a String cannot fail.
        let _ = write!(self.line, "{:.6},{}", report.t, report.doing);
        for list in [report.command, report.current, report.q] {
            for j in 0..self.dof {
                let _ = match list.get(j) {
                    Some(value) => write!(self.line, ",{value:.6}"),
                    None => write!(self.line, ","),
                };
            }
        }
        let _ = writeln!(self.line, ",\"{}\"", report.event.replace('"', "'"));
        self.flush();
    }

    fn flush(&mut self) {
        if let Some(file) = &mut self.file
            && let Err(error) = file.write_all(self.line.as_bytes())
        {
            self.fault = Some(error);
            self.file = None;
        }
    }

    /// Why nothing is written any more, if that is so.
    pub fn fault(&self) -> Option<&std::io::Error> {
        self.fault.as_ref()
    }
}
