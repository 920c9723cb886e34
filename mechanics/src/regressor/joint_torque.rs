//! The regressor of joint efforts at one sample.

use std::ops::Range;

use nalgebra::Vector3;

use super::body::BodyRegressor;
use super::straight_axis::StraightAxis;
use crate::dynamics::{LinkPose, TermState, TorqueTerms};
use crate::lanes::{Lane, sines_and_cosines};
use crate::model::{Columns, ColumnsError, ParameterId, Robot, StandardParameters};
use crate::spatial::{LaneMotion, Motion};

/// Up to this many joints no evaluation allocates.
const INLINE_JOINTS: usize = 8;

/// `Y(q, q̇, q̈)` of one robot: n rows (joints), p columns (parameters).
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::chains;
/// use armid::dynamics::Dynamics;
/// use armid::model::Columns;
/// use armid::regressor::JointTorqueRegressor;
/// use armid::seed::Seed;
/// let mut rng = Seed::new(1).stream("doc", 0);
/// let (robot, parameters) = chains::random_robot(&mut rng, 6);
/// let (q, qd, qdd) = chains::random_state(&mut rng, 6);
/// let regressor = JointTorqueRegressor::new(&robot, Columns::RIGID_ROTOR_FRICTION).unwrap();
/// let mut y = vec![0.0; regressor.rows() * regressor.cols()];
/// regressor.evaluate(&q, &qd, &qdd, &mut y);
/// let mut tau = [0.0; 6];
/// Dynamics::new(&robot, &parameters).inverse(&q, &qd, &qdd, &mut tau);
/// let phi = parameters.vector(&robot, regressor.columns());
/// for (row, tau) in y.chunks_exact(regressor.cols()).zip(tau) {
///     let by_regressor: f64 = row.iter().zip(&phi).map(|(y, phi)| y * phi).sum();
///     assert!((by_regressor - tau).abs() < 1e-11);
/// }
/// ```
#[derive(Clone, Debug)]
pub struct JointTorqueRegressor {
    pub(super) poses: Vec<LinkPose>,
    pub(super) axes: Vec<Motion>,
    /// Of each joint whose axis is a straight one.
    pub(super) straight: Vec<Option<StraightAxis>>,
    gravity: Vector3<f64>,
    pub(super) terms: TorqueTerms,
    /// The links' parameters by which the torque is found that terms may depend on, 10 n; empty where none does.
    pub(super) links: Vec<f64>,
    columns: Columns,
    parameters: Vec<ParameterId>,
}

impl JointTorqueRegressor {
    /// The regressor of `robot` with these columns.
    ///
    /// # Errors
    /// [`ColumnsError`] if a term among them depends on more than the motion: on the torque that the links take (see
    /// [`JointTorqueRegressor::with_load`]), on a temperature or on what changes with time.
    pub fn new(robot: &Robot, columns: Columns) -> Result<Self, ColumnsError> {
        columns.check_motion()?;
        Ok(Self::without_load(robot, columns))
    }

    /// The regressor of `robot` with these columns, the torque that the links take, where a term depends on it, being
    /// `Y_links φ_links` by these parameters of the links. A term of temperature is that of a cold gear.
    ///
    /// # Panics
    /// If the parameters are not those of as many links as the robot has.
    pub fn with_load(robot: &Robot, columns: Columns, parameters: &StandardParameters) -> Self {
        assert_eq!(parameters.links.len(), robot.dof(), "parameters of one link for each joint");
        let mut regressor = Self::without_load(robot, columns);
        if regressor.terms.needs_load {
            regressor.links = parameters.vector(robot, Columns::RIGID).as_slice().to_vec();
        }
        regressor
    }

    fn without_load(robot: &Robot, columns: Columns) -> Self {
        Self {
            poses: robot.joints().iter().map(LinkPose::new).collect(),
            axes: robot.axes().to_vec(),
            straight: robot.axes().iter().map(StraightAxis::of).collect(),
            gravity: robot.gravity(),
            terms: TorqueTerms::new(robot, columns),
            links: Vec::new(),
            columns,
            parameters: columns.parameters(robot),
        }
    }

    /// Returns this regressor with other parameters of the links, 10 n, by which the torque is found that terms may depend on.
    #[must_use]
    pub fn with_links(&self, links: &[f64]) -> Self {
        let links = if self.terms.needs_load { links.to_vec() } else { Vec::new() };
        Self { links, ..self.clone() }
    }

    /// Whether a term among its columns depends on the torque that the links take.
    pub const fn needs_load(&self) -> bool {
        self.terms.needs_load
    }

    /// One sample as [`evaluate`](Self::evaluate) gives it, and with it the slopes of `Y φ` by the parameters, for `values` of those of the
    /// terms, in place of the links' columns:
    ///
    /// ```text
    /// ∂(Y φ)/∂φ_links = (1 + S) Y_links        S = ∂τ_terms/∂τ_t
    /// ```
    /// Returns `S τ_t` (n), what the terms that depend on the torque of the links add to the torque.
    ///
    /// # Panics
    /// If a slice is shorter than n, `out` than n·p, or `values` than the parameters of the terms.
    pub fn evaluate_slopes(&self, values: &[f64], [q, qd, qdd]: [&[f64]; 3], out: &mut [f64]) -> Vec<f64> {
        let (n, p) = (self.rows(), self.cols());
        self.evaluate(q, qd, qdd, out);
        let load = self.load(0..n, out);
        let mut slopes = vec![0.0; n * n];
        self.terms.add_load_slopes(values, &TermState { q, qd, qdd, load: &load }, &mut slopes);
        let links: Vec<f64> = out.chunks_exact(p).flat_map(|row| row[..10 * n].to_vec()).collect();
        for (row, slopes) in out.chunks_exact_mut(p).zip(slopes.chunks_exact(n)) {
            for (from, &slope) in links.chunks_exact(10 * n).zip(slopes).filter(|(_, slope)| **slope != 0.0) {
                row.iter_mut().zip(from).for_each(|(to, y)| *to += slope * y);
            }
        }
        slopes.chunks_exact(n).map(|row| row.iter().zip(&load).map(|(slope, load)| slope * load).sum()).collect()
    }

    /// The parameter of each column, p.
    pub fn parameters(&self) -> &[ParameterId] {
        &self.parameters
    }

    /// Which columns it has.
    pub const fn columns(&self) -> Columns {
        self.columns
    }

    /// Number of rows of one sample: joints n.
    pub fn rows(&self) -> usize {
        self.poses.len()
    }

    /// Number of columns p.
    pub fn cols(&self) -> usize {
        self.parameters.len()
    }

    /// One sample: overwrites `out` with `Y(q, q̇, q̈)`, n × p row-major.
    ///
    /// `q`, `qd`, `qdd` (n each) in rad, rad/s, rad/s²; entries in N·m per unit of the parameter.
    ///
    /// # Panics
    /// If a slice is shorter than n, or `out` than n·p.
    pub fn evaluate(&self, q: &[f64], qd: &[f64], qdd: &[f64], out: &mut [f64]) {
        self.evaluate_from(self.base_at_rest(), 0..self.rows(), q, qd, qdd, out);
    }

    /// One sample of joint `row` alone, at a fraction of the cost: its row of [`evaluate`](Self::evaluate), in its place in
    /// `out` (n × p). What else of `out` is overwritten means nothing.
    pub fn evaluate_row(&self, row: usize, q: &[f64], qd: &[f64], qdd: &[f64], out: &mut [f64]) {
        // A motor's load is that of all joints that it drives.
        let rows = if self.links.is_empty() { row..row + 1 } else { 0..self.rows() };
        self.evaluate_from(self.base_at_rest(), rows, q, qd, qdd, out);
    }

    /// Velocity and acceleration of a base at rest, gravity subtracted.
    pub(super) fn base_at_rest(&self) -> (Motion, Motion) {
        (Motion::zero(), Motion::new(Vector3::zeros(), -self.gravity))
    }

    /// The recursion from a base that moves with velocity `v` and acceleration `a`, gravity subtracted, for the joints
    /// `rows`.
    pub(super) fn evaluate_from(
        &self,
        (v, a): (Motion, Motion),
        rows: Range<usize>,
        q: &[f64],
        qd: &[f64],
        qdd: &[f64],
        out: &mut [f64],
    ) {
        let (n, p) = (self.rows(), self.cols());
        let out = &mut out[..n * p];
        // Axes of the joints so far, in the frame of the current link.
        let mut inline = [LaneMotion::splat(0.0, &Motion::zero()); INLINE_JOINTS];
        let mut heap = Vec::new();
        let carried: &mut [LaneMotion<f64>] = if n <= INLINE_JOINTS {
            &mut inline
        } else {
            heap.resize(n, inline[0]);
            &mut heap
        };
        let mut few = [[0.0; INLINE_JOINTS]; 2];
        let mut many;
        let [sines, cosines]: [&mut [f64]; 2] = if n <= INLINE_JOINTS {
            few.each_mut().map(|x| &mut x[..n])
        } else {
            many = [vec![0.0; n], vec![0.0; n]];
            many.each_mut().map(|x: &mut Vec<f64>| x.as_mut_slice())
        };
        sines_and_cosines(&q[..n], sines, cosines);
        self.walk(
            (&v).into(),
            (&a).into(),
            |k| (self.poses[k].turn_of(q[k], sines[k], cosines[k]), [qd[k], qdd[k]]),
            rows.clone(),
            carried,
            |k, body, axes| {
                for (i, row) in rows.clone().zip(out[rows.start * p..].chunks_exact_mut(p)) {
                    let block = row[10 * k..].first_chunk_mut().expect("a row holds ten columns per link");
                    *block = match &self.straight[k] {
                        // A link further in does not load joint i.
                        _ if i > k => [0.0; 10],
                        Some(own) if i == k => own.project(body),
                        _ => body.project(&axes[i]),
                    };
                }
            },
        );
        for row in out[rows.start * p..].chunks_exact_mut(p).take(rows.len()) {
            row[10 * n..].fill(0.0);
        }
        let load = self.load(rows, out);
        let state = TermState { q: &q[..n], qd: &qd[..n], qdd: &qdd[..n], load: &load };
        self.terms.write_columns(&state, 10 * n, p, out);
    }

    /// The recursion itself, for as many samples as V has lanes, from a base with velocity `v` and acceleration `a`. Calls
    /// `visit` for each link with its body's regressor and the axes of the joints `rows` up to it, in its frame; `state` gives
    /// the two functions of a joint's position ([`LinkPose`]), its velocity and its acceleration.
    #[inline(always)]
    pub(super) fn walk<V: Lane>(
        &self,
        mut v: LaneMotion<V>,
        mut a: LaneMotion<V>,
        mut state: impl FnMut(usize) -> ([V; 2], [V; 2]),
        rows: Range<usize>,
        axes: &mut [LaneMotion<V>],
        mut visit: impl FnMut(usize, &BodyRegressor<V>, &[LaneMotion<V>]),
    ) {
        for (k, (pose, axis)) in self.poses.iter().zip(&self.axes).enumerate() {
            let (turn, [qd, qdd]) = state(k);
            let x = pose.in_lanes(turn);
            (v, a) = (x.motion_to_child(&v), x.motion_to_child(&a));
            for s in &mut axes[rows.start.min(k)..rows.end.min(k)] {
                *s = x.motion_to_child(s);
            }
            let axis = LaneMotion::splat(qd, axis);
            if let Some(own) = &self.straight[k] {
                (v, a) = own.moved((v, a), qd, qdd);
            } else {
                let rate = axis.times(qd);
                v = v.plus(&rate);
                a = a.plus(&axis.times(qdd)).plus(&v.cross(&rate));
            }
            axes[k] = axis;
            visit(k, &BodyRegressor::in_lanes(&v, &a), axes);
        }
    }

    /// The torque that the links take of the joints `rows`, by what stands in their columns; empty where no term needs it.
    pub(super) fn load(&self, rows: Range<usize>, out: &[f64]) -> Vec<f64> {
        if self.links.is_empty() {
            return Vec::new();
        }
        let mut load = vec![0.0; self.rows()];
        for (load, row) in load[rows.clone()].iter_mut().zip(out.chunks_exact(self.cols()).skip(rows.start)) {
            *load = row.iter().zip(&self.links).fold(0.0, |sum, (y, phi)| sum + y * phi);
        }
        load
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains::{self, ChainRecipe};
    use crate::dynamics::{Dynamics, States};
    use crate::model::term::LOAD_FRICTION;
    use crate::seed::Seed;

    #[test]
    fn identity_a_row_alone_is_that_of_the_whole_regressor() {
        for run in 0..20 {
            let mut rng = Seed::new(12).stream("chains", run);
            let dof = 1 + usize::try_from(run % 9).unwrap();
            let (robot, _) = ChainRecipe { coupled: run % 2 == 0, ..ChainRecipe::new(dof) }.draw(&mut rng);
            let regressor = JointTorqueRegressor::new(&robot, Columns::RIGID_ROTOR_FRICTION).unwrap();
            let (q, qd, qdd) = chains::random_state(&mut rng, dof);
            let p = regressor.cols();
            let mut whole = vec![0.0; dof * p];
            regressor.evaluate(&q, &qd, &qdd, &mut whole);
            for row in 0..dof {
                let mut alone = vec![f64::NAN; dof * p];
                regressor.evaluate_row(row, &q, &qd, &qdd, &mut alone);
                // The same operations in the same order: the same bits.
                assert_eq!(alone[row * p..(row + 1) * p], whole[row * p..(row + 1) * p]);
            }
        }
    }

    #[test]
    fn identity_inverse_dynamics_is_regressor_times_parameters() {
        let seed = Seed::new(11);
        for run in 0..60 {
            let mut rng = seed.stream("chains", run);
            let dof = 1 + usize::try_from(run % 9).unwrap();
            let recipe = ChainRecipe { coupled: run % 2 == 0, tilted: run % 3 == 0, ..ChainRecipe::new(dof) };
            let (robot, parameters) = recipe.draw(&mut rng);
            let regressor = JointTorqueRegressor::new(&robot, Columns::RIGID_ROTOR_FRICTION).unwrap();
            let phi = parameters.vector(&robot, Columns::RIGID_ROTOR_FRICTION);
            let mut dynamics = Dynamics::new(&robot, &parameters);
            let mut states = States::new(dof);
            for _ in 0..10 {
                let (q, qd, qdd) = chains::random_state(&mut rng, dof);
                states.push(&q, &qd, &qdd);
            }
            let torque = regressor.stack(&states) * phi;
            for k in 0..states.len() {
                let mut tau = vec![0.0; dof];
                dynamics.inverse(states.q(k), states.qd(k), states.qdd(k), &mut tau);
                let size = tau.iter().fold(1.0_f64, |m, t| m.max(t.abs()));
                for i in 0..dof {
                    // Rounding of some hundred operations on torques of this size.
                    assert!((torque[k * dof + i] - tau[i]).abs() < 1e-13 * size, "chain {run}, joint {i}");
                }
            }
        }
    }

    #[test]
    fn identity_the_load_is_the_torque_of_the_links_alone() {
        let mut rng = Seed::new(15).stream("chains", 0);
        let (robot, parameters) = ChainRecipe::new(6).draw(&mut rng);
        let columns = Columns::RIGID_ROTOR_FRICTION.with_term(LOAD_FRICTION);
        let (q, qd, qdd) = chains::random_state(&mut rng, 6);
        let mut states = States::new(6);
        states.push(&q, &qd, &qdd);
        let links = JointTorqueRegressor::new(&robot, Columns::RIGID).unwrap();
        let expected = links.stack(&states) * parameters.vector(&robot, Columns::RIGID);
        let found = JointTorqueRegressor::with_load(&robot, columns, &parameters).load_at(&q, &qd, &qdd);
        for (found, expected) in found.iter().zip(expected.iter()) {
            assert!((found - expected).abs() < 1e-12 * expected.abs().max(1.0), "{found} {expected}");
        }
    }
}
