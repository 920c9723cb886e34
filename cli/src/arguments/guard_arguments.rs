//! The guard on the command line: its options, and how an arm is put behind it.

use std::io::{IsTerminal, Write};
use std::path::PathBuf;

use armid_hardware::guard::Confirmation;
use armid_io::Error as Fault;
use miette::Result;

use crate::arms::Speed;

/// Options of the guard.
#[derive(Clone, Debug, Default, clap::Args)]
pub(crate) struct GuardArguments {
    /// Guard a simulated arm too; a real one always is guarded
    #[arg(long)]
    pub(crate) guard: bool,
    /// Share of the designed speed, such as 10%, on the same path
    #[arg(long, value_name = "PERCENT")]
    pub(crate) speed: Option<Speed>,
    /// Limit the speed of flange and [[point]]s, mm/s; not safety-rated
    #[arg(long, value_name = "MM_S", num_args = 0..=1, default_missing_value = "250")]
    pub(crate) reduced_speed: Option<f64>,
    /// Perform the motion at 10, 50 and 100 % of its speed
    #[arg(long, conflicts_with = "speed")]
    pub(crate) first_run: bool,
    /// Recordings of this motion on the real arm at lower speed
    #[arg(long, value_name = "R.mcap", num_args = 1..)]
    pub(crate) earlier: Vec<PathBuf>,
    /// Confirm: emergency stop works, arm is homed, nobody is near
    #[arg(long)]
    pub(crate) yes_the_estop_works: bool,
}

impl GuardArguments {
    /// The speeds to go through, in order.
    pub(crate) fn speeds(&self) -> Vec<Speed> {
        if self.first_run { Speed::STEPS.to_vec() } else { vec![self.speed.unwrap_or(Speed::FULL)] }
    }

    /// The operator's confirmation that a robot may move.
    pub(crate) fn confirmation(&self, robot: &str) -> Result<Confirmation> {
        if self.yes_the_estop_works {
            return Ok(Confirmation::on_the_command_line());
        }
        let help = "type the robot's name at a terminal, or give --yes-the-estop-works";
        let unconfirmed = |message: String| Fault::new(message).help(help);
        if !(std::io::stdin().is_terminal() && std::io::stderr().is_terminal()) {
            return Err(unconfirmed("no operator confirmed that the emergency stop works".to_owned()).into());
        }
        let mut answer = String::new();
        let asked = write!(std::io::stderr(), "{}", Confirmation::question(robot))
            .and_then(|()| std::io::stderr().flush())
            .and_then(|()| std::io::stdin().read_line(&mut answer));
        asked.map_err(|error| unconfirmed(format!("the operator could not be asked: {error}")))?;
        Confirmation::typed(robot, &answer)
            .ok_or_else(|| unconfirmed(format!("found \"{}\", expected \"{robot}\"", answer.trim())).into())
    }
}
