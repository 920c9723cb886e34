//! The joint states that the robot controller reports, with the errors that faults add.

use armid::experiment::JointLoop;
use armid::model::{EffortInterface, Robot};

use super::FaultKind;
use super::output::Output;
use crate::message::{Header, JointState, Time};

/// Part of the joint states that [`FaultKind::Drop`] loses.
const LOST: f64 = 0.98;
/// Longest delay of [`FaultKind::Jitter`], s.
const LATEST_S: f64 = 0.2;

/// A joint state that is late.
struct Late {
    /// When it was taken, s.
    taken_s: f64,
    /// When it is due, s.
    due_s: f64,
    state: JointState,
}

/// Reports joint states.
pub(super) struct Reporter {
    /// Time between two states, s.
    span_s: f64,
    last_q: Vec<f64>,
    late: Vec<Late>,
    chance: u64,
    /// States so far.
    count: u64,
}

impl Reporter {
    /// Reports every `span_s` seconds of an arm that stands at `q`; chance is that of `run`.
    pub(super) fn new(span_s: f64, q: &[f64], run: u64) -> Self {
        Self { span_s, last_q: q.to_vec(), late: Vec::new(), chance: 0x9e37_79b9_7f4a_7c15 ^ run, count: 0 }
    }

    /// A number in [0, 1): the middle bits of Vigna's splitmix64.
    fn chance(&mut self) -> f64 {
        self.chance = self.chance.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.chance;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// The joint state of this step, with what a fault makes of it.
    pub(super) fn state(
        &mut self,
        robot: &Robot,
        joints: &mut JointLoop,
        stamp: Time,
        fault: Option<FaultKind>,
    ) -> JointState {
        let (q, effort) = joints.sense();
        let (mut position, mut effort) = (q.to_vec(), effort.to_vec());
        let velocity: Vec<f64> = position.iter().zip(&self.last_q).map(|(q, last)| (q - last) / self.span_s).collect();
        self.last_q.copy_from_slice(&position);
        self.count += 1;
        let drive = &robot.joints()[0].drive;
        let most = match robot.effort() {
            EffortInterface::Current => drive.current_limit,
            EffortInterface::Torque => drive.current_limit * drive.torque_per_ampere(),
        };
        match fault {
            Some(FaultKind::Overcurrent) => effort[0] = 1.5 * most,
            Some(FaultKind::Oscillation) => effort[0] = if self.count.is_multiple_of(2) { most } else { 0.0 },
            Some(FaultKind::Nan) => position[0] = f64::NAN,
            Some(FaultKind::Order) if position.len() > 1 => {
                position.swap(0, 1);
                effort.swap(0, 1);
            }
            _ => {}
        }
        let name = robot.joints().iter().map(|joint| joint.name.clone()).collect();
        let mut state =
            JointState { header: Header { stamp, frame_id: String::new() }, name, position, velocity, effort };
        if fault == Some(FaultKind::Gripper) {
            state.name.insert(0, "gripper".to_owned());
            for list in [&mut state.position, &mut state.velocity, &mut state.effort] {
                list.insert(0, 0.02);
            }
        }
        state
    }

    /// Sends a state that was taken at `t`, unless a fault loses or delays it. Returns a remark for the log.
    pub(super) fn send(
        &mut self,
        state: JointState,
        t: f64,
        fault: Option<FaultKind>,
        output: &mut Vec<Output>,
    ) -> Option<String> {
        match fault {
            Some(FaultKind::Drop) if self.chance() < LOST => None,
            Some(FaultKind::Jitter) => {
                let due_s = t + LATEST_S * self.chance();
                self.late.push(Late { taken_s: t, due_s, state });
                None
            }
            _ => {
                output.push(Output::State(state));
                (fault == Some(FaultKind::Drop)).then(|| "state sent".to_owned())
            }
        }
    }

    /// Sends the late states that are due at `t`. Returns a remark about the latest of them.
    pub(super) fn release(&mut self, t: f64, output: &mut Vec<Output>) -> Option<String> {
        let mut latest = None;
        let mut k = 0;
        while k < self.late.len() {
            if self.late[k].due_s <= t {
                let late = self.late.swap_remove(k);
                latest = Some(latest.map_or(late.taken_s, |taken: f64| taken.min(late.taken_s)));
                output.push(Output::State(late.state));
            } else {
                k += 1;
            }
        }
        latest.map(|taken| format!("state sent {:.0} ms late", 1e3 * (t - taken)))
    }
}
