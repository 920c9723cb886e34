//! Sums of a few blocks of samples, one cell for each joint and wanted column, and how they get into a stack.

use pulp::Simd;

use super::body::BodyRegressor;
use super::joint_torque::JointTorqueRegressor;
use super::straight_axis::{Along, StraightAxis, Y, Z};
use crate::dynamics::{TOGETHER, Together};
use crate::lanes::Wide;
use crate::linalg::column_products::Line;
use crate::spatial::{LaneMotion, Motion};

/// The same for each of the ten columns of a link, one by one, so that each is compiled for its column.
macro_rules! entries {
    (|$c:ident| $add:expr) => {
        entries!(@ $c, $add, 0 1 2 3 4 5 6 7 8 9)
    };
    (@ $c:ident, $add:expr, $($number:literal)*) => {{
        $({
            const $c: usize = $number;
            $add
        })*
    }};
}

/// Sums of the blocks that are worked on, one cell for each joint and wanted column.
pub(super) struct Cells<'a> {
    regressor: &'a JointTorqueRegressor,
    /// Those that are wanted.
    columns: &'a [usize],
    /// Of each link's ten columns, where its cells begin, or [`UNWANTED`].
    links: Vec<[usize; 10]>,
    /// Place of each of the terms' columns among the wanted.
    terms: Vec<Option<usize>>,
    /// Lines from a joint's cell to the next one's, and from a column's to the next one's.
    pub(super) strides: [usize; 2],
    /// The line of each cell that is worked on.
    pub(super) line: usize,
    pub(super) sums: Vec<Line>,
    /// Those that links or terms add to; the others are zero for every state.
    pub(super) touched: Vec<Cell>,
    /// How many of them are in the order of columns.
    sorted: usize,
    /// Where those of terms begin, and whether a cell is one: no link writes there first.
    of_terms: Vec<usize>,
    is_of_terms: Vec<bool>,
}

/// What one walk along the chain writes to.
pub(super) struct Workspace<S: Simd> {
    turns: Vec<[Wide<S>; 2]>,
    axes: Vec<LaneMotion<Wide<S>>>,
}

impl<S: Simd> Workspace<S> {
    /// For n joints.
    #[inline(always)]
    pub(super) fn new(simd: S, n: usize) -> Self {
        let zero = Wide::new(simd, simd.splat_f64s(0.0));
        Self { turns: vec![[zero; 2]; n], axes: vec![LaneMotion::splat(zero, &Motion::zero()); n] }
    }
}

/// Where something is added.
#[derive(Clone, Copy)]
pub(super) struct Cell {
    /// The place of its column among the wanted.
    pub(super) place: usize,
    pub(super) joint: usize,
    /// Where its lines begin.
    pub(super) index: usize,
}

/// Where a column begins that is not wanted: beyond all cells.
const UNWANTED: usize = usize::MAX / 2;

impl<'a> Cells<'a> {
    /// One line each, row-major n × wanted.
    pub(super) fn in_rows(regressor: &'a JointTorqueRegressor, columns: &'a [usize]) -> Self {
        Self::new(regressor, columns, [columns.len(), 1], regressor.rows() * columns.len())
    }

    /// `depth` lines each, one joint after the other in each column; after the last column one more, of every joint.
    pub(super) fn in_columns(regressor: &'a JointTorqueRegressor, columns: &'a [usize], depth: usize) -> Self {
        let (n, last) = (regressor.rows(), columns.len());
        // An odd distance, so that the columns do not take each other's places in the first cache.
        let column = (n * depth) | 1;
        let mut cells = Self::new(regressor, columns, [depth, column], column * (last + 1));
        cells.touched.extend((0..n).map(|joint| Cell { place: last, joint, index: joint * depth + last * column }));
        cells
    }

    fn new(regressor: &'a JointTorqueRegressor, columns: &'a [usize], strides: [usize; 2], lines: usize) -> Self {
        let n = regressor.rows();
        let mut links = vec![[UNWANTED; 10]; n];
        let mut terms = vec![None; regressor.cols() - 10 * n];
        let mut touched = Vec::new();
        for (place, &column) in columns.iter().enumerate() {
            let link = column / 10;
            if link < n {
                links[link][column % 10] = place * strides[1];
            } else {
                terms[column - 10 * n] = Some(place);
            }
            // A link loads the joints up to its own. Which of them a term of motion alone loads is seen when it does.
            let of_motion = if link < n { link + 1 } else { 0 };
            let loaded = if regressor.links.is_empty() { of_motion } else { n };
            let cell = |joint: usize| Cell { place, joint, index: joint * strides[0] + place * strides[1] };
            touched.extend((0..loaded).map(cell));
        }
        let (sums, is_of_terms) = (vec![Line::ZERO; lines], vec![false; lines]);
        let (of_terms, line, sorted) = (Vec::new(), 0, 0);
        Self { regressor, columns, links, terms, strides, line, sums, touched, sorted, of_terms, is_of_terms }
    }

    /// Adds one sample of each block; the `FIRST` of them takes the place of what was there.
    #[inline(always)]
    pub(super) fn add<S: Simd, const FIRST: bool>(&mut self, simd: S, state: &Together, work: &mut Workspace<S>) {
        if !self.regressor.links.is_empty() {
            return self.add_alone::<FIRST>(state);
        }
        let Self { regressor, links, terms, strides, line, sums, touched, of_terms, is_of_terms, .. } = self;
        let [of_joint, of_column] = *strides;
        let sums = &mut sums[*line..];
        let (v, a) = regressor.base_at_rest();
        let one = Wide::new(simd, simd.splat_f64s(0.0));
        let n = regressor.rows();
        for vector in 0..TOGETHER / S::F64_LANES {
            let at = |x: &[[f64; TOGETHER]], k: usize| Wide::new(simd, S::as_simd_f64s(&x[k]).0[vector]);
            // Those of all joints first: their long chains of operations overlap.
            for (k, (turn, pose)) in work.turns.iter_mut().zip(&regressor.poses).enumerate() {
                *turn = pose.turn(at(&state.q, k));
            }
            let turns = &work.turns;
            regressor.walk(
                LaneMotion::splat(one, &v),
                LaneMotion::splat(one, &a),
                #[inline(always)]
                |k| (turns[k], [at(&state.qd, k), at(&state.qdd, k)]),
                0..n,
                &mut work.axes,
                #[inline(always)]
                |k, body, axes| {
                    let places = &links[k];
                    let others = match &regressor.straight[k] {
                        Some(own) => {
                            let sums = &mut sums[k * of_joint..];
                            match own.along {
                                Along::Y => add_own::<S, FIRST, Y>(simd, sums, places, body, own, vector),
                                Along::Z => add_own::<S, FIRST, Z>(simd, sums, places, body, own, vector),
                            }
                            &axes[..k]
                        }
                        None => &axes[..=k],
                    };
                    for (joint, axis) in others.iter().enumerate() {
                        let sums = &mut sums[joint * of_joint..];
                        entries!(|C| add::<S, FIRST>(
                            simd,
                            sums,
                            places[C],
                            vector,
                            #[inline(always)]
                            || body.entry(axis, C)
                        ));
                    }
                },
            );
        }
        if FIRST {
            for &index in &*of_terms {
                sums[index] = Line::ZERO;
            }
        }
        let flat = [&state.q, &state.qd, &state.qdd].map(|x| x.as_flattened());
        regressor.terms.each_column(flat, |joint, column, d, g: &[f64; TOGETHER]| {
            if let Some(place) = terms[column] {
                let index = joint * of_joint + place * of_column;
                if !is_of_terms[index] {
                    is_of_terms[index] = true;
                    of_terms.push(index);
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
    /// [`Self::add`] sample by sample, for terms that depend on the torque that all links take.
    fn add_alone<const FIRST: bool>(&mut self, state: &Together) {
        let p = self.regressor.cols();
        let mut rows = vec![0.0; self.regressor.rows() * p];
        for lane in 0..TOGETHER {
            let of = |x: &[[f64; TOGETHER]]| -> Vec<f64> { x.iter().map(|x| x[lane]).collect() };
            self.regressor.evaluate(&of(&state.q), &of(&state.qd), &of(&state.qdd), &mut rows);
            for cell in self.touched.iter().filter(|cell| cell.place < self.columns.len()) {
                let entry = rows[cell.joint * p + self.columns[cell.place]];
                let sum = &mut self.sums[cell.index + self.line].0[lane];
                *sum = if FIRST { entry } else { *sum + entry };
            }
        }
    }

    /// Sets the line of every joint in the one column more, to the values of some samples, n each.
    pub(super) fn put_last(&mut self, values: &[f64]) {
        let [of_joint, of_column] = self.strides;
        let n = self.regressor.rows();
        for joint in 0..n {
            let line = &mut self.sums[joint * of_joint + self.columns.len() * of_column + self.line];
            for (to, values) in line.0.iter_mut().zip(values.chunks_exact(n)) {
                *to = values[joint];
            }
        }
    }

    /// From sums over blocks of so many samples to means, in the order in which they are written.
    #[inline(always)]
    pub(super) fn average(&mut self, block: usize) {
        if self.touched.len() != self.sorted {
            self.sorted = self.touched.len();
            // Column by column, as they stand in memory.
            self.touched.sort_unstable_by_key(|cell| (cell.place, cell.joint));
        }
        if block > 1 {
            let scale = 1.0 / block as f64;
            for cell in &self.touched {
                self.sums[cell.index].0.iter_mut().for_each(|sum| *sum *= scale);
            }
        }
    }

    /// Writes the sums of `count` blocks into rows of W, n × wanted of each block after the other.
    #[inline(always)]
    pub(super) fn write_in_rows(&self, blocks: &mut [f64], count: usize) {
        for (lane, block) in blocks.chunks_exact_mut(self.sums.len()).enumerate().take(count) {
            for (to, sum) in block.iter_mut().zip(&self.sums) {
                *to = sum.0[lane];
            }
        }
    }

    /// Writes the sums of `count` blocks into W, whose columns are `rows` long, from row `first` of each column on.
    #[inline(always)]
    pub(super) fn write(&self, w: &mut [f64], rows: usize, first: usize, count: usize) {
        // The usual numbers of joints with distances of known length.
        match (self.regressor.rows(), count) {
            (6, TOGETHER) => self.write_all::<6>(w, rows, first),
            (7, TOGETHER) => self.write_all::<7>(w, rows, first),
            (n, _) => self.write_rows(w, n, rows, first, count),
        }
    }

    /// [`Self::write`] of N joints and all blocks: each number once, in its order. What no state moves has stayed zero.
    #[inline(always)]
    fn write_all<const N: usize>(&self, w: &mut [f64], rows: usize, first: usize) {
        let [of_joint, of_column] = self.strides;
        for (place, column) in w.chunks_exact_mut(rows).enumerate() {
            let mut lines = [&Line::ZERO; N];
            for (joint, line) in lines.iter_mut().enumerate() {
                *line = &self.sums[joint * of_joint + place * of_column];
            }
            for (lane, to) in column[first..].as_chunks_mut::<N>().0[..TOGETHER].iter_mut().enumerate() {
                for joint in 0..N {
                    to[joint] = lines[joint].0[lane];
                }
            }
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
                for (lane, sum) in self.sums[cell.index].0[..count].iter().enumerate() {
                    to[cell.joint + lane * n] = *sum;
                }
            }
        }
    }
}

/// Adds what the link's ten columns have along its own joint's axis.
#[inline(always)]
fn add_own<S: Simd, const FIRST: bool, const M: usize>(
    simd: S,
    sums: &mut [Line],
    places: &[usize; 10],
    body: &BodyRegressor<Wide<S>>,
    own: &StraightAxis,
    vector: usize,
) {
    entries!(|C| add::<S, FIRST>(
        simd,
        sums,
        places[C],
        vector,
        #[inline(always)]
        || own.entry::<_, M>(body, C)
    ));
}

/// Adds an entry at its place (or `FIRST` puts it there), where it is wanted.
#[inline(always)]
fn add<S: Simd, const FIRST: bool>(
    simd: S,
    sums: &mut [Line],
    place: usize,
    vector: usize,
    entry: impl FnOnce() -> Wide<S>,
) {
    if let Some(sum) = sums.get_mut(place) {
        let sum = &mut S::as_mut_simd_f64s(&mut sum.0).0[vector];
        let entry = entry().x;
        *sum = if FIRST { entry } else { simd.add_f64s(*sum, entry) };
    }
}
