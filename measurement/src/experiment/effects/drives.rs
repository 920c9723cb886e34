//! Everything that happens between the set points of the servo and the torques on the plant, in one run.
//!
//! ```text
//! set point ─ delay ─ lag ─ K (1 ± e) ─ ripple, cogging ─ rotor ─ error, spring, gap, loop ─ − excess friction, cable ─→ plant
//!                                                          └── where the encoder is
//! ```

use super::actual_arm::{ActualArm, Coupling};
use super::cable::Strands;
use super::current_loop::CurrentLoop;
use super::drive_friction::DriveFriction;
use super::elasticity::{MotorSide, Spring};
use super::kind::EffectKind as Kind;
use super::ripple::Ripple;
use super::torque_constant;
use super::transmission_error::TransmissionError;
use super::uneven_links::UnevenLinks;
use crate::dynamics::Dynamics;
use crate::experiment::transmission::Transmission;
use crate::model::term::ROTOR;

/// The drives of one run.
#[derive(Clone, Debug)]
pub(in crate::experiment) struct ActualDrives {
    /// Parts of a servo step.
    pub(in crate::experiment) parts: usize,
    /// Length of a part, s.
    h: f64,
    transmission: Transmission,
    currents: CurrentLoop,
    /// True torque of each motor per ampere, N·m/A.
    per_ampere: Vec<f64>,
    ripple: Vec<Ripple>,
    joints: Vec<DriveFriction>,
    motors: Vec<DriveFriction>,
    coupled: Vec<bool>,
    sides: Vec<Side>,
    /// Of each joint; empty without cables.
    cables: Vec<Strands>,
    /// The links alone, where the torque that they take is asked for.
    links: Option<Box<Dynamics>>,
    /// Where gears without springs have errors.
    uneven: Option<Box<UnevenLinks>>,
    q_motor: Vec<f64>,
    qd_motor: Vec<f64>,
    last_qd: Vec<f64>,
    qdd: Vec<f64>,
    mean: Vec<f64>,
    torque: Vec<f64>,
    /// What the links take of each joint and of each motor, N·m.
    load: Vec<f64>,
    load_motor: Vec<f64>,
    /// On the joints beside what goes through the motors, N·m.
    extra: Vec<f64>,
}

#[derive(Clone, Copy, Debug)]
enum Side {
    Rigid,
    TwoMasses(MotorSide),
    /// A spring, and the angle of the motor before its link.
    QuasiStatic(Spring, f64),
}

impl ActualDrives {
    /// The drives of one run of an arm, where they do anything; motors of `per_ampere` N·m/A, the plant at rest at `start`.
    pub(in crate::experiment) fn of(
        arm: &ActualArm,
        transmission: &Transmission,
        per_ampere: &[f64],
        start: &[f64],
    ) -> Option<Self> {
        arm.acts_on_drives().then(|| Self::new(arm, transmission, per_ampere, start))
    }

    fn new(arm: &ActualArm, transmission: &Transmission, per_ampere: &[f64], start: &[f64]) -> Self {
        let n = start.len();
        let magnitude = |kind| arm.effects.magnitude(kind);
        let seed = arm.effects.seed;
        let ratings = arm.ratings();
        let geared: Vec<(f64, f64)> =
            arm.robot().joints().iter().zip(&ratings).map(|(joint, &rating)| (joint.drive.gear, rating)).collect();
        let mut errors = arm.transmission_errors();
        let coupled: Vec<bool> = (0..n).map(|i| arm.robot().is_coupled(i)).collect();
        let h = 1.0 / (arm.robot().servo().rate_hz * arm.parts as f64);
        let mut q_motor = vec![0.0; n];
        transmission.motor_motion(start, &mut q_motor);
        let (mut joints, mut motors) = arm.frictions();
        let side = |(i, coupling): (usize, &Coupling)| match *coupling {
            Coupling::Rigid => Side::Rigid,
            Coupling::QuasiStatic(spring) => Side::QuasiStatic(spring, 0.0),
            Coupling::TwoMasses(spring) => {
                let friction = if coupled[i] { &motors[i] } else { &joints[i] };
                let slope = friction.slope(ratings[i]);
                let motor = MotorSide::new(spring, arm.drives[i][ROTOR], slope, h, q_motor[i]);
                Side::TwoMasses(motor.with_error(std::mem::take(&mut errors[i])))
            }
        };
        let sides: Vec<Side> = arm.couplings.iter().enumerate().map(side).collect();
        for i in 0..n {
            joints[i].rest_at(start[i]);
            motors[i].rest_at(q_motor[i]);
            if let Side::TwoMasses(motor) = &sides[i] {
                let friction = if coupled[i] { &mut motors[i] } else { &mut joints[i] };
                friction.rest_at(motor.q);
            }
        }
        let is_uneven = errors.iter().any(|error| *error != TransmissionError::default());
        let asked = is_uneven || arm.needs_load() || sides.iter().any(|s| matches!(s, Side::QuasiStatic(..)));
        let factors = torque_constant::factors(magnitude(Kind::TorqueConstant), n, seed);
        Self {
            parts: arm.parts,
            h,
            transmission: transmission.clone(),
            currents: CurrentLoop::new(1e-3 * magnitude(Kind::CurrentLag), magnitude(Kind::CurrentDelay) as usize, n),
            per_ampere: factors.iter().zip(per_ampere).map(|(factor, per_ampere)| factor * per_ampere).collect(),
            ripple: Ripple::of_motors(&geared, magnitude(Kind::TorqueRipple), magnitude(Kind::Cogging), seed),
            joints,
            motors,
            coupled,
            sides,
            cables: arm.cables(start),
            uneven: is_uneven.then(|| Box::new(UnevenLinks::new(errors))),
            links: asked.then(|| Box::new(Dynamics::new(arm.robot(), &arm.parameters().links_alone()))),
            qd_motor: vec![0.0; n],
            last_qd: vec![0.0; n],
            qdd: vec![0.0; n],
            mean: vec![0.0; n],
            torque: vec![0.0; n],
            load: vec![0.0; n],
            load_motor: vec![0.0; n],
            extra: vec![0.0; n],
            q_motor,
        }
    }

    /// A new servo step with these set points, A.
    pub(in crate::experiment) fn set(&mut self, set_points: &[f64]) {
        self.currents.set(set_points);
    }

    /// Where the motors are, given where they would be if nothing gave: what encoders see, rad (m).
    pub(in crate::experiment) fn positions(&self, q_motor: &mut [f64]) {
        for (q, side) in q_motor.iter_mut().zip(&self.sides) {
            match side {
                Side::Rigid => {}
                Side::TwoMasses(motor) => *q = motor.q,
                Side::QuasiStatic(_, ahead) => *q += ahead,
            }
        }
    }

    /// How fast the motors turn, given how fast they would if nothing gave, rad/s (m/s).
    pub(in crate::experiment) fn speeds(&self, qd_motor: &mut [f64]) {
        for (qd, side) in qd_motor.iter_mut().zip(&self.sides) {
            if let Side::TwoMasses(motor) = side {
                *qd = motor.qd;
            }
        }
    }

    /// Efforts on the joints of a plant at `(q, qd)` for the next part of a servo step, N·m (N).
    pub(in crate::experiment) fn push(&mut self, q: &[f64], qd: &[f64], tau: &mut [f64]) {
        let h = self.h;
        self.transmission.motor_motion(q, &mut self.q_motor);
        self.transmission.motor_motion(qd, &mut self.qd_motor);
        self.find_load(q, qd);
        self.currents.flow(h, &mut self.mean);
        for i in 0..tau.len() {
            let (mut at, mut speed) = (self.q_motor[i], self.qd_motor[i]);
            if let Side::TwoMasses(motor) = &self.sides[i] {
                (at, speed) = (motor.q, motor.qd);
            }
            let ideal = self.per_ampere[i] * self.mean[i];
            let torque = self.ripple[i].torque(ideal, at + 0.5 * h * speed);
            self.torque[i] = self.through(i, torque);
        }
        self.transmission.joint_torque(&self.torque, tau);
        for i in 0..tau.len() {
            let middle = q[i] + 0.5 * h * qd[i];
            let inside = matches!(self.sides[i], Side::TwoMasses(_)) && !self.coupled[i];
            if !inside {
                tau[i] -= self.joints[i].held(q[i], qd[i], self.load[i]);
                tau[i] -= self.joints[i].slide(middle);
                self.joints[i].turn(qd[i], h);
            }
            if let Some(strands) = self.cables.get_mut(i) {
                tau[i] -= strands.torque(middle);
            }
            tau[i] += self.extra[i];
        }
        self.last_qd.copy_from_slice(qd);
    }

    /// Torque of motor `i` on the links: through its spring, less what friction of its own takes in excess.
    fn through(&mut self, i: usize, torque: f64) -> f64 {
        let (h, q, qd, load) = (self.h, self.q_motor[i], self.qd_motor[i], self.load_motor[i]);
        let friction = if self.coupled[i] { &mut self.motors[i] } else { &mut self.joints[i] };
        match &mut self.sides[i] {
            Side::TwoMasses(motor) => {
                let at = motor.q;
                let sliding = friction.slide(at + 0.5 * h * motor.qd);
                let spring = motor.step(h, torque - sliding, (q, qd), |v| friction.whole(at, v, load));
                friction.turn(motor.qd, h);
                self.load_motor[i] = spring;
                spring
            }
            side => {
                if let Side::QuasiStatic(spring, ahead) = side {
                    *ahead = spring.angle(load);
                }
                if self.coupled[i] {
                    let held = friction.held(q, qd, load);
                    let sliding = friction.slide(q + 0.5 * h * qd);
                    friction.turn(qd, h);
                    torque - held - sliding
                } else {
                    torque
                }
            }
        }
    }

    /// What the links took over the last part, by Newton–Euler with the mean acceleration of that part.
    fn find_load(&mut self, q: &[f64], qd: &[f64]) {
        let Some(links) = &mut self.links else { return };
        for i in 0..qd.len() {
            self.qdd[i] = (qd[i] - self.last_qd[i]) / self.h;
        }
        match &mut self.uneven {
            None => links.inverse(q, qd, &self.qdd, &mut self.load),
            Some(uneven) => {
                let motion = [q, qd, &self.qdd];
                uneven.load(links, &self.transmission, motion, self.h, &mut self.load, &mut self.extra);
            }
        }
        self.transmission.motor_torque(&self.load, &mut self.mean);
        for i in 0..qd.len() {
            // A spring that is integrated has its own torque.
            if !matches!(self.sides[i], Side::TwoMasses(_)) {
                self.load_motor[i] = self.mean[i];
            }
        }
    }
}
