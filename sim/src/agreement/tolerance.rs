//! What each engine must reach, in one place, each number with its reason.

use crate::Engine;

/// What is asked of one engine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Smallest and largest order of convergence.
    pub order: (f64, f64),
    /// Torque residual of its equations, relative to the largest torque.
    pub equations: f64,
    /// Error of free motion at the step of the certificate, relative to the largest travel of a joint.
    pub free: f64,
    /// Change of energy in free motion at that step, relative to the energy that moved.
    pub energy: f64,
    /// Distance to the first engine in the closed loop, rad (m).
    pub closed_loop: f64,
}

impl Tolerance {
    /// What is asked of this engine.
    pub const fn for_engine(engine: Engine) -> Self {
        match engine {
            // Order 4, measured 3.988 to 3.992 from 16 ms down to where rounding begins. Equations differ by rounding
            // through a mass matrix: 2e-15. At 1 ms the error is 7e-12 of the way and the energy's 8e-12 at most; both
            // grow with the fourth power of how fast an arm falls.
            Engine::Analytic => {
                Self { order: (3.9, 4.1), equations: 1e-12, free: 1e-9, energy: 1e-9, closed_loop: 1e-6 }
            }
            // Order 1, measured 0.9999 to 1.0001. Residuals are terms that the engine treats implicitly, at a step of
            // 1e-12 s: 3e-13. A step h of 0.25 ms (four in a millisecond) costs about h/t of the way after t = 0.25 s
            // and of the energy: 1.2e-3 and 1.4e-3. In the closed loop the servo corrects that to 5e-6 to 7e-6 rad; where it
            // is as soft as the TX40's, whose wrist is 0.2 rad behind its command, 6.1e-4 rad are left.
            Engine::Rapier => {
                Self { order: (0.98, 1.02), equations: 1e-11, free: 5e-3, energy: 5e-3, closed_loop: 2e-3 }
            }
            // The same method as the first, around equations of others, compared by `mj_inverse`: 2e-14.
            Engine::Mujoco => Self { order: (3.9, 4.1), equations: 1e-12, free: 1e-9, energy: 1e-9, closed_loop: 1e-6 },
        }
    }
}
