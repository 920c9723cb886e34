//! What a design is asked for.

use std::path::PathBuf;
use std::sync::Arc;

use armid::excitation::{Criterion, DEFAULT_EVALUATIONS, LimitSettings};
use armid::experiment::Effects;
use armid::model::{Columns, Obstacle, Robot};
use armid::spatial::Inertia;
use armid::trajectory::Family;
use armid_io::robot::PackagePath;
use armid_io::{Error, LoadedRobot};

/// Radius of gyration of the heaviest load about its centre of mass, m.
const GYRATION: f64 = 0.05;

/// What a design is made for.
#[derive(Clone, Debug)]
pub enum DesignGoal {
    /// The parameters of the arm, by a criterion of the list or one's own.
    Arm(Arc<dyn Criterion>),
    /// The ten parameters of a load on the last link.
    Load(HeaviestLoad),
}

/// The heaviest load that a design holds torque and current with.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct HeaviestLoad {
    /// Its mass, kg.
    pub mass_kg: f64,
    /// Its centre of mass in the frame of the last link, m.
    pub centre_m: [f64; 3],
}

impl HeaviestLoad {
    /// The load as a body in the frame of the last link.
    ///
    /// # Errors
    /// [`Error`] where the mass is not a finite number above zero or the centre is no point.
    pub fn body(&self) -> Result<Inertia, Error> {
        let Self { mass_kg, centre_m } = *self;
        if !(mass_kg.is_finite() && mass_kg > 0.0 && centre_m.iter().all(|x| x.is_finite())) {
            let message = format!("the payload is {mass_kg} kg at {centre_m:?} m, expected a finite mass above zero");
            return Err(Error::new(message));
        }
        Ok(Inertia::with_gyration(mass_kg, centre_m, GYRATION))
    }
}

/// What a design is asked for; [`DesignSettings::new`] has the defaults of the command.
#[derive(Clone, Debug)]
pub struct DesignSettings {
    /// What it is made for.
    pub goal: DesignGoal,
    /// Which parameters are estimated.
    pub columns: Columns,
    /// Period, s.
    pub period_s: f64,
    /// Family of trajectories.
    pub family: Family,
    /// Harmonics of every joint, or one number for each.
    pub harmonics: Vec<usize>,
    /// Joints that are held still, by their names, and where, rad (m).
    pub frozen: Vec<(String, f64)>,
    /// Seed of the first guesses.
    pub seed: u64,
    /// First guesses at which a search starts.
    pub starts: u64,
    /// Trajectories, by name or file, at which further searches start.
    pub from: Vec<String>,
    /// Evaluations of the criterion for each start.
    pub evaluations: usize,
    /// Steps of the optimiser for each start; as many as the evaluations allow where `None`.
    pub iterations: Option<usize>,
    /// Which limits are held.
    pub limits: LimitSettings,
    /// Largest acceleration of every joint, instead of the robot's own limits.
    pub max_acceleration: Option<f64>,
    /// Height of the base frame above which everything stays, m.
    pub keep_above_m: Option<f64>,
    /// Where the meshes of a URDF are found.
    pub packages: PackagePath,
    /// Weights equations by the noise of each joint's effort.
    pub weighted: bool,
    /// Files of earlier estimates, to whose information the design adds.
    pub prior: Vec<PathBuf>,
    /// Effects that the arm is expected to have; usual ones where none is named. Only for criteria that expect effects.
    pub expected: Effects,
    /// Motions on which torque will be predicted: by name or file, or one [kind](armid::study::MotionKind); usual ones where none is named.
    pub predict: Vec<String>,
    /// Recorded periods of the experiment.
    pub periods: usize,
    /// Whether the best of random trajectories is found for comparison.
    pub baseline: bool,
}

impl DesignSettings {
    /// The defaults: all limits of the robot, eight starts, a period of 10 s and five harmonics.
    pub fn new(goal: DesignGoal) -> Self {
        Self {
            goal,
            columns: Columns::RIGID_ROTOR_FRICTION,
            period_s: 10.0,
            family: Family::Fourier,
            harmonics: vec![5],
            frozen: Vec::new(),
            seed: 1,
            starts: 8,
            from: Vec::new(),
            evaluations: DEFAULT_EVALUATIONS,
            iterations: None,
            limits: LimitSettings::default(),
            max_acceleration: None,
            keep_above_m: None,
            packages: PackagePath::default(),
            weighted: false,
            prior: Vec::new(),
            expected: Effects::none(),
            predict: Vec::new(),
            periods: 10,
            baseline: true,
        }
    }

    /// The robot with the limits and obstacles of these settings.
    pub(super) fn robot(&self, loaded: &LoadedRobot) -> Result<Robot, Error> {
        let mut robot = loaded.robot.clone();
        if let Some(acceleration) = self.max_acceleration {
            robot = robot.with_joints(|joint| joint.limits.acceleration = acceleration).map_err(Error::new)?;
        }
        if let Some(z) = self.keep_above_m {
            if !z.is_finite() {
                return Err(Error::new(format!("the height to keep above is {z} m, expected a finite number")));
            }
            robot = robot.with_obstacle(Obstacle::everything_below("keep-above", z));
        }
        Ok(robot)
    }
}
