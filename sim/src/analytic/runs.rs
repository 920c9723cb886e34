//! Several runs of one experiment, computed together.

use armid::experiment::{ArmError, Ending, ExperimentPlan, Next, Recorder, Recording, Servo, Sink};
use armid::seed::Seed;

use super::plant::AnalyticPlant;

/// Performs a plan once for each seed and run number, all of them together, each with a sink of its own.
///
/// Every run has the bits that `servo.with_seed(seed, run)` alone would give; together they take a fraction of the
/// time, since one step of the simulator serves as many runs as the processor has lanes. Eight or a multiple is best.
///
/// # Errors
/// [`ArmError`] where the experiment cannot begin.
///
/// # Panics
/// If there is not one sink for each run.
pub fn perform_runs<S: Sink>(
    servo: &Servo<AnalyticPlant>,
    plan: &ExperimentPlan,
    runs: &[(Seed, u64)],
    sinks: &mut [S],
) -> Result<Vec<Ending>, ArmError> {
    assert_eq!(runs.len(), sinks.len(), "one sink for each run");
    let mut cycles = servo.cycles(plan, runs)?;
    let Some((dt, parts)) = cycles.first().map(|cycle| (cycle.dt(), cycle.parts())) else { return Ok(Vec::new()) };
    let mut team = servo.plant().team(runs.len());
    for (k, (cycle, sink)) in cycles.iter().zip(sinks.iter_mut()).enumerate() {
        team.reset(k, cycle.start(), &vec![0.0; cycle.start().len()]);
        sink.begin(&servo.recording(plan, runs[k].0)?);
    }
    let mut endings: Vec<Option<Ending>> = vec![None; runs.len()];
    loop {
        let mut going = false;
        for (k, (cycle, sink)) in cycles.iter_mut().zip(sinks.iter_mut()).enumerate() {
            if endings[k].is_some() {
                continue;
            }
            let (q, qd) = team.state(k);
            match cycle.advance(q, qd, sink, &mut |_| {}) {
                Next::Step => going = true,
                Next::End(ending) => endings[k] = Some(ending),
            }
        }
        if !going {
            return Ok(endings.into_iter().flatten().collect());
        }
        for _ in 0..parts {
            for (k, cycle) in cycles.iter_mut().enumerate() {
                if endings[k].is_none() {
                    let (q, qd) = team.state(k);
                    cycle.push(q, qd);
                    team.push(k, cycle.tau());
                }
            }
            team.step(dt / parts as f64);
            for (k, cycle) in cycles.iter_mut().enumerate() {
                if endings[k].is_none()
                    && let Some(fault) = team.fault(k)
                {
                    endings[k] = Some(cycle.fail(fault));
                }
            }
        }
    }
}

/// Performs a plan once for each seed and run number, all of them together, and keeps every sample in memory.
///
/// # Errors
/// [`ArmError`] where the experiment cannot begin.
pub fn record_runs(
    servo: &Servo<AnalyticPlant>,
    plan: &ExperimentPlan,
    runs: &[(Seed, u64)],
) -> Result<Vec<(Recording, Ending)>, ArmError> {
    let mut recorders = vec![Recorder::default(); runs.len()];
    let endings = perform_runs(servo, plan, runs, &mut recorders)?;
    Ok(recorders.into_iter().filter_map(Recorder::into_recording).zip(endings).collect())
}
