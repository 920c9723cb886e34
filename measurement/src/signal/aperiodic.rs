//! A record without periods: the whole of it filtered and differentiated.
//!
//! The low pass of positions takes out of the regressor what the torque keeps: the servo's transients at each reversal of friction.
//! On the A460 along Table I in closed loop, without any noise at 500 Hz, the share of torque that is left by `wls`, all columns:
//!
//! ```text
//! cut-off, Hz                          10       20       40       80      160
//! used equations, motion alone      0.88 %   0.45 %   0.29 %   0.21 %   0.04 %
//! all samples, motion alone         1.22 %   0.55 %   0.36 %   0.21 %   0.04 %
//! all samples, rest and ramps too   1.53 %   0.99 %   0.76 %   0.50 %   0.26 %
//! ```
//! What differences and grid have in it was not separated: of the motion alone, all but 0.04 % goes with the cut-off. A higher cut-off
//! costs noise of the acceleration, with its square.

use std::ops::Range;

use super::butterworth::Butterworth;
use super::columns::{column, put_column};
use super::cutoff::find_cutoff;
use super::differences::differences;
use super::error::{SignalError, check_finite, refused};
use super::periodic::{effort_units, used_blocks};
use super::processing::{Derivatives, Processing, TorqueFilter};
use super::samples::Samples;
use super::torque::{map_rows, torque_map};
use crate::dynamics::States;
use crate::model::{EffortInterface, Robot};

/// A record of any motion: `q`, `qd` and `effort` are N × n, row-major.
#[derive(Clone, Copy, Debug)]
pub struct AperiodicRecord<'a> {
    /// Number of joints n.
    pub dof: usize,
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// Positions, rad or m.
    pub q: &'a [f64],
    /// Measured velocities, rad/s or m/s; `None` takes them from the positions.
    pub qd: Option<&'a [f64]>,
    /// Efforts, in the unit that the arm reports.
    pub effort: &'a [f64],
    /// Samples of each segment without a break, in order; none where the record is one segment. Filters and differences
    /// do not reach across a break.
    pub segments: &'a [usize],
    /// Which samples give no equation of a joint, N × n: its effort was saturated, say. None where all do.
    pub excluded: &'a [bool],
}

impl<'a> AperiodicRecord<'a> {
    /// A record without measured velocities, in one segment, of which every sample counts.
    pub const fn new(dof: usize, rate_hz: f64, q: &'a [f64], effort: &'a [f64]) -> Self {
        Self { dof, rate_hz, q, qd: None, effort, segments: &[], excluded: &[] }
    }

    /// The cut-off that [`find_cutoff`] finds in the longest segment, Hz: of the velocities where they are measured, else of the positions.
    ///
    /// # Panics
    /// If the segments have more samples than there are.
    pub fn find_cutoff(&self) -> f64 {
        let spans = self.spans(self.q.len() / self.dof).into_iter();
        let (first, count) = spans.max_by_key(|(_, count)| *count).unwrap_or_default();
        let rows = first * self.dof..(first + count) * self.dof;
        find_cutoff(&self.qd.unwrap_or(self.q)[rows], self.dof, self.rate_hz)
    }

    /// First sample and number of samples of each segment.
    fn spans(&self, len: usize) -> Vec<(usize, usize)> {
        if self.segments.is_empty() {
            return vec![(0, len)];
        }
        let mut first = 0;
        self.segments
            .iter()
            .map(|&count| {
                first += count;
                (first - count, count)
            })
            .collect()
    }

    fn check(&self, robot: &Robot) -> Result<usize, SignalError> {
        let n = self.dof;
        if robot.dof() != n {
            return Err(SignalError::Joints { found: n, expected: robot.dof() });
        }
        let len = self.q.len() / n;
        if len < SHORTEST || !self.q.len().is_multiple_of(n) {
            let (found, least) = (self.q.len(), SHORTEST * n);
            return Err(SignalError::Length { quantity: "positions", found, block: n, of: "joints", least });
        }
        let marks = if self.excluded.is_empty() { self.q.len() } else { self.excluded.len() };
        let counts = [
            ("efforts", self.effort.len(), self.q.len()),
            ("velocities", self.qd.map_or(self.q.len(), <[f64]>::len), self.q.len()),
            ("marks of samples", marks, self.q.len()),
            ("samples of all segments", self.spans(len).iter().map(|(_, count)| count).sum(), len),
        ];
        if let Some(&(quantity, found, expected)) = counts.iter().find(|(_, found, expected)| found != expected) {
            return Err(SignalError::Unequal { quantity, found, other: "positions", expected });
        }
        check_finite("position", self.q, n)?;
        check_finite("velocity", self.qd.unwrap_or_default(), n)?;
        check_finite("effort", self.effort, n)?;
        Ok(len)
    }
}

/// Length of an edge, in periods of the cut-off: what the reflection adds has fallen to a hundredth by then.
const EDGE_CYCLES: f64 = 2.0;
/// Fewest samples that can be processed.
const SHORTEST: usize = 8;

/// Keeps the rows of these samples, of n numbers each, in place.
fn keep<T: Copy>(table: &mut Vec<T>, kept: &[Range<usize>], n: usize) {
    let mut to = 0;
    for samples in kept {
        table.copy_within(samples.start * n..samples.end * n, to);
        to += samples.len() * n;
    }
    table.truncate(to);
}

/// Leaves out the blocks of samples that begin or end within `edge` samples of the ends of a segment, at most an eighth of it: the
/// filter continues a motion there by point reflection, which turns its acceleration round.
fn leave_out_edges(used: &mut [bool], segments: &[Range<usize>], [block, n]: [usize; 2], edge: f64) {
    let mut before = 0;
    for count in segments.iter().map(Range::len) {
        let edge = (edge.ceil() as usize).min(count / 8);
        for (m, block_used) in used.chunks_exact_mut(n).enumerate() {
            let (first, end) = (m * block, (m + 1) * block);
            let inside = first >= before && end <= before + count;
            if inside && (first < before + edge || end + edge > before + count) {
                block_used.fill(false);
            }
        }
        before += count;
    }
}

/// Processes a record without periods by zero-phase low pass and central differences. `rate_hz` is the rate of the
/// equations, Hz: blocks of samples are averaged to come near it.
///
/// There is no scatter to see noise in, so the result carries none, and estimators take it from their residual. The
/// cut-off is the one that is stated, or that [`AperiodicRecord::find_cutoff`] finds.
///
/// Blocks take noise of the acceleration out of the regressor: its mean over a block is a difference of two velocities. With shorter
/// blocks inertias come out too small, and with a lower cut-off too large.
///
/// # Errors
/// [`SignalError`] where the record is malformed, shorter than 8 samples, or a setting does not fit it.
pub fn process_aperiodic(
    record: &AperiodicRecord<'_>,
    robot: &Robot,
    effort: EffortInterface,
    rate_hz: f64,
    processing: &Processing,
) -> Result<Samples, SignalError> {
    processing.check()?;
    let len = record.check(robot)?;
    let n = record.dof;
    let cutoff_hz = processing.cutoff_hz.unwrap_or_else(|| record.find_cutoff());
    let filter = Butterworth::new(processing.filter_order, cutoff_hz, record.rate_hz)?;
    if !(rate_hz.is_finite() && rate_hz > 0.0) {
        return refused("rate of the equations", format!("{rate_hz} Hz"), "a finite number above zero");
    }
    let spans = record.spans(len);
    let longest = spans.iter().map(|(_, count)| *count).max().unwrap_or(len);
    let block = ((record.rate_hz / rate_hz).round() as usize).clamp(1, (longest / SHORTEST).max(1));
    let mut tau = map_rows(record.effort, &torque_map(robot, effort));
    let mut states = States::with_len(n, len);
    let same = processing.torque_filter == TorqueFilter::SameAsPositions;
    // Only whole blocks of a segment give equations: what is left at its end is filtered with it, and goes.
    let mut kept: Vec<Range<usize>> = Vec::new();
    for (first, count) in spans {
        let rows = first * n..(first + count) * n;
        let step = 1.0 / record.rate_hz;
        states.q[rows.clone()].copy_from_slice(&filter.zero_phase_reflected(&record.q[rows.clone()], n));
        if let Some(measured) = record.qd {
            states.qd[rows.clone()].copy_from_slice(&filter.zero_phase_reflected(&measured[rows.clone()], n));
        }
        for i in 0..n {
            if record.qd.is_some() {
                let (qdd, _) = differences(&column(&states.qd[rows.clone()], n, i), step);
                put_column(&mut states.qdd[rows.clone()], n, i, &qdd);
            } else {
                let (qd, qdd) = differences(&column(&states.q[rows.clone()], n, i), step);
                put_column(&mut states.qd[rows.clone()], n, i, &qd);
                put_column(&mut states.qdd[rows.clone()], n, i, &qdd);
            }
        }
        if same {
            let filtered = filter.zero_phase_reflected(&tau[rows.clone()], n);
            tau[rows].copy_from_slice(&filtered);
        }
        kept.push(first..first + count - if record.segments.len() > 1 { count % block } else { 0 });
    }
    let mut excluded = record.excluded.to_vec();
    if kept.iter().map(Range::len).sum::<usize>() < len {
        for table in [&mut states.q, &mut states.qd, &mut states.qdd, &mut tau] {
            keep(table, &kept, n);
        }
        if !excluded.is_empty() {
            keep(&mut excluded, &kept, n);
        }
    }
    let cycles = if processing.reversal_fraction > 0.0 { processing.reversal_cycles } else { 0.0 };
    let reach = cycles / cutoff_hz * record.rate_hz;
    let moves = used_blocks(&states, block, processing.reversal_fraction, reach.ceil() as usize);
    let mut usable = vec![true; moves.len()];
    leave_out_edges(&mut usable, &kept, [block, n], EDGE_CYCLES / cutoff_hz * record.rate_hz);
    for (block, rows) in usable.chunks_exact_mut(n).zip(excluded.chunks(n * block)) {
        for (i, usable) in block.iter_mut().enumerate() {
            *usable &= !rows.iter().skip(i).step_by(n).any(|&excluded| excluded);
        }
    }
    let of = |moving: bool| usable.iter().zip(&moves).map(|(&usable, &moves)| usable && moves == moving).collect();
    Ok(Samples {
        used: of(true),
        slow: of(false),
        block,
        derivatives: Derivatives::Differences,
        position_band_hz: vec![cutoff_hz; n],
        torque_band_hz: same.then_some(cutoff_hz),
        torque_filter_order: processing.filter_order,
        ..Samples::exact(states, tau, effort_units(robot), record.rate_hz)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::hinges;

    const COUNT: usize = 400;
    const RATE_HZ: f64 = 100.0;

    fn processed(record: &AperiodicRecord<'_>, rate_hz: f64) -> Samples {
        let processing = Processing { reversal_fraction: 0.0, ..Processing::default() };
        process_aperiodic(record, &hinges::coupled(), EffortInterface::Torque, rate_hz, &processing).unwrap()
    }

    #[test]
    fn analytic_a_measured_velocity_is_the_velocity_and_its_slope_the_acceleration() {
        let w = std::f64::consts::TAU * 0.5;
        let at = |k: usize, j: usize| w * k as f64 / RATE_HZ + j as f64;
        // Positions that stand still: what moves is measured.
        let (q, effort) = (vec![0.3; 2 * COUNT], vec![0.0; 2 * COUNT]);
        let qd: Vec<f64> = (0..2 * COUNT).map(|row| libm::sin(at(row / 2, row % 2))).collect();
        let record = AperiodicRecord { qd: Some(&qd), ..AperiodicRecord::new(2, RATE_HZ, &q, &effort) };
        let states = processed(&record, RATE_HZ).states;
        // The low pass passes 0.5 Hz to 1e-10, central differences to 2e-4; its transients end within a second.
        for k in COUNT / 4..3 * COUNT / 4 {
            for j in 0..2 {
                assert!((states.q(k)[j] - 0.3).abs() < 1e-6);
                assert!((states.qd(k)[j] - libm::sin(at(k, j))).abs() < 1e-6);
                assert!((states.qdd(k)[j] - w * libm::cos(at(k, j))).abs() < 3e-4 * w, "{k}: {}", states.qdd(k)[j]);
            }
        }
    }

    #[test]
    fn analytic_the_low_pass_keeps_all_but_two_percent_of_a_step_beyond_the_reach() {
        let cutoff_hz = 5.0;
        let filter = Butterworth::new(Processing::default().filter_order, cutoff_hz, RATE_HZ).unwrap();
        let step: Vec<f64> = (0..COUNT).map(|k| if k < COUNT / 2 { 0.0 } else { 1.0 }).collect();
        let filtered = filter.zero_phase_reflected(&step, 1);
        let cycles = Processing::default().reversal_cycles;
        let reach = (cycles / cutoff_hz * RATE_HZ).ceil() as usize;
        let lost = |k: &usize| (step[*k] - filtered[*k]).abs();
        let beyond = (COUNT / 2 + reach..COUNT).map(|k| lost(&k)).fold(0.0, f64::max);
        let nearer = (COUNT / 2 + reach / 2..COUNT / 2 + reach).map(|k| lost(&k)).fold(0.0, f64::max);
        assert!(beyond < 0.021 && nearer > 0.06, "{beyond} {nearer}");
        // Joints that turn round every second, between two samples, half a second after each other.
        let half = 0.5 / RATE_HZ;
        let at = |k: usize| k as f64 / RATE_HZ + half;
        let q = (0..COUNT).flat_map(|k| [0.0, 0.5].map(|late| libm::cos(std::f64::consts::PI * (at(k) - late))));
        let q: Vec<f64> = q.collect();
        let effort = vec![0.0; 2 * COUNT];
        let processing = Processing { cutoff_hz: Some(cutoff_hz), ..Processing::default() };
        let record = AperiodicRecord::new(2, RATE_HZ, &q, &effort);
        let samples =
            process_aperiodic(&record, &hinges::coupled(), EffortInterface::Torque, RATE_HZ / 4.0, &processing)
                .unwrap();
        for (m, used) in samples.used.iter().step_by(2).enumerate().filter(|(m, _)| (12..88).contains(m)) {
            let nearest = (4 * m..4 * m + 4).map(|k| (at(k) - at(k).round()).abs()).fold(1.0, f64::min);
            assert_eq!(*used, nearest > cycles / cutoff_hz, "{m}");
        }
    }

    #[test]
    fn a_mark_leaves_out_the_equation_of_its_own_joint() {
        let (q, effort) = (vec![0.0; 2 * COUNT], vec![0.0; 2 * COUNT]);
        let mut excluded = vec![false; 2 * COUNT];
        // Joint 1 in sample 121, joint 2 in sample 143; blocks of four samples.
        (excluded[2 * 121], excluded[2 * 143 + 1]) = (true, true);
        let record = AperiodicRecord { excluded: &excluded, ..AperiodicRecord::new(2, RATE_HZ, &q, &effort) };
        let samples = processed(&record, RATE_HZ / 4.0);
        assert_eq!((samples.block, samples.used.len()), (4, 2 * COUNT / 4));
        let left_out: Vec<usize> = (0..samples.used.len()).filter(|&row| !samples.used[row]).collect();
        // Behind the filter's edges.
        let inside = 12..2 * COUNT / 4 - 12;
        assert_eq!(left_out.iter().filter(|row| inside.contains(row)).collect::<Vec<_>>(), [&(2 * 30), &(2 * 35 + 1)]);
        assert!(left_out.contains(&0) && left_out.contains(&(2 * COUNT / 4 - 1)));
    }
}
