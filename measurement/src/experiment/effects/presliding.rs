//! Coulomb friction before it slides: a function of displacement.
//!
//! ```text
//! dF/dx = σ (1 − F/Fc sgn ẋ)        σ = Fc/s
//! F(x + Δ) = ± Fc + (F(x) ∓ Fc) exp(−|Δ|/s)        over a displacement Δ in the direction ±
//! ```
//! `s` is the magnitude: the displacement of the motor after its gear in which friction comes nearer to sliding by the factor e.
//! About the place where it was let go friction is a spring of stiffness `σ`; far from it `Fc`, that of the parameters. The second
//! line is the first one's solution, so that a step of any length is exact, friction never exceeds `Fc`, and
//! nothing depends on speed. It stands in place of `Fc tanh(v/v_s)` in the plant; other terms of friction keep their
//! laws of speed.
//!
//! Held over a part of a servo step at the displacement of its middle, as the torque of a [spring](super::elasticity) is; parts are
//! so short that `ω h ≤ 0.5` for the oscillation `ω = √(σ m)` on this spring, `m` the mobility of the drive.
//!
//! Sources: P. R. Dahl, *AIAA J.* 14(12), 1976 (report TOR-0158(3107-18)-1, 1968), exponent 1; it is the model of C. Canudas
//! de Wit et al., *IEEE TAC* 40(3), 1995 without the damping of its bristles and with a constant sliding friction. The levels are
//! assumed.

/// Largest `ω h` on the spring of presliding.
pub(super) const RESOLVED: f64 = 0.5;

/// Coulomb friction of one coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Presliding {
    coulomb: f64,
    distance: f64,
    at: f64,
    torque: f64,
}

impl Presliding {
    /// Friction that slides at `coulomb` N·m, after some times `distance` rad (m).
    pub(super) const fn new(coulomb: f64, distance: f64) -> Self {
        Self { coulomb, distance, at: 0.0, torque: 0.0 }
    }

    /// Comes to rest at `q` without torque.
    pub(super) const fn rest_at(&mut self, q: f64) {
        (self.at, self.torque) = (q, 0.0);
    }

    /// Stiffness `σ` about rest, N·m/rad.
    pub(super) fn stiffness(&self) -> f64 {
        self.coulomb / self.distance
    }

    /// Moves to `q`, rad (m); returns the friction there, N·m.
    pub(super) fn slide(&mut self, q: f64) -> f64 {
        let moved = q - self.at;
        let sliding = self.coulomb.copysign(moved);
        self.torque = sliding + (self.torque - sliding) * libm::exp(-moved.abs() / self.distance);
        self.at = q;
        self.torque
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COULOMB: f64 = 4.0;
    const DISTANCE: f64 = 1e-3;

    fn at_rest() -> Presliding {
        let mut friction = Presliding::new(COULOMB, DISTANCE);
        friction.rest_at(0.7);
        friction
    }

    #[test]
    fn analytic_a_spring_about_rest_and_coulomb_friction_far_from_it() {
        // F = σ Δ (1 − Δ/2s + …)
        for moved in [1e-6, -1e-6] {
            let found = at_rest().slide(0.7 + moved) / moved;
            assert!((found / (COULOMB / DISTANCE) - 1.0).abs() < 5.1e-4, "{found}");
        }
        assert!((at_rest().stiffness() - 4000.0).abs() < 1e-9);
        for direction in [1.0, -1.0] {
            // After 20 s all but exp(−20) of it.
            let found = at_rest().slide(0.7 + 20.0 * direction * DISTANCE);
            assert!((found - direction * COULOMB).abs() < 1e-8, "{found}");
        }
    }

    /// Euler's solution of the differential equation itself, in another variable: time, at two speeds.
    #[test]
    fn analytic_the_path_counts_and_not_the_speed() {
        let path = |t: f64| 0.7 + 2e-3 * libm::sin(t) + 5e-4 * libm::sin(5.0 * t);
        let followed = |steps: i32, until: f64| {
            let mut friction = at_rest();
            let mut last = 0.0;
            for k in 1..=steps {
                last = friction.slide(path(until * f64::from(k) / f64::from(steps)));
            }
            last
        };
        // Twice as fast is half as many points of the same path: what is left is where it turns between two points.
        let (slow, fast) = (followed(40_000, 4.0), followed(20_000, 4.0));
        assert!((slow - fast).abs() < 1e-6 * COULOMB, "{slow} {fast}");
        let by_euler = |speed: f64| {
            let (steps, sigma) = (1_000_000, COULOMB / DISTANCE);
            let dt = 4.0 / speed / f64::from(steps);
            let mut force: f64 = 0.0;
            for k in 0..steps {
                let t = dt * (f64::from(k) + 0.5) * speed;
                let rate = speed * (2e-3 * libm::cos(t) + 2.5e-3 * libm::cos(5.0 * t));
                force += dt * sigma * (rate - force / COULOMB * rate.abs());
            }
            force
        };
        for speed in [1.0, 30.0] {
            let found = by_euler(speed);
            // Euler's error is half a step's displacement, at most 1.8e-8 rad of s.
            assert!((found - slow).abs() < 1e-5 * COULOMB, "{found} {slow}");
        }
    }

    #[test]
    fn analytic_energy_lost_in_a_long_cycle_is_that_of_coulomb_friction() {
        let (mut friction, mut lost, mut before) = (at_rest(), 0.0, 0.0);
        let amplitude = 0.1;
        let path = |k: i32| 0.7 + amplitude * libm::sin(std::f64::consts::TAU * f64::from(k) / 20_000.0);
        for k in 1..=40_000 {
            let torque = friction.slide(path(k));
            if k > 20_000 {
                lost += 0.5 * (before + torque) * (path(k) - path(k - 1));
            }
            before = torque;
        }
        // After each of two reversals friction goes from −Fc to Fc like 1 − 2 exp(−x/s): 2 Fc s less than 4 A Fc each.
        let expected = 4.0 * COULOMB * (amplitude - DISTANCE);
        assert!((lost / expected - 1.0).abs() < 1e-5, "{lost} {expected}");
    }
}
