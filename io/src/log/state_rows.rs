//! Rows of joint states, each of one message, or of several that came from senders of parts of the arm.

use std::collections::BTreeMap;

use armid_cdr::JointState;

use super::topics::Message;
use crate::error::Error;

/// Messages that hold some joints.
struct Sender {
    holds: Vec<bool>,
    messages: Vec<usize>,
}

/// Rows of some joints.
pub(super) struct StateRows<'a> {
    name: &'a str,
    messages: &'a [Message],
    joints: Vec<String>,
    /// Times of the rows, ns.
    pub(super) times_ns: Vec<i64>,
    /// The message of each row, for each joint; none where it has no message near enough.
    of_joint: Vec<Vec<Option<usize>>>,
    /// What was done, a sentence each.
    pub(super) remarks: Vec<String>,
}

impl<'a> StateRows<'a> {
    /// Rows of `joints`: the messages that hold all of them; where none does, those that hold the most of them, each with
    /// the nearest ones, by their stamps, that hold the others. Where stamps stand still, the times are those of the recorder.
    ///
    /// # Errors
    /// [`Error`] where a joint is in no message, or the messages of its sender are of other times.
    pub(super) fn of(name: &'a str, messages: &'a [Message], joints: Vec<String>) -> Result<Self, Error> {
        let mut groups: BTreeMap<Vec<bool>, Vec<usize>> = BTreeMap::new();
        for (k, message) in messages.iter().enumerate() {
            let holds = joints.iter().map(|joint| message.state.name.contains(joint)).collect();
            groups.entry(holds).or_default().push(k);
        }
        // Of senders of equal size, the one of the first joints comes first.
        let senders = groups.into_iter().rev().map(|(holds, messages)| Sender { holds, messages });
        let mut senders: Vec<Sender> = senders.collect();
        senders.sort_by_key(|sender| {
            let count = sender.holds.iter().filter(|holds| **holds).count();
            std::cmp::Reverse((count, sender.messages.len()))
        });
        let (mut covered, mut used, mut left_out) = (vec![false; joints.len()], Vec::new(), [0, 0]);
        for sender in senders {
            if sender.holds.iter().zip(&covered).any(|(holds, covered)| *holds && !covered) {
                covered.iter_mut().zip(&sender.holds).for_each(|(covered, holds)| *covered |= holds);
                used.push(sender);
            } else {
                left_out[usize::from(sender.holds.contains(&true))] += sender.messages.len();
            }
        }
        if let Some(at) = covered.iter().position(|covered| !covered) {
            return Err(Error::mismatch(format!("{name}: joint \"{}\" is in no message", joints[at])));
        }
        let count = messages.len();
        let mut remarks = Vec::new();
        for (left_out, why) in left_out.into_iter().zip(["hold none of the joints", "hold only some of the joints"]) {
            if left_out > 0 {
                remarks.push(format!("{left_out} of {count} messages {why} and are left out"));
            }
        }
        let recorded = used.iter().any(|sender| stands_still(sender.messages.iter().map(|&k| stamp(&messages[k]))))
            && !stands_still(messages.iter().map(|message| message.recorded_ns));
        if recorded {
            remarks
                .push("the stamps of the messages stand still: the times at which they were recorded are taken".into());
        }
        let time = |k: usize| if recorded { messages[k].recorded_ns } else { stamp(&messages[k]) };
        let first = used.first().map(|sender| sender.messages.clone()).unwrap_or_default();
        let times_ns: Vec<i64> = first.iter().map(|&k| time(k)).collect();
        let mut of_joint: Vec<Vec<Option<usize>>> = vec![Vec::new(); joints.len()];
        for (number, sender) in used.iter().enumerate() {
            let rows: Vec<Option<usize>> = if number == 0 {
                first.iter().copied().map(Some).collect()
            } else {
                let others: Vec<(i64, usize)> = sender.messages.iter().map(|&k| (time(k), k)).collect();
                let (rows, farthest_ns) = nearest(&times_ns, others);
                let held = joints.iter().zip(&sender.holds).filter(|(_, holds)| **holds);
                let held = held.map(|(joint, _)| joint.as_str()).collect::<Vec<_>>().join(", ");
                if 2 * rows.iter().flatten().count() < rows.len() {
                    let message = format!(
                        "{name}: the messages of the joints {held} are of other times than those of the other joints, expected \
                         both at the same times"
                    );
                    return Err(Error::mismatch(message).help("record all joints in one message, or at equal rates"));
                }
                remarks.push(format!(
                    "the joints {held} come in messages of their own: those with the nearest stamps are taken, at most {:.3} ms \
                     away",
                    farthest_ns as f64 * 1e-6
                ));
                rows
            };
            for (of_joint, _) in of_joint.iter_mut().zip(&sender.holds).filter(|(of, holds)| **holds && of.is_empty()) {
                of_joint.clone_from(&rows);
            }
        }
        Ok(Self { name, messages, joints, times_ns, of_joint, remarks })
    }

    /// Positions or efforts of some of the joints, row after row: NaN where a row has no message of a joint.
    ///
    /// # Errors
    /// [`Error`] where a message has not as many values as names.
    pub(super) fn values(&self, joints: &[String], of: fn(&JointState) -> &[f64]) -> Result<Vec<f64>, Error> {
        self.all(joints, |k, joint| {
            let state = &self.messages[k].state;
            let at = state.name.iter().position(|found| found == joint);
            let complete = state.position.len() == state.name.len() && state.effort.len() == state.name.len();
            at.filter(|_| complete).map(|at| of(state)[at]).ok_or_else(|| {
                let message = format!(
                    "{}: message {}: {} names, {} positions and {} efforts, expected one of each for joint \"{joint}\"",
                    self.name,
                    k + 1,
                    state.name.len(),
                    state.position.len(),
                    state.effort.len()
                );
                Error::new(message)
            })
        })
    }

    /// Velocities of some of the joints; `None` where a message lacks one.
    pub(super) fn velocities(&self, joints: &[String]) -> Option<Vec<f64>> {
        let velocity = |k: usize, joint: &String| {
            let state = &self.messages[k].state;
            let at = state.name.iter().position(|found| found == joint);
            at.and_then(|at| state.velocity.get(at).copied()).ok_or(())
        };
        self.all(joints, velocity).ok()
    }

    /// A value for each row and joint.
    fn all<E>(&self, joints: &[String], of: impl Fn(usize, &String) -> Result<f64, E>) -> Result<Vec<f64>, E> {
        let place = |joint: &String| self.joints.iter().position(|known| known == joint);
        let columns: Vec<Option<&Vec<Option<usize>>>> =
            joints.iter().map(|joint| place(joint).map(|at| &self.of_joint[at])).collect();
        let mut values = Vec::with_capacity(self.times_ns.len() * joints.len());
        for row in 0..self.times_ns.len() {
            for (joint, column) in joints.iter().zip(&columns) {
                match column.and_then(|column| column[row]) {
                    Some(k) => values.push(of(k, joint)?),
                    None => values.push(f64::NAN),
                }
            }
        }
        Ok(values)
    }
}

fn stamp(message: &Message) -> i64 {
    message.state.stamp.ns()
}

/// Whether several times are all the same.
fn stands_still(mut times: impl Iterator<Item = i64>) -> bool {
    let first = times.next();
    let mut rest = times.peekable();
    rest.peek().is_some() && rest.all(|time| Some(time) == first)
}

/// For each time the nearest of the others, at most one of their usual steps away, and the largest distance, ns.
fn nearest(times: &[i64], mut others: Vec<(i64, usize)>) -> (Vec<Option<usize>>, u64) {
    others.sort_unstable();
    let mut steps: Vec<u64> = others.windows(2).map(|pair| pair[1].0.abs_diff(pair[0].0)).collect();
    steps.sort_unstable();
    let usual = steps.get(steps.len() / 2).copied().unwrap_or(0);
    let mut farthest = 0;
    let found = times.iter().map(|&time| {
        let next = others.partition_point(|other| other.0 < time);
        let near = others[next.saturating_sub(1)..others.len().min(next + 1)].iter();
        let (distance, k) = near.map(|&(other, k)| (other.abs_diff(time), k)).min()?;
        if distance > usual {
            return None;
        }
        farthest = farthest.max(distance);
        Some(k)
    });
    let found = found.collect();
    (found, farthest)
}

#[cfg(test)]
mod tests {
    use armid_cdr::{JointState, Time};

    use super::{Message, StateRows};

    fn message(ms: i64, recorded_ms: i64, joints: &[(&str, f64)]) -> Message {
        let state = JointState {
            stamp: Time::from_ns(ms * 1_000_000).unwrap(),
            name: joints.iter().map(|(name, _)| (*name).to_owned()).collect(),
            position: joints.iter().map(|(_, q)| *q).collect(),
            effort: joints.iter().map(|(_, q)| 10.0 * q).collect(),
            ..JointState::default()
        };
        Message { recorded_ns: recorded_ms * 1_000_000, state }
    }

    fn joints(names: &[&str]) -> Vec<String> {
        names.iter().map(|&name| name.to_owned()).collect()
    }

    #[test]
    fn messages_without_the_joints_are_left_out_and_counted() {
        let mut finger = message(1, 1, &[("finger", 9.0)]);
        finger.state.effort.clear();
        let messages = [message(0, 0, &[("a", 1.0), ("b", 2.0)]), finger, message(2, 2, &[("b", 4.0), ("a", 3.0)])];
        let rows = StateRows::of("bag", &messages, joints(&["a", "b"])).unwrap();
        assert_eq!(rows.values(&joints(&["b", "a"]), |state| &state.position).unwrap(), [2.0, 1.0, 4.0, 3.0]);
        assert_eq!(rows.values(&joints(&["a"]), |state| &state.effort).unwrap(), [10.0, 30.0]);
        assert_eq!((rows.times_ns.as_slice(), rows.velocities(&joints(&["a"]))), (&[0, 2_000_000][..], None));
        assert_eq!(rows.remarks, ["1 of 3 messages hold none of the joints and are left out"]);
        assert!(StateRows::of("bag", &messages, joints(&["a", "c"])).is_err());
    }

    #[test]
    fn parts_of_an_arm_are_joined_by_the_nearest_stamps() {
        let mut messages: Vec<Message> = (0..6).map(|k| message(10 * k, 0, &[("a", k as f64), ("b", 0.5)])).collect();
        // The fourth is missing: nothing is within a step of the third row.
        messages.extend([1, 11, 22, 51].map(|ms| message(ms, 0, &[("c", ms as f64)])));
        let rows = StateRows::of("bag", &messages, joints(&["a", "c"])).unwrap();
        let c = rows.values(&joints(&["c"]), |state| &state.position).unwrap();
        assert_eq!(c[..3], [1.0, 11.0, 22.0]);
        assert_eq!((rows.times_ns.len(), c[5]), (6, 51.0));
        assert!(rows.remarks[0].starts_with("the joints c come in messages of their own"), "{:?}", rows.remarks);
        // Of other times altogether.
        let late: Vec<Message> = (0..6).map(|k| message(10 * k, 0, &[("a", 0.0)])).collect();
        let late: Vec<Message> =
            late.into_iter().chain((0..6).map(|k| message(900 + 10 * k, 0, &[("c", 0.0)]))).collect();
        let fault = StateRows::of("bag", &late, joints(&["a", "c"])).err().unwrap().to_string();
        assert!(fault.contains("the joints c are of other times"), "{fault}");
    }

    #[test]
    fn times_are_those_of_the_recorder_where_stamps_stand_still() {
        let messages = [message(0, 5, &[("a", 1.0)]), message(0, 7, &[("a", 1.0)])];
        let rows = StateRows::of("bag", &messages, joints(&["a"])).unwrap();
        assert_eq!(rows.times_ns, [5_000_000, 7_000_000]);
        assert!(rows.remarks[0].contains("stand still"));
        // Nothing better is known.
        let messages = [message(0, 5, &[("a", 1.0)]), message(0, 5, &[("a", 1.0)])];
        assert_eq!(StateRows::of("bag", &messages, joints(&["a"])).unwrap().times_ns, [0, 0]);
    }
}
