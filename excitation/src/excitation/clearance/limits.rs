//! Clearance as a limit of the optimiser: rows at the times at which two bodies come nearest.
//!
//! ```text
//! c = (d_required − d(q(θ)))/s ≤ 0        ∂c/∂x = −1/s Σ_j ∂d/∂q_j B_q(θ)_j
//! ```

use std::f64::consts::TAU;

use super::scene::Scene;
use super::sweep::CLEARANCE_TOLERANCE;
use crate::dynamics::States;
use crate::excitation::{basis::MotionBasis, sampled::SampledBasis};
use crate::optimiser::{CurvePoint, Row, SmoothLimits, SmoothRow, climb};
use crate::trajectory::Trajectory;

/// Distance that counts as one unit of excess, m.
const UNIT: f64 = 0.1;

/// A local minimum further than this from the required distance gets no row, m.
const NEAR: f64 = 0.15;

/// How well the time of a nearest approach is known, in steps of the grid.
const REFINED: f64 = 1e-3;

/// What the optimiser keeps above the required distance, m, so that neither its tolerance nor the sweep's undercuts
/// it.
const INSIDE: f64 = 2.0 * CLEARANCE_TOLERANCE;

/// A time at which a pair comes nearest.
#[derive(Clone, Copy, Debug)]
struct Dip {
    pair: usize,
    phase: f64,
    distance: f64,
}

/// The clearance of a robot around a motion of one family.
#[derive(Clone, Debug)]
pub struct ClearanceLimits {
    scene: Scene,
    sampled: SampledBasis,
    required: f64,
    states: States,
    /// The dips of the point they belong to.
    dips: Vec<Dip>,
    at: Vec<f64>,
}

impl ClearanceLimits {
    /// The limit of at least `clearance` (m) between all bodies of `scene`, watched on a grid of `samples`.
    pub fn new(scene: Scene, basis: &MotionBasis, samples: usize, clearance: f64) -> Self {
        let states = States::with_len(basis.dof(), samples);
        let sampled = SampledBasis::new(basis.clone(), samples);
        Self { scene, sampled, required: clearance + INSIDE, states, dips: Vec::new(), at: Vec::new() }
    }

    /// Finds the dips of the point `x`, unless they are there already.
    fn move_to(&mut self, x: &[f64]) {
        if self.at == x {
            return;
        }
        let mut states = std::mem::take(&mut self.states);
        self.sampled.states(x, &mut states);
        let (count, pairs) = (states.len(), self.scene.pairs.len());
        let step = TAU / count as f64;
        let half_s = 0.5 * step / self.sampled.basis.omega();
        let mut distances = vec![0.0; count * pairs];
        for k in 0..count {
            self.scene.place(states.q(k));
            for pair in 0..pairs {
                distances[k * pairs + pair] = self.scene.distance_within(pair, self.required + NEAR);
            }
        }
        self.dips.clear();
        let trajectory = self.sampled.basis.trajectory(x);
        let mut dips = Vec::new();
        for pair in 0..pairs {
            let at = |k: usize| distances[(k % count) * pairs + pair];
            for k in 0..count {
                let here = at(k);
                let dips_here = here <= at(k + count - 1) && here < at(k + 1);
                if !dips_here || here > self.required + NEAR {
                    continue;
                }
                let dip = Dip { pair, phase: k as f64 * step, distance: here };
                let (qd, qdd) = (states.qd(k), states.qdd(k));
                let moved: Vec<f64> =
                    qd.iter().zip(qdd).map(|(qd, qdd)| half_s * (qd.abs() + half_s * qdd.abs())).collect();
                let near = here - self.scene.closing(pair, &moved) < self.required;
                dips.push(if near { self.refine(&trajectory, dip, step) } else { dip });
            }
        }
        self.states = states;
        self.dips = dips;
        self.at = x.to_vec();
    }

    /// The nearest approach around a dip on the grid.
    fn refine(&mut self, motion: &dyn Trajectory, dip: Dip, step: f64) -> Dip {
        let n = motion.dof();
        let (mut q, mut qd, mut qdd) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let omega = self.sampled.basis.omega();
        let scene = &mut self.scene;
        let nearness = |phase: f64| {
            motion.evaluate(phase / omega, &mut q, &mut qd, &mut qdd);
            scene.place(&q);
            -scene.separation(dip.pair).distance
        };
        let from = CurvePoint { place: dip.phase, value: -dip.distance };
        let top = climb(nearness, from, dip.phase - step..dip.phase + step, REFINED * step);
        Dip { phase: top.place, distance: -top.value, ..dip }
    }
}

impl SmoothLimits for ClearanceLimits {
    fn excess(&mut self, x: &[f64]) -> f64 {
        self.move_to(x);
        let mut worst = vec![0.0_f64; self.scene.pairs.len()];
        for dip in &self.dips {
            worst[dip.pair] = worst[dip.pair].max((self.required - dip.distance) / UNIT);
        }
        worst.iter().sum()
    }

    fn linearise(&mut self, x: &[f64], rows: &mut Vec<SmoothRow>) {
        self.move_to(x);
        let basis = &self.sampled.basis;
        let trajectory = basis.trajectory(x);
        let n = basis.dof();
        let (mut q, mut qd, mut qdd) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let mut slopes = vec![0.0; n];
        let mut row = Vec::new();
        for dip in &self.dips {
            trajectory.evaluate(dip.phase / basis.omega(), &mut q, &mut qd, &mut qdd);
            self.scene.place(&q);
            let separation = self.scene.separation(dip.pair);
            self.scene.slopes(dip.pair, &separation, &mut slopes);
            let mut normal = vec![0.0; x.len()];
            for (j, slope) in slopes.iter().enumerate() {
                basis.add_combined_row(j, dip.phase, [-slope / UNIT, 0.0, 0.0], &mut row, &mut normal);
            }
            let bound = (separation.distance - self.required) / UNIT;
            rows.push(SmoothRow { row: Row { start: 0, normal, bound }, limit: dip.pair, at: dip.phase / TAU });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains;
    use crate::excitation::DesignSpace;
    use crate::excitation::radkhah2007_start;
    use crate::seed::Seed;
    use crate::trajectory::Family;

    /// The A460 on a motion of the first guess that is `scale` times as large, watched on a grid of 200.
    fn watched(scale: f64, clearance: f64) -> (MotionBasis, Vec<f64>, ClearanceLimits) {
        let robot = chains::crs_a460();
        let basis = MotionBasis::new(&robot, &DesignSpace::new(Family::Fourier, 10.0, vec![5; 6])).unwrap();
        let start = radkhah2007_start(&robot, 10.0, 5, Seed::new(2), 1).unwrap().into();
        let x = basis.coefficients(&start).unwrap().iter().map(|x| scale * x).collect();
        let limits = ClearanceLimits::new(Scene::new(&robot), &basis, 200, clearance);
        (basis, x, limits)
    }

    /// Distance of a pair at a phase of the motion x.
    fn distance(scene: &mut Scene, basis: &MotionBasis, x: &[f64], pair: usize, phase: f64) -> f64 {
        let (mut q, mut qd, mut qdd) = ([0.0; 6], [0.0; 6], [0.0; 6]);
        basis.trajectory(x).evaluate(phase / basis.omega(), &mut q, &mut qd, &mut qdd);
        scene.place(&q);
        scene.separation(pair).distance
    }

    #[test]
    fn identity_rows_are_the_slopes_of_the_dips() {
        let (basis, x, mut limits) = watched(1.0, 0.02);
        let mut rows = Vec::new();
        limits.linearise(&x, &mut rows);
        let dips = limits.dips.clone();
        assert!(rows.len() == dips.len() && rows.len() > 5, "{}", rows.len());
        let mut scene = Scene::new(&chains::crs_a460());
        for (SmoothRow { row, .. }, dip) in rows.iter().zip(&dips) {
            assert!((row.bound - (dip.distance - limits.required) / UNIT).abs() < 1e-12);
            for i in (0..x.len()).step_by(7) {
                let mut at = |h: f64| {
                    let mut moved = x.clone();
                    moved[i] += h;
                    distance(&mut scene, &basis, &moved, dip.pair, dip.phase)
                };
                let difference = -(at(1e-6) - at(-1e-6)) / (2e-6 * UNIT);
                assert!((difference - row.normal[i]).abs() < 1e-5, "{difference} {}", row.normal[i]);
            }
        }
    }

    #[test]
    fn identity_no_pair_that_is_too_close_is_closer_around_its_dip() {
        let (basis, x, mut limits) = watched(1.0, 0.1);
        limits.move_to(&x);
        let close: Vec<Dip> = limits.dips.iter().copied().filter(|dip| dip.distance < limits.required).collect();
        let mut scene = Scene::new(&chains::crs_a460());
        let mut at =
            |dip: &Dip, steps: f64| distance(&mut scene, &basis, &x, dip.pair, dip.phase + steps * TAU / 200.0);
        assert!(close.len() > 2, "{}", close.len());
        for dip in &close {
            assert!((at(dip, 0.0) - dip.distance).abs() < 1e-12);
            assert!([-0.02, 0.02].into_iter().all(|steps| at(dip, steps) >= dip.distance), "{dip:?}");
        }
    }

    #[test]
    fn analytic_a_pair_that_keeps_its_distance_has_no_dip() {
        let (_, x, mut limits) = watched(0.0, 1.0);
        limits.move_to(&x);
        assert!(limits.dips.is_empty(), "{:?}", limits.dips);
    }
}
