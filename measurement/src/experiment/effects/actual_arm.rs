//! The arm as it is: what its plant is built from, and what the servo adds around the plant.

use super::cable::Strands;
use super::clock_slips::ClockSlips;
use super::drive_friction::{DriveFriction, is_displaced};
use super::eccentricity::Eccentricity;
use super::elasticity::Spring;
use super::kind::EffectKind as Kind;
use super::selection::Effects;
use super::spikes::Spikes;
use super::transmission_error::TransmissionError;
use super::warming::Warming;
use super::{
    base_tilt, cable, coloured_noise, direction_friction, draw, kinematics, position_friction, presliding,
    sample_clock, tool,
};
use crate::dynamics::Dynamics;
use crate::experiment::motor_load::gain_pose;
use crate::model::term::{
    COULOMB, Carrier, LOAD_FRICTION, MOTOR_COULOMB, MOTOR_LOAD_FRICTION, MOTOR_STRIBECK, MOTOR_VISCOUS,
    MOTOR_WARM_VISCOUS, ROTOR, STRIBECK, Term, VISCOUS, WARM_VISCOUS,
};
use crate::model::{DriveParameters, Joint, JointKind, Robot, StandardParameters};
use crate::seed::RunNoise;

/// Parts of a servo step where something happens between motor and link.
const FINE_PARTS: usize = 4;
/// More parts a servo step never has.
const MOST_PARTS: f64 = 16.0;
/// Largest share of its way to standstill that friction beyond the plant's may take in a part.
const STIFFNESS: f64 = 0.5;

/// An arm with effects: robot and parameters for its plant, the rest for its [`Servo`](crate::experiment::Servo).
///
/// ```
/// # use armid_measurement as armid;
/// use armid::chains::planar_2r;
/// use armid::experiment::{ActualArm, EffectKind, Effects, Level};
/// use armid::model::StandardParameters;
/// let truth = StandardParameters::zero(2);
/// let tool = Effects::only(EffectKind::Tool, Level::Severe);
/// let arm = ActualArm::new(&tool, &planar_2r(), &truth);
/// assert_eq!(arm.parameters().links[1].mass, 1.0);
/// let plain = ActualArm::new(&Effects::none(), &planar_2r(), &truth);
/// assert_eq!(plain.parameters(), &truth);
/// ```
/// Where a drive is elastic, the plant's parameters have no rotor inertia and no drive friction of that joint: the servo
/// turns the rotor. Terms that depend on the transmitted torque or on temperature are the servo's everywhere, and so is Coulomb
/// friction that follows displacement. Where gears without springs have a transmission error, the plant's coordinates are
/// those of the motors.
#[derive(Clone, Debug)]
pub struct ActualArm {
    pub(super) effects: Effects,
    robot: Robot,
    parameters: StandardParameters,
    /// The drives with everything that was moved to the motors.
    pub(super) drives: Vec<DriveParameters>,
    pub(super) couplings: Vec<Coupling>,
    pub(super) parts: usize,
}

/// What stands between a motor and its link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Coupling {
    /// Nothing that gives.
    Rigid,
    /// A spring whose oscillation is followed.
    TwoMasses(Spring),
    /// A spring that is always at rest under its torque.
    QuasiStatic(Spring),
}

impl ActualArm {
    /// The arm that has these true parameters and effects, where `robot` is what its file says.
    ///
    /// # Panics
    /// If the parameters are not those of as many drives as the robot has joints.
    pub fn new(effects: &Effects, robot: &Robot, truth: &StandardParameters) -> Self {
        assert_eq!(truth.drives.len(), robot.dof(), "one drive for each joint");
        let seed = effects.seed;
        let (mut actual, mut parameters) = (robot.clone(), truth.clone());
        if effects.has(Kind::Kinematics) {
            actual = kinematics::disturb(&actual, effects.magnitude(Kind::Kinematics), seed);
        }
        if effects.has(Kind::BaseTilt) {
            actual = base_tilt::tilt(&actual, effects.magnitude(Kind::BaseTilt), seed);
        }
        if effects.has(Kind::Tool) {
            tool::add(&mut parameters, effects.magnitude(Kind::Tool));
        }
        let mut drives = truth.drives.clone();
        drives.iter_mut().for_each(|drive| add_terms(effects, drive));
        direction_friction::add(&mut drives, effects.magnitude(Kind::DirectionFriction), seed);
        position_friction::add(&mut drives, effects.magnitude(Kind::PositionFriction), seed);
        cable::add(&mut drives, &ratings(&actual), effects.magnitude(Kind::Cable));
        let is_displaced = |term| effects.has(Kind::Presliding) && is_displaced(term);
        for (own, drive) in parameters.drives.iter_mut().zip(&drives) {
            *own = drive.only(|term| term.entry().needs.is_motion() && !is_displaced(term));
        }
        let mut arm = Self {
            effects: effects.clone(),
            robot: actual,
            parameters,
            drives,
            couplings: vec![Coupling::Rigid; robot.dof()],
            parts: 1,
        };
        arm.join();
        arm.parts = arm.parts_needed();
        arm
    }

    /// What its plant is built from.
    pub const fn robot(&self) -> &Robot {
        &self.robot
    }

    /// The parameters that its plant is built from.
    pub const fn parameters(&self) -> &StandardParameters {
        &self.parameters
    }

    /// Torque rating of each motor, N·m: the joint's, or what its largest current gives.
    pub(super) fn ratings(&self) -> Vec<f64> {
        ratings(&self.robot)
    }

    /// The error of each drive's gear.
    pub(super) fn transmission_errors(&self) -> Vec<TransmissionError> {
        let amplitude = 1e-3 * self.effects.magnitude(Kind::TransmissionError);
        TransmissionError::of_motors(&turning(&self.robot), amplitude, self.effects.seed)
    }

    /// What bends along each joint that starts at rest at `start`; empty without cables.
    pub(super) fn cables(&self, start: &[f64]) -> Vec<Strands> {
        let share = self.effects.magnitude(Kind::Cable);
        let strands = |(rating, &start): (f64, &f64)| Strands::new(rating, share, start);
        if share > 0.0 { self.ratings().into_iter().zip(start).map(strands).collect() } else { Vec::new() }
    }

    /// What the drive of each joint carries at the joint, and at the motor.
    pub(super) fn frictions(&self) -> (Vec<DriveFriction>, Vec<DriveFriction>) {
        let of = |i: usize, at_motor: bool| {
            let (joint, drive) = (&self.robot.joints()[i], &self.drives[i]);
            let (viscous, coulomb) = if at_motor { (MOTOR_VISCOUS, MOTOR_COULOMB) } else { (VISCOUS, COULOMB) };
            let warming = Warming::new(drive[viscous], drive[coulomb], joint.limits.velocity);
            let distance = 1e-3 * self.effects.magnitude(Kind::Presliding);
            DriveFriction::new(joint, drive, at_motor, warming, distance)
        };
        let n = self.drives.len();
        ((0..n).map(|i| of(i, false)).collect(), (0..n).map(|i| of(i, true)).collect())
    }

    /// Whether a torque term depends on what the links take.
    pub(super) fn needs_load(&self) -> bool {
        self.drives.iter().any(|drive| drive.iter().any(|(term, _)| term.entry().needs.load))
    }

    /// Whether the servo has nothing to do around the plant.
    pub fn is_plain(&self) -> bool {
        self.effects.is_none() && !self.acts_on_drives()
    }

    /// Whether something around the plant acts on torques or on where the motors are.
    pub(super) fn acts_on_drives(&self) -> bool {
        let held = |drive: &DriveParameters| drive.iter().any(|(term, _)| !term.entry().needs.is_motion());
        let effects = [
            Kind::Elasticity,
            Kind::Hysteresis,
            Kind::Backlash,
            Kind::TransmissionError,
            Kind::Presliding,
            Kind::Cable,
            Kind::TorqueRipple,
            Kind::Cogging,
            Kind::TorqueConstant,
            Kind::CurrentLag,
            Kind::CurrentDelay,
        ];
        self.drives.iter().any(held) || effects.into_iter().any(|kind| self.effects.has(kind))
    }

    /// Mobility of each motor against links and, where `rotors`, rotors: diagonal of `C H⁻¹ Cᵀ`, 1/(kg·m²).
    fn mobility(&self, parameters: &StandardParameters) -> Vec<f64> {
        let mass_matrix = Dynamics::new(&self.robot, parameters).mass_matrix(&gain_pose(&self.robot));
        let n = self.drives.len();
        let Some(inverse) = mass_matrix.try_inverse() else { return vec![f64::INFINITY; n] };
        let at_motors = match self.robot.coupling() {
            Some(c) => c * inverse * c.transpose(),
            None => inverse,
        };
        at_motors.diagonal().iter().copied().collect()
    }

    /// Puts springs between motors and links, and takes from the plant what then belongs to the motors.
    fn join(&mut self) {
        let magnitude = |kind| 1e-3 * self.effects.magnitude(kind);
        let [elasticity, hysteresis, backlash] = [Kind::Elasticity, Kind::Hysteresis, Kind::Backlash].map(magnitude);
        if elasticity + hysteresis + backlash == 0.0 {
            return;
        }
        let realistic = 1e-3 * Kind::Elasticity.entry().realistic;
        let wind_up = if elasticity > 0.0 { elasticity } else { realistic };
        let h = 1.0 / (self.robot.servo().rate_hz * FINE_PARTS as f64);
        let mobility = self.mobility(&self.parameters.links_alone());
        for (i, rating) in self.ratings().into_iter().enumerate() {
            if !rating.is_finite() {
                continue;
            }
            let spring = Spring::new(rating / wind_up, backlash, hysteresis);
            let rotor = self.drives[i][ROTOR];
            if !spring.is_followed(rotor, mobility[i], h) {
                self.couplings[i] = Coupling::QuasiStatic(spring);
                continue;
            }
            self.couplings[i] = Coupling::TwoMasses(spring.between(rotor, mobility[i]));
            let coupled = self.robot.is_coupled(i);
            let stays = |term: Term| term.entry().carrier == Carrier::Link || (coupled && !term.is_motors());
            self.parameters.drives[i] = self.parameters.drives[i].only(stays);
        }
    }

    fn parts_needed(&self) -> usize {
        if !self.acts_on_drives() {
            return 1;
        }
        let elastic = self.couplings.iter().any(|coupling| *coupling != Coupling::Rigid);
        let by_position = [Kind::TorqueRipple, Kind::Cogging, Kind::TransmissionError, Kind::Presliding, Kind::Cable];
        let fine = elastic || by_position.into_iter().any(|kind| self.effects.has(kind));
        let least = if fine { FINE_PARTS } else { 1 };
        // Friction beyond the plant's is held over a part.
        let whole = StandardParameters { links: self.parameters.links.clone(), drives: self.drives.clone() };
        let (mobility, ratings) = (self.mobility(&whole), self.ratings());
        let (joints, motors) = self.frictions();
        let rate = (0..self.drives.len())
            .map(|i| (joints[i].held_slope(ratings[i]) + motors[i].held_slope(ratings[i])) * mobility[i])
            .fold(0.0, f64::max);
        // Friction that follows displacement is a spring, of the rotor alone where that has another to its link.
        let swing = (0..self.drives.len())
            .map(|i| {
                let alone = matches!(self.couplings[i], Coupling::TwoMasses(_));
                let mobility = if alone { 1.0 / self.drives[i][ROTOR] } else { mobility[i] };
                ((joints[i].stiffness() + motors[i].stiffness()) * mobility).sqrt()
            })
            .fold(0.0, f64::max);
        let rate_hz = self.robot.servo().rate_hz;
        let parts = (rate / rate_hz / STIFFNESS).max(swing / rate_hz / presliding::RESOLVED);
        (parts.ceil().clamp(1.0, MOST_PARTS) as usize).max(least)
    }

    /// Eccentricity of each joint's encoder and gear, and the factor of its encoder's and its converter's step.
    pub(in crate::experiment) fn sensors(&self, rate_hz: f64) -> ActualSensors {
        let magnitude = |kind| self.effects.magnitude(kind);
        let joints = self.robot.joints();
        let seed = self.effects.seed;
        let (motor, joint) = (1e-3 * magnitude(Kind::MotorEccentricity), 1e-3 * magnitude(Kind::JointEccentricity));
        let offset = magnitude(Kind::AdcOffset);
        let signs = draw::signs(seed, "converter offsets", joints.len());
        let position_noise = |joint: &Joint| match joint.kind {
            JointKind::Revolute => magnitude(Kind::EncoderNoise).to_radians(),
            JointKind::Prismatic => 0.0,
        };
        let current_noise = |joint: &Joint| magnitude(Kind::TorqueNoise) / joint.drive.torque_per_ampere().abs();
        let spikes = |joint: &Joint| Spikes { share: magnitude(Kind::TorqueSpikes), range: range(joint) };
        ActualSensors {
            eccentricity: Eccentricity::of_joints(&turning(&self.robot), motor, joint, seed),
            encoder_step: magnitude(Kind::EncoderStep).max(1.0),
            converter_step: magnitude(Kind::AdcStep).max(1.0),
            offset: joints.iter().zip(signs).map(|(joint, sign)| sign * offset * range(joint)).collect(),
            memory: coloured_noise::Memory::new(1e-3 * magnitude(Kind::ColouredNoise), rate_hz),
            position_noise: joints.iter().map(position_noise).collect(),
            current_noise: joints.iter().map(current_noise).collect(),
            spikes: joints.iter().map(spikes).collect(),
        }
    }

    /// The slips of one run's clock, where it slips.
    pub(in crate::experiment) fn clock_slips(&self, rate_hz: f64, run: RunNoise) -> Option<ClockSlips> {
        let share = self.effects.magnitude(Kind::ClockSlips);
        (share > 0.0).then(|| ClockSlips::new(share, rate_hz, run))
    }

    /// The clock of one run's samples, where it is not ideal.
    pub(in crate::experiment) fn clock(&self, run: RunNoise) -> Option<sample_clock::SampleClock> {
        let (jitter, lost) =
            (1e-6 * self.effects.magnitude(Kind::ClockJitter), self.effects.magnitude(Kind::DroppedSamples));
        let step = 1.0 / self.robot.servo().rate_hz;
        (jitter + lost > 0.0).then(|| sample_clock::SampleClock::new(jitter, lost, step, run))
    }
}

/// Adds to the coefficients of a drive's terms what effects make of them.
fn add_terms(effects: &Effects, drive: &mut DriveParameters) {
    let [stribeck, load, warming] =
        [Kind::Stribeck, Kind::LoadFriction, Kind::Warming].map(|kind| effects.magnitude(kind));
    for [coulomb, viscous, above, per_load, warm] in [
        [COULOMB, VISCOUS, STRIBECK, LOAD_FRICTION, WARM_VISCOUS],
        [MOTOR_COULOMB, MOTOR_VISCOUS, MOTOR_STRIBECK, MOTOR_LOAD_FRICTION, MOTOR_WARM_VISCOUS],
    ] {
        // Load makes friction where there is any.
        let per_torque = if drive[coulomb] > 0.0 { load } else { 0.0 };
        for (term, change) in
            [(above, stribeck * drive[coulomb]), (per_load, per_torque), (warm, -warming * drive[viscous])]
        {
            if change != 0.0 {
                drive[term] += change;
            }
        }
    }
}

/// Torque rating of each motor of a robot, N·m.
fn ratings(robot: &Robot) -> Vec<f64> {
    let rating = |joint: &Joint| {
        let drive = &joint.drive;
        let by_current = drive.current_limit * drive.torque_per_ampere();
        if joint.limits.torque.is_finite() { joint.limits.torque } else { by_current }
    };
    robot.joints().iter().map(rating).collect()
}

/// Gear of each joint, and whether it is revolute.
fn turning(robot: &Robot) -> Vec<(f64, bool)> {
    robot.joints().iter().map(|joint| (joint.drive.gear, joint.kind == JointKind::Revolute)).collect()
}

/// Full scale of a converter; that of the current limit where there is none.
fn range(joint: &Joint) -> f64 {
    let drive = &joint.drive;
    if drive.adc_range.is_finite() {
        drive.adc_range
    } else if drive.current_limit.is_finite() {
        drive.current_limit
    } else {
        1.0
    }
}

/// What is wrong with the sensors of an arm.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::experiment) struct ActualSensors {
    /// Of each joint.
    pub(in crate::experiment) eccentricity: Vec<Eccentricity>,
    /// Encoder counts that are one.
    pub(in crate::experiment) encoder_step: f64,
    /// Converter steps that are one.
    pub(in crate::experiment) converter_step: f64,
    /// Offset of each current, A.
    pub(in crate::experiment) offset: Vec<f64>,
    /// Of the noise of a current.
    pub(in crate::experiment) memory: coloured_noise::Memory,
    /// White noise of each position that comes to what the sensors have, rad.
    pub(in crate::experiment) position_noise: Vec<f64>,
    /// White noise of each current that comes to what the sensors have, A.
    pub(in crate::experiment) current_noise: Vec<f64>,
    /// Readings of each current that are wrong.
    pub(in crate::experiment) spikes: Vec<Spikes>,
}
