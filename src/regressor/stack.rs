//! The regressor of many samples, in lanes.
//!
//! ```text
//! W, (n·M) × columns        row k n + i: joint i, mean over block k of consecutive samples
//! ```
//! A lane holds a block: its samples are walked one after the other and summed in that order. Only the columns that are wanted
//! are computed, and they go straight into their places.

use nalgebra::DMatrix;
use pulp::{Arch, Simd, WithSimd};

use super::{BodyRegressor, JointTorqueRegressor};
use crate::dynamics::States;
use crate::lanes::Wide;
use crate::spatial::{LaneMotion, Motion};

/// Blocks that are worked on together: a whole number of lanes of any processor.
const TOGETHER: usize = 8;

/// Some rows of a stack, for as long as they are in the processor's first cache.
#[derive(Clone, Copy, Debug)]
pub struct StackPart<'a> {
    /// Number of the first block.
    pub first: usize,
    /// Number of blocks, at most eight.
    pub count: usize,
    joints: usize,
    numbers: &'a [f64],
}

impl StackPart<'_> {
    /// Column `column` of those that were wanted, n · count: row `k n + i` is joint i, block `first + k`.
    ///
    /// # Panics
    /// If there is no such column.
    #[inline]
    #[must_use]
    pub fn column(&self, column: usize) -> &[f64] {
        &self.numbers[column * TOGETHER * self.joints..][..self.count * self.joints]
    }
}

impl JointTorqueRegressor {
    /// All samples: `W`, (n·N) × p, where row `k n + i` is joint i at sample k. Bit by bit what
    /// [`evaluate`](Self::evaluate) gives.
    ///
    /// # Panics
    /// If the states are not those of n joints.
    #[must_use]
    pub fn stack(&self, states: &States) -> DMatrix<f64> {
        let all: Vec<usize> = (0..self.cols()).collect();
        self.stack_means(states, &all, 1)
    }

    /// These columns alone, with the mean over each `block` of consecutive samples as one equation per joint,
    /// (n·M) × as many; samples beyond the last whole block are left out.
    ///
    /// # Panics
    /// If the states are not those of n joints, `block` is zero, or a column is beyond p.
    #[must_use]
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
        if !self.links.is_empty() {
            return self.stack_under_load(states, columns, block, w);
        }
        let (rows, w) = (w.nrows(), w.as_mut_slice());
        self.stack_by(
            states,
            columns,
            block,
            #[inline(always)]
            |cells, first, count| cells.write(w, rows, first * n, count),
        );
    }

    /// The sums of a few blocks after the other, for `put(cells, first, count)`.
    #[inline]
    fn stack_by(&self, states: &States, columns: &[usize], block: usize, put: impl FnMut(&Cells<'_>, usize, usize)) {
        Arch::new().dispatch(Stack { cells: Cells::new(self, columns), states, block, put });
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
        if self.links.is_empty() {
            let mut numbers = vec![0.0; TOGETHER * n * columns.len()];
            return self.stack_by(
                states,
                columns,
                block,
                #[inline(always)]
                |cells, first, count| {
                    cells.write(&mut numbers, TOGETHER * n, 0, count);
                    visit(&StackPart { first, count, joints: n, numbers: &numbers });
                },
            );
        }
        let w = self.stack_means(states, columns, block);
        let mut numbers = vec![0.0; TOGETHER * n * columns.len()];
        for first in (0..w.nrows() / n).step_by(TOGETHER) {
            let count = TOGETHER.min(w.nrows() / n - first);
            for (to, from) in numbers.chunks_exact_mut(TOGETHER * n).zip(w.column_iter()) {
                to[..count * n].copy_from_slice(&from.as_slice()[first * n..(first + count) * n]);
            }
            visit(&StackPart { first, count, joints: n, numbers: &numbers });
        }
    }

    /// Sample by sample, for terms that depend on the torque that all links take.
    fn stack_under_load(&self, states: &States, columns: &[usize], block: usize, w: &mut DMatrix<f64>) {
        let (n, p) = (self.rows(), self.cols());
        w.fill(0.0);
        let mut rows = vec![0.0; n * p];
        for m in 0..states.len() / block {
            for k in m * block..(m + 1) * block {
                self.evaluate(states.q(k), states.qd(k), states.qdd(k), &mut rows);
                for (c, &column) in columns.iter().enumerate() {
                    for i in 0..n {
                        w[(m * n + i, c)] += rows[i * p + column];
                    }
                }
            }
        }
        if block > 1 {
            *w *= 1.0 / block as f64;
        }
    }
}

/// A number of each block, in a cache line of its own, so that no access touches two.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Line([f64; TOGETHER]);

/// Sums of the blocks that are worked on, one place for each joint and wanted column.
struct Cells<'a> {
    regressor: &'a JointTorqueRegressor,
    /// Of each link's ten columns, the place among the wanted, or [`UNWANTED`].
    links: Vec<[usize; 10]>,
    /// Place of each of the terms' columns among the wanted.
    terms: Vec<Option<usize>>,
    /// Number of wanted columns.
    wanted: usize,
    /// Row-major n × wanted.
    sums: Vec<Line>,
    /// Those that links or terms add to; the others are zero for every state.
    touched: Vec<Cell>,
    /// Those of terms: no link writes there first.
    of_terms: Vec<bool>,
}

/// Where something is added.
#[derive(Clone, Copy)]
struct Cell {
    /// The place of its column among the wanted.
    place: usize,
    joint: usize,
    /// `joint · wanted + place`.
    index: usize,
}

/// The place of a column that is not wanted.
const UNWANTED: usize = usize::MAX;

impl<'a> Cells<'a> {
    fn new(regressor: &'a JointTorqueRegressor, columns: &[usize]) -> Self {
        let (n, wanted) = (regressor.rows(), columns.len());
        let mut links = vec![[UNWANTED; 10]; n];
        let mut terms = vec![None; regressor.cols() - 10 * n];
        for (place, &column) in columns.iter().enumerate() {
            if column < 10 * n {
                links[column / 10][column % 10] = place;
            } else {
                terms[column - 10 * n] = Some(place);
            }
        }
        let mut touched = Vec::new();
        for (k, places) in links.iter().enumerate() {
            // A link loads the joints up to its own.
            let places = places.iter().filter(|place| **place != UNWANTED);
            let cell = |joint: usize, place: usize| Cell { place, joint, index: joint * wanted + place };
            touched.extend(places.flat_map(|&place| (0..=k).map(move |joint| cell(joint, place))));
        }
        let (sums, of_terms) = (vec![Line([0.0; TOGETHER]); n * wanted], vec![false; n * wanted]);
        Self { regressor, links, terms, wanted, sums, touched, of_terms }
    }

    /// Adds one sample of each block; the `FIRST` of them takes the place of what was there.
    #[inline(always)]
    fn add<S: Simd, const FIRST: bool>(&mut self, simd: S, state: &Together, axes: &mut [LaneMotion<Wide<S>>]) {
        let Self { regressor, links, terms, wanted, sums, touched, of_terms } = self;
        let wanted = *wanted;
        let (v, a) = regressor.base_at_rest();
        let one = Wide::new(simd, simd.splat_f64s(0.0));
        let n = regressor.rows();
        for vector in 0..TOGETHER / S::F64_LANES {
            let at = |x: &[[f64; TOGETHER]], k: usize| Wide::new(simd, S::as_simd_f64s(&x[k]).0[vector]);
            regressor.walk(
                LaneMotion::splat(one, &v),
                LaneMotion::splat(one, &a),
                #[inline(always)]
                |k| (regressor.poses[k].turn(at(&state.q, k)), [at(&state.qd, k), at(&state.qdd, k)]),
                0..n,
                axes,
                #[inline(always)]
                |k, body, axes| {
                    let places = &links[k];
                    for (axis, sums) in axes[..=k].iter().zip(sums.chunks_exact_mut(wanted)) {
                        // One by one, so that each entry is compiled for its column.
                        add_entry::<S, FIRST>(simd, sums, places, body, axis, 0, vector);
                        add_entry::<S, FIRST>(simd, sums, places, body, axis, 1, vector);
                        add_entry::<S, FIRST>(simd, sums, places, body, axis, 2, vector);
                        add_entry::<S, FIRST>(simd, sums, places, body, axis, 3, vector);
                        add_entry::<S, FIRST>(simd, sums, places, body, axis, 4, vector);
                        add_entry::<S, FIRST>(simd, sums, places, body, axis, 5, vector);
                        add_entry::<S, FIRST>(simd, sums, places, body, axis, 6, vector);
                        add_entry::<S, FIRST>(simd, sums, places, body, axis, 7, vector);
                        add_entry::<S, FIRST>(simd, sums, places, body, axis, 8, vector);
                        add_entry::<S, FIRST>(simd, sums, places, body, axis, 9, vector);
                    }
                },
            );
        }
        if FIRST {
            for cell in touched.iter().filter(|cell| of_terms[cell.index]) {
                sums[cell.index] = Line([0.0; TOGETHER]);
            }
        }
        let flat = [&state.q, &state.qd, &state.qdd].map(|x| x.as_flattened());
        regressor.terms.each_column(flat, |joint, column, d, g: &[f64; TOGETHER]| {
            if let Some(place) = terms[column] {
                let index = joint * wanted + place;
                if !of_terms[index] {
                    of_terms[index] = true;
                    touched.push(Cell { place, joint, index });
                }
                for (sum, g) in sums[index].0.iter_mut().zip(g) {
                    *sum += d * g;
                }
            }
        });
    }
}

impl Cells<'_> {
    /// Writes the sums of `count` blocks into W, whose columns are `rows` long, from row `first` of each column on.
    #[inline(always)]
    fn write(&self, w: &mut [f64], rows: usize, first: usize, count: usize) {
        // The usual numbers of joints with distances of known length.
        match self.regressor.rows() {
            6 => self.write_rows(w, 6, rows, first, count),
            7 => self.write_rows(w, 7, rows, first, count),
            n => self.write_rows(w, n, rows, first, count),
        }
    }

    #[inline(always)]
    fn write_rows(&self, w: &mut [f64], n: usize, rows: usize, first: usize, count: usize) {
        let mut cells = self.touched.iter().peekable();
        for (place, column) in w.chunks_exact_mut(rows).enumerate() {
            let to = &mut column[first..first + count * n];
            // What no state moves is zero; the rest follows while it is in the first cache.
            for zeros in to.as_chunks_mut::<2>().0 {
                *zeros = [0.0; 2];
            }
            if let Some(last) = to.last_mut() {
                *last = 0.0;
            }
            while let Some(cell) = cells.next_if(|cell| cell.place == place) {
                let (to, sums) = (&mut to[cell.joint..], &self.sums[cell.index].0);
                if count == TOGETHER {
                    // One look at the length for all of them.
                    let to = &mut to[..(TOGETHER - 1) * n + 1];
                    for lane in 0..TOGETHER {
                        to[lane * n] = sums[lane];
                    }
                } else {
                    for lane in 0..count {
                        to[lane * n] = sums[lane];
                    }
                }
            }
        }
    }
}

/// Adds entry `c` of `sᵀ K` to its place (or `FIRST` puts it there) among the sums of the joint with the axis `s`, where it is wanted.
#[inline(always)]
fn add_entry<S: Simd, const FIRST: bool>(
    simd: S,
    sums: &mut [Line],
    places: &[usize; 10],
    body: &BodyRegressor<Wide<S>>,
    axis: &LaneMotion<Wide<S>>,
    c: usize,
    vector: usize,
) {
    if let Some(sum) = sums.get_mut(places[c]) {
        let sum = &mut S::as_mut_simd_f64s(&mut sum.0).0[vector];
        let entry = body.entry(axis, c).x;
        *sum = if FIRST { entry } else { simd.add_f64s(*sum, entry) };
    }
}

/// One sample of each of the blocks that are worked on, joint by joint.
struct Together {
    q: Vec<[f64; TOGETHER]>,
    qd: Vec<[f64; TOGETHER]>,
    qdd: Vec<[f64; TOGETHER]>,
}

impl Together {
    /// The samples `first`, `first + step`, …, `count` of them; the last again in the places beyond.
    fn fill(&mut self, states: &States, first: usize, step: usize, count: usize) {
        for lane in 0..TOGETHER {
            let k = first + lane.min(count - 1) * step;
            for (to, from) in [(&mut self.q, states.q(k)), (&mut self.qd, states.qd(k)), (&mut self.qdd, states.qdd(k))]
            {
                for (to, &from) in to.iter_mut().zip(from) {
                    to[lane] = from;
                }
            }
        }
    }
}

/// Works on all states; `put(cells, first, count)` takes the sums of as many blocks.
struct Stack<'a, F> {
    cells: Cells<'a>,
    states: &'a States,
    block: usize,
    put: F,
}

impl<F: FnMut(&Cells<'_>, usize, usize)> WithSimd for Stack<'_, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { mut cells, states, block, mut put } = self;
        let n = states.dof;
        let (blocks, scale) = (states.len() / block, 1.0 / block as f64);
        let mut state =
            Together { q: vec![[0.0; TOGETHER]; n], qd: vec![[0.0; TOGETHER]; n], qdd: vec![[0.0; TOGETHER]; n] };
        let zero = Wide::new(simd, simd.splat_f64s(0.0));
        let mut axes = vec![LaneMotion::splat(zero, &Motion::zero()); n];
        let mut seen = 0;
        for first in (0..blocks).step_by(TOGETHER) {
            let count = TOGETHER.min(blocks - first);
            state.fill(states, first * block, block, count);
            cells.add::<S, true>(simd, &state, &mut axes);
            for k in 1..block {
                state.fill(states, first * block + k, block, count);
                cells.add::<S, false>(simd, &state, &mut axes);
            }
            if cells.touched.len() != seen {
                seen = cells.touched.len();
                // Column by column, as they stand in memory.
                cells.touched.sort_unstable_by_key(|cell| (cell.place, cell.joint));
            }
            if block > 1 {
                for cell in &cells.touched {
                    cells.sums[cell.index].0.iter_mut().for_each(|sum| *sum *= scale);
                }
            }
            put(&cells, first, count);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conformance::chains::{self, ChainRecipe};
    use crate::model::Columns;
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
            let regressor = JointTorqueRegressor::new(&robot, Columns::RIGID_ROTOR_FRICTION);
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
            let (mut narrow, mut parts) = (DMatrix::zeros(w.nrows(), p), DMatrix::zeros(w.nrows(), p));
            let (rows, columns) = (w.nrows(), narrow.as_mut_slice());
            let put = |cells: &Cells<'_>, first: usize, count| cells.write(columns, rows, first * dof, count);
            Arch::Scalar.dispatch(Stack { cells: Cells::new(&regressor, &all), states: &states, block: 1, put });
            assert_eq!(narrow, w);
            regressor.stack_in_parts(&states, &all, 1, |part| {
                for c in 0..p {
                    parts.column_mut(c).rows_mut(part.first * dof, part.count * dof).copy_from_slice(part.column(c));
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
            let free = JointTorqueRegressor::new(&robot, Columns::RIGID_ROTOR_FRICTION);
            let loaded = JointTorqueRegressor::with_load(&robot, Columns::RIGID_ROTOR_FRICTION, &parameters);
            for regressor in [free, loaded] {
                let columns: Vec<usize> = (0..regressor.cols()).filter(|c| c % 3 != 1).collect();
                let (w, means) = (regressor.stack(&states), regressor.stack_means(&states, &columns, 7));
                assert_eq!(means.shape(), (50, columns.len()));
                let mut blocks = 0;
                regressor.stack_in_parts(&states, &columns, 7, |part| {
                    assert_eq!(part.first, blocks);
                    blocks += part.count;
                    let rows = part.first * 5..blocks * 5;
                    assert!((0..columns.len()).all(|c| part.column(c) == &means.column(c).as_slice()[rows.clone()]));
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
