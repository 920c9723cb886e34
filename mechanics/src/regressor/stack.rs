//! The regressor of many samples, in lanes.
//!
//! ```text
//! W, (n·M) × columns        row k n + i: joint i, mean over block k of consecutive samples
//! ```
//! A lane holds a block: its samples are walked one after the other and summed in that order. Only the columns that are wanted
//! are computed, and they go straight into their places.

use nalgebra::DMatrix;
use pulp::{Arch, Simd, WithSimd};

use super::cells::{Cells, Workspace};
use super::joint_torque::JointTorqueRegressor;
use crate::dynamics::{States, TOGETHER, Together, samples_of};
use crate::linalg::column_products::Line;

/// With more joints, all columns in the order of C come sooner sample by sample: the cells of eight samples leave the first cache.
const MOST_JOINTS_IN_LANES: usize = 7;

/// Blocks of a [`StackPart`] that is not the last.
pub const BLOCKS_OF_PART: usize = TOGETHER;

/// The entries of a few blocks, for as long as they are in the processor's first cache.
#[derive(Clone, Copy, Debug)]
pub struct StackPart<'a> {
    /// Number of the first block.
    pub first: usize,
    /// Number of blocks, at most [`BLOCKS_OF_PART`].
    pub count: usize,
    columns: usize,
    lines: &'a [Line],
}

impl StackPart<'_> {
    /// Joint `joint` and column `column` of those that were wanted, of each of the blocks in their order.
    ///
    /// # Panics
    /// If there is no such joint or column.
    #[inline]
    pub fn entries(&self, joint: usize, column: usize) -> &[f64] {
        &self.line(joint, column)[..self.count]
    }

    /// The same in a row of known length, for loops that fill the processor's lanes. Beyond the last block it means nothing.
    ///
    /// # Panics
    /// As [`Self::entries`].
    #[inline(always)]
    pub fn line(&self, joint: usize, column: usize) -> &[f64; BLOCKS_OF_PART] {
        assert!(column < self.columns, "column {column} of {}", self.columns);
        &self.lines[joint * self.columns + column].0
    }
}

impl JointTorqueRegressor {
    /// All samples: `W`, (n·N) × p, where row `k n + i` is joint i at sample k. Bit by bit what
    /// [`evaluate`](Self::evaluate) gives.
    ///
    /// # Panics
    /// If the states are not those of n joints.
    pub fn stack(&self, states: &States) -> DMatrix<f64> {
        let all: Vec<usize> = (0..self.cols()).collect();
        self.stack_means(states, &all, 1)
    }

    /// These columns alone, with the mean over each `block` of consecutive samples as one equation per joint,
    /// (n·M) × as many; samples beyond the last whole block are left out.
    ///
    /// # Panics
    /// If the states are not those of n joints, `block` is zero, or a column is beyond p.
    pub fn stack_means(&self, states: &States, columns: &[usize], block: usize) -> DMatrix<f64> {
        let rows = self.rows() * (states.len() / block);
        // A vector of zeros comes from the system without a pass over it, which `DMatrix::zeros` takes.
        let mut w = DMatrix::from_vec(rows, columns.len(), vec![0.0; rows * columns.len()]);
        self.stack_means_into(states, columns, block, &mut w);
        w
    }

    /// [`Self::stack_means`] in the place of what `w` held. A recording that is read in parts which fit in the processor's cache, into one
    /// matrix, waits for no memory.
    ///
    /// # Panics
    /// As [`Self::stack_means`], or if `w` is not (n·M) × as many as there are columns.
    pub fn stack_means_into(&self, states: &States, columns: &[usize], block: usize, w: &mut DMatrix<f64>) {
        let n = self.rows();
        assert_eq!(states.dof, n, "states of {} joints, expected {n}", states.dof);
        let (found, expected) = (w.shape(), (n * (states.len() / block), columns.len()));
        assert_eq!(found, expected, "a matrix for the stack of {found:?}, expected {expected:?}");
        if w.is_empty() {
            return;
        }
        let (rows, w) = (w.nrows(), w.as_mut_slice());
        self.stack_by(
            &mut Cells::in_rows(self, columns),
            states.arrays(),
            block,
            #[inline(always)]
            |cells, first, count| cells.write(w, rows, first * n, count),
        );
    }

    /// These columns of all samples in the order of C: entry of joint i and column j at sample k in `out[(k n + i) c + j]`, for c columns.
    /// Bit by bit what [`Self::stack`] gives, in memory of the caller. `q`, `qd` and `qdd` are N × n row-major.
    ///
    /// # Panics
    /// If they are not as long as each other or not those of whole samples, `out` is not N·n·c long, or a column is beyond p.
    pub fn stack_rows_into(&self, samples: [&[f64]; 3], columns: &[usize], out: &mut [f64]) {
        let (n, sample) = (self.rows(), self.rows() * columns.len());
        assert_eq!(out.len(), samples_of(n, samples) * sample, "one place for each entry");
        if sample == 0 {
            return;
        }
        if n > MOST_JOINTS_IN_LANES && columns.iter().copied().eq(0..self.cols()) {
            for (k, rows) in out.chunks_exact_mut(sample).enumerate() {
                let [q, qd, qdd] = samples.map(|x| &x[k * n..(k + 1) * n]);
                self.evaluate(q, qd, qdd, rows);
            }
            return;
        }
        self.stack_by(
            &mut Cells::in_rows(self, columns),
            samples,
            1,
            #[inline(always)]
            |cells, first, count| cells.write_in_rows(&mut out[first * sample..], count),
        );
    }

    /// The sums of a few blocks after the other in `cells`, for `put(cells, first, count)`.
    #[inline]
    pub(super) fn stack_by(
        &self,
        cells: &mut Cells<'_>,
        samples: [&[f64]; 3],
        block: usize,
        put: impl FnMut(&mut Cells<'_>, usize, usize),
    ) {
        Arch::new().dispatch(Stack { cells, joints: self.rows(), samples, block, put });
    }

    /// [`Self::stack_means`] a few blocks at a time, in their order. The matrix as a whole is never held: who reads each part once reads
    /// it from the first cache.
    ///
    /// # Panics
    /// As [`Self::stack_means`].
    pub fn stack_in_parts(
        &self,
        states: &States,
        columns: &[usize],
        block: usize,
        mut visit: impl FnMut(&StackPart<'_>),
    ) {
        let n = self.rows();
        assert_eq!(states.dof, n, "states of {} joints, expected {n}", states.dof);
        self.stack_by(
            &mut Cells::in_rows(self, columns),
            states.arrays(),
            block,
            #[inline(always)]
            |cells, first, count| visit(&StackPart { first, count, columns: columns.len(), lines: &cells.sums }),
        );
    }
}

/// Works on all samples; `put(cells, first, count)` takes the sums of as many blocks.
struct Stack<'a, 'c, F> {
    cells: &'a mut Cells<'c>,
    joints: usize,
    samples: [&'a [f64]; 3],
    block: usize,
    put: F,
}

impl<F: FnMut(&mut Cells<'_>, usize, usize)> WithSimd for Stack<'_, '_, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { cells, joints: n, samples, block, mut put } = self;
        let (blocks, mut state) = (samples_of(n, samples) / block, Together::new(n));
        let mut work = Workspace::new(simd, n);
        for first in (0..blocks).step_by(TOGETHER) {
            let count = TOGETHER.min(blocks - first);
            state.fill(samples, first * block, block, count);
            cells.add::<S, true>(simd, &state, &mut work);
            for k in 1..block {
                state.fill(samples, first * block + k, block, count);
                cells.add::<S, false>(simd, &state, &mut work);
            }
            cells.average(block);
            put(cells, first, count);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains::{self, ChainRecipe};
    use crate::model::Columns;
    use crate::model::term::LOAD_FRICTION;
    use crate::seed::Seed;

    fn states(dof: usize, count: usize, run: u64) -> States {
        let mut rng = Seed::new(13).stream("stack", run);
        let mut states = States::new(dof);
        for _ in 0..count {
            let (q, qd, qdd) = chains::random_state(&mut rng, dof);
            states.push(&q, &qd, &qdd);
        }
        states
    }

    #[test]
    fn identity_many_samples_are_each_alone_to_the_bit_on_every_width() {
        for run in 0..20 {
            let dof = 1 + usize::try_from(run % 9).unwrap();
            let recipe = ChainRecipe { coupled: run % 2 == 0, tilted: run % 3 == 0, ..ChainRecipe::new(dof) };
            let (robot, _) = recipe.draw(&mut Seed::new(13).stream("chains", run));
            let regressor = JointTorqueRegressor::new(&robot, Columns::RIGID_ROTOR_FRICTION).unwrap();
            let (p, states) = (regressor.cols(), states(dof, 21, run));
            let w = regressor.stack(&states);
            let mut y = vec![0.0; dof * p];
            for k in 0..states.len() {
                regressor.evaluate(states.q(k), states.qd(k), states.qdd(k), &mut y);
                for i in 0..dof {
                    for c in 0..p {
                        assert_eq!(w[(k * dof + i, c)], y[i * p + c], "chain {run}, sample {k}, joint {i}, column {c}");
                    }
                }
            }
            let all: Vec<usize> = (0..p).collect();
            let mut again = DMatrix::repeat(w.nrows(), p, f64::NAN);
            regressor.stack_means_into(&states, &all, 1, &mut again);
            assert_eq!(again, w);
            let mut rows = vec![f64::NAN; w.len()];
            regressor.stack_rows_into(states.arrays(), &all, &mut rows);
            assert_eq!(DMatrix::from_row_slice(w.nrows(), p, &rows), w);
            let (mut narrow, mut parts) = (DMatrix::zeros(w.nrows(), p), DMatrix::zeros(w.nrows(), p));
            let (rows, columns) = (w.nrows(), narrow.as_mut_slice());
            let put = |cells: &mut Cells<'_>, first: usize, count| cells.write(columns, rows, first * dof, count);
            let (cells, samples) = (&mut Cells::in_rows(&regressor, &all), states.arrays());
            Arch::Scalar.dispatch(Stack { cells, joints: dof, samples, block: 1, put });
            assert_eq!(narrow, w);
            regressor.stack_in_parts(&states, &all, 1, |part| {
                for (joint, c) in (0..dof).flat_map(|joint| (0..p).map(move |c| (joint, c))) {
                    for (k, entry) in part.entries(joint, c).iter().enumerate() {
                        parts[((part.first + k) * dof + joint, c)] = *entry;
                    }
                }
            });
            assert_eq!(parts, w);
        }
    }

    #[test]
    fn identity_means_over_blocks_of_chosen_columns() {
        for coupled in [false, true] {
            let recipe = ChainRecipe { coupled, ..ChainRecipe::new(5) };
            let (robot, parameters) = recipe.draw(&mut Seed::new(14).stream("chains", 0));
            let states = states(5, 71, 1);
            let free = JointTorqueRegressor::new(&robot, Columns::RIGID_ROTOR_FRICTION).unwrap();
            let columns = Columns::RIGID_ROTOR_FRICTION.with_term(LOAD_FRICTION);
            let loaded = JointTorqueRegressor::with_load(&robot, columns, &parameters);
            for regressor in [free, loaded] {
                let columns: Vec<usize> = (0..regressor.cols()).filter(|c| c % 3 != 1).collect();
                let (w, means) = (regressor.stack(&states), regressor.stack_means(&states, &columns, 7));
                assert_eq!(means.shape(), (50, columns.len()));
                let p = regressor.cols();
                let mut y = vec![0.0; 5 * p];
                for k in 0..states.len() {
                    regressor.evaluate(states.q(k), states.qd(k), states.qdd(k), &mut y);
                    assert_eq!(w.rows(5 * k, 5).transpose().as_slice(), y);
                }
                let mut rows = vec![f64::NAN; w.nrows() * columns.len()];
                regressor.stack_rows_into(states.arrays(), &columns, &mut rows);
                assert_eq!(DMatrix::from_row_slice(w.nrows(), columns.len(), &rows), w.select_columns(&columns));
                let mut blocks = 0;
                regressor.stack_in_parts(&states, &columns, 7, |part| {
                    assert_eq!(part.first, blocks);
                    blocks += part.count;
                    for (joint, c) in (0..5).flat_map(|joint| (0..columns.len()).map(move |c| (joint, c))) {
                        let rows = (part.first..blocks).map(|k| means[(5 * k + joint, c)]);
                        assert!(part.entries(joint, c).iter().copied().eq(rows));
                    }
                });
                assert_eq!(blocks, 10);
                for m in 0..10 {
                    for i in 0..5 {
                        for (c, &column) in columns.iter().enumerate() {
                            let mean = (0..7).map(|k| w[((7 * m + k) * 5 + i, column)]).sum::<f64>() / 7.0;
                            assert!((means[(m * 5 + i, c)] - mean).abs() < 1e-13 * mean.abs().max(100.0));
                        }
                    }
                }
            }
        }
    }
}
