//! What to try after an error.

use super::Command;

impl Command {
    /// The commands that help on, where an error names none itself.
    pub(crate) const fn next_step(&self) -> &'static str {
        match self {
            Self::Robot(_) => "`armid robot` lists the bundled robots, `armid robot crs-a460` describes one",
            Self::Advise(_) => "`armid robot ROBOT` checks the robot alone, `armid advise --help` shows examples",
            Self::Campaign(_) => "`armid robot ROBOT` checks the robot alone, `armid campaign --help` shows examples",
            Self::Init(_) => "`armid robot ROBOT` checks the robot alone, `armid init --help` shows examples",
            Self::Agree(_) => "`armid robot ROBOT` checks the robot alone, `armid doctor` says which engines are here",
            Self::Reduce(_) => "`armid robot ROBOT` checks the robot alone, `armid reduce --help` shows examples",
            Self::Dynamics(_) => "`armid robot ROBOT` checks the robot alone, `armid dynamics --help` shows examples",
            Self::Design(_) => "`armid robot ROBOT` checks the robot alone, `armid design --help` shows examples",
            Self::Trajectory(_) => {
                "`armid design ROBOT --criterion d-optimal -o T.toml` makes a trajectory, `armid trajectory sample --help` shows examples"
            }
            Self::Run(_) => {
                "`armid init ROBOT` makes an experiment to begin with, `armid doctor` says which arms are here"
            }
            Self::Calibrate(_) => "`armid robot ROBOT` checks the robot alone, `armid calibrate --help` shows examples",
            Self::Monitor(_) => "`armid run EXPERIMENT` checks and performs it, `armid monitor --help` shows examples",
            Self::Identify(_) => {
                "`armid init ROBOT` makes a folder with a mapping for logs, `armid identify --help` shows examples"
            }
            Self::Validate(_) => {
                "`armid identify LOG -o E.json` makes an estimate, `armid validate --help` shows examples"
            }
            Self::Export(_) => "`armid identify LOG -o E.json` makes an estimate, `armid export --help` shows examples",
            Self::Study(_) => {
                "`armid study STUDY --runs 1` performs a small study, `armid study --help` shows examples"
            }
            Self::Report(_) => {
                "`armid identify LOG -o E.json` makes an estimate, `armid study STUDY -o DIR` results, `armid report --help` shows examples"
            }
            Self::Controller(_) => {
                "`armid robot ROBOT` checks the robot alone, `armid controller --help` shows examples"
            }
            Self::Doctor(_) => "`armid doctor --help` says what is looked at",
            Self::Completions(_) => "`armid completions --help` lists the shells",
            Self::Topic(_) => "`armid --help` lists the commands",
        }
    }
}
