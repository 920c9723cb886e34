//! Wind-up that depends on where it came from: four Maxwell slip elements beside the spring of a drive.
//!
//! ```text
//! τ = k u + Σ_j s_j        s_j ← clamp(s_j + k_j Δu, ±S)        S = k w/8        k_j = S/y_j, y_j = w/4, w/2, 3w/4, w
//! ```
//! `u` is the wind-up, `s_j` the state: one torque per element. Coming back from far, all elements slip the other way, and
//! at zero torque `u = Σ S / k = w/2`: the loop is `w` wide there. A cycle between ±A beyond `w` loses
//! `Σ 4 S (A − y_j)`, the area of the loop. Independent of speed.
//!
//! Source: F. Al-Bender, V. Lampaert, J. Swevers, "The generalized Maxwell-slip model", *IEEE TAC* 50(11), 2005; four
//! elements and their spread are assumed.

/// Number of elements.
pub(super) const ELEMENTS: usize = 4;

/// The elements of one drive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Slips {
    stiffness: [f64; ELEMENTS],
    /// Torque at which each element slips, N·m.
    strength: f64,
    torque: [f64; ELEMENTS],
}

impl Slips {
    /// Elements beside a spring of `stiffness` N·m/rad that make a loop `width` rad wide.
    pub(super) fn new(stiffness: f64, width: f64) -> Self {
        let strength = stiffness * width / (2 * ELEMENTS) as f64;
        let of = |j: usize| {
            if width > 0.0 { strength / (width * (j + 1) as f64 / ELEMENTS as f64) } else { 0.0 }
        };
        Self { stiffness: std::array::from_fn(of), strength, torque: [0.0; ELEMENTS] }
    }

    /// The elements after the wind-up has changed by `change` rad in one direction.
    pub(super) fn wound(mut self, change: f64) -> Self {
        for j in 0..ELEMENTS {
            self.torque[j] = (self.torque[j] + self.stiffness[j] * change).clamp(-self.strength, self.strength);
        }
        self
    }

    /// Torque of all elements, N·m.
    pub(super) fn torque(&self) -> f64 {
        self.torque.iter().sum()
    }

    /// Stiffness of the elements that do not slip when wound in the direction of `sign`, N·m/rad, and the change at
    /// which the first of them begins to, rad.
    fn sticking(&self, sign: f64) -> (f64, f64) {
        let (mut stiffness, mut change) = (0.0, f64::INFINITY);
        for j in 0..ELEMENTS {
            let room = self.strength - sign * self.torque[j];
            // Rounding may leave a slipping element a last bit short of its strength.
            if room > 1e-12 * self.strength {
                stiffness += self.stiffness[j];
                change = f64::min(change, room / self.stiffness[j]);
            }
        }
        (stiffness, change)
    }

    /// The change of wind-up that brings spring and elements from their torque now to `torque` more, rad.
    pub(super) fn change_for(self, spring: f64, torque: f64) -> f64 {
        let sign = if torque < 0.0 { -1.0 } else { 1.0 };
        let (mut slips, mut left, mut change) = (self, torque.abs(), 0.0);
        // One piece of the path for each element that begins to slip, and the last.
        for _ in 0..=ELEMENTS {
            let (stiffness, room) = slips.sticking(sign);
            let needed = left / (spring + stiffness);
            if needed <= room {
                return sign * (change + needed);
            }
            left -= room * (spring + stiffness);
            change += room;
            slips = slips.wound(sign * room);
        }
        sign * (change + left / spring)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STIFFNESS: f64 = 2e4;
    const WIDTH: f64 = 4e-4;

    fn path(amplitude: f64, cycles: i32) -> impl Iterator<Item = f64> {
        (0..=cycles * 4000).map(move |k| amplitude * (std::f64::consts::TAU * f64::from(k) / 4000.0).sin())
    }

    #[test]
    fn analytic_energy_lost_in_a_cycle_is_the_area_of_the_loop() {
        let amplitude = 1e-3;
        let (mut slips, mut u, mut lost) = (Slips::new(STIFFNESS, WIDTH), 0.0, 0.0);
        for (k, next) in path(amplitude, 2).enumerate() {
            let before = STIFFNESS * u + slips.torque();
            slips = slips.wound(next - u);
            if k > 4000 {
                lost += 0.5 * (before + STIFFNESS * next + slips.torque()) * (next - u);
            }
            u = next;
        }
        let strength = STIFFNESS * WIDTH / 8.0;
        let area: f64 = (1..=4).map(|j| 4.0 * strength * (amplitude - WIDTH * f64::from(j) / 4.0)).sum();
        // The trapezium misses the corners of the loop, where an element begins to slip inside a step of 1.6e-6 rad.
        assert!((lost - area).abs() < 1e-4 * area, "{lost} {area}");
    }

    #[test]
    fn analytic_the_loop_is_as_wide_as_said() {
        let (mut slips, mut u) = (Slips::new(STIFFNESS, WIDTH), 0.0);
        for next in [2e-3, 1.5e-3] {
            slips = slips.wound(next - u);
            u = next;
        }
        // From there back to zero torque.
        u += slips.change_for(STIFFNESS, -(STIFFNESS * u + slips.torque()));
        assert!((u - 0.5 * WIDTH).abs() < 1e-12, "{u}");
    }

    #[test]
    fn identity_torque_from_wind_up_and_back() {
        let (mut slips, mut u) = (Slips::new(STIFFNESS, WIDTH), 0.0);
        for (k, next) in path(7e-4, 1).step_by(37).enumerate() {
            let after = slips.wound(next - u);
            let torque = STIFFNESS * (next - u) + after.torque() - slips.torque();
            let change = slips.change_for(STIFFNESS, torque);
            assert!((change - (next - u)).abs() < 1e-14, "{k}: {change} {}", next - u);
            (slips, u) = (after, next);
        }
    }
}
