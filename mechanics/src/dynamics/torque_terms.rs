//! All torque terms of a robot, bound to its joints and motors and to their parameters.

use nalgebra::DMatrix;

use super::placed_term::PlacedTerm;
use crate::linalg::dot;
use crate::model::term::{Shapes, Slope, Term, TermBlock, TermInput};
use crate::model::{Columns, ParameterId, Robot, StandardParameters};

/// So many joints are evaluated at once, without allocating.
const CHUNK: usize = 8;

/// One term and those joints or motors that have its parameter.
#[derive(Clone, Debug)]
struct Bank {
    term: Term,
    /// Whether its coordinates are those of coupled motors.
    through_coupling: bool,
    /// Index of the joint or motor, and which of the terms' columns its parameter is.
    members: Vec<(usize, usize)>,
    /// Shape parameters of each joint or motor, n.
    shapes: Vec<Shapes>,
}

/// A state of the joints as terms see it, slices of length n.
#[derive(Clone, Copy, Debug)]
pub struct TermState<'a> {
    /// Positions, rad (m).
    pub q: &'a [f64],
    /// Velocities, rad/s (m/s).
    pub qd: &'a [f64],
    /// Accelerations, rad/s² (m/s²).
    pub qdd: &'a [f64],
    /// Torque that the links take of each joint, N·m (N); may be empty where no term needs it.
    pub load: &'a [f64],
}

/// The torque terms of a robot and the columns they have in its regressor, after those of the links.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::chains;
/// use armid::dynamics::TorqueTerms;
/// use armid::model::Columns;
/// let terms = TorqueTerms::new(&chains::planar_2r(), Columns::RIGID_ROTOR_FRICTION);
/// let names: Vec<String> = terms.parameters().iter().map(ToString::to_string).collect();
/// assert_eq!(names, ["Ia1", "Fv1", "Fc1", "Fo1", "Ia2", "Fv2", "Fc2", "Fo2"]);
/// ```
#[derive(Clone, Debug)]
pub struct TorqueTerms {
    dof: usize,
    parameters: Vec<ParameterId>,
    banks: Vec<Bank>,
    /// Motor coordinates from joint coordinates, row-major n × n; empty where motors are not coupled.
    coupling: Vec<f64>,
    /// Motor torques from joint torques, `C⁻ᵀ`, row-major n × n; empty where motors are not coupled.
    torque_coupling: Vec<f64>,
    /// Whether a term depends on the torque that the links take.
    pub(crate) needs_load: bool,
}

impl TorqueTerms {
    /// The terms among these columns of a robot.
    pub fn new(robot: &Robot, columns: Columns) -> Self {
        let dof = robot.dof();
        let parameters = columns.parameters(robot).split_off(10 * dof);
        let coupled = robot.coupling().is_some();
        let bank = |term: Term| {
            let own = parameters.iter().enumerate().filter(|(_, id)| id.kind.term() == Some(term));
            Bank {
                term,
                through_coupling: coupled && term.is_motors(),
                members: own.map(|(column, id)| (id.index, column)).collect(),
                shapes: robot.joints().iter().map(|joint| joint.drive.shapes_of(term)).collect(),
            }
        };
        let banks: Vec<Bank> = columns.terms().map(bank).filter(|bank| !bank.members.is_empty()).collect();
        let coupling = robot.coupling().map(|c| c.transpose().as_slice().to_vec()).unwrap_or_default();
        let inverse = robot.coupling().map(|c| {
            // Row-major C⁻ᵀ is column-major C⁻¹.
            c.clone().try_inverse().expect("a robot's coupling is invertible by construction").as_slice().to_vec()
        });
        let needs_load = banks.iter().any(|bank| bank.term.entry().needs.load);
        Self { dof, parameters, banks, coupling, torque_coupling: inverse.unwrap_or_default(), needs_load }
    }

    /// Those that act with these parameters: without what all joints have with the value zero.
    #[must_use]
    pub(super) fn acting(mut self, parameters: &StandardParameters) -> Self {
        let all = &self.parameters;
        self.banks.retain(|bank| bank.members.iter().any(|&(_, column)| parameters.get(all[column]) != 0.0));
        self.needs_load = self.banks.iter().any(|bank| bank.term.entry().needs.load);
        self
    }

    /// The parameter of each column, in order.
    pub fn parameters(&self) -> &[ParameterId] {
        &self.parameters
    }

    /// Whether there is any.
    pub(super) const fn acts(&self) -> bool {
        !self.banks.is_empty()
    }

    /// The terms one by one, in the order of their parameters: for engines with equations of motion of their own.
    pub fn placed(&self) -> Vec<PlacedTerm> {
        let mut terms = vec![None; self.parameters.len()];
        for bank in &self.banks {
            for &(index, column) in &bank.members {
                let direction = (0..self.dof).map(|joint| (joint, self.direction(bank, index, joint)));
                terms[column] = Some(PlacedTerm {
                    parameter: self.parameters[column],
                    term: bank.term,
                    shape: bank.shapes[index],
                    direction: direction.filter(|&(_, d)| d != 0.0).collect(),
                });
            }
        }
        terms.into_iter().flatten().collect()
    }

    /// The terms' part in the mass matrix: `Σ φ d dᵀ ∂g/∂a`, n × n, constant.
    pub fn inertia(&self, parameters: &StandardParameters) -> DMatrix<f64> {
        let mut m = DMatrix::zeros(self.dof, self.dof);
        for bank in self.banks.iter().filter(|bank| bank.term.is_inertia()) {
            for &(index, column) in &bank.members {
                let value = parameters.get(self.parameters[column]);
                for i in 0..self.dof {
                    for j in 0..self.dof {
                        m[(i, j)] += value * self.direction(bank, index, i) * self.direction(bank, index, j);
                    }
                }
            }
        }
        m
    }

    /// Energy that terms other than inertias store at positions `q` (n), J, for `values` of their parameters.
    pub(crate) fn potential(&self, values: &[f64], q: &[f64]) -> f64 {
        let mut energy = 0.0;
        for (bank, values) in self.banks.iter().zip(values.chunks_exact(self.dof)) {
            if bank.term.is_inertia() {
                continue;
            }
            for &(index, _) in &bank.members {
                let q = if bank.through_coupling { dot(self.coupling_row(index), q) } else { q[index] };
                let shape = bank.shapes[index];
                let x = TermInput { q, qd: 0.0, qdd: 0.0, load: 0.0, warmth: 0.0, shape };
                energy += values[index] * bank.term.law().energy(&x);
            }
        }
        energy
    }

    /// The parameters' values in the order in which [`add_torque`](Self::add_torque) takes them: n for each law, zero for a
    /// joint that does not have the parameter.
    pub fn values(&self, parameters: &StandardParameters) -> Vec<f64> {
        let mut values = vec![0.0; self.banks.len() * self.dof];
        for (bank, values) in self.banks.iter().zip(values.chunks_exact_mut(self.dof)) {
            for &(index, column) in &bank.members {
                values[index] = parameters.get(self.parameters[column]);
            }
        }
        values
    }

    /// Adds the terms' torque to `tau` (n), for `values` of their parameters.
    #[inline]
    pub fn add_torque(&self, values: &[f64], state: &TermState<'_>, tau: &mut [f64]) {
        for (bank, values) in self.banks.iter().zip(values.chunks_exact(self.dof)) {
            self.evaluate(bank, state, |first, g| {
                let values = &values[first..];
                if bank.through_coupling {
                    for (k, (value, g)) in values.iter().zip(g).enumerate() {
                        for (tau, d) in tau.iter_mut().zip(self.coupling_row(first + k)) {
                            *tau += d * (value * g);
                        }
                    }
                } else {
                    for ((tau, value), g) in tau[first..].iter_mut().zip(values).zip(g) {
                        *tau += value * g;
                    }
                }
            });
        }
    }

    /// Writes the terms' columns into a row-major regressor whose rows are `stride` long and in which they start at column
    /// `start`; what stands there must be zero.
    #[inline]
    pub(crate) fn write_columns(&self, state: &TermState<'_>, start: usize, stride: usize, out: &mut [f64]) {
        for bank in &self.banks {
            self.evaluate(bank, state, |first, g| {
                for &(index, column) in &bank.members {
                    // Another chunk's otherwise.
                    let Some(&g) = g.get(index.wrapping_sub(first)) else { continue };
                    let column = start + column;
                    if bank.through_coupling {
                        for (row, d) in self.coupling_row(index).iter().enumerate() {
                            out[row * stride + column] = d * g;
                        }
                    } else {
                        out[index * stride + column] = g;
                    }
                }
            });
        }
    }

    /// The terms' columns at several states at once, for terms of motion alone: calls `put(row, column, d, g)`, where
    /// `d g[s]` is the entry of state s. `q`, `qd` and `qdd` hold W numbers of each joint, joint after joint.
    pub(crate) fn each_column<const W: usize>(
        &self,
        [q, qd, qdd]: [&[f64]; 3],
        mut put: impl FnMut(usize, usize, f64, &[f64; W]),
    ) {
        let mut g = [0.0; W];
        for bank in &self.banks {
            for &(index, column) in &bank.members {
                let shape = &[bank.shapes[index]; W];
                let own = index * W..(index + 1) * W;
                if bank.through_coupling {
                    let row = self.coupling_row(index);
                    let at_motor = |x: &[f64]| -> [f64; W] {
                        std::array::from_fn(|s| row.iter().enumerate().fold(0.0, |sum, (j, d)| sum + d * x[j * W + s]))
                    };
                    let [q, qd, qdd] = [at_motor(q), at_motor(qd), at_motor(qdd)];
                    let block = TermBlock { q: &q, qd: &qd, qdd: &qdd, load: &[], warmth: &[], shape };
                    bank.term.law().torques(&block, &mut g);
                    for (joint, &d) in row.iter().enumerate() {
                        put(joint, column, d, &g);
                    }
                } else {
                    let (q, qd, qdd) = (&q[own.clone()], &qd[own.clone()], &qdd[own]);
                    bank.term.law().torques(&TermBlock { q, qd, qdd, load: &[], warmth: &[], shape }, &mut g);
                    put(index, column, 1.0, &g);
                }
            }
        }
    }

    /// Adds the gradient of `Σ w ∘ Y` over the terms' columns to `slopes`, by `(q, q̇, q̈, τ_t)` of the joints, n each;
    /// the row-major weights `w` have the layout of the regressor, in rows of `stride` whose terms begin at column `start`.
    pub fn add_gradient(
        &self,
        state: &TermState<'_>,
        start: usize,
        stride: usize,
        weights: &[f64],
        slopes: [&mut [f64]; Slope::COUNT],
    ) {
        let [dq, dqd, dqdd, dload] = slopes;
        for bank in &self.banks {
            for &(index, column) in &bank.members {
                let column = start + column;
                let by = bank.term.slopes(&self.input(bank, index, state));
                let mut add = |i: usize, by_motion: f64, by_load: f64| {
                    dq[i] += by_motion * by[0];
                    dqd[i] += by_motion * by[1];
                    dqdd[i] += by_motion * by[2];
                    dload[i] += by_load * by[3];
                };
                if bank.through_coupling {
                    let (d, shares) = (self.coupling_row(index), self.torque_row(index));
                    let weight = (0..self.dof).fold(0.0, |sum, i| sum + d[i] * weights[i * stride + column]);
                    (0..self.dof).for_each(|i| add(i, d[i] * weight, shares[i] * weight));
                } else {
                    let weight = weights[index * stride + column];
                    add(index, weight, weight);
                }
            }
        }
    }

    /// Adds `∂/∂τ_t Σ φ d g` at a state to `slopes`, n × n row-major, for `values` of the terms' parameters in their order: how the torque of
    /// friction follows the torque that the links take of each joint.
    pub(crate) fn add_load_slopes(&self, values: &[f64], state: &TermState<'_>, slopes: &mut [f64]) {
        for bank in self.banks.iter().filter(|bank| bank.term.entry().needs.load) {
            for &(index, column) in &bank.members {
                let slope = values[column] * bank.term.slopes(&self.input(bank, index, state))[3];
                if bank.through_coupling {
                    for (row, d) in slopes.chunks_exact_mut(self.dof).zip(self.coupling_row(index)) {
                        for (slope_of, share) in row.iter_mut().zip(self.torque_row(index)) {
                            *slope_of += d * share * slope;
                        }
                    }
                } else {
                    slopes[index * self.dof + index] += slope;
                }
            }
        }
    }

    /// A state as the law of a joint or motor sees it.
    fn input(&self, bank: &Bank, index: usize, state: &TermState<'_>) -> TermInput<f64> {
        let at = |x: &[f64]| if bank.through_coupling { dot(self.coupling_row(index), x) } else { x[index] };
        let load = match (state.load, bank.through_coupling) {
            ([], _) => 0.0,
            (load, true) => dot(self.torque_row(index), load),
            (load, false) => load[index],
        };
        TermInput { q: at(state.q), qd: at(state.qd), qdd: at(state.qdd), load, warmth: 0.0, shape: bank.shapes[index] }
    }

    /// Calls `each(first, g)` with the law of the joints or motors from `first` on, in chunks.
    #[inline]
    fn evaluate<'s>(&self, bank: &Bank, state: &TermState<'s>, mut each: impl FnMut(usize, &[f64])) {
        let mut g = [0.0; CHUNK];
        let mut first = 0;
        while first < self.dof {
            let count = CHUNK.min(self.dof - first);
            let g = &mut g[..count];
            let shape = &bank.shapes[first..first + count];
            let mut at_motors;
            let [q, qd, qdd, load] = if bank.through_coupling {
                at_motors = [[0.0; CHUNK]; 4];
                for k in 0..count {
                    let row = self.coupling_row(first + k);
                    at_motors[0][k] = dot(row, state.q);
                    at_motors[1][k] = dot(row, state.qd);
                    at_motors[2][k] = dot(row, state.qdd);
                    if !state.load.is_empty() {
                        at_motors[3][k] = dot(self.torque_row(first + k), state.load);
                    }
                }
                at_motors.each_ref().map(|x| &x[..count])
            } else {
                let own = |x: &'s [f64]| if x.is_empty() { x } else { &x[first..first + count] };
                [state.q, state.qd, state.qdd, state.load].map(own)
            };
            bank.term.law().torques(&TermBlock { q, qd, qdd, load, warmth: &[], shape }, g);
            each(first, g);
            first += count;
        }
    }

    /// Row `motor` of the coupling matrix.
    #[inline]
    fn coupling_row(&self, motor: usize) -> &[f64] {
        &self.coupling[motor * self.dof..(motor + 1) * self.dof]
    }

    /// What a motor takes of the joints' torques: row `motor` of `C⁻ᵀ`.
    #[inline]
    fn torque_row(&self, motor: usize) -> &[f64] {
        &self.torque_coupling[motor * self.dof..(motor + 1) * self.dof]
    }

    /// Entry `joint` of the direction of a member.
    fn direction(&self, bank: &Bank, index: usize, joint: usize) -> f64 {
        if bank.through_coupling { self.coupling_row(index)[joint] } else { f64::from(u8::from(index == joint)) }
    }
}
