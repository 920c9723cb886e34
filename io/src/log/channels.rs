//! Channels that stood still or ran into their end while the arm moved.
//!
//! - *saturated*: an effort has its largest (smallest) value again and again, five times in a row somewhere, and the next
//!   three values below it occur less than a tenth as often, while the joint moves: a peak that is merely rounded dwells on
//!   the values below it as well.
//! - *frozen position*: the same value at least ten times in a row, and then a jump of more than three times what the joint
//!   makes in one step otherwise.
//! - *frozen effort*: the same value at least ten times in a row, five times as long as usual, while its joint moves, and then
//!   a change of more than the smallest step of the channel, which is all that a rounded peak changes by.
//!
//! Rows of a frozen position give no equation at all, those of an effort none of its joint; all are counted.

use std::collections::BTreeSet;

use serde::Serialize;

/// Smallest steps in a step from which on a joint moves.
const MOVING: f64 = 3.0;
/// Samples in a row from which on a value counts as held.
const HELD: usize = 10;
/// Repeats of a value at the end of a channel.
const HELD_AT_END: usize = 5;

/// What is wrong with a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ChannelState {
    /// The effort stays at its largest or smallest value.
    Saturated,
    /// The effort does not change while the joint moves.
    FrozenEffort,
    /// The position does not change, and then jumps.
    FrozenPosition,
}

/// A channel that is not what it should be.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChannelFault {
    /// Joint, from one.
    pub joint: usize,
    /// What is wrong.
    pub state: ChannelState,
    /// Rows that it takes.
    pub rows: usize,
}

impl ChannelFault {
    /// One sentence.
    pub fn sentence(&self) -> String {
        let Self { joint, rows, .. } = self;
        match self.state {
            ChannelState::Saturated => {
                format!("joint {joint}: {rows} rows at the end of the effort's range are not used for this joint")
            }
            ChannelState::FrozenEffort => {
                format!(
                    "joint {joint}: the effort is constant in {rows} rows of motion; they are not used for this joint"
                )
            }
            ChannelState::FrozenPosition => {
                format!("joint {joint}: the position is constant in {rows} rows and then jumps; they are not used")
            }
        }
    }
}

/// Looks at positions and efforts (N × n); the faults, and which rows give no equation of which joint (N × n; empty where
/// all do).
pub(super) fn look(q: &[f64], effort: &[f64], n: usize) -> (Vec<ChannelFault>, Vec<bool>) {
    let (mut faults, mut excluded) = (Vec::new(), Vec::new());
    let column = |rows: &[f64], i: usize| -> Vec<f64> { rows.iter().skip(i).step_by(n).copied().collect() };
    for i in 0..n {
        let (position, effort) = (column(q, i), column(effort, i));
        let frozen = frozen_position(&position);
        let saturated = saturated(&effort, &position);
        let mut still = frozen_effort(&effort, &position);
        let ends: BTreeSet<usize> = saturated.iter().copied().collect();
        still.retain(|row| !ends.contains(row));
        for (state, rows) in [
            (ChannelState::Saturated, saturated),
            (ChannelState::FrozenEffort, still),
            (ChannelState::FrozenPosition, frozen),
        ] {
            if rows.is_empty() {
                continue;
            }
            faults.push(ChannelFault { joint: i + 1, state, rows: rows.len() });
            excluded.resize(q.len(), false);
            for row in rows {
                let joints = if state == ChannelState::FrozenPosition { 0..n } else { i..i + 1 };
                excluded[row * n + joints.start..row * n + joints.end].fill(true);
            }
        }
    }
    (faults, excluded)
}

/// Rows that repeat the positions of the row before while the arm moves: what is written more often than it is read. Runs of ten and
/// more are standstill or a frozen channel, and a joint that moves by single counts of its encoder is merely slow.
pub(super) fn repeated_rows(q: &[f64], n: usize) -> usize {
    let rows: Vec<&[f64]> = q.chunks_exact(n).collect();
    let step = |k: usize, i: usize| (rows[k][i] - rows[k - 1][i]).abs();
    let count = |i: usize| (1..rows.len()).map(|k| step(k, i)).filter(|step| *step > 0.0).fold(f64::INFINITY, f64::min);
    let counts: Vec<f64> = (0..n).map(count).collect();
    let (mut repeated, mut held) = (0, 0);
    for k in 1..rows.len() {
        if rows[k] == rows[k - 1] {
            held += 1;
            continue;
        }
        if held < HELD && (0..n).any(|i| step(k, i) > MOVING * counts[i]) {
            repeated += held;
        }
        held = 0;
    }
    repeated
}

/// Where a value stays the same: first row and number of rows.
fn runs(x: &[f64]) -> Vec<(usize, usize)> {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for (row, value) in x.iter().enumerate() {
        match runs.last_mut() {
            Some((first, length)) if x[*first].to_bits() == value.to_bits() => *length += 1,
            _ => runs.push((row, 1)),
        }
    }
    runs
}

/// Largest minus smallest value.
fn spread(x: &[f64]) -> f64 {
    let (low, high) = x.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)));
    if x.is_empty() { 0.0 } else { high - low }
}

fn frozen_position(q: &[f64]) -> Vec<usize> {
    let mut steps: Vec<f64> = q.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|step| *step > 0.0).collect();
    steps.sort_by(f64::total_cmp);
    // All but one step in a thousand are shorter.
    let Some(&usual) = steps.get((steps.len() * 999 / 1000).saturating_sub(2)) else { return Vec::new() };
    let runs = runs(q);
    let jumps = |&(first, length): &(usize, usize)| {
        let next = first + length;
        length >= HELD && next < q.len() && (q[next] - q[next - 1]).abs() > 3.0 * usual
    };
    runs.iter().filter(|run| jumps(run)).flat_map(|&(first, length)| first..first + length).collect()
}

fn saturated(effort: &[f64], q: &[f64]) -> Vec<usize> {
    let runs = runs(effort);
    let moves = |first: usize, length: usize| spread(&q[first..first + length]) > 0.0;
    let mut found = Vec::new();
    for sign in [1.0, -1.0] {
        let mut values: Vec<f64> = effort.iter().map(|x| sign * x).collect();
        values.sort_by(|a, b| b.total_cmp(a));
        let Some(&end) = values.first() else { continue };
        let at_end = values.iter().take_while(|value| **value == end).count();
        let mut levels = 0;
        let mut last = end;
        let below = values[at_end..]
            .iter()
            .take_while(|value| {
                if **value != last {
                    (levels, last) = (levels + 1, **value);
                }
                levels <= 3
            })
            .count();
        let at = |&&(first, _): &&(usize, usize)| sign * effort[first] == end;
        let longest = runs.iter().filter(at).filter(|run| moves(run.0, run.1)).map(|run| run.1).max().unwrap_or(0);
        if longest >= HELD_AT_END && at_end > 10 * below && spread(effort) > 0.0 {
            found.extend(runs.iter().filter(at).filter(|run| moves(run.0, run.1)).flat_map(|run| run.0..run.0 + run.1));
        }
    }
    found
}

fn frozen_effort(effort: &[f64], q: &[f64]) -> Vec<usize> {
    let runs = runs(effort);
    if runs.len() < 2 {
        return Vec::new();
    }
    let mut lengths: Vec<usize> = runs.iter().map(|run| run.1).collect();
    lengths.sort_unstable();
    let usual = lengths[lengths.len() / 2];
    let range = spread(q);
    let steps = effort.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|step| *step > 0.0);
    let smallest = steps.fold(f64::INFINITY, f64::min);
    let jumps = |first: usize, length: usize| {
        let next = first + length;
        next < effort.len() && (effort[next] - effort[next - 1]).abs() > 1.5 * smallest
    };
    runs.into_iter()
        .filter(|&(first, length)| {
            length >= HELD.max(5 * usual)
                && jumps(first, length)
                && spread(&q[first..first + length]) > 0.01 * range
                && range > 0.0
        })
        .flat_map(|(first, length)| first..first + length)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{ChannelState, look, repeated_rows};

    fn wave(k: usize, amplitude: f64) -> f64 {
        amplitude * (0.01 * k as f64).sin()
    }

    fn states(q: &[f64], effort: &[f64]) -> Vec<(ChannelState, usize)> {
        look(q, effort, 1).0.into_iter().map(|fault| (fault.state, fault.rows)).collect()
    }

    #[test]
    fn sound_channels_have_no_fault_even_where_they_are_rounded_or_at_rest() {
        let q: Vec<f64> = (0..4000).map(|k| wave(k, 1.0)).collect();
        let rough = |step: f64, x: f64| (x / step).round() * step;
        for step in [1e-9, 1e-3, 0.02] {
            let effort: Vec<f64> = (0..4000).map(|k| rough(step, wave(k + 50, 3.0))).collect();
            let q: Vec<f64> = q.iter().map(|q| rough(1e-4, *q)).collect();
            assert!(states(&q, &effort).is_empty(), "{step}: {:?}", states(&q, &effort));
        }
        // At rest nothing changes.
        assert!(states(&[0.5; 500], &[2.0; 500]).is_empty());
        let rest: Vec<f64> = (0..4000).map(|k| wave(k.clamp(1000, 3000), 1.0)).collect();
        let effort: Vec<f64> = rest.iter().map(|q| 5.0 * q).collect();
        assert!(states(&rest, &effort).is_empty(), "{:?}", states(&rest, &effort));
    }

    #[test]
    fn rows_that_repeat_are_counted_and_slow_or_resting_joints_are_not() {
        let read: Vec<f64> = (0..4000).flat_map(|k| [wave(k, 1.0), wave(k + 300, 0.4)]).collect();
        assert_eq!(repeated_rows(&read, 2), 0);
        // Every fifth row is that of the row before.
        let row = |k: usize| if k % 5 == 4 { k - 1 } else { k };
        let written: Vec<f64> = (0..4000).flat_map(|k| [read[2 * row(k)], read[2 * row(k) + 1]]).collect();
        assert_eq!(repeated_rows(&written, 2), 799);
        let counts: Vec<f64> = read.iter().map(|q| (q / 0.02).round() * 0.02).collect();
        assert_eq!(repeated_rows(&counts, 2), 0);
        let rest: Vec<f64> = (0..4000).flat_map(|k| [read[2 * k.max(1000)], read[2 * k.max(1000) + 1]]).collect();
        assert_eq!(repeated_rows(&rest, 2), 0);
    }

    #[test]
    fn saturation_and_frozen_channels_are_counted() {
        let q: Vec<f64> = (0..4000).map(|k| wave(k, 1.0)).collect();
        let clipped: Vec<f64> = (0..4000).map(|k| wave(k + 50, 3.0).clamp(-2.0, 9.0)).collect();
        let at_end = clipped.iter().filter(|x| **x == -2.0).count();
        assert_eq!(states(&q, &clipped), [(ChannelState::Saturated, at_end)]);

        let mut effort: Vec<f64> = (0..4000).map(|k| wave(k + 50, 3.0)).collect();
        let held = effort[1000];
        effort[1000..1100].fill(held);
        assert_eq!(states(&q, &effort), [(ChannelState::FrozenEffort, 100)]);

        let mut frozen = q.clone();
        frozen[2000..2100].fill(q[2000]);
        let (faults, excluded) = look(&frozen, &clipped.iter().map(|_| 0.0).collect::<Vec<_>>(), 1);
        assert_eq!((faults[0].state, faults[0].rows), (ChannelState::FrozenPosition, 100));
        assert_eq!(excluded.iter().filter(|x| **x).count(), 100);
    }
}
