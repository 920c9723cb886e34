//! Why the positions of logs give no equations: nothing moves, or one sample is far from all others.
//!
//! A joint's rows count where it is not much slower than its top speed: against a jump of thousands of radians it never moves.

use super::joint_log::Log;
use super::processed_log::ProcessedLog;
use super::used_part::by_cuts;
use crate::error::Error;

/// A sample this many times farther from the middle than 99 of 100 are is wild.
const WILD: f64 = 1e3;
/// Smaller ranges count as this one, rad (m): a joint at rest has its noise alone.
const LEAST_RANGE: f64 = 1e-3;

impl ProcessedLog {
    /// The error of logs in which no joint moves.
    pub(super) fn no_motion(&self) -> Error {
        let joints: Vec<&str> = self.robot.robot.joints().iter().map(|joint| joint.name.as_str()).collect();
        let message = format!(
            "{}: no joint moves ({} stand still in all samples), expected at least one that does",
            self.name(),
            joints.join(", ")
        );
        Error::new(message).help(by_cuts("record the arm while its drives move it, or choose the part in motion by "))
    }

    /// The error of logs with a wild sample; `None` where there is none.
    pub(super) fn wild_sample(&self) -> Option<Error> {
        let (log, joint, at) = self.logs.iter().find_map(|log| farthest(log).map(|(joint, at)| (log, joint, at)))?;
        let (joint, value) = (&self.robot.robot.joints()[joint], log.q[at * log.dof + joint]);
        let message = format!(
            "{}: {} is at {value:e} {} in sample {} (t = {:.3} s), more than {WILD} times farther out than in the others, expected \
             positions of a motion",
            log.name,
            joint.name,
            joint.kind.unit(),
            at + 1,
            time_s(log, at),
        );
        Some(Error::new(message).help(by_cuts("remove this sample from the log, or leave it out by ")))
    }
}

/// Joint (from zero) and sample of the wildest position.
fn farthest(log: &Log) -> Option<(usize, usize)> {
    let mut wildest: Option<(f64, usize, usize)> = None;
    for joint in 0..log.dof {
        let q: Vec<f64> = log.q.iter().skip(joint).step_by(log.dof).copied().collect();
        let sorted = |mut values: Vec<f64>| {
            values.sort_by(f64::total_cmp);
            values
        };
        let Some(&middle) = sorted(q.clone()).get(q.len() / 2) else { continue };
        let away: Vec<f64> = q.iter().map(|q| (q - middle).abs()).collect();
        let usual = sorted(away.clone())[(away.len() - 1) * 99 / 100].max(LEAST_RANGE);
        let Some((at, farthest)) = away.into_iter().enumerate().max_by(|a, b| a.1.total_cmp(&b.1)) else { continue };
        if farthest > WILD * usual && wildest.is_none_or(|(ratio, ..)| farthest / usual > ratio) {
            wildest = Some((farthest / usual, joint, at));
        }
    }
    wildest.map(|(_, joint, at)| (joint, at))
}

/// Time of a sample, s from the beginning of the log.
fn time_s(log: &Log, sample: usize) -> f64 {
    let mut before = 0;
    for segment in &log.segments {
        if sample < before + segment.samples {
            return segment.start_s + (sample - before) as f64 / log.rate_hz;
        }
        before += segment.samples;
    }
    sample as f64 / log.rate_hz
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;
    use std::fmt::Write;

    use armid::estimation::EstimatorKind;
    use armid::model::Columns;

    use crate::error::Error;
    use crate::log::{LogSettings, ProcessedLog, parse_csv};
    use crate::robot;
    use crate::text::Text;

    const RATE_HZ: f64 = 100.0;
    const PERIOD_S: f64 = 2.0;

    /// A log of `n` joints over so many periods: a motion with friction and noise, after `change` has altered each row.
    fn log(n: usize, periods: f64, change: &dyn Fn(usize, &mut [f64])) -> String {
        let mut text = "t".to_owned();
        for name in ["q", "tau"] {
            (1..=n).for_each(|k| write!(text, ",{name}{k}").unwrap());
        }
        for k in 0..(periods * PERIOD_S * RATE_HZ) as usize {
            let t = k as f64 / RATE_HZ;
            let noise = |i: usize| ((k * 7919 + i * 104_729) % 1009) as f64 / 1009.0 - 0.5;
            let angle = |i: usize| TAU / PERIOD_S * (i % 3 + 1) as f64 * t + i as f64;
            let q = (0..n).map(|i| 0.5 * angle(i).sin() + 1e-5 * noise(i));
            let tau = (0..n).map(|i| 3.0 * angle(i).sin() + 0.5 * angle(i).cos().signum() + 0.1 * noise(i + n));
            let mut row: Vec<f64> = q.chain(tau).collect();
            change(k, &mut row);
            write!(text, "\n{t}").unwrap();
            row.iter().for_each(|value| write!(text, ",{value}").unwrap());
        }
        text
    }

    fn processed(name: &str, text: &str, settings: &LogSettings) -> Result<ProcessedLog, Error> {
        parse_csv(Text::new("log.csv", text))?.process(robot::find(name)?, settings)
    }

    /// What is done to each row of a log.
    type Change = Box<dyn Fn(usize, &mut [f64])>;

    /// Logs of two joints that hold little or nothing of a motion: what is wrong, periods, the change of each row.
    fn degenerate() -> Vec<(String, f64, Change)> {
        let mut logs: Vec<(String, f64, Change)> = vec![
            ("one joint at rest".into(), 4.0, Box::new(|_, row| row[0] = 0.3)),
            ("at rest".into(), 4.0, Box::new(|_, row| row[..2].fill(0.3))),
            ("at rest but for noise".into(), 4.0, Box::new(|_, row| row[..2].iter_mut().for_each(|q| *q *= 1e-5))),
            ("all zero".into(), 4.0, Box::new(|_, row| row.fill(0.0))),
            ("constant torque".into(), 4.0, Box::new(|_, row| row[2..].fill(1.0))),
            ("a column of NaN".into(), 4.0, Box::new(|_, row| row[3] = f64::NAN)),
            ("one period".into(), 1.0, Box::new(|_, _| {})),
            ("two samples".into(), 0.01, Box::new(|_, _| {})),
        ];
        for value in [1e12, 1e26] {
            for columns in [0..1, 1..2, 2..3, 0..2] {
                let what = format!("{value:e} in {columns:?}");
                let change = move |k: usize, row: &mut [f64]| {
                    if k == 333 {
                        row[columns.clone()].fill(value);
                    }
                };
                logs.push((what, 4.0, Box::new(change)));
            }
        }
        logs
    }

    #[test]
    fn degenerate_logs_give_every_estimator_finite_numbers_or_an_error() {
        for (what, periods, change) in degenerate() {
            let text = log(2, periods, &*change);
            for settings in [LogSettings::default(), LogSettings::periodic(PERIOD_S)] {
                let Ok(log) = processed("planar-2r", &text, &settings) else { continue };
                let columns = Columns::RIGID_ROTOR_FRICTION;
                for &kind in EstimatorKind::ALL {
                    let Ok(estimate) = log.identify(columns, kind) else { continue };
                    let values = estimate.base.iter().flat_map(|p| [p.value, p.std]);
                    let is_finite = !estimate.base.is_empty() && values.into_iter().all(f64::is_finite);
                    assert!(is_finite, "{what}, {}: {:?}", kind.name(), estimate.base);
                    log.residual(&estimate, "E").unwrap();
                }
                log.suspicions(columns).unwrap();
            }
        }
    }

    #[test]
    fn an_arm_at_rest_and_a_wild_sample_are_named() {
        let still: Change = Box::new(|_, row| row.iter_mut().take(2).for_each(|q| *q = 0.3));
        let all_still: Change = Box::new(|_, row| row[..6].fill(0.3));
        let wild: Change = Box::new(|k, row| row[1] = if k == 333 { 1e26 } else { row[1] });
        let at_rest = |joints: &str| format!("log.csv: no joint moves ({joints} stand still in all samples)");
        let a460 = robot::find("crs-a460").unwrap();
        let joints: Vec<&str> = a460.robot.joints().iter().map(|joint| joint.name.as_str()).collect();
        for (name, n, change, words) in [
            ("planar-2r", 2, &still, at_rest("shoulder, elbow")),
            ("crs-a460", 6, &all_still, at_rest(&joints.join(", "))),
            ("planar-2r", 2, &wild, "log.csv: elbow is at 1e26 rad in sample 334 (t = 3.330 s)".into()),
            ("crs-a460", 6, &wild, format!("log.csv: {} is at 1e26 rad in sample 334 (t = 3.330 s)", joints[1])),
        ] {
            let log = processed(name, &log(n, 4.0, &**change), &LogSettings::periodic(PERIOD_S)).unwrap();
            for kind in [EstimatorKind::Wls, EstimatorKind::Ols] {
                let fault = log.identify(Columns::RIGID_ROTOR_FRICTION, kind).unwrap_err().to_string();
                assert!(fault.contains(&words), "{name}, {}: {fault}", kind.name());
            }
        }
    }
}
