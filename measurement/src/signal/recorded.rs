//! A recording to samples.

use super::error::SignalError;
use super::period_average::PeriodicRecord;
use super::periodic::process_periods;
use super::processing::Processing;
use super::samples::Samples;
use crate::experiment::Recording;
use crate::model::Robot;

/// Processes the recorded periods of a recording.
///
/// Periods that the experiment did not finish are left out.
///
/// # Errors
/// [`SignalError::NoPeriods`] where no whole period was recorded, [`SignalError`] where the recording is malformed or
/// a setting does not fit it.
pub fn process(recording: &Recording, robot: &Robot, processing: &Processing) -> Result<Samples, SignalError> {
    let periods = recording.periods();
    if periods == 0 {
        let (found, expected) = (recording.recorded().len(), recording.period_samples);
        return Err(SignalError::NoPeriods { found, expected });
    }
    let n = recording.dof;
    for (quantity, series) in [("positions", &recording.q), ("efforts", &recording.effort)] {
        if series.len() != recording.len() * n {
            let (found, expected) = (series.len(), recording.len() * n);
            return Err(SignalError::Unequal { quantity, found, other: "times of all joints", expected });
        }
    }
    let first = recording.recorded().start;
    let rows = first * n..(first + periods * recording.period_samples) * n;
    let record = PeriodicRecord {
        dof: n,
        rate_hz: recording.rate_hz,
        period_samples: recording.period_samples,
        q: &recording.q[rows.clone()],
        effort: &recording.effort[rows],
    };
    let highest_hz = recording.trajectory.highest_hz();
    let mut samples = process_periods(&record, robot, recording.effort_unit, highest_hz, processing)?;
    if !recording.link_q.is_empty() {
        let record = PeriodicRecord { q: &recording.link_q[first * n..][..record.q.len()], ..record };
        let of_links = process_periods(&record, robot, recording.effort_unit, highest_hz, processing)?;
        samples = samples.with_link_positions(&of_links);
    }
    samples.provenance = Some(recording.provenance.clone());
    Ok(samples)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::hinges::{self, FlyWheels};
    use crate::experiment::{ExperimentPlan, Servo, record};

    #[test]
    fn identity_samples_are_those_of_the_whole_periods_alone() {
        let plan =
            ExperimentPlan { settle_s: 0.1, ramp_s: 0.3, periods: 3, ..ExperimentPlan::new(hinges::trajectory(1)) };
        let robot = hinges::single();
        let mut servo = Servo::new(&robot, &hinges::parameters(1), FlyWheels::new(1)).unwrap();
        let recording = record(&mut servo, &plan).unwrap().0;
        let samples = |changed: Option<usize>| {
            let mut recording = recording.clone();
            if let Some(k) = changed {
                recording.q[k] += 0.01;
                recording.effort[k] += 0.01;
            }
            process(&recording, &robot, &Processing::default()).unwrap()
        };
        let (whole, periods) = (samples(None), recording.recorded());
        for (k, counts) in [
            (0, false),
            (periods.start - 1, false),
            (periods.start, true),
            (periods.end - 1, true),
            (periods.end, false),
        ] {
            assert_eq!(samples(Some(k)) != whole, counts, "sample {k} of {periods:?}");
        }
    }
}
