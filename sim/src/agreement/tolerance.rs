//! What each engine must reach, in one place, each number with its reason.

use crate::Engine;

/// What is asked of one engine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Smallest and largest order of convergence.
    pub order: (f64, f64),
    /// Torque residual of its equations, relative to the largest torque.
    pub equations: f64,
    /// Error of free motion at the step of the certificate, relative to the way that joints moved.
    pub free: f64,
    /// Change of energy in free motion at that step, relative to the energy that moved.
    pub energy: f64,
    /// Distance to the first engine in the closed loop, rad (m).
    pub closed_loop: f64,
}

impl Tolerance {
    /// What is asked of this engine.
    #[must_use]
    pub const fn of(engine: Engine) -> Self {
        match engine {
            // Order 4 shows between the coarsest step, where the next order still counts, and rounding. Equations
            // differ by rounding through a mass matrix. A step of 1 ms leaves (h/t)⁴ ~ 1e-10 of the way.
            Engine::Analytic => {
                Self { order: (3.7, 4.6), equations: 1e-11, free: 1e-8, energy: 1e-8, closed_loop: 1e-5 }
            }
            // Order 1. Residuals: terms that the engine treats implicitly, at a step of 1e-12 s. A step h of 0.25 ms
            // (four in a millisecond) costs about h/t of the way after t = 0.25 s, and as much energy.
            Engine::Rapier => Self { order: (0.9, 1.1), equations: 1e-9, free: 5e-3, energy: 1e-2, closed_loop: 1e-4 },
        }
    }
}
