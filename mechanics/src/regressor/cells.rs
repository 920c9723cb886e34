//! Sums of a few blocks of samples, one place for each joint and wanted column, and how they get into a stack.

use pulp::Simd;

use super::body::BodyRegressor;
use super::joint_torque::JointTorqueRegressor;
use crate::dynamics::{TOGETHER, Together};
use crate::lanes::Wide;
use crate::linalg::column_products::Line;
use crate::spatial::LaneMotion;

/// Sums of the blocks that are worked on, one place for each joint and wanted column.
pub(super) struct Cells<'a> {
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
    /// How many of them are in the order of columns.
    sorted: usize,
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
    pub(super) fn new(regressor: &'a JointTorqueRegressor, columns: &[usize]) -> Self {
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
        let (sums, of_terms) = (vec![Line::ZERO; n * wanted], vec![false; n * wanted]);
        Self { regressor, links, terms, wanted, sums, touched, sorted: 0, of_terms }
    }

    /// Adds one sample of each block; the `FIRST` of them takes the place of what was there.
    #[inline(always)]
    pub(super) fn add<S: Simd, const FIRST: bool>(
        &mut self,
        simd: S,
        state: &Together,
        axes: &mut [LaneMotion<Wide<S>>],
    ) {
        let Self { regressor, links, terms, wanted, sums, touched, of_terms, .. } = self;
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
                sums[cell.index] = Line::ZERO;
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

    /// Joint, place of the column and sums of everything that is not zero for every state.
    #[inline(always)]
    pub(super) fn each(&self, mut visit: impl FnMut(usize, usize, &Line)) {
        for cell in &self.touched {
            visit(cell.joint, cell.place, &self.sums[cell.index]);
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
