//! What must hold before the first motion.

use armid::experiment::{ArmError, Command, Expectation, ExperimentPlan};
use armid::model::Robot;

use super::{Confirmation, GuardSettings, JointBounds, Passed, fastest_point};

/// Every check before the first motion, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Preflight {
    /// Every setting of the guard is in its range.
    Settings,
    /// The plan is for this robot, and its motion keeps the robot's limits at every sample, ramps included.
    Plan,
    /// The motion keeps the soft limits, the start pose with it.
    SoftLimits,
    /// The robot's joints have the names of the robot file.
    JointNames,
    /// Every position and effort is a number.
    Finite,
    /// States come at the rate of the plan, at least.
    Rate,
    /// The arm stands within its hard limits, so that the start pose can be reached.
    StartPose,
    /// The operator confirmed that the emergency stop works.
    EmergencyStop,
    /// The arm is homed.
    Homed,
}

armid::input::named! { Preflight {
    Settings: "settings", Plan: "plan", SoftLimits: "soft-limits", JointNames: "joint-names", Finite: "finite",
    Rate: "rate", StartPose: "start-pose", EmergencyStop: "emergency-stop", Homed: "homed"
} }

impl Preflight {
    fn passed(self, found: impl Into<String>) -> Passed {
        Passed { check: self.name(), found: found.into() }
    }

    fn refuse(self, found: impl Into<String>, expected: Expectation) -> ArmError {
        ArmError::Refused { check: self.name(), found: found.into(), expected }
    }
}

/// What an arm reports before it moves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Survey {
    /// Names of its joints, as it gives them.
    pub joints: Vec<String>,
    /// Its positions, rad (m), in the order of the robot file.
    pub q: Vec<f64>,
    /// Its efforts, in the same order.
    pub effort: Vec<f64>,
    /// States per second that were seen, Hz.
    pub rate_hz: f64,
    /// Whether it is homed; `None` where its interface does not report it.
    pub homed: Option<bool>,
    /// Whether it is ready to move: drives on, no emergency stop; `None` where its interface does not report it.
    pub ready: Option<bool>,
    /// The state that it reports, in its own words; `None` where its interface does not report one.
    pub state: Option<String>,
    /// The states in which it may move.
    pub ready_states: Vec<String>,
}

/// What can be said of a plan before any arm is asked.
pub(super) fn of_plan(
    robot: &Robot,
    settings: &GuardSettings,
    bounds: &[JointBounds],
    plan: &ExperimentPlan,
) -> Result<Vec<Passed>, ArmError> {
    settings
        .check()
        .map_err(|fault| Preflight::Settings.refuse(format!("{} = {}", fault.key, fault.found), fault.expected))?;
    let layout = plan.check(robot.dof())?;
    plan.check_limits(robot)?;
    let command = Command::new(plan, &layout);
    let n = robot.dof();
    let (mut q, mut qd, mut qdd) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    // Largest use of the soft limits, its joint and its position.
    let mut worst = (0.0_f64, 0, 0.0);
    // The ramps run the path of the motion: one period shows every position.
    for k in 0..=layout.period_samples {
        command.evaluate(command.periodic_s + k as f64 / plan.rate_hz, &mut q, &mut qd, &mut qdd);
        for (j, joint) in bounds.iter().enumerate() {
            if joint.soft_use(q[j]) > worst.0 {
                worst = (joint.soft_use(q[j]), j, q[j]);
            }
        }
    }
    if settings.reduced_speed_mm_s > 0.0 {
        let (fastest, line) = (fastest_point(robot, plan, &layout), settings.reduced_speed_mm_s);
        let found = 1e3 * fastest.speed;
        if found > line {
            let found = format!("point \"{}\" at {found:.0} mm/s", fastest.point);
            let remedy = "choose a slower speed";
            return Err(Preflight::Plan.refuse(found, Expectation::AtMost { limit: line, unit: "mm/s", remedy }));
        }
    }
    let (used, joint) = (worst.0, &bounds[worst.1]);
    if used > 1.0 {
        let (name, unit) = (&joint.name, joint.unit);
        let found = format!("joint \"{name}\" at {:.4} {unit}", worst.2);
        let (low, high) = joint.soft;
        return Err(Preflight::SoftLimits.refuse(found, Expectation::Between { low, high, unit, remedy: "" }));
    }
    Ok(vec![
        Preflight::Settings.passed("every setting is in its range"),
        Preflight::Plan.passed("within the robot's limits at every sample"),
        Preflight::SoftLimits.passed(format!("{:.0} % used, by joint \"{}\"", 100.0 * used, joint.name)),
    ])
}

/// What can be said of an arm before it moves.
///
/// # Errors
/// [`ArmError::Refused`] for the first check that does not pass.
pub(super) fn of_survey(
    bounds: &[JointBounds],
    plan: &ExperimentPlan,
    survey: &Survey,
    confirmation: &Confirmation,
) -> Result<Vec<Passed>, ArmError> {
    let mut passed = Vec::new();
    let wanted: Vec<&str> = bounds.iter().map(|joint| joint.name.as_str()).collect();
    if let Some(missing) = wanted.iter().find(|name| !survey.joints.iter().any(|found| found == *name)) {
        let found = format!("joints {}", survey.joints.join(", "));
        return Err(Preflight::JointNames.refuse(found, Expectation::Joint((*missing).to_owned())));
    }
    passed.push(Preflight::JointNames.passed(wanted.join(", ")));
    for (what, values) in [("position", &survey.q), ("effort", &survey.effort)] {
        if let Some(j) = values.iter().position(|value| !value.is_finite()) {
            let found = format!("{what} {} of joint \"{}\"", values[j], bounds[j].name);
            let expected = "a number (ros2_control reports NaN where the hardware has no such interface)";
            return Err(Preflight::Finite.refuse(found, Expectation::State(expected)));
        }
    }
    passed.push(Preflight::Finite.passed("every position and effort is a number"));
    // A tenth of slack: the rate is counted over a short look.
    if survey.rate_hz < 0.9 * plan.rate_hz {
        let found = format!("{:.0}", survey.rate_hz);
        return Err(
            Preflight::Rate.refuse(found, Expectation::AtLeast { limit: plan.rate_hz, unit: "states per second" })
        );
    }
    passed.push(Preflight::Rate.passed(format!("{:.0} Hz", survey.rate_hz)));
    for (joint, &q) in bounds.iter().zip(&survey.q) {
        let (low, high) = joint.hard;
        if !(q >= low && q <= high) {
            let (name, unit) = (&joint.name, joint.unit);
            let found = format!("joint \"{name}\" at {q:.4} {unit}");
            let remedy = "bring it back by hand";
            return Err(Preflight::StartPose.refuse(found, Expectation::Between { low, high, unit, remedy }));
        }
    }
    passed
        .push(Preflight::StartPose.passed("reachable in a straight line of the joints; free of collisions: not known"));
    if survey.ready == Some(false) {
        let found = survey.state.as_ref().map_or("a robot that is stopped".to_owned(), |state| format!("\"{state}\""));
        let expected = if survey.ready_states.is_empty() {
            Expectation::State("drives on and no emergency stop")
        } else {
            Expectation::OneOf(survey.ready_states.clone())
        };
        return Err(Preflight::EmergencyStop.refuse(found, expected));
    }
    passed.push(Preflight::EmergencyStop.passed(confirmation.how()));
    match survey.homed {
        Some(false) => {
            return Err(Preflight::Homed.refuse("an arm that is not homed", Expectation::State("a homed arm")));
        }
        Some(true) => passed.push(Preflight::Homed.passed("as reported by the robot")),
        None => passed.push(Preflight::Homed.passed(format!("{}; not reported by the robot", confirmation.how()))),
    }
    Ok(passed)
}
