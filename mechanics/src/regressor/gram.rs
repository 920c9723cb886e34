//! Normal equations of many samples, whose regressor is never held.
//!
//! ```text
//! WᵀW = Σ_i w_i Σ_k y_kiᵀ y_ki        Wᵀτ = Σ_i w_i Σ_k y_kiᵀ τ_ki        y_ki: row i of Y at sample k
//! ```
//! Joint by joint, on the columns that are not zero in its rows: a link loads the joints up to its own, so that half of the
//! products are never made. Each entry is summed in eight running sums, sample k in sum k mod 8, the same bits on any processor.

use nalgebra::{DMatrix, DVector};
use pulp::Arch;

use super::joint_torque::JointTorqueRegressor;
use crate::dynamics::States;
use crate::linalg::Gram;
use crate::linalg::column_products::{Line, Products};

/// Lines of eight samples that are held of each joint and column: those of one joint fit into the first cache.
const DEPTH: usize = 8;

impl JointTorqueRegressor {
    /// `Σ w YᵀY`, `Σ w Yᵀτ` and `Σ w τ²` over all samples, for these columns of Y, the torque of joint i at sample k at `k n + i` of
    /// `torque` (n·N), N·m, and one weight of each joint (n), not below zero.
    ///
    /// # Panics
    /// If the states are not those of n joints, a length does not fit, or a column is beyond p.
    pub fn gram(&self, states: &States, columns: &[usize], torque: &[f64], weights: &[f64]) -> Gram {
        let n = self.rows();
        assert_eq!(states.dof, n, "states of {} joints, expected {n}", states.dof);
        assert_eq!(
            (torque.len(), weights.len()),
            (n * states.len(), n),
            "one torque per joint and sample, one weight per joint"
        );
        let roots: Vec<f64> = weights.iter().map(|weight| weight.sqrt()).collect();
        let mut panels = Panels::new(n, columns.len());
        let put = |panels: &mut Panels, first: usize, count: usize| {
            for (joint, root) in roots.iter().enumerate() {
                let of_lane = |lane: usize| if lane < count { root * torque[(first + lane) * n + joint] } else { 0.0 };
                panels.put(joint, columns.len(), Line(std::array::from_fn(of_lane)));
            }
            panels.next();
        };
        if !self.links.is_empty() {
            self.stack_in_parts(states, columns, 1, |part| {
                for place in 0..columns.len() {
                    for (joint, root) in roots.iter().enumerate() {
                        let entry =
                            |lane: usize| part.column(place).get(lane * n + joint).map_or(0.0, |entry| root * entry);
                        panels.put(joint, place, Line(std::array::from_fn(entry)));
                    }
                }
                put(&mut panels, part.first, part.count);
            });
        } else {
            self.stack_by(states, columns, 1, |cells, first, count| {
                cells.each(|joint, place, line| {
                    let entry = |lane: usize| if lane < count { roots[joint] * line.0[lane] } else { 0.0 };
                    panels.put(joint, place, Line(std::array::from_fn(entry)));
                });
                put(&mut panels, first, count);
            });
        }
        panels.finish(n * states.len())
    }
}

/// Some samples of all joints, each column in one piece, and the sums over those before.
struct Panels {
    joints: usize,
    /// Columns, the torque being the last.
    width: usize,
    /// `(joint · width + column) · DEPTH + line`.
    held: Vec<Line>,
    /// Lines that are held.
    count: usize,
    /// Which columns of which joints anything was put in: `joint · width + column`.
    seen: Vec<bool>,
    /// `row · width + column`, upper triangle.
    sums: Vec<Line>,
}

impl Panels {
    fn new(joints: usize, columns: usize) -> Self {
        let width = columns + 1;
        let (held, sums) = (vec![Line::ZERO; joints * width * DEPTH], vec![Line::ZERO; width * width]);
        Self { joints, width, held, count: 0, seen: vec![false; joints * width], sums }
    }

    /// Eight samples of one column of one joint.
    #[inline(always)]
    fn put(&mut self, joint: usize, column: usize, line: Line) {
        let at = joint * self.width + column;
        self.seen[at] = true;
        self.held[at * DEPTH + self.count] = line;
    }

    /// The next eight samples.
    fn next(&mut self) {
        self.count += 1;
        if self.count == DEPTH {
            self.sum();
        }
    }

    fn sum(&mut self) {
        for joint in 0..self.joints {
            let own = joint * self.width..(joint + 1) * self.width;
            let columns: Vec<usize> = (0..self.width).filter(|column| self.seen[own.start + column]).collect();
            let held = &self.held[own.start * DEPTH..own.end * DEPTH];
            let products = Products::<DEPTH> { columns: &columns, held, width: self.width, sums: &mut self.sums };
            Arch::new().dispatch(products);
        }
        self.held.fill(Line::ZERO);
        self.count = 0;
    }

    fn finish(mut self, rows: usize) -> Gram {
        self.sum();
        let b = self.width - 1;
        let entry = |i: usize, j: usize| self.sums[i * self.width + j].sum();
        let upper = DMatrix::from_fn(b, b, |i, j| if i <= j { entry(i, j) } else { 0.0 });
        Gram::from_sums(upper, DVector::from_fn(b, |i, _| entry(i, b)), entry(b, b), rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains::{self, ChainRecipe};
    use crate::model::Columns;
    use crate::model::term::LOAD_FRICTION;
    use crate::seed::Seed;

    #[test]
    fn identity_normal_equations_are_those_of_the_stack() {
        for run in 0..9 {
            let dof = 1 + usize::try_from(run).unwrap();
            let mut rng = Seed::new(15).stream("gram", run);
            let (robot, parameters) = ChainRecipe { coupled: run % 2 == 0, ..ChainRecipe::new(dof) }.draw(&mut rng);
            let columns = Columns::RIGID_ROTOR_FRICTION;
            let free = JointTorqueRegressor::new(&robot, columns).unwrap();
            let loaded = JointTorqueRegressor::with_load(&robot, columns.with(LOAD_FRICTION), &parameters);
            for (regressor, count) in [(free, 150), (loaded, 67)] {
                let mut states = States::new(dof);
                for _ in 0..count {
                    let (q, qd, qdd) = chains::random_state(&mut rng, dof);
                    states.push(&q, &qd, &qdd);
                }
                let wanted: Vec<usize> = (0..regressor.cols()).filter(|column| column % 7 != 3).collect();
                let torque: Vec<f64> = (0..dof * count).map(|row| libm::sin((row * row) as f64)).collect();
                let weights: Vec<f64> = (0..dof).map(|joint| (joint + 1) as f64 / 2.0).collect();
                let gram = regressor.gram(&states, &wanted, &torque, &weights);
                let mut w = regressor.stack_means(&states, &wanted, 1);
                let mut y = DVector::from_vec(torque);
                for (row, (mut w, y)) in w.row_iter_mut().zip(y.iter_mut()).enumerate() {
                    w *= weights[row % dof].sqrt();
                    *y *= weights[row % dof].sqrt();
                }
                let size = w.norm_squared();
                assert!((gram.information() - w.tr_mul(&w)).amax() < 1e-13 * size, "{dof} joints");
                assert!((gram.moment() - w.tr_mul(&y)).amax() < 1e-13 * (size * y.norm_squared()).sqrt());
                assert!((gram.energy() - y.norm_squared()).abs() < 1e-12 * y.norm_squared().max(1e-300));
                assert_eq!(gram.rows(), dof * count);
            }
        }
    }
}
