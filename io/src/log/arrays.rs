//! A log from arrays of a program.

use armid::estimation::PositionServo;
use armid::input::size::JOINTS;
use armid::model::EffortInterface;

use super::Log;
use super::origin::Origin;
use super::raw_log::RawLog;
use super::servo;
use crate::error::Error;

/// When the rows of arrays were sampled.
#[derive(Clone, Debug, PartialEq)]
pub enum ArrayTime {
    /// Stamps, s, N: even or not, with gaps where rows are missing.
    Stamps(Vec<f64>),
    /// Rows per second, Hz.
    Rate(f64),
}

/// Measured values of N rows and n joints, row by row. A value that is missing is NaN.
#[derive(Clone, Debug, PartialEq)]
pub struct LogArrays {
    /// What errors call the log.
    pub name: String,
    /// Names of the joints, n; of the robot's joints in its order where there are none.
    pub joints: Option<Vec<String>>,
    /// Number of joints n.
    pub dof: usize,
    /// When the rows were sampled.
    pub time: ArrayTime,
    /// Joint coordinates, rad (m), N × n.
    pub q: Vec<f64>,
    /// Velocities, rad/s (m/s), N × n, where they are measured.
    pub qd: Option<Vec<f64>>,
    /// Positions behind the transmissions, rad (m), N × n, where they are measured too.
    pub link_q: Option<Vec<f64>>,
    /// Torques, N·m (N), or motor currents, A, N × n; commanded positions, rad (m), where there is a servo.
    pub effort: Vec<f64>,
    /// Which of the two; as the robot file says where `None`.
    pub effort_unit: Option<EffortInterface>,
    /// What makes torques of commanded positions.
    pub servo: Option<PositionServo>,
}

impl Log {
    /// A log of arrays. Gaps, uneven stamps and rows with NaN are treated as those of a file.
    ///
    /// # Errors
    /// [`Error`] where the arrays do not belong together, the stamps are no times, or nothing is left.
    ///
    /// ```
    /// use armid_io::log::{ArrayTime, LogArrays};
    /// use armid_io::Log;
    /// let (q, tau) = ((0..100).map(|k| 0.01 * f64::from(k)).collect::<Vec<_>>(), vec![1.0; 100]);
    /// let arrays = LogArrays {
    ///     name: "arrays".to_owned(),
    ///     joints: None,
    ///     dof: 1,
    ///     time: ArrayTime::Rate(100.0),
    ///     q,
    ///     qd: None,
    ///     link_q: None,
    ///     effort: tau,
    ///     effort_unit: None,
    ///     servo: None,
    /// };
    /// let log = Log::from_arrays(arrays.clone())?;
    /// assert_eq!((log.dof, log.rate_hz, log.segments[0].samples), (1, 100.0, 100));
    /// assert!(Log::from_arrays(LogArrays { effort: vec![1.0], ..arrays }).is_err());
    /// # Ok::<(), armid_io::Error>(())
    /// ```
    pub fn from_arrays(arrays: LogArrays) -> Result<Self, Error> {
        let LogArrays { name, joints, dof, time, q, qd, link_q, mut effort, mut effort_unit, servo } = arrays;
        JOINTS.check_count("number of joints", dof)?;
        if dof == 0 || q.len() % dof != 0 {
            let message = format!("{name}: q has {} values, expected as many for each of {dof} joints", q.len());
            return Err(Error::new(message));
        }
        let rows = q.len() / dof;
        let sizes = [
            ("effort", Some(effort.len()), q.len()),
            ("qd", qd.as_ref().map(Vec::len), q.len()),
            ("link_q", link_q.as_ref().map(Vec::len), q.len()),
            ("joints", joints.as_ref().map(Vec::len), dof),
            ("t", matches!(&time, ArrayTime::Stamps(_)).then(|| time.stamps().len()), rows),
        ];
        for (what, found, expected) in sizes {
            if let Some(found) = found.filter(|found| *found != expected) {
                return Err(Error::new(format!("{name}: {what} has {found} values, expected {expected}")));
            }
        }
        let (t, rate_hz) = match time {
            ArrayTime::Stamps(t) => (t, None),
            ArrayTime::Rate(rate) if rate.is_finite() && rate > 0.0 => (Vec::new(), Some(rate)),
            ArrayTime::Rate(rate) => {
                return Err(Error::new(format!("{name}: the rate is {rate} Hz, expected a number above zero")));
            }
        };
        let mut origin = Origin::default();
        if let Some(of) = &servo {
            if let Some(fault) = of.fault(dof) {
                return Err(Error::new(format!("{name}: {fault}")));
            }
            let time = |row: usize| rate_hz.map_or_else(|| t[row], |rate| row as f64 / rate);
            effort = servo::stiffness_torque(of, &effort, &q, &[], time);
            effort_unit = Some(EffortInterface::Torque);
            origin.remarks.push(servo::remark(of, qd.is_some()));
        }
        let called = name.clone();
        let raw = RawLog {
            name,
            joints,
            dof,
            t,
            rate_hz,
            q,
            qd,
            link_q,
            effort,
            without_effort: Vec::new(),
            effort_unit,
            servo,
            conversion: Default::default(),
            origin,
        };
        raw.even(|row, message| Error::new(format!("{called}: row {row}: {message}")))
    }
}

impl ArrayTime {
    fn stamps(&self) -> &[f64] {
        match self {
            Self::Stamps(t) => t,
            Self::Rate(_) => &[],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arrays(rows: usize) -> LogArrays {
        let t = |k: usize| k as f64 / 200.0;
        LogArrays {
            name: "arrays".to_owned(),
            joints: None,
            dof: 2,
            time: ArrayTime::Stamps((0..rows).map(t).collect()),
            q: (0..rows).flat_map(|k| [(3.0 * t(k)).sin(), (5.0 * t(k)).cos()]).collect(),
            qd: None,
            link_q: None,
            effort: (0..rows).flat_map(|k| [t(k), -t(k)]).collect(),
            effort_unit: Some(EffortInterface::Torque),
            servo: None,
        }
    }

    #[test]
    fn identity_arrays_and_the_table_of_the_same_numbers_are_one_log() {
        let mut made = arrays(400);
        // Missing values, a missing row and an uneven stamp.
        made.q[20] = f64::NAN;
        if let ArrayTime::Stamps(t) = &mut made.time {
            t[300] += 1e-3;
        }
        let mut text = "t,q1,q2,tau1,tau2\n".to_owned();
        for (k, t) in made.time.stamps().iter().enumerate() {
            let cell = |x: f64| if x.is_finite() { format!("{x:?}") } else { String::new() };
            let row = [*t, made.q[2 * k], made.q[2 * k + 1], made.effort[2 * k], made.effort[2 * k + 1]];
            text += &(row.map(cell).join(",") + "\n");
        }
        let table = crate::log::parse_csv(crate::text::Text::new("t.csv", text)).unwrap();
        let log = Log::from_arrays(made).unwrap();
        assert_eq!((&log.q, &log.effort, log.rate_hz), (&table.q, &table.effort, table.rate_hz));
        assert_eq!(log.segments, table.segments);
        assert_eq!(log.origin.timing, table.origin.timing);
    }

    #[test]
    fn identity_commands_by_a_mapping_and_in_arrays_make_the_torque_of_their_servo() {
        let servo = PositionServo::new(vec![100.0, 40.0], vec![3.0, 0.5], 0.01);
        let of_torque = arrays(400);
        let t = |k: usize| k as f64 / 200.0;
        // What must be commanded so that the servo has this torque: the velocities are those of sines.
        let command = |k: usize, at: f64| {
            let state =
                [((3.0 * at).sin(), 3.0 * (3.0 * at).cos(), at), ((5.0 * at).cos(), -5.0 * (5.0 * at).sin(), -at)];
            let (q, qd, tau) = state[k];
            q + (tau + servo.kd[k] * qd) / servo.kp[k]
        };
        let commands: Vec<f64> =
            (0..400).flat_map(|k| [0, 1].map(|joint| command(joint, t(k) + servo.delay_s))).collect();
        let mut text = "t,q1,q2,c1,c2\n".to_owned();
        for k in 0..400 {
            let [a, b] = [0, 1].map(|joint| commands[2 * k + joint].to_degrees());
            text += &format!("{:?},{:?},{:?},{a:?},{b:?}\n", t(k), of_torque.q[2 * k], of_torque.q[2 * k + 1]);
        }
        let mapping = super::super::Mapping::parse("t=t, q=q[1-2], q_cmd=c[1-2] deg kp=100/40 kd=3/0.5 delay_ms=10");
        let texts = vec![crate::text::Text::new("c.csv", text)];
        let table = super::super::parse_tables(texts, Some(&mapping.unwrap()), None).unwrap();
        let log =
            Log::from_arrays(LogArrays { effort: commands, servo: Some(servo), effort_unit: None, ..arrays(400) })
                .unwrap();
        // Two rows have no command that acts yet.
        assert_eq!((log.q.len(), log.effort_unit), (2 * 398, Some(EffortInterface::Torque)));
        let expected = &Log::from_arrays(of_torque).unwrap().effort[4..];
        for (k, ((a, b), tau)) in log.effort.iter().zip(&table.effort).zip(expected).enumerate() {
            // At the ends of the log the velocity is less accurate.
            let near_end = !(4..2 * 396).contains(&k);
            assert!(
                (a - b).abs() < 1e-10 && (a - tau).abs() < if near_end { 2e-2 } else { 1e-5 },
                "{k}: {a} {b} {tau}"
            );
        }
        assert!(log.origin.remarks[0].starts_with("torques are those of a servo"), "{:?}", log.origin.remarks);
    }

    #[test]
    fn arrays_that_do_not_belong_together_are_refused_by_their_name() {
        type Fault = (fn(&mut LogArrays), &'static str);
        const fn servo(kp: Vec<f64>, kd: Vec<f64>, delay_s: f64) -> Option<PositionServo> {
            Some(PositionServo::new(kp, kd, delay_s))
        }
        let faults: [Fault; 9] = [
            (|a| a.servo = servo(vec![1.0], vec![0.0; 2], 0.0), "kp has 1 values, expected 2"),
            (|a| a.servo = servo(vec![1.0; 2], vec![0.0, -1.0], 0.0), "kd is -1, expected zero"),
            (|a| a.servo = servo(vec![1.0; 2], vec![0.0; 2], f64::NAN), "delay is NaN s"),
            (|a| a.dof = 0, "q has 20 values"),
            (|a| a.dof = 3, "q has 20 values, expected as many for each of 3 joints"),
            (|a| a.qd = Some(vec![0.0; 3]), "qd has 3 values, expected 20"),
            (|a| a.joints = Some(vec!["one".to_owned()]), "joints has 1 values, expected 2"),
            (|a| a.time = ArrayTime::Stamps(vec![0.0; 4]), "t has 4 values, expected 10"),
            (|a| a.time = ArrayTime::Rate(f64::NAN), "the rate is NaN Hz"),
        ];
        for (fault, said) in faults {
            let mut made = arrays(10);
            fault(&mut made);
            let error = Log::from_arrays(made).unwrap_err().to_string();
            assert!(error.starts_with("arrays: ") && error.contains(said), "{error}");
        }
        // Nothing at all, and stamps that go back.
        assert!(Log::from_arrays(arrays(0)).is_err());
        let mut back = arrays(10);
        back.time = ArrayTime::Stamps((0..10).map(|k| f64::from(-k)).collect());
        assert!(Log::from_arrays(back).is_err());
    }
}
