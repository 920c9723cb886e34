//! A log as it was recorded, row by row, and how it becomes an even one.

use armid::estimation::PositionServo;
use armid::model::EffortInterface;
use armid::signal::{Interpolation, resample};

use super::channels;
use super::conversion::Conversion;
use super::joint_log::{Log, Segment};
use super::mapping::Quantity;
use super::origin::Origin;
use super::servo::velocities;
use super::stamps::{SegmentRows, Stamps};
use crate::error::Error;

/// Part of the rows from which on it is said that they repeat the row before.
const REPEATED: f64 = 0.01;

/// Rows of a log: a value that is missing is NaN.
#[derive(Clone, Debug)]
pub(super) struct RawLog {
    pub(super) name: String,
    /// Names of the joints, where the file has them.
    pub(super) joints: Option<Vec<String>>,
    pub(super) dof: usize,
    /// Stamps, s; none where `rate_hz` says how far apart the rows are.
    pub(super) t: Vec<f64>,
    /// Rows per second, where there are no stamps or they are not to be used.
    pub(super) rate_hz: Option<f64>,
    pub(super) q: Vec<f64>,
    pub(super) qd: Option<Vec<f64>>,
    pub(super) link_q: Option<Vec<f64>>,
    /// Zero where a joint has none.
    pub(super) effort: Vec<f64>,
    /// Joints, from zero, whose effort was not measured or is not to be used.
    pub(super) without_effort: Vec<usize>,
    pub(super) effort_unit: Option<EffortInterface>,
    /// The servos that made the efforts, whose damping these still lack.
    pub(super) servo: Option<PositionServo>,
    pub(super) conversion: Conversion,
    pub(super) origin: Origin,
}

impl RawLog {
    /// An even log, in segments without a break. `at_row` makes a fault that points at a row.
    ///
    /// # Errors
    /// [`Error`] where the stamps are no times or nothing is left.
    pub(super) fn even(mut self, at_row: impl Fn(usize, String) -> Error) -> Result<Log, Error> {
        let n = self.dof;
        let rows = self.q.len() / n.max(1);
        let complete: Vec<usize> = (0..rows).filter(|&row| self.is_complete(row)).collect();
        if complete.len() < 2 {
            let empty = self.columns_without_numbers();
            let why =
                if empty.is_empty() { String::new() } else { format!(": no row has a number in {}", empty.join(", ")) };
            let message = format!("{} has {} samples, expected at least 2{why}", self.name, complete.len());
            return Err(Error::new(message));
        }
        let mut stamps = match self.rate_hz {
            // A row that is missing is a step of two.
            Some(rate) if complete.len() < rows => {
                let t: Vec<f64> = complete.iter().map(|&row| row as f64 / rate).collect();
                Stamps::of(&t).map_err(|(at, message)| at_row(complete[at], message))?
            }
            Some(rate) => Stamps::even(rows, rate),
            None => {
                let t: Vec<f64> = complete.iter().map(|&row| self.t[row]).collect();
                Stamps::of(&t).map_err(|(at, message)| at_row(complete[at], message))?
            }
        };
        stamps.timing.rows = rows;
        stamps.timing.incomplete_rows = rows - complete.len();
        let kept: Vec<usize> = stamps.kept.iter().map(|&at| complete[at]).collect();
        let t: Vec<f64> = match self.rate_hz {
            Some(rate) => kept.iter().map(|&row| row as f64 / rate).collect(),
            None => kept.iter().map(|&row| self.t[row]).collect(),
        };
        if kept.len() < rows {
            let pick = |table: &[f64]| -> Vec<f64> {
                kept.iter().flat_map(|&row| table[row * n..(row + 1) * n].iter().copied()).collect()
            };
            (self.q, self.effort) = (pick(&self.q), pick(&self.effort));
            self.qd = self.qd.as_deref().map(pick);
            self.link_q = self.link_q.as_deref().map(pick);
        }
        let (faults, mut excluded) = channels::look(&self.q, &self.effort, n);
        for &joint in &self.without_effort {
            excluded.resize(self.q.len(), false);
            excluded.iter_mut().skip(joint).step_by(n).for_each(|excluded| *excluded = true);
            let remark = format!("joint {}: its effort is left out, and it gives no equation of its own", joint + 1);
            self.origin.remarks.push(remark);
        }
        let repeated = channels::repeated_rows(&self.q, n) as f64 / kept.len().max(1) as f64;
        if repeated >= REPEATED {
            let remark = format!(
                "{:.0} % of the rows repeat the positions of the row before: the log was written more often than the positions were read",
                100.0 * repeated
            );
            self.origin.remarks.push(remark);
        }
        let rate_hz = stamps.timing.rate_hz;
        let mut log = Log {
            rate_hz,
            q: Vec::new(),
            qd: self.qd.as_ref().map(|_| Vec::new()),
            link_q: self.link_q.as_ref().map(|_| Vec::new()),
            effort: Vec::new(),
            excluded: Vec::new(),
            segments: Vec::new(),
            name: self.name,
            joints: self.joints,
            dof: n,
            effort_unit: self.effort_unit,
            robot: None,
            recording: None,
            servo: self.servo,
            notes: std::collections::BTreeMap::new(),
            complete: true,
            conversion: self.conversion,
            origin: Origin { channels: faults, ..self.origin },
        };
        for segment in &stamps.segments {
            let SegmentRows { rows, even, start_s } = segment;
            let span = rows.start * n..rows.end * n;
            let t = &t[rows.clone()];
            let count = if *even { rows.len() } else { ((t[t.len() - 1] - t[0]) * rate_hz + 1e-6) as usize + 1 };
            let onto = |table: &[f64], way: Interpolation| -> Vec<f64> {
                if *even {
                    table[span.clone()].to_vec()
                } else {
                    resample(t, &table[span.clone()], n, rate_hz, count, way)
                }
            };
            log.q.extend(onto(&self.q, Interpolation::Cubic));
            for (all, own) in [(&mut log.qd, &self.qd), (&mut log.link_q, &self.link_q)] {
                if let (Some(all), Some(own)) = (all, own) {
                    all.extend(onto(own, Interpolation::Cubic));
                }
            }
            log.effort.extend(onto(&self.effort, Interpolation::Lines));
            if !excluded.is_empty() {
                // A sample counts where both rows that it lies between do.
                let marks: Vec<f64> = excluded.iter().map(|&mark| f64::from(u8::from(mark))).collect();
                log.excluded.extend(onto(&marks, Interpolation::Lines).into_iter().map(|mark| mark > 0.0));
            }
            log.segments.push(Segment { start_s: *start_s, samples: count });
        }
        log.origin.timing = Some(stamps.timing);
        subtract_damping(&mut log);
        Ok(log)
    }

    /// Columns without a number in any row, each as its file calls it.
    fn columns_without_numbers(&self) -> Vec<String> {
        let mut empty = Vec::new();
        for (quantity, names) in self.origin.read_as.iter().flat_map(|read_as| &read_as.columns) {
            let values = match quantity {
                Quantity::Time => Some(&self.t),
                Quantity::Position => Some(&self.q),
                Quantity::Velocity => self.qd.as_ref(),
                Quantity::LinkPosition => self.link_q.as_ref(),
                Quantity::Torque | Quantity::Current | Quantity::Command => Some(&self.effort),
            };
            let Some(values) = values.filter(|values| !values.is_empty()) else { continue };
            for (column, name) in names.iter().enumerate() {
                if !values.iter().skip(column).step_by(names.len()).any(|value| value.is_finite()) {
                    empty.push(format!("\"{name}\" ({})", quantity.key()));
                }
            }
        }
        empty
    }

    fn is_complete(&self, row: usize) -> bool {
        let span = row * self.dof..(row + 1) * self.dof;
        let stamp = self.rate_hz.is_some() || self.t.get(row).is_some_and(|t| t.is_finite());
        let finite = |table: &[f64]| table[span.clone()].iter().all(|x| x.is_finite());
        let more = [&self.qd, &self.link_q];
        stamp && finite(&self.q) && finite(&self.effort) && more.iter().all(|own| own.as_deref().is_none_or(finite))
    }
}

/// Subtracts Kd q̇ from the efforts, with velocities as they were measured, or from the positions where they were not.
fn subtract_damping(log: &mut Log) {
    let Some(PositionServo { kd: damping, .. }) = &log.servo else { return };
    let (n, mut first) = (log.dof, 0);
    for segment in &log.segments {
        let span = first..first + segment.samples * n;
        first = span.end;
        let found = match &log.qd {
            Some(qd) => qd[span.clone()].to_vec(),
            None => velocities(&log.q[span.clone()], n, log.rate_hz),
        };
        for (effort, qd) in log.effort[span].chunks_exact_mut(n).zip(found.chunks_exact(n)) {
            effort.iter_mut().zip(qd).zip(damping).for_each(|((effort, qd), kd)| *effort -= kd * qd);
        }
    }
}
