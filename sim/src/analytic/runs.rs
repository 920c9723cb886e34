//! Several runs of one arm, computed together.

use armid::experiment::{ArmError, Cycle, CycleGroup, Ending, ExperimentPlan, Recorder, Recording, Servo, Sink};
use armid::lanes::MOST_LANES;
use armid::observer::{Observer, Unobserved};
use armid::seed::RunNoise;

use super::plant::AnalyticPlant;

/// One of several runs: what is performed, with which random streams.
#[derive(Clone, Copy, Debug)]
pub struct BatchRun<'a> {
    /// What is performed.
    pub plan: &'a ExperimentPlan,
    /// Its random numbers.
    pub noise: RunNoise,
}

/// Performs every run on one arm, all of them together, each with a sink of its own.
///
/// Every run has the bits that `servo.with_noise(noise)` alone would give for its plan; together they take a fraction of
/// the time, since one step of the simulator serves as many runs as the processor has lanes. Eight or a multiple is best.
///
/// # Errors
/// [`ArmError`] for each run that cannot begin; the others are performed.
///
/// # Panics
/// If there is not one sink for each run.
pub fn perform_runs<S: Sink>(
    servo: &Servo<AnalyticPlant>,
    runs: &[BatchRun<'_>],
    sinks: &mut [S],
) -> Vec<Result<Ending, ArmError>> {
    assert_eq!(runs.len(), sinks.len(), "one sink for each run");
    let mut endings: Vec<Option<Result<Ending, ArmError>>> = vec![None; runs.len()];
    let mut members = Vec::new();
    for (place, begun) in begin(servo, runs, sinks).into_iter().enumerate() {
        match begun {
            Ok(cycle) => members.push((place, cycle)),
            Err(error) => endings[place] = Some(Err(error)),
        }
    }
    for (member, ending) in perform(servo, members, sinks) {
        endings[member] = Some(Ok(ending));
    }
    endings.into_iter().flatten().collect()
}

/// Performs every run on one arm, all of them together, and keeps every sample in memory.
///
/// # Errors
/// [`ArmError`] for each run that cannot begin.
pub fn record_runs(servo: &Servo<AnalyticPlant>, runs: &[BatchRun<'_>]) -> Vec<Result<(Recording, Ending), ArmError>> {
    record_runs_watched(servo, runs, &Unobserved)
}

/// Records the runs and reports to an observer, which may stop the arms of all runs.
pub(crate) fn record_runs_watched(
    servo: &Servo<AnalyticPlant>,
    runs: &[BatchRun<'_>],
    observer: &dyn Observer,
) -> Vec<Result<(Recording, Ending), ArmError>> {
    let mut recorders: Vec<Recorder<'_>> = runs.iter().map(|_| Recorder::watched_by(observer)).collect();
    let endings = perform_runs(servo, runs, &mut recorders);
    let recorded = |(recorder, ending): (Recorder<'_>, Result<Ending, ArmError>)| {
        ending.map(|ending| (recorder.into_recording().expect("a run that began has a recording"), ending))
    };
    recorders.into_iter().zip(endings).map(recorded).collect()
}

/// The servo of each run, its recording begun. Neighbours with one plan share its table of commands.
fn begin<S: Sink>(
    servo: &Servo<AnalyticPlant>,
    runs: &[BatchRun<'_>],
    sinks: &mut [S],
) -> Vec<Result<Cycle, ArmError>> {
    let mut begun = Vec::with_capacity(runs.len());
    for group in runs.chunk_by(|a, b| std::ptr::eq(a.plan, b.plan)) {
        let streams: Vec<RunNoise> = group.iter().map(|run| run.noise).collect();
        match servo.cycles(group[0].plan, &streams) {
            Ok(cycles) => {
                for (cycle, run) in cycles.into_iter().zip(group) {
                    let recording = servo.recording(run.plan, run.noise.seed);
                    begun.push(recording.map(|recording| {
                        sinks[begun.len()].begin(&recording);
                        cycle
                    }));
                }
            }
            Err(error) => begun.extend(group.iter().map(|_| Err(error.clone()))),
        }
    }
    begun
}

/// Steps all runs until the last has ended; every ending with the place of its run.
fn perform<S: Sink>(
    servo: &Servo<AnalyticPlant>,
    members: Vec<(usize, Cycle)>,
    sinks: &mut [S],
) -> Vec<(usize, Ending)> {
    let mut batch = servo.plant().batch(members.len());
    let mut members = members.into_iter().peekable();
    let mut groups = Vec::new();
    while members.peek().is_some() {
        groups.push(CycleGroup::new(members.by_ref().take(MOST_LANES).collect()));
    }
    // One servo, so that steps and their parts are the same for every run.
    let Some((dt, parts)) = groups.first().map(|group| (group.dt(), group.parts())) else { return Vec::new() };
    for (run, start) in groups.iter().flat_map(CycleGroup::starts).enumerate() {
        batch.reset(run, start, &vec![0.0; start.len()]);
    }
    loop {
        let mut going = false;
        for (k, group) in groups.iter_mut().enumerate() {
            let (q, qd, tau) = batch.group_mut(k);
            going |= group.advance(q, qd, tau, sinks);
        }
        if !going {
            return groups.into_iter().flat_map(CycleGroup::into_endings).collect();
        }
        for _ in 0..parts {
            for (k, group) in groups.iter_mut().enumerate() {
                let (q, qd, tau) = batch.group_mut(k);
                group.push(q, qd, tau);
            }
            batch.step(dt / parts as f64);
            for (k, group) in groups.iter_mut().enumerate() {
                let (q, qd, _) = batch.group(k);
                group.check(q, qd);
            }
        }
    }
}
