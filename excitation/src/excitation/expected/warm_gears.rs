//! Gears whose friction falls as they warm up, along one period of a motion.
//!
//! ```text
//! s = S q̇        w_g = c_g mean_k (Fc_g + Fv_g m) m        m = s²/√(s² + ε²)        d = −Sᵀ diag(l_g w_g) s
//! ```
//! `w_g` is the temperature rise of gear g by the power that its friction took over the period, and `l_g` what a warm gear loses of its
//! viscous friction. A period is far shorter than a gear takes to warm up, so that `w_g` is one number for all of it. Then the arm
//! shows the viscous friction of gears as warm as the motion makes them, and predicts motions that make them colder or warmer with it.

use nalgebra::DMatrix;

use crate::dynamics::States;

/// What a gear is for its temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WarmGear {
    /// Viscous friction Fv, N·m·s/rad (or N·s/m).
    pub viscous: f64,
    /// Coulomb friction Fc, N·m (or N).
    pub coulomb: f64,
    /// Speed ε below which Coulomb friction fades, rad/s or m/s, above zero.
    pub fade: f64,
    /// Temperature rise for each watt of mean power, c, 1/W; one is that of a warm gear.
    pub rise_per_watt: f64,
    /// Viscous friction that a warm gear has lost, l, N·m·s/rad.
    pub lost: f64,
}

/// The gears of an arm.
#[derive(Clone, Debug, PartialEq)]
pub struct WarmGears {
    /// S, gears × n: the speeds of gears from those of joints.
    pub speeds: DMatrix<f64>,
    /// As many.
    pub gears: Vec<WarmGear>,
}

impl WarmGear {
    /// Magnitude m of a speed, and its slope.
    fn magnitude(&self, s: f64) -> [f64; 2] {
        let (square, fade) = (s * s, self.fade * self.fade);
        let root = (square + fade).sqrt();
        [square / root, s * (square + 2.0 * fade) / (root * root * root)]
    }

    /// Temperature rise by these speeds of one period.
    fn warmth(&self, speeds: impl Iterator<Item = f64>, samples: usize) -> f64 {
        let power = |s: f64| {
            let [m, _] = self.magnitude(s);
            (self.coulomb + self.viscous * m) * m
        };
        self.rise_per_watt * speeds.map(power).sum::<f64>() / samples as f64
    }

    /// Slope of the sum of powers by one of the speeds.
    fn power_slope(&self, s: f64) -> f64 {
        let [m, slope] = self.magnitude(s);
        (self.coulomb + 2.0 * self.viscous * m) * slope
    }
}

impl WarmGears {
    /// Speed of a gear at sample `k` of vectors of joints, N × n.
    fn speed(&self, gear: usize, joints: &[f64], k: usize) -> f64 {
        let n = self.speeds.ncols();
        joints[k * n..(k + 1) * n].iter().enumerate().map(|(j, x)| self.speeds[(gear, j)] * x).sum()
    }

    /// Adds the torque d, N × n, of the states of one period.
    pub(super) fn add_torque(&self, states: &States, d: &mut [f64]) {
        let (n, samples) = (states.dof, states.len());
        for (g, gear) in self.gears.iter().enumerate() {
            let speed = |k| self.speed(g, &states.qd, k);
            let loss = gear.lost * gear.warmth((0..samples).map(speed), samples);
            for k in 0..samples {
                let torque = loss * speed(k);
                d[k * n..(k + 1) * n].iter_mut().enumerate().for_each(|(j, d)| *d -= self.speeds[(g, j)] * torque);
            }
        }
    }

    /// Adds the gradient of `Σ u d` (u is N × n) by the joints' speeds.
    pub(super) fn pull_back(&self, states: &States, u: &[f64], slopes: &mut States) {
        let (n, samples) = (states.dof, states.len());
        for (g, gear) in self.gears.iter().enumerate() {
            let speed = |k| self.speed(g, &states.qd, k);
            let weight = |k| self.speed(g, u, k);
            let warmth = gear.warmth((0..samples).map(speed), samples);
            let by_warmth =
                (0..samples).map(|k| weight(k) * speed(k)).sum::<f64>() * gear.rise_per_watt / samples as f64;
            for k in 0..samples {
                let slope = gear.lost * (warmth * weight(k) + by_warmth * gear.power_slope(speed(k)));
                let to = slopes.qd[k * n..(k + 1) * n].iter_mut().enumerate();
                to.for_each(|(j, to)| *to -= self.speeds[(g, j)] * slope);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_a_gear_at_one_speed_loses_friction_in_proportion_to_its_power() {
        // Two joints, of which both turn the one gear: s = 2·0.5 − 3·(−1) = 4, power (1.5 + 0.25·4) 4 = 10 W.
        let gear = WarmGear { viscous: 0.25, coulomb: 1.5, fade: 1e-9, rise_per_watt: 0.02, lost: 0.15 };
        let gears = WarmGears { speeds: DMatrix::from_row_slice(1, 2, &[2.0, -3.0]), gears: vec![gear] };
        let mut states = States::new(2);
        (0..3).for_each(|_| states.push(&[0.0; 2], &[0.5, -1.0], &[0.0; 2]));
        let mut d = vec![0.0; 6];
        gears.add_torque(&states, &mut d);
        let torque = 0.15 * (0.02 * 10.0) * 4.0;
        for d in d.chunks_exact(2) {
            assert!((d[0] + 2.0 * torque).abs() < 1e-12 && (d[1] - 3.0 * torque).abs() < 1e-12, "{d:?}");
        }
    }
}
