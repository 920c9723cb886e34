//! A sink that panics: what a defect of armid itself does to an arm, tried by `scripts/faults` in builds for tests alone.

use armid::experiment::{Flow, RawSample, Recording, Sink};

/// Hands everything on, and panics at a state.
pub(crate) struct Failing<'a> {
    sink: &'a mut dyn Sink,
    left: usize,
}

impl<'a> Failing<'a> {
    /// Panics after so many states, of the approach and of the experiment.
    pub(crate) fn new(sink: &'a mut dyn Sink, states: usize) -> Self {
        Self { sink, left: states }
    }

    fn count(&mut self) {
        self.left = self.left.checked_sub(1).expect("a panic, as --panic-after asks for");
    }
}

impl Sink for Failing<'_> {
    fn begin(&mut self, recording: &Recording) {
        self.sink.begin(recording);
    }

    fn sample(&mut self, sample: &RawSample<'_>) -> Flow {
        self.count();
        self.sink.sample(sample)
    }

    fn unrecorded(&mut self, sample: &RawSample<'_>) -> Flow {
        self.count();
        self.sink.unrecorded(sample)
    }

    fn idle(&mut self, age_s: f64) -> Flow {
        self.sink.idle(age_s)
    }

    fn command(&mut self, set_point: &[f64], age_s: f64) -> Flow {
        self.sink.command(set_point, age_s)
    }
}
