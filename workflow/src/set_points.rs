//! The commanded motion of an experiment as set-points for the controller of any robot.

use std::fmt::Write;

use armid::experiment::{Command, ExperimentPlan};
use armid_io::Error;
use serde::Serialize;
use serde_json::json;

/// How set-points are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PointFormat {
    /// A table: `t`, then position, velocity and acceleration of each joint.
    Csv,
    /// ROS 2's message `trajectory_msgs/JointTrajectory`, as JSON, which is YAML too.
    JointTrajectory,
    /// A program for a controller of Universal Robots: `servoj` at every point.
    Urscript,
}

armid::input::named! {
    PointFormat { Csv: "csv", JointTrajectory: "joint-trajectory", Urscript: "urscript" }
}

impl PointFormat {
    /// How files of this format end.
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::JointTrajectory => "json",
            Self::Urscript => "script",
        }
    }
}

/// A motion from rest to rest, point by point. It serialises to the keys of the command's answer, without the points.
#[derive(Clone, Debug, Serialize)]
pub struct SetPoints {
    /// Names of the n joints.
    pub joints: Vec<String>,
    /// Points in a second.
    pub rate_hz: f64,
    /// How long the motion takes, s.
    pub duration_s: f64,
    /// When the periodic motion begins, s.
    pub periodic_from_s: f64,
    /// Its period, s.
    pub period_s: f64,
    /// Largest |position|, |velocity| and |acceleration| of each joint: rad, rad/s, rad/s² (m).
    pub largest: Vec<[f64; 3]>,
    /// Position, velocity and acceleration of the joints, 3 n numbers a point.
    #[serde(skip)]
    pub rows: Vec<Vec<f64>>,
}

impl SetPoints {
    /// Every sample of a plan, and the last moment: settling, ramp, periods and ramp, in the order of the trajectory's joints.
    ///
    /// # Errors
    /// [`Error`] where the plan cannot be performed, or has more samples than are held in memory.
    pub fn new(plan: &ExperimentPlan) -> Result<Self, Error> {
        let samples = plan.check_held().map_err(Error::new)?;
        let layout = plan.layout().map_err(Error::new)?;
        let command = Command::new(plan, &layout);
        let n = plan.trajectory.dof();
        let row = |k: usize| {
            let mut row = vec![0.0; 3 * n];
            let (q, rest) = row.split_at_mut(n);
            let (qd, qdd) = rest.split_at_mut(n);
            command.evaluate(k as f64 / plan.rate_hz, q, qd, qdd);
            row
        };
        let rows: Vec<Vec<f64>> = (0..=samples).map(row).collect();
        let most = |at: usize| rows.iter().fold(0.0_f64, |most, row| most.max(row[at].abs()));
        Ok(Self {
            joints: plan.trajectory.names().into_iter().map(str::to_owned).collect(),
            rate_hz: plan.rate_hz,
            duration_s: samples as f64 / plan.rate_hz,
            periodic_from_s: command.periodic_s,
            period_s: plan.trajectory.period_s(),
            largest: (0..n).map(|i| [most(i), most(n + i), most(2 * n + i)]).collect(),
            rows,
        })
    }

    /// The file.
    ///
    /// # Errors
    /// [`Error`] where the format has no place for this arm.
    pub fn text(&self, format: PointFormat) -> Result<String, Error> {
        match format {
            PointFormat::Csv => Ok(self.csv()),
            PointFormat::JointTrajectory => Ok(self.joint_trajectory()),
            PointFormat::Urscript if self.joints.len() == 6 => Ok(self.urscript()),
            PointFormat::Urscript => Err(Error::new(format!("urscript moves 6 joints, found {}", self.joints.len()))),
        }
    }

    /// Where the motion is, and how fast.
    fn states(&self) -> impl Iterator<Item = (f64, [&[f64]; 3])> {
        let n = self.joints.len();
        self.rows
            .iter()
            .enumerate()
            .map(move |(k, row)| (k as f64 / self.rate_hz, [&row[..n], &row[n..2 * n], &row[2 * n..]]))
    }

    fn csv(&self) -> String {
        let mut text = "t".to_owned();
        for quantity in ["q", "qd", "qdd"] {
            for i in 1..=self.joints.len() {
                let _ = write!(text, ",{quantity}{i}");
            }
        }
        text.push('\n');
        for (t, state) in self.states() {
            let _ = write!(text, "{t}");
            for value in state.into_iter().flatten() {
                let _ = write!(text, ",{value}");
            }
            text.push('\n');
        }
        text
    }

    fn joint_trajectory(&self) -> String {
        let points = self.states().map(|(t, [q, qd, qdd])| {
            let nanoseconds = (1e9 * t).round() as u64;
            let time = json!({ "sec": nanoseconds / 1_000_000_000, "nanosec": nanoseconds % 1_000_000_000 });
            json!({ "positions": q, "velocities": qd, "accelerations": qdd, "time_from_start": time })
        });
        let points: Vec<_> = points.collect();
        format!("{}\n", json!({ "joint_names": self.joints, "points": points }))
    }

    /// A slow `movej` to the beginning, then a `servoj` in every period of the controller.
    fn urscript(&self) -> String {
        let mut text = "def armid_motion():\n".to_owned();
        for (k, (_, [q, ..])) in self.states().enumerate() {
            let q: Vec<String> = q.iter().map(|value| format!("{value:.6}")).collect();
            let q = q.join(",");
            if k == 0 {
                let _ = writeln!(text, "  movej([{q}], a=0.3, v=0.2)");
            }
            let _ = writeln!(text, "  servoj([{q}], t={}, lookahead_time=0.03, gain=2000)", 1.0 / self.rate_hz);
        }
        text.push_str("  stopj(2)\nend\n");
        text
    }
}
