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

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::chains::ChainRecipe;
    use crate::excitation::effort::ParameterSpread;
    use crate::excitation::radkhah2007_start;
    use crate::model::Columns;
    use crate::model::term::LOAD_FRICTION;
    use crate::seed::Seed;
    use crate::trajectory::{PathPoint, Segment, Timeline};

    #[test]
    fn identity_many_instants_have_the_bits_of_each_alone() {
        for run in 0..8 {
            let mut rng = Seed::new(41).stream("efforts", run);
            let recipe = ChainRecipe { coupled: run % 2 == 1, ..ChainRecipe::new(1 + usize::try_from(run).unwrap()) };
            let (robot, mut parameters) = recipe.draw(&mut rng);
            let robot = robot
                .with_joints(|joint| {
                    (joint.limits.torque, joint.drive.current_limit) = (20.0, 3.0);
                })
                .unwrap();
            if run % 3 == 2 {
                parameters.drives.iter_mut().for_each(|drive| drive[LOAD_FRICTION] = 0.05);
            }
            let count = Columns::default().with_terms_of(&parameters).parameters(&robot).len();
            let deviations = (0..count).map(|_| rng.random_range(0.0..0.3)).collect();
            let spread = ParameterSpread { deviations, multiple: 1.6 };
            let mut model = EffortModel::new(&robot, &parameters, Some(&spread));
            let channels = Channel::all(&robot);
            assert_eq!(channels.len(), 2 * robot.dof());

            let motion = radkhah2007_start(&robot, 10.0, 3, Seed::new(2), run).unwrap();
            let timeline = Timeline { period_s: 10.0, ramp_s: Some(1.0) };
            let omega = std::f64::consts::TAU / timeline.period_s;
            let segment = |k: usize| if k < 9 { Segment::RampIn } else { Segment::Period };
            let points: Vec<PathPoint> = (0..21).map(|k| timeline.point(segment(k), k as f64 / 21.0)).collect();
            let mut states = States::new(robot.dof());
            for point in &points {
                let [q, qd, qdd] = model.move_state_to(&motion, omega, point);
                states.push(q, qd, qdd);
            }
            let mut loads = Vec::new();
            model.add_loads(&states, &channels, &mut loads);
            let mut found = loads.iter();
            for (k, point) in points.iter().enumerate() {
                for (c, channel) in channels.iter().enumerate() {
                    let alone = model.load_at(channel, &motion, omega, point);
                    assert_eq!(found.next(), Some(&alone), "chain {run}, instant {k}, channel {c}");
                }
            }
            assert_eq!(found.next(), None);
        }
    }
}
