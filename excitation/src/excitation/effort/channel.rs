//! What is limited: the torque of each joint and the current of each motor, both linear in the joint torques.

use crate::model::Robot;

/// Which effort.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EffortKind {
    /// Torque of a joint, N·m (N).
    Torque,
    /// Current of a motor, A.
    Current,
}

/// One limited effort, `w · τ`.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Which effort.
    pub kind: EffortKind,
    /// The joint, or the motor of that joint.
    pub joint: usize,
    /// Weights w of the joint torques (n).
    pub weights: Vec<f64>,
    /// Largest magnitude, N·m (N) or A; infinite where there is no limit.
    pub peak: f64,
    /// Largest root mean square over a period; infinite where none is stated.
    pub continuous: f64,
}

impl Channel {
    /// The joint and its weight, where the effort is that of one joint alone.
    pub(super) fn single(&self) -> Option<(usize, f64)> {
        let mut weights = self.weights.iter().copied().enumerate().filter(|(_, weight)| *weight != 0.0);
        weights.next().filter(|_| weights.next().is_none())
    }

    /// All efforts of a robot that have a limit: torques, then currents.
    pub fn all(robot: &Robot) -> Vec<Self> {
        let n = robot.dof();
        let mut channels = Vec::new();
        for (joint, j) in robot.joints().iter().enumerate() {
            let mut weights = vec![0.0; n];
            weights[joint] = 1.0;
            let (peak, continuous) = (j.limits.torque, j.limits.continuous_torque);
            channels.push(Self { kind: EffortKind::Torque, joint, weights, peak, continuous });
        }
        // τ = Cᵀ τ_motor: the rows of (Cᵀ)⁻¹ give the motors' torques.
        let inverse = robot
            .coupling()
            .map(|c| c.transpose().try_inverse().expect("a robot's coupling is invertible by construction"));
        for (joint, j) in robot.joints().iter().enumerate() {
            let weights = (0..n)
                .map(|i| {
                    let share = inverse.as_ref().map_or(f64::from(u8::from(i == joint)), |inverse| inverse[(joint, i)]);
                    share / j.drive.torque_per_ampere()
                })
                .collect();
            let (peak, continuous) = (j.drive.current_limit, j.drive.continuous_current);
            channels.push(Self { kind: EffortKind::Current, joint, weights, peak, continuous });
        }
        channels.retain(|channel| channel.peak.is_finite() || channel.continuous.is_finite());
        channels
    }

    /// The `channels` that can be the first to be reached: where a torque and a current are multiples of each
    /// other, only the tighter one.
    pub fn binding(channels: &[Self]) -> Vec<Self> {
        let scale = |channel: &Self| channel.weights[channel.joint].abs();
        let alone = |channel: &Self| channel.single().is_some_and(|(joint, _)| joint == channel.joint);
        let mut kept: Vec<Self> = Vec::new();
        for channel in channels {
            let twin = kept.iter_mut().find(|other| other.joint == channel.joint && alone(other) && alone(channel));
            match twin {
                Some(other) => {
                    let unit = scale(other) / scale(channel);
                    other.peak = other.peak.min(channel.peak * unit);
                    other.continuous = other.continuous.min(channel.continuous * unit);
                }
                None => kept.push(channel.clone()),
            }
        }
        kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains;

    #[test]
    fn analytic_currents_are_torques_over_gear_and_constant() {
        let channels = Channel::all(&chains::crs_a460());
        assert_eq!(channels.len(), 12);
        let shoulder = &channels[7];
        assert_eq!((shoulder.kind, shoulder.joint, shoulder.peak), (EffortKind::Current, 1, 5.0));
        assert!((shoulder.weights[1] - 1.0 / 15.0).abs() < 1e-15 && shoulder.weights[0] == 0.0);
        // 5 A give 75 N·m, more than the shoulder's 66.08; 3 A of the last joint give 6.97, more than its 2.5.
        let binding = Channel::binding(&channels);
        let peaks: Vec<f64> = binding.iter().map(|channel| channel.peak).collect();
        assert_eq!(peaks, [39.5, 66.08, 39.5, 6.89, 6.82, 2.5]);
    }
}
