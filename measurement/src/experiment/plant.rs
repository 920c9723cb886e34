//! What turns joint torques into motion.

/// A mechanism between servo steps: torque in, state out.
///
/// ```text
/// H(q) q̈ + c(q, q̇) + g(q) + friction(q̇) = τ        τ held over a step
/// ```
/// `q` in rad (m for a prismatic joint), `q̇` per second, all slices of length n. `τ` is what the motors exert on the
/// joints after gears and coupling, N·m or N; friction and rotor inertia belong to the plant, sensors and currents do not.
///
/// Laws that every plant obeys are in `conformance::plant_laws`.
pub trait Plant: Send {
    /// Number of joints n.
    fn dof(&self) -> usize;

    /// Joint coordinates and velocities now.
    fn state(&self) -> (&[f64], &[f64]);

    /// Puts the plant into a state; everything that follows depends on nothing before.
    ///
    /// # Panics
    /// If a slice has another length than n.
    fn reset(&mut self, q: &[f64], qd: &[f64]);

    /// Advances by `dt` seconds under the torque `tau`, held constant.
    ///
    /// # Errors
    /// [`PlantError`] where the motion is no longer a number or the engine fails; the state is then undefined until
    /// the next reset.
    fn step(&mut self, tau: &[f64], dt: f64) -> Result<(), PlantError>;
}

impl<P: Plant + ?Sized> Plant for Box<P> {
    fn dof(&self) -> usize {
        (**self).dof()
    }

    fn state(&self) -> (&[f64], &[f64]) {
        (**self).state()
    }

    fn reset(&mut self, q: &[f64], qd: &[f64]) {
        (**self).reset(q, qd);
    }

    fn step(&mut self, tau: &[f64], dt: f64) -> Result<(), PlantError> {
        (**self).step(tau, dt)
    }
}

/// Why a plant cannot go on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum PlantError {
    /// A coordinate or velocity is NaN or infinite.
    #[error("joint {joint}: {quantity} is {value}, expected a finite number")]
    NotFinite { joint: usize, quantity: &'static str, value: f64 },
    /// The engine behind the plant reports a fault of its own.
    #[error("{engine}: {reason}")]
    Engine { engine: &'static str, reason: String },
}

impl PlantError {
    /// The first entry of a state that is not finite, if there is one.
    pub fn of_state(q: &[f64], qd: &[f64]) -> Option<Self> {
        // Nearly always, and found without a branch at each entry.
        let finite = |x: &[f64]| x.iter().fold(true, |finite, x| finite & x.is_finite());
        if finite(q) & finite(qd) {
            return None;
        }
        let look = |values: &[f64], quantity| {
            values.iter().position(|x| !x.is_finite()).map(|i| Self::NotFinite {
                joint: i + 1,
                quantity,
                value: values[i],
            })
        };
        look(q, "position").or_else(|| look(qd, "velocity"))
    }
}
