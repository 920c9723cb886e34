//! The engines, listed once.

use armid::dynamics::Dynamics;
use armid::experiment::Plant;
use armid::model::{Robot, StandardParameters};

use crate::{AnalyticPlant, MujocoModel, MujocoPlant, RapierPlant};

/// An engine that turns joint torques into motion.
///
/// ```
/// use armid_sim::Engine;
/// assert_eq!(Engine::parse("rapier"), Some(Engine::Rapier));
/// assert!(Engine::ALL.iter().all(|engine| Engine::parse(engine.name()) == Some(*engine)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Engine {
    /// Equations of motion of this project, Runge–Kutta of order 4.
    Analytic,
    /// Multibody joints of the physics engine rapier, a method of order 1.
    Rapier,
    /// MuJoCo's forward dynamics, Runge–Kutta of order 4; its library is loaded when it is first asked for.
    Mujoco,
}

/// Why an engine cannot simulate a robot.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}: {reason}", engine.name())]
pub struct EngineError {
    /// Which engine.
    pub engine: Engine,
    /// What it says.
    pub reason: String,
}

armid::input::named! { Engine { Analytic: "analytic", Rapier: "rapier", Mujoco: "mujoco" } }

impl Engine {
    /// A plant of this robot with these, true, parameters, at rest at zero.
    ///
    /// # Errors
    /// [`EngineError`] where the engine cannot simulate it.
    pub fn plant(self, robot: &Robot, parameters: &StandardParameters) -> Result<Box<dyn Plant>, EngineError> {
        match self {
            Self::Analytic => self.boxed(AnalyticPlant::new(robot, parameters)),
            Self::Rapier => self.boxed(RapierPlant::new(robot, parameters)),
            Self::Mujoco => self.boxed(MujocoPlant::new(robot, parameters)),
        }
    }

    fn boxed<P: Plant + 'static>(
        self,
        plant: Result<P, impl std::fmt::Display>,
    ) -> Result<Box<dyn Plant>, EngineError> {
        plant.map(|plant| Box::new(plant) as Box<dyn Plant>).map_err(|fault| self.fault(&fault))
    }

    fn fault(self, reason: &impl std::fmt::Display) -> EngineError {
        EngineError { engine: self, reason: reason.to_string() }
    }

    /// Efforts by which the engine's equations of motion differ from the core's Newton–Euler; n, N·m (N).
    ///
    /// `tau` is what Newton–Euler asks for at `(q, qd, qdd)`. An engine with inverse dynamics of its own, MuJoCo's
    /// `mj_inverse`, is asked for the same; of another the accelerations under `tau` go back into Newton–Euler.
    /// `parameters` without friction.
    pub(crate) fn torque_residual(
        self,
        robot: &Robot,
        parameters: &StandardParameters,
        q: &[f64],
        qd: &[f64],
        qdd: &[f64],
        tau: &[f64],
    ) -> Result<Vec<f64>, EngineError> {
        let (mut found, mut efforts) = (vec![0.0; q.len()], vec![0.0; q.len()]);
        match self {
            Self::Analytic => {
                let mut plant = AnalyticPlant::new(robot, parameters).map_err(|fault| self.fault(&fault))?;
                plant.reset(q, qd);
                plant.acceleration(tau, &mut found);
            }
            Self::Rapier => {
                let mut plant = RapierPlant::new(robot, parameters).map_err(|fault| self.fault(&fault))?;
                plant.reset(q, qd);
                plant.acceleration(tau, &mut found);
            }
            Self::Mujoco => {
                let mut model = MujocoModel::new(robot, parameters).map_err(|fault| self.fault(&fault))?;
                model.inverse(q, qd, qdd, &mut efforts);
            }
        }
        if self != Self::Mujoco {
            Dynamics::new(robot, parameters).inverse(q, qd, &found, &mut efforts);
        }
        for (effort, tau) in efforts.iter_mut().zip(tau) {
            *effort -= tau;
        }
        Ok(efforts)
    }
}
