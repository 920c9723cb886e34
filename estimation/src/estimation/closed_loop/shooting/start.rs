//! Multiple shooting of the closed loop along a recording.

use nalgebra::{DMatrix, DVector};

use super::interval::{End, Interval, Point};
use super::search::{CLOSED, search};
use crate::estimation::closed_loop::descent::is_rejected;
use crate::estimation::closed_loop::simulation::{ClosedLoopInterval, ClosedLoopNode};
use crate::estimation::closed_loop::trial::Trial;
use crate::estimation::error::EstimationError;
use crate::estimation::finding::Finding;

/// Parts of a recording that an interval is tried as, the longest first; not less than a block.
const PARTS: [usize; 5] = [10, 30, 100, 300, 1000];

/// What is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::estimation::closed_loop) enum Output {
    /// Measured and simulated positions.
    Positions,
    /// Measured and simulated torques.
    Torque,
}

/// β where the intervals are one motion, from a β whose motion runs away, and what is to be said of it; `None` where the loop
/// cannot be simulated in intervals, or where they do not become one motion.
pub(in crate::estimation::closed_loop) fn shoot(
    trial: &Trial<'_>,
    from: &DVector<f64>,
    output: Output,
) -> Result<Option<(DVector<f64>, Finding)>, EstimationError> {
    let Some(loop_of) = trial.in_intervals() else { return Ok(None) };
    let n = trial.observation.dof;
    let blocks = trial.observation.y.len() / n;
    let measured = match output {
        Output::Positions => trial.positions(),
        Output::Torque => trial.observation.y.clone(),
    };
    let outputs = DVector::from_fn(n, |i, _| spread(measured.iter().skip(i).step_by(n)));
    let mut apart_before = usize::MAX;
    for parts in PARTS {
        let apart = (blocks / parts).max(1);
        if apart == apart_before {
            continue;
        }
        apart_before = apart;
        let nodes = trial.nodes(loop_of, from, apart);
        let used = &trial.observation.used;
        let linearise = |point: &Point| {
            let nodes: Vec<ClosedLoopNode> = nodes
                .iter()
                .zip(&point.nodes)
                .map(|(node, state)| ClosedLoopNode { state: state.clone(), ..node.clone() })
                .collect();
            let found = trial.intervals(loop_of, &point.beta, &nodes)?;
            let follows = nodes.iter().skip(1).map(|node| node.follows).chain([false]);
            let linear = |((own, node), continues)| linearised(used, &measured, (output, own), node, continues);
            Ok(found.into_iter().zip(&nodes).zip(follows).map(linear).collect::<Vec<Interval>>())
        };
        let start = Point { beta: from.clone(), nodes: nodes.iter().map(|node| node.state.clone()).collect() };
        let at = match linearise(&start) {
            Ok(at) => at,
            // Shorter ones may do.
            Err(error) if is_rejected(&error) => continue,
            Err(error) => return Err(error),
        };
        let found = search((start, at), (&outputs, n), &linearise, is_rejected)?;
        let finding = Finding::MultipleShooting { intervals: nodes.len(), gap: found.gap };
        return Ok((found.gap <= CLOSED).then_some((found.point.beta, finding)));
    }
    Ok(None)
}

/// Equations of one interval; zero in rows that are none.
fn linearised(
    used: &[bool],
    measured: &DVector<f64>,
    (output, own): (Output, ClosedLoopInterval),
    node: &ClosedLoopNode,
    continues: bool,
) -> Interval {
    let s = node.state.len();
    let (simulated, slopes) = match output {
        Output::Positions => (own.q, own.slopes.q),
        Output::Torque => (own.tau, own.slopes.tau),
    };
    let (first, d) = (node.blocks.start * simulated.len() / node.blocks.len(), slopes.ncols() - s);
    let of = |row: usize, value: f64| if used[first + row] { value } else { 0.0 };
    let part =
        |from: usize, width: usize| DMatrix::from_fn(slopes.nrows(), width, |row, k| of(row, slopes[(row, from + k)]));
    Interval {
        residual: DVector::from_fn(simulated.len(), |row, _| of(row, measured[first + row] - simulated[row])),
        by_parameters: part(0, d),
        by_state: part(d, s),
        end: continues.then(|| End {
            by_parameters: own.end_slopes.columns(0, d).into_owned(),
            by_state: own.end_slopes.columns(d, s).into_owned(),
            state: own.end,
        }),
    }
}

/// Standard deviation.
fn spread<'a>(values: impl Iterator<Item = &'a f64> + Clone) -> f64 {
    let count = values.clone().count().max(1) as f64;
    let mean = values.clone().sum::<f64>() / count;
    (values.map(|value| (value - mean) * (value - mean)).sum::<f64>() / count).sqrt()
}
