//! Efforts at many instants, eight side by side in lanes.

use std::ops::Range;

use super::channel::Channel;
use super::model::{EffortModel, Load};
use crate::dynamics::States;
use crate::regressor::{BLOCKS_OF_PART, StackPart};

/// A number of each instant of a part.
type Line = [f64; BLOCKS_OF_PART];

/// `w · Y φ̄` and its variance, of each instant of a part.
struct Sums {
    value: Line,
    variance: Line,
}

impl EffortModel {
    /// Appends the effort of every channel at every one of these states, state after state, with the bits that it has alone.
    pub(super) fn add_loads(&self, states: &States, channels: &[Channel], loads: &mut Vec<Load>) {
        let wanted: Vec<usize> = (0..self.phi.len()).collect();
        let begin = loads.len();
        loads.resize(begin + states.len() * channels.len(), Load { value: 0.0, spread: 0.0 });
        let loads = &mut loads[begin..];
        let mut row = vec![[0.0; BLOCKS_OF_PART]; self.phi.len()];
        self.regressor.stack_in_parts(
            states,
            &wanted,
            1,
            #[inline(always)]
            |part| {
                for (c, channel) in channels.iter().enumerate() {
                    let sums = self.sums(part, channel, &mut row);
                    for k in 0..part.count {
                        loads[(part.first + k) * channels.len() + c] = self.load_of(sums.value[k], sums.variance[k]);
                    }
                }
            },
        );
    }

    #[inline(always)]
    fn sums(&self, part: &StackPart<'_>, channel: &Channel, row: &mut [Line]) -> Sums {
        let mut sums = Sums { value: [0.0; BLOCKS_OF_PART], variance: [0.0; BLOCKS_OF_PART] };
        if let Some((i, weight)) = channel.single() {
            for range in &self.columns[i] {
                self.add_products(
                    #[inline(always)]
                    |c| part.line(i, c),
                    weight,
                    range.clone(),
                    &mut sums,
                );
            }
        } else {
            row.fill([0.0; BLOCKS_OF_PART]);
            for (i, &weight) in channel.weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0) {
                for (c, row) in row.iter_mut().enumerate() {
                    let line = part.line(i, c);
                    for k in 0..BLOCKS_OF_PART {
                        row[k] += weight * line[k];
                    }
                }
            }
            self.add_products(
                #[inline(always)]
                |c| &row[c],
                1.0,
                0..self.phi.len(),
                &mut sums,
            );
        }
        sums
    }

    /// Adds `weight Σ y φ̄` and `weight² Σ y² σ²` over a range of columns, summed in the order of [`dot`](crate::optimiser::dot).
    #[inline(always)]
    fn add_products<'a>(
        &self,
        line: impl Fn(usize) -> &'a Line,
        weight: f64,
        range: Range<usize>,
        Sums { value, variance }: &mut Sums,
    ) {
        let mut values = [[0.0; BLOCKS_OF_PART]; 4];
        let mut variances = values;
        let in_fours = range.len() / 4 * 4;
        for (place, c) in range.clone().take(in_fours).enumerate() {
            add_product(line(c), (self.phi[c], self.variance[c]), &mut values[place % 4], &mut variances[place % 4]);
        }
        let (mut rest, mut rest_variance) = ([-0.0; BLOCKS_OF_PART], [-0.0; BLOCKS_OF_PART]);
        for c in range.skip(in_fours) {
            add_product(line(c), (self.phi[c], self.variance[c]), &mut rest, &mut rest_variance);
        }
        let sum = |x: &[Line; 4], rest: &Line, k: usize| (x[0][k] + x[2][k]) + (x[1][k] + x[3][k]) + rest[k];
        for k in 0..BLOCKS_OF_PART {
            value[k] += weight * sum(&values, &rest, k);
            variance[k] += weight * weight * sum(&variances, &rest_variance, k);
        }
    }
}

#[inline(always)]
fn add_product(line: &Line, (phi, variance): (f64, f64), value: &mut Line, spread: &mut Line) {
    for k in 0..BLOCKS_OF_PART {
        value[k] += line[k] * phi;
        spread[k] += line[k] * line[k] * variance;
    }
}
