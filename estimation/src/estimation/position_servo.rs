//! The position servos of joints, and what is not known of them.
//!
//! ```text
//! τ(t) = Kp (q_cmd(t − d) − q(t)) − Kd q̇(t)        q of the model = q of the encoder + z
//! ```
//! with stiffness Kp and damping Kd, both diagonal, a delay d, and the errors z of the encoders' zeros. Command and encoder share their
//! zero, so that z moves the arm by gravity and inertia alone. A command whose zero is not the encoder's adds a constant torque, the
//! offset `Fo`.

use std::fmt;

use crate::signal::Samples;

/// A number of position servos.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ServoPart {
    /// Stiffness of a joint, from zero, N·m/rad (N/m).
    Stiffness(usize),
    /// Damping of a joint, N·m·s/rad (N·s/m).
    Damping(usize),
    /// The delay of all joints, s.
    Delay,
    /// What is added to the encoder of a joint, rad (m).
    Zero(usize),
}

impl fmt::Display for ServoPart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stiffness(joint) => write!(f, "kp{}", joint + 1),
            Self::Damping(joint) => write!(f, "kd{}", joint + 1),
            Self::Delay => f.write_str("delay"),
            Self::Zero(joint) => write!(f, "zero{}", joint + 1),
        }
    }
}

impl ServoPart {
    /// Reads a name: `delay`, or `kp`, `kd` or `zero` with the number of a joint from one.
    pub fn parse(name: &str) -> Option<Self> {
        if name == "delay" {
            return Some(Self::Delay);
        }
        let joint = |kind: &str| name.strip_prefix(kind)?.parse::<usize>().ok()?.checked_sub(1);
        let damping = || joint("kd").map(Self::Damping);
        let zero = || joint("zero").map(Self::Zero);
        joint("kp").map(Self::Stiffness).or_else(damping).or_else(zero)
    }

    /// Its joint, from zero; none of the delay.
    pub const fn joint(self) -> Option<usize> {
        match self {
            Self::Stiffness(joint) | Self::Damping(joint) | Self::Zero(joint) => Some(joint),
            Self::Delay => None,
        }
    }

    /// Its unit at a joint whose torque has this one.
    pub fn unit(self, torque: &str) -> &'static str {
        match (self, torque == "N") {
            (Self::Delay, _) => "s",
            (Self::Stiffness(_), false) => "N·m/rad",
            (Self::Stiffness(_), true) => "N/m",
            (Self::Damping(_), false) => "N·m·s/rad",
            (Self::Damping(_), true) => "N·s/m",
            (Self::Zero(_), false) => "rad",
            (Self::Zero(_), true) => "m",
        }
    }
}

/// Gains, delay and zeros of the position servos of n joints.
#[derive(Clone, Debug, PartialEq)]
pub struct PositionServo {
    /// Torque per error, N·m/rad (N/m), n.
    pub kp: Vec<f64>,
    /// Torque per speed, N·m·s/rad (N·s/m), n.
    pub kd: Vec<f64>,
    /// Time by which the servo acts after its command, s. One that holds each command until the next acts half a row late on average.
    pub delay_s: f64,
    /// What is added to the encoders, rad (m), n; empty where nothing is.
    pub zero: Vec<f64>,
    /// The numbers that are guesses, to be estimated.
    pub unknown: Vec<ServoPart>,
}

impl PositionServo {
    /// Servos whose numbers are known.
    pub const fn new(kp: Vec<f64>, kd: Vec<f64>, delay_s: f64) -> Self {
        Self { kp, kd, delay_s, zero: Vec::new(), unknown: Vec::new() }
    }

    /// What is wrong with those of n joints, in a sentence.
    pub fn fault(&self, n: usize) -> Option<String> {
        for (name, gains, lowest) in [("kp", &self.kp, f64::MIN_POSITIVE), ("kd", &self.kd, 0.0)] {
            if gains.len() != n {
                return Some(format!("{name} has {} values, expected {n}, one for each joint", gains.len()));
            }
            if let Some(gain) = gains.iter().find(|gain| !(gain.is_finite() && **gain >= lowest)) {
                let expected = if lowest > 0.0 { "a number above zero" } else { "zero or a number above" };
                return Some(format!("{name} is {gain}, expected {expected}"));
            }
        }
        for (at, part) in self.unknown.iter().enumerate() {
            if part.joint().is_some_and(|joint| joint >= n) {
                return Some(format!("unknown is \"{part}\", expected one of joints 1 to {n}"));
            }
            if self.unknown[..at].contains(part) {
                return Some(format!("unknown names \"{part}\" twice, expected once"));
            }
        }
        let delay = self.delay_s;
        (!(delay.is_finite() && delay >= 0.0)).then(|| format!("delay is {delay} s, expected zero or a number above"))
    }

    /// The servos of these joints, in this order; what is unknown of others is left out.
    #[must_use]
    pub fn of_joints(&self, joints: &[usize]) -> Self {
        let pick = |all: &[f64]| joints.iter().filter_map(|&joint| all.get(joint).copied()).collect();
        let place = |joint: usize| joints.iter().position(|&own| own == joint);
        let part = |part: &ServoPart| match *part {
            ServoPart::Stiffness(joint) => place(joint).map(ServoPart::Stiffness),
            ServoPart::Damping(joint) => place(joint).map(ServoPart::Damping),
            ServoPart::Zero(joint) => place(joint).map(ServoPart::Zero),
            ServoPart::Delay => Some(ServoPart::Delay),
        };
        Self {
            kp: pick(&self.kp),
            kd: pick(&self.kd),
            delay_s: self.delay_s,
            zero: pick(&self.zero),
            unknown: self.unknown.iter().filter_map(part).collect(),
        }
    }

    /// One of its numbers.
    pub fn value(&self, part: ServoPart) -> f64 {
        match part {
            ServoPart::Stiffness(joint) => self.kp[joint],
            ServoPart::Damping(joint) => self.kd[joint],
            ServoPart::Delay => self.delay_s,
            ServoPart::Zero(joint) => self.zero.get(joint).copied().unwrap_or(0.0),
        }
    }

    /// These servos with other values of what is unknown, in the order of that list.
    #[must_use]
    pub fn with_unknown(mut self, values: &[f64]) -> Self {
        self.zero.resize(self.kp.len(), 0.0);
        for (part, value) in self.unknown.iter().zip(values) {
            match *part {
                ServoPart::Stiffness(joint) => self.kp[joint] = *value,
                ServoPart::Damping(joint) => self.kd[joint] = *value,
                ServoPart::Delay => self.delay_s = *value,
                ServoPart::Zero(joint) => self.zero[joint] = *value,
            }
        }
        self
    }

    /// Commands in the samples' coordinates, N × n, rad (m), by samples whose torque these servos made: those that act at each sample, as
    /// the samples' low pass leaves them.
    pub fn commands(&self, samples: &Samples) -> Vec<f64> {
        let n = self.kp.len();
        let states = &samples.states;
        let command = |(at, tau): (usize, &f64)| {
            let i = at % n;
            (tau + self.kd[i] * states.qd[at]) / self.kp[i] + states.q[at]
        };
        samples.tau.iter().enumerate().map(command).collect()
    }

    /// The samples of these servos as `other` servos make them under the same commands. Rows whose command is not known are no equations.
    #[must_use]
    pub fn restated_samples(&self, samples: &Samples, other: &Self) -> Samples {
        let n = self.kp.len();
        let commands = self.commands(samples);
        let later = (other.delay_s - self.delay_s) * samples.rate_hz;
        let mut restated = samples.clone();
        for (at, tau) in restated.tau.iter_mut().enumerate() {
            let (row, i) = (at / n, at % n);
            let (command, _) = interpolate(&commands, n, i, row as f64 - later);
            *tau = other.kp[i] * (command - samples.states.q[at]) - other.kd[i] * samples.states.qd[at];
        }
        // Rows whose command was before the samples, or is after them, are no equations.
        let last = (samples.states.len().max(1) - 1) as f64;
        for (k, used) in restated.used.chunks_exact_mut(n).enumerate() {
            let (first, end) = ((k * samples.block) as f64 - later, ((k + 1) * samples.block - 1) as f64 - later);
            if first < 0.0 || end > last {
                used.fill(false);
            }
        }
        for (at, q) in restated.states.q.iter_mut().enumerate() {
            *q += other.value(ServoPart::Zero(at % n)) - self.value(ServoPart::Zero(at % n));
        }
        restated
    }
}

/// The value of column `i` of a table of `n` columns at a row that need not be whole, and its slope per row: a cubic through the four
/// rows around it (Catmull and Rom's); that of the first or last row beyond them.
pub fn interpolate(table: &[f64], n: usize, i: usize, row: f64) -> (f64, f64) {
    let last = table.len() / n.max(1) - 1;
    let from = row.floor();
    let x = row - from;
    let at = |step: f64| table[(from + step).clamp(0.0, last as f64) as usize * n + i];
    let (before, a, b, after) = (at(-1.0), at(0.0), at(1.0), at(2.0));
    let (start, end, rise) = (0.5 * (b - before), 0.5 * (after - a), b - a);
    let (square, cube) = (3.0 * rise - 2.0 * start - end, start + end - 2.0 * rise);
    (a + x * (start + x * (square + x * cube)), start + x * (2.0 * square + 3.0 * x * cube))
}

/// One number of a servo that was estimated.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ServoEstimate {
    /// `delay`, or `kp`, `kd` or `zero` with the number of the joint.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Standard deviation.
    pub std: f64,
    /// 95 % interval, lower and upper end.
    #[serde(deserialize_with = "crate::plain::infinite::interval")]
    pub ci95: [f64; 2],
    /// The guess that was stated.
    pub stated: f64,
    /// Unit of all of them.
    pub unit: String,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::States;

    #[test]
    fn analytic_a_parabola_between_rows_is_exact() {
        let table: Vec<f64> = (0..6).flat_map(|k| [f64::from(k * k), 1.0 - f64::from(k)]).collect();
        for row in [1.0, 2.25, 3.5, 3.999] {
            let (value, slope) = interpolate(&table, 2, 0, row);
            assert!((value - row * row).abs() < 1e-12 && (slope - 2.0 * row).abs() < 1e-12, "{row}: {value} {slope}");
            assert!((interpolate(&table, 2, 1, row).0 - (1.0 - row)).abs() < 1e-12);
        }
        assert_eq!((interpolate(&table, 2, 0, -2.0).0, interpolate(&table, 2, 0, 9.0).0), (0.0, 25.0));
    }

    #[test]
    fn analytic_samples_of_other_servos_have_their_torque() {
        let (rate, rows) = (100.0, 60);
        let at = |k: usize| k as f64 / rate;
        let position = |t: f64| [0.1 * t, 0.5 - 0.2 * t];
        let command = |t: f64| [0.3 * t + 0.1, 0.4 * t - 0.2];
        let tau = |servo: &PositionServo, t: f64| {
            let (c, q, qd) = (command(t - servo.delay_s), position(t), [0.1, -0.2]);
            [0, 1].map(|i| servo.kp[i] * (c[i] - q[i]) - servo.kd[i] * qd[i])
        };
        let stated = PositionServo {
            unknown: vec![ServoPart::Stiffness(1), ServoPart::Delay, ServoPart::Zero(0)],
            ..PositionServo::new(vec![10.0, 20.0], vec![1.0, 0.5], 0.01)
        };
        let states = States {
            dof: 2,
            q: (0..rows).flat_map(|k| position(at(k))).collect(),
            qd: (0..rows).flat_map(|_| [0.1, -0.2]).collect(),
            qdd: vec![0.0; 2 * rows],
        };
        let torque = (0..rows).flat_map(|k| tau(&stated, at(k))).collect();
        let samples = Samples::exact(states, torque, vec!["N·m".to_owned(); 2], rate);
        let other = stated.clone().with_unknown(&[30.0, 0.023, 0.25]);
        let restated = stated.restated_samples(&samples, &other);
        for k in 5..rows - 5 {
            let expected = tau(&other, at(k));
            for i in 0..2 {
                assert!((restated.tau[2 * k + i] - expected[i]).abs() < 1e-12);
            }
            assert!((restated.states.q[2 * k] - position(at(k))[0] - 0.25).abs() < 1e-15);
        }
        // Commands of the first rows were given before them.
        assert!((0..2 * rows).all(|at| restated.used[at] == (at >= 4)), "{:?}", restated.used);
        let back = other.restated_samples(&restated, &stated);
        assert!(back.states.q.iter().zip(&samples.states.q).all(|(a, b)| (a - b).abs() < 1e-15));
    }

    #[test]
    fn analytic_servos_of_joints_in_another_order() {
        let servo = PositionServo {
            zero: vec![0.1, 0.2, 0.3],
            unknown: vec![ServoPart::Zero(0), ServoPart::Delay, ServoPart::Damping(2)],
            ..PositionServo::new(vec![1.0, 2.0, 3.0], vec![4.0, 5.0, 6.0], 0.5)
        };
        let expected = PositionServo {
            zero: vec![0.3, 0.2],
            unknown: vec![ServoPart::Delay, ServoPart::Damping(0)],
            ..PositionServo::new(vec![3.0, 2.0], vec![6.0, 5.0], 0.5)
        };
        assert_eq!(servo.of_joints(&[2, 1]), expected);
    }

    #[test]
    fn a_name_of_a_part_is_read_back() {
        for part in [ServoPart::Stiffness(0), ServoPart::Damping(11), ServoPart::Delay, ServoPart::Zero(2)] {
            assert_eq!(ServoPart::parse(&part.to_string()), Some(part));
        }
        for wrong in ["kp", "kp0", "zero-1", "lag", "delay2", ""] {
            assert_eq!(ServoPart::parse(wrong), None, "{wrong}");
        }
        let servo =
            PositionServo { unknown: vec![ServoPart::Zero(2)], ..PositionServo::new(vec![1.0; 2], vec![0.0; 2], 0.0) };
        assert_eq!(servo.fault(2).unwrap(), "unknown is \"zero3\", expected one of joints 1 to 2");
    }
}
