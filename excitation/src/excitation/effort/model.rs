//! Torque and its uncertainty at one instant, and the slopes of both.

use std::ops::Range;

use rand::RngExt;
use rand_distr::StandardNormal;

use super::channel::Channel;
use super::spread::ParameterSpread;
use crate::excitation::information::pattern;
use crate::model::{Columns, Robot, StandardParameters};
use crate::optimiser::{dot, square};
use crate::provenance::sha256;
use crate::regressor::JointTorqueRegressor;
use crate::seed::Seed;
use crate::statistics::{Interval, wilson_interval};
use crate::trajectory::{PathPoint, Timeline, Trajectory};

/// Efforts of a robot by parameters that are known with an uncertainty.
#[derive(Clone, Debug)]
pub struct EffortModel {
    pub(super) regressor: JointTorqueRegressor,
    pub(super) phi: Vec<f64>,
    /// Variance of each parameter, zero where it is taken as known.
    pub(super) variance: Vec<f64>,
    pub(super) multiple: f64,
    /// Where the row of each joint can differ from zero.
    pub(super) columns: Vec<Vec<Range<usize>>>,
    /// Regressor at the last instant, n × p.
    y: Vec<f64>,
    /// Row `w · Y` of the last channel, p.
    row: Vec<f64>,
    state: [Vec<f64>; 3],
}

/// Sets of parameters that are drawn.
const INSIDE_DRAWS: usize = 400;

/// Instants of a period at which they are looked at.
const INSIDE_SAMPLES: usize = 200;

/// How many of the parameter sets drawn pass no effort limit at any instant looked at.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct InsideShare {
    /// The share of all draws.
    pub share: f64,
    /// Sets of parameters drawn.
    pub draws: usize,
    /// 95 % interval of the share (Wilson).
    pub ci95: [f64; 2],
}

impl InsideShare {
    fn new(hits: usize, draws: usize) -> Self {
        let share = hits as f64 / draws as f64;
        let whole = Interval { low: 0.0, high: 1.0 };
        let Interval { low, high } = wilson_interval(hits, draws, 0.95).unwrap_or(whole);
        Self { share, draws, ci95: [low, high] }
    }
}

/// An effort at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Load {
    /// By the nominal parameters, `w · Y φ̄`.
    pub(super) value: f64,
    /// k standard deviations of it.
    pub(super) spread: f64,
}

impl Load {
    /// The largest magnitude that it stands for.
    pub(super) fn largest(&self) -> f64 {
        self.value.abs() + self.spread
    }
}

impl EffortModel {
    /// The efforts of `robot` by the `nominal` parameters, and their uncertainty where one is given.
    ///
    /// # Panics
    /// If the parameters or their deviations are not those of the robot.
    pub fn new(robot: &Robot, nominal: &StandardParameters, spread: Option<&ParameterSpread>) -> Self {
        let n = robot.dof();
        let columns = Columns::default().with_terms_of(nominal);
        let regressor = JointTorqueRegressor::with_load(robot, columns, nominal);
        let phi: Vec<f64> = nominal.vector(robot, columns).iter().copied().collect();
        let p = phi.len();
        let variance = spread.map_or_else(|| vec![0.0; p], |s| s.deviations.iter().map(|x| x * x).collect());
        assert_eq!(variance.len(), p, "one deviation per parameter");
        let multiple = spread.map_or(0.0, |spread| spread.multiple);
        let state = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
        let pattern = pattern(&regressor);
        let columns = pattern.chunks_exact(p).map(ranges).collect();
        let (y, row) = (vec![0.0; n * p], vec![0.0; p]);
        Self { regressor, phi, variance, multiple, columns, y, row, state }
    }

    /// Number of joints n.
    pub fn dof(&self) -> usize {
        self.regressor.rows()
    }

    /// SHA-256 of the parameters, and of how well they are known where that counts.
    pub fn parameters_sha256(&self) -> String {
        let variance: &[f64] = if self.multiple > 0.0 { &self.variance } else { &[] };
        sha256(&format!("{:?} {variance:?}", self.phi))
    }

    /// Evaluates the regressor at an instant of an experiment around a motion.
    pub(super) fn move_to(&mut self, motion: &dyn Trajectory, omega: f64, point: &PathPoint) {
        self.move_state_to(motion, omega, point);
        let [q, qd, qdd] = &self.state;
        self.regressor.evaluate(q, qd, qdd, &mut self.y);
    }

    /// The effort of one channel at an instant, without moving the others there.
    pub(super) fn load_at(
        &mut self,
        channel: &Channel,
        motion: &dyn Trajectory,
        omega: f64,
        point: &PathPoint,
    ) -> Load {
        self.move_channel_to(channel, motion, omega, point);
        self.load(channel)
    }

    /// Moves to an instant, for one channel alone. Returns the state there.
    pub(super) fn move_channel_to(
        &mut self,
        channel: &Channel,
        motion: &dyn Trajectory,
        omega: f64,
        point: &PathPoint,
    ) -> [&[f64]; 3] {
        self.move_state_to(motion, omega, point);
        let [q, qd, qdd] = &self.state;
        match channel.single() {
            Some((joint, _)) => self.regressor.evaluate_row(joint, q, qd, qdd, &mut self.y),
            None => self.regressor.evaluate(q, qd, qdd, &mut self.y),
        }
        self.state.each_ref().map(Vec::as_slice)
    }

    /// Returns the state at an instant of an experiment around a motion: coordinates, velocities and accelerations.
    pub(super) fn move_state_to(&mut self, motion: &dyn Trajectory, omega: f64, point: &PathPoint) -> [&[f64]; 3] {
        let [q, qd, qdd] = &mut self.state;
        motion.evaluate(point.phase / omega, q, qd, qdd);
        point.scale_motion(qd, qdd);
        self.state.each_ref().map(Vec::as_slice)
    }

    /// The effort of a channel where the model was last moved to.
    pub(super) fn load(&mut self, channel: &Channel) -> Load {
        let (mut value, mut variance) = (0.0, 0.0);
        if let Some((i, weight)) = channel.single() {
            // Most efforts are those of one joint, and most of its row is zero: of the links that it does not carry.
            let y = &self.y[i * self.phi.len()..];
            for range in &self.columns[i] {
                let y = &y[range.clone()];
                value += weight * dot(y, &self.phi[range.clone()]);
                variance += weight * weight * square(y, &self.variance[range.clone()]);
            }
        } else {
            self.fill_row(channel);
            value = dot(&self.row, &self.phi);
            variance = square(&self.row, &self.variance);
        }
        self.load_of(value, variance)
    }

    pub(super) fn load_of(&self, value: f64, variance: f64) -> Load {
        let spread = if self.multiple > 0.0 { self.multiple * variance.sqrt() } else { 0.0 };
        Load { value, spread }
    }

    /// Writes the row `w · Y` of a channel where the model was last moved to.
    fn fill_row(&mut self, channel: &Channel) {
        self.row.fill(0.0);
        let rows = self.y.chunks_exact(self.phi.len());
        for (y, &weight) in rows.zip(&channel.weights).filter(|(_, weight)| **weight != 0.0) {
            for (row, y) in self.row.iter_mut().zip(y) {
                *row += weight * y;
            }
        }
    }

    /// Writes into `g` (n × p) the derivatives of `scale · (sign · value + spread)` by the regressor's entries, of a channel where the
    /// model was last moved to.
    pub(super) fn write_weights(&mut self, channel: &Channel, sign: f64, scale: f64, g: &mut [f64]) {
        let Load { spread, .. } = self.load(channel);
        self.fill_row(channel);
        let p = self.phi.len();
        let factor = if spread > 0.0 { self.multiple * self.multiple / spread } else { 0.0 };
        g.fill(0.0);
        for (i, &weight) in channel.weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0) {
            let row = self.row.iter().zip(&self.phi).zip(&self.variance);
            for (g, ((y, phi), variance)) in g[i * p..(i + 1) * p].iter_mut().zip(row) {
                *g = scale * weight * (sign * phi + factor * variance * y);
            }
        }
    }

    /// Of sets of parameters drawn from the stated uncertainty, how many pass no peak limit of `channels` at any of some
    /// instants of period and ramps: the share that all limits hold *together* and *at all times*.
    pub(crate) fn inside(&mut self, motion: &dyn Trajectory, timeline: Timeline, channels: &[Channel]) -> InsideShare {
        let draws = INSIDE_DRAWS;
        let mut rng = Seed::new(0).stream("parameters within their uncertainty", 0);
        // Parameter by parameter, so that all sets are looked at in one pass.
        let mut sets = vec![0.0; self.phi.len() * draws];
        for draw in 0..draws {
            for (c, (phi, variance)) in self.phi.iter().zip(&self.variance).enumerate() {
                let normal: f64 = rng.sample(StandardNormal);
                sets[c * draws + draw] = phi + normal * variance.sqrt();
            }
        }
        let mut inside = vec![true; draws];
        let mut efforts = vec![0.0; draws];
        let omega = std::f64::consts::TAU / timeline.period_s;
        for &segment in timeline.segments() {
            let count = timeline.samples(segment, INSIDE_SAMPLES);
            for k in 0..count {
                self.move_to(motion, omega, &timeline.point(segment, k as f64 / count as f64));
                for channel in channels.iter().filter(|channel| channel.peak.is_finite()) {
                    self.fill_row(channel);
                    efforts.fill(0.0);
                    for (entry, sets) in self.row.iter().zip(sets.chunks_exact(draws)).filter(|(y, _)| **y != 0.0) {
                        for (effort, parameter) in efforts.iter_mut().zip(sets) {
                            *effort += entry * parameter;
                        }
                    }
                    for (inside, effort) in inside.iter_mut().zip(&efforts) {
                        *inside &= effort.abs() <= channel.peak;
                    }
                }
            }
        }
        InsideShare::new(inside.iter().filter(|inside| **inside).count(), draws)
    }
}

/// The segments of a row that can differ from zero.
fn ranges(row: &[bool]) -> Vec<Range<usize>> {
    let mut ranges: Vec<Range<usize>> = Vec::new();
    for column in (0..row.len()).filter(|&column| row[column]) {
        match ranges.last_mut() {
            Some(last) if last.end == column => last.end += 1,
            _ => ranges.push(column..column + 1),
        }
    }
    ranges
}
