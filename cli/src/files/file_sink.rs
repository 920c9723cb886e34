//! Sinks that end as a file.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use armid::experiment::{Ending, Flow, RawSample, Recording, Sink};
use miette::Result;

use super::recording_csv;
use super::recording_mcap::part_of;
use crate::atomic_file;
use crate::fault::Fault;
use crate::interrupt;

/// A sink whose samples end in a file.
pub(crate) trait FileSink: Sink + Send {
    /// Completes the file. It takes its name where the experiment was completed, and ends in `.part` otherwise.
    /// `remarks` are what is known only now and goes into the file beside its ending. Returns where it is.
    fn finish(self: Box<Self>, ending: &Ending, remarks: BTreeMap<String, String>) -> Result<PathBuf>;
}

/// Keeps the samples and writes them as CSV.
pub(crate) struct CsvSink<'a> {
    path: PathBuf,
    recording: Option<Recording>,
    on_sample: Box<dyn FnMut(usize) + Send + 'a>,
}

impl<'a> CsvSink<'a> {
    /// A sink that writes `path`; `on_sample` hears how many samples there are.
    pub(crate) fn new(path: &Path, on_sample: impl FnMut(usize) + Send + 'a) -> Self {
        Self { path: path.to_path_buf(), recording: None, on_sample: Box::new(on_sample) }
    }
}

impl Sink for CsvSink<'_> {
    fn begin(&mut self, recording: &Recording) {
        self.recording = Some(recording.clone());
    }

    fn sample(&mut self, sample: &RawSample<'_>) -> Flow {
        if let Some(recording) = &mut self.recording {
            recording.push(sample);
            (self.on_sample)(recording.len());
        }
        if interrupt::asked() { Flow::Stop } else { Flow::Continue }
    }

    fn idle(&mut self, _: f64) -> Flow {
        if interrupt::asked() { Flow::Stop } else { Flow::Continue }
    }
}

impl FileSink for CsvSink<'_> {
    fn finish(self: Box<Self>, ending: &Ending, _: BTreeMap<String, String>) -> Result<PathBuf> {
        let Some(recording) = &self.recording else {
            return Err(Fault::new("the arm never began a recording").into());
        };
        let path = if ending.is_complete() { self.path.clone() } else { part_of(&self.path) };
        atomic_file::write_text(&path, &recording_csv::write(recording))?;
        Ok(path)
    }
}
