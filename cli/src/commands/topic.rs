//! Help on what several commands share: `armid help map`.

use miette::Result;
use serde_json::json;

use crate::terminal::{Answer, Console, Ending};

const MAP: &str = "\
Each part of --map names a quantity, its columns and their unit:

  --map \"t=time ms, q=joint_[1-6] deg, current=i_[1-6] mA constant=0.05\"

Quantities:
  t          time
  q          positions
  q_link     positions behind the transmissions
  qd         velocities
  tau        torques, or forces
  current    motor currents
  q_cmd      commanded positions of servos without torque, with their gains

Columns:
  joint_[1-6]       headings with a number for each joint; [01-06] with leading zeros
  #[2-7]            columns by number
  base/elbow/#3     a list
  tau_1/-/tau_3     without the torque of a joint whose position stays
  pos:j[1-6]        columns of one of several files; pos_*:j[1-6] if each log has its own

Units and scales, of all joints or a list with / between them:
  deg, ms, mA, %    unit of the columns
  motor, gear=100   values at the motors, and the gear ratios
  sign=-            reversed; sign=+/-/+ for some joints
  offset_deg=0/90   zero positions
  constant=0.05     torque constants of currents, N·m/A
  rated=2.1         rated torques of values in %
  kp=40 kd=1        gains of servos: torque is kp (q_cmd - q) - kd qd
  delay_ms=4        time after which a command acts
  unknown=delay/kp2 numbers that --estimator cloe finds; kd1, zero1 too

For ROS 2 joint states the names of joints replace the headings, without t.
topic=/arm/joint_states chooses a topic.";

const LIMITS: &str = "\
A design keeps all limits at every instant, also between samples and on ramps:

  position         less --margin: the soft limits of the guard of a real arm,
                   and a degree for the servo; the guard's metres if prismatic
  velocity, acceleration, jerk
  torque, current  peak and RMS, at each instant with probability --confidence
                   by the uncertainty of the nominal parameters; 0.5 uses the
                   nominal parameters alone; without an uncertainty nine tenths
  distance         --clearance between shapes, and to obstacles; cylinders and
                   meshes are replaced by their hulls

If no start keeps all limits, the nearest is written, its excess is reported,
and the exit status is 1. Figures with the suffix _all are those of the chosen
columns, those without it of the rigid base columns.";

/// A page of help.
#[derive(Debug, clap::Subcommand)]
pub(crate) enum Topic {
    /// Columns of a log and their units
    #[command(hide = true, override_help = MAP)]
    Map,
    /// Limits of a design
    #[command(hide = true, override_help = LIMITS)]
    Limits,
}

pub(crate) fn run(topic: &Topic, console: &Console) -> Result<Ending> {
    let text = match topic {
        Topic::Map => MAP,
        Topic::Limits => LIMITS,
    };
    console.show(&Answer { text: format!("{text}\n"), json: json!({ "help": text }) })?;
    Ok(Ending::Done)
}
