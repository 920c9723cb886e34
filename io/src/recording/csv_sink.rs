//! Recordings as CSV.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use armid::experiment::{Ending, Flow, RawSample, Recording, Sink};

use super::{FileSink, check_free, part_path};
use crate::error::Error;
use crate::log::write_csv;
use crate::output;

/// Keeps the samples and writes them as CSV.
pub struct CsvSink<'a> {
    path: PathBuf,
    recording: Option<Recording>,
    on_sample: Box<dyn FnMut(usize) + Send + 'a>,
    asked_to_stop: fn() -> bool,
}

impl<'a> CsvSink<'a> {
    /// A sink that writes `path`; `on_sample` gets the number of samples so far.
    pub fn new(path: &Path, on_sample: impl FnMut(usize) + Send + 'a) -> Self {
        Self { path: path.to_path_buf(), recording: None, on_sample: Box::new(on_sample), asked_to_stop: || false }
    }

    /// Returns this sink, which stops the experiment when `asked` says so.
    #[must_use]
    pub fn stopping_when(self, asked: fn() -> bool) -> Self {
        Self { asked_to_stop: asked, ..self }
    }

    fn flow(&self) -> Flow {
        if (self.asked_to_stop)() { Flow::Stop } else { Flow::Continue }
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
        self.flow()
    }

    fn idle(&mut self, _: f64) -> Flow {
        self.flow()
    }
}

impl FileSink for CsvSink<'_> {
    fn finish(self: Box<Self>, ending: &Ending, _: BTreeMap<String, String>) -> Result<PathBuf, Error> {
        let Some(recording) = &self.recording else {
            return Err(Error::new("the arm never began a recording"));
        };
        let path = if ending.is_complete() {
            self.path.clone()
        } else {
            check_free(&self.path)?;
            part_path(&self.path)
        };
        output::write_text(&path, &write_csv(recording))?;
        Ok(path)
    }
}
