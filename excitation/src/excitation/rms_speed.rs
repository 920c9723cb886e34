//! A limit on the root mean square of all joints' speeds, so that designs are compared at equal speed.
//!
//! ```text
//! s(x)² = 1/n Σ_j 1/N Σ_k (q̇_j(t_k) / limit_j)² = xᵀ G x        s ≤ s_max        ∂s/∂x = G x / s
//! ```
//! Each joint counts by its own speed limit, so that revolute and prismatic ones add up; a joint without a limit counts as at rest.
//! G is constant, since every family is linear in its coefficients. Amplitudes times a factor are s times that factor.

use std::f64::consts::TAU;

use nalgebra::DMatrix;

use super::basis::MotionBasis;
use crate::model::Robot;
use crate::optimiser::{Row, SmoothLimits, SmoothRow};
use crate::trajectory::{PeriodicTrajectory, Quantity};

/// Below this part of the permitted speed the limit gets no row.
const NEAR: f64 = 0.75;

/// The RMS speed of a robot's motions in one space, and what is permitted of it.
#[derive(Clone, Debug)]
pub(crate) struct RmsSpeed {
    /// First variable of each joint, and its block of G.
    blocks: Vec<(usize, DMatrix<f64>)>,
    most: f64,
}

impl RmsSpeed {
    /// At most `most`, on a grid of `samples` of one period.
    pub(crate) fn new(robot: &Robot, basis: &MotionBasis, samples: usize, most: f64) -> Self {
        let block = |j: usize| {
            let range = basis.range(j);
            let limit = robot.joints()[j].limits.velocity;
            let mut rows = DMatrix::zeros(samples, range.len());
            for k in 0..samples {
                let row = basis.row(j, Quantity::Velocity, TAU * k as f64 / samples as f64, 1.0 / limit);
                rows.row_mut(k).copy_from_slice(&row);
            }
            (range.start, rows.tr_mul(&rows) / (samples * robot.dof()) as f64)
        };
        Self { blocks: (0..robot.dof()).map(block).collect(), most }
    }

    /// The factor that brings all amplitudes of a motion inside; 1 of one that is.
    pub(crate) fn factor(robot: &Robot, motion: &PeriodicTrajectory, samples: usize, most: f64) -> f64 {
        (most / rms_speed(robot, motion, samples)).min(1.0)
    }

    /// s / s_max and its gradient.
    fn part(&self, x: &[f64]) -> (f64, Vec<f64>) {
        let (mut square, mut slope) = (0.0, vec![0.0; x.len()]);
        for (first, block) in &self.blocks {
            let own = &x[*first..*first + block.ncols()];
            for (i, slope) in slope[*first..*first + own.len()].iter_mut().enumerate() {
                *slope = own.iter().zip(block.column(i).iter()).map(|(x, g)| x * g).sum();
                square += own[i] * *slope;
            }
        }
        let speed = square.max(0.0).sqrt();
        if speed > 0.0 {
            slope.iter_mut().for_each(|slope| *slope /= speed * self.most);
        }
        (speed / self.most, slope)
    }
}

/// Root mean square over joints and time of speed over speed limit, on `samples` of one period; from 0 at rest to less than 1.
pub fn rms_speed(robot: &Robot, motion: &PeriodicTrajectory, samples: usize) -> f64 {
    let states = motion.sample(samples);
    let joints = robot.joints();
    let squares = (0..states.len())
        .flat_map(|k| states.qd(k).iter().zip(joints).map(|(speed, joint)| (speed / joint.limits.velocity).powi(2)));
    (squares.sum::<f64>() / (states.len() * joints.len()) as f64).sqrt()
}

impl SmoothLimits for RmsSpeed {
    fn excess(&mut self, x: &[f64]) -> f64 {
        (self.part(x).0 - 1.0).max(0.0)
    }

    fn linearise(&mut self, x: &[f64], rows: &mut Vec<SmoothRow>) {
        let (part, normal) = self.part(x);
        if part > NEAR {
            rows.push(SmoothRow { row: Row { start: 0, normal, bound: 1.0 - part }, limit: 0, at: 0.0 });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains;
    use crate::excitation::{CriterionKind, DesignBudget, DesignLimits, DesignProblem, design, radkhah2007_start};
    use crate::model::Columns;
    use crate::seed::Seed;

    #[test]
    fn identity_the_form_is_the_mean_square_of_the_motion_and_its_row_the_slope() {
        let robot = chains::crs_a460();
        let problem =
            DesignProblem::new(robot.clone(), Columns::RIGID, CriterionKind::DOptimal, DesignLimits::motion()).unwrap();
        let motion: PeriodicTrajectory = radkhah2007_start(&robot, 10.0, 5, Seed::new(2), 1).unwrap().into();
        let x = problem.basis().coefficients(&motion).unwrap();
        let mut limit = RmsSpeed::new(&robot, problem.basis(), 200, 0.1);
        let speed = rms_speed(&robot, &motion, 977);
        assert!((limit.part(&x).0 / (speed / 0.1) - 1.0).abs() < 1e-12 && speed > 0.1, "{speed}");
        assert!((RmsSpeed::factor(&robot, &motion, 977, 0.1) - 0.1 / speed).abs() < 1e-15);
        let mut rows = Vec::new();
        limit.linearise(&x, &mut rows);
        for i in (0..x.len()).step_by(7) {
            let at = |h: f64| {
                let mut moved = x.clone();
                moved[i] += h;
                limit.part(&moved).0
            };
            let difference = (at(1e-5) - at(-1e-5)) / 2e-5;
            assert!((difference - rows[0].row.normal[i]).abs() < 1e-8, "{i}");
        }
    }

    #[test]
    fn identity_a_design_keeps_its_rms_speed_and_uses_it() {
        let robot = chains::crs_a460();
        let limits = DesignLimits::motion();
        let make = |limits| {
            let mut problem =
                DesignProblem::new(robot.clone(), Columns::RIGID, CriterionKind::DOptimal, limits).unwrap();
            problem.set_budget(DesignBudget { evaluations: 80, ..DesignBudget::default() }).unwrap();
            design(&problem, Seed::new(7), 0).unwrap()
        };
        let (free, held) = (make(limits.clone()), make(DesignLimits { rms_speed: Some(0.15), ..limits.clone() }));
        let speed = |design: &crate::excitation::Design| rms_speed(&robot, &design.trajectory, 1000);
        assert!(speed(&free) > 0.2 && free.value > held.value, "{}", speed(&free));
        assert!((0.149..=0.15 * (1.0 + 1e-9)).contains(&speed(&held)), "{}", speed(&held));
        for none in [0.0, f64::NAN] {
            let limits = DesignLimits { rms_speed: Some(none), ..limits.clone() };
            assert!(DesignProblem::new(robot.clone(), Columns::RIGID, CriterionKind::DOptimal, limits).is_err());
        }
    }
}
