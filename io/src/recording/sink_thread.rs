//! A sink on a thread of its own: a slow disk must not delay the guard of an arm.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};

use armid::experiment::{Flow, Phase, RawSample, Recording, Sink};

use crate::error::Error;

/// How far a sink may fall behind before it is waited for: two minutes at 500 Hz.
const BEHIND: usize = 1 << 16;

/// Does `work` with a sink that passes on what it receives and does not wait; `sink` takes it on another thread, and has taken
/// all of it when this returns. Where `sink` wants to stop, or `asked` says so, one of the next samples is answered so.
///
/// Returns what `work` gave, and the error where `sink` panicked: the work was asked to stop then, like any other time, and what
/// it has to say of the arm is not lost.
pub fn with_sink_thread<T>(
    sink: &mut (impl Sink + Send + ?Sized),
    asked: fn() -> bool,
    work: impl FnOnce(&mut dyn Sink) -> T,
) -> (T, Result<(), Error>) {
    let (sender, received) = sync_channel(BEHIND);
    let stop = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let wants = &stop;
        let taker = scope.spawn(move || {
            for received in received {
                let flow = match received {
                    Received::Begin(recording) => {
                        sink.begin(&recording);
                        Flow::Continue
                    }
                    Received::Sample(sample) => sink.sample(&sample.view()),
                };
                if flow.ends() {
                    wants.store(true, Ordering::Relaxed);
                }
            }
        });
        // Once it is dropped, the thread has received everything.
        let done = work(&mut Relay { sender, stop: &stop, asked });
        let taken = taker.join().map_err(|_| Error::new("the thread that writes the recording has panicked"));
        (done, taken)
    })
}

enum Received {
    Begin(Box<Recording>),
    Sample(OwnSample),
}

/// A sample that owns its values.
struct OwnSample {
    index: usize,
    t: f64,
    phase: Phase,
    q: Vec<f64>,
    effort: Vec<f64>,
    voltage: Vec<f64>,
    link_q: Vec<f64>,
    command: Vec<f64>,
}

impl OwnSample {
    fn of(sample: &RawSample<'_>) -> Self {
        Self {
            index: sample.index,
            t: sample.t,
            phase: sample.phase,
            q: sample.q.to_vec(),
            effort: sample.effort.to_vec(),
            voltage: sample.voltage.to_vec(),
            link_q: sample.link_q.to_vec(),
            command: sample.command.to_vec(),
        }
    }

    fn view(&self) -> RawSample<'_> {
        let Self { index, t, phase, q, effort, voltage, link_q, command } = self;
        RawSample { index: *index, t: *t, phase: *phase, q, effort, voltage, link_q, command }
    }
}

struct Relay<'a> {
    sender: SyncSender<Received>,
    stop: &'a AtomicBool,
    asked: fn() -> bool,
}

impl Relay<'_> {
    fn flow(&self) -> Flow {
        if self.stop.load(Ordering::Relaxed) || (self.asked)() { Flow::Stop } else { Flow::Continue }
    }
}

impl Sink for Relay<'_> {
    fn begin(&mut self, recording: &Recording) {
        // The next sample shows whether the thread is gone.
        let _ = self.sender.send(Received::Begin(Box::new(recording.clone())));
    }

    fn sample(&mut self, sample: &RawSample<'_>) -> Flow {
        match self.sender.send(Received::Sample(OwnSample::of(sample))) {
            Ok(()) => self.flow(),
            Err(_) => Flow::Stop,
        }
    }

    fn idle(&mut self, _: f64) -> Flow {
        self.flow()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Receiver, channel};

    use super::*;

    /// A disk that takes nothing before it is released, and is full after `room` samples.
    struct Disk {
        go: Receiver<()>,
        room: usize,
        indices: Vec<usize>,
    }

    impl Sink for Disk {
        fn begin(&mut self, _: &Recording) {}

        fn sample(&mut self, sample: &RawSample<'_>) -> Flow {
            self.go.recv().unwrap();
            self.indices.push(sample.index);
            if self.indices.len() < self.room { Flow::Continue } else { Flow::Stop }
        }
    }

    fn sample(index: usize) -> RawSample<'static> {
        RawSample {
            index,
            t: 0.0,
            phase: Phase::Settle,
            q: &[0.0],
            effort: &[0.0],
            voltage: &[],
            link_q: &[],
            command: &[0.0],
        }
    }

    #[test]
    fn a_disk_that_stands_still_holds_nobody_up_and_loses_nothing() {
        let (release, go) = channel();
        let mut disk = Disk { go, room: 500, indices: Vec::new() };
        let ((), taken) = with_sink_thread(
            &mut disk,
            || false,
            |sink| {
                // Nothing has been written while these are answered.
                assert!((0..100).all(|index| sink.sample(&sample(index)) == Flow::Continue));
                (0..100).for_each(|_| release.send(()).unwrap());
            },
        );
        assert!(taken.is_ok());
        assert_eq!(disk.indices, (0..100).collect::<Vec<_>>());
    }

    #[test]
    fn a_disk_that_is_full_stops_the_experiment() {
        let (release, go) = channel();
        (0..1000).for_each(|_| release.send(()).unwrap());
        let mut disk = Disk { go, room: 3, indices: Vec::new() };
        let (answered, taken) = with_sink_thread(
            &mut disk,
            || false,
            |sink| {
                let answers =
                    (0..).map(|index| (index < 3 && sink.sample(&sample(index)).ends()) || sink.idle(0.0).ends());
                answers.into_iter().any(|stop| stop)
            },
        );
        assert!(answered && taken.is_ok() && disk.indices == [0, 1, 2]);
    }

    #[test]
    fn a_thread_that_panics_stops_the_experiment_and_is_named() {
        let (release, go) = channel();
        drop(release);
        let mut disk = Disk { go, room: 3, indices: Vec::new() };
        let work = |sink: &mut dyn Sink| (0..10_000_000).any(|index| sink.sample(&sample(index)).ends());
        let (stopped, taken) = with_sink_thread(&mut disk, || false, work);
        assert!(stopped && taken.is_err_and(|error| error.message().contains("panicked")));
    }
}
