//! A folder to begin with: a robot file over a URDF, an experiment, a log's columns, and what to do next.

use std::path::{Path, PathBuf};

use armid::model::DriveKind;
use armid::model::format::ChainEnds;
use armid::model::{Joint, JointKind};
use armid::remedy::{Remedy, Setting, Task};
use armid::study::{AdvicePlan, Purpose};

use crate::error::Error;
use crate::output::{make_folder, write_text};
use crate::robot::{self, LoadedRobot};
use crate::text::Text;

/// Period of the motion that is designed, s.
const PERIOD_S: u32 = 10;
/// Its harmonics.
const HARMONICS: u32 = 5;

/// The files of such a folder, each with its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Starter {
    files: Vec<(String, String)>,
    /// The URDF, which is copied unless it is in the folder already.
    urdf: PathBuf,
}

impl Starter {
    /// The files for a URDF; `ends` choose the chain.
    ///
    /// # Errors
    /// [`Error`] where the URDF cannot be read, or is none.
    pub fn of_urdf(urdf: &Path, ends: &ChainEnds) -> Result<Self, Error> {
        let Some(name) = urdf.file_name().and_then(|name| name.to_str()) else {
            return Err(Error::new(format!("{} is no file with a name in UTF-8, expected a URDF", urdf.display())));
        };
        let text = Text::read(urdf)?;
        let path = urdf.display().to_string();
        let loaded = robot::load(&path, ends, None)?;
        // Beside the copy, whatever folder that is in.
        let robot_file = robot::begin(urdf, ends, &urdf.with_file_name("robot.toml"))?;
        let files = vec![
            (name.to_owned(), text.content.to_string()),
            ("robot.toml".to_owned(), robot_file),
            ("experiment.toml".to_owned(), experiment(&loaded)),
            ("study.toml".to_owned(), study()),
            ("log.toml".to_owned(), log(&loaded)),
            ("README.md".to_owned(), readme(&loaded, name)),
        ];
        Ok(Self { files, urdf: urdf.to_path_buf() })
    }

    /// Names of the files.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.files.iter().map(|(name, _)| name.as_str())
    }

    /// Writes the files into a folder, which is made where it is not there. Nothing that is there is written over; where one
    /// file cannot be written, those before it are taken away again.
    ///
    /// # Errors
    /// [`Error`] where one of the files is there already, or cannot be written.
    pub fn write(&self, folder: &Path) -> Result<Vec<PathBuf>, Error> {
        let places: Vec<PathBuf> = self.files.iter().map(|(name, _)| folder.join(name)).collect();
        let is_urdf = |place: &Path| match (place.canonicalize(), self.urdf.canonicalize()) {
            (Ok(place), Ok(urdf)) => place == urdf,
            _ => false,
        };
        let there: Vec<&PathBuf> = places.iter().filter(|place| place.exists() && !is_urdf(place)).collect();
        if let Some(first) = there.first() {
            let message =
                format!("{} is there already, expected a folder without it: nothing is written over", first.display());
            return Err(
                Error::new(message).help(Remedy::default().setting(Setting::Output).say(" chooses another folder"))
            );
        }
        make_folder(folder).map_err(|error| Error::unwritable(folder, &error))?;
        let mut written: Vec<PathBuf> = Vec::new();
        for (place, (_, text)) in places.into_iter().zip(&self.files) {
            if is_urdf(&place) {
                continue;
            }
            if let Err(error) = write_text(&place, text) {
                for place in &written {
                    // The first error is the one to report.
                    let _ = std::fs::remove_file(place);
                }
                return Err(error);
            }
            written.push(place);
        }
        Ok(written)
    }
}

/// The joints that nothing bounds: a design needs their limits.
fn without_bounds(loaded: &LoadedRobot) -> Vec<&str> {
    let lacks = |joint: &&Joint| joint.limits.velocity.is_infinite();
    loaded.robot.joints().iter().filter(lacks).map(|joint| joint.name.as_str()).collect()
}

fn experiment(loaded: &LoadedRobot) -> String {
    format!(
        "# The motion that excites {name}, and how it is performed: rehearsed on a simulated arm with the inertias of the\n\
         # URDF, or by the arm itself, arm = \"ros2\".\n\
         name = \"excitation\"\nrobot = \"robot.toml\"\ntrajectory = \"trajectory.toml\"   # of a design\n\
         rate_hz = 500                    # samples per second\n\
         periods = 5                      # that count, after one that does not; each takes {PERIOD_S} s\n",
        name = loaded.robot.name()
    )
}

/// Which motion and estimator, over arms around this one: what advice performs, to change and run.
fn study() -> String {
    let robot = "robot.toml".to_owned();
    let (drive, purpose) = (DriveKind::Harmonic, Purpose::Torque);
    AdvicePlan { robot, drive, purpose, periods: 5, rate_hz: 500.0, shown: Vec::new(), arms: 6, seed: 1 }.text()
}

fn log(loaded: &LoadedRobot) -> String {
    let n = loaded.robot.dof();
    let revolute = loaded.robot.joints().iter().all(|joint| joint.kind == JointKind::Revolute);
    let degrees = if revolute { "deg where in degrees; " } else { "" };
    format!(
        "# What the columns of the log are. As it stands: those of a run into log.csv. For the log of the arm, put its\n\
         # headings here: [1-{n}] stands for the numbers of the joints, #2 for the second column of a table without headings.\n\
         [log]\nfiles = [\"log.csv\"]              # several stand side by side: q = \"positions:j[1-{n}]\"\n\
         robot = \"robot.toml\"\n\
         # rate_hz = 500                  # rows per second, where there is no column of times\n\
         # period_s = {PERIOD_S}                  # where the motion repeats; found in the log by default\n\
         t = \"t\"                          # \"time_ms ms\" where in milliseconds\n\
         q = \"q[1-{n}]\"                     # {degrees}motor gear=100/… where at the motors; sign=- or sign=+-…\n\
         tau = \"tau[1-{n}]\"                 # N·m at the joints; or current = \"i[1-{n}] mA constant=0.1 gear=100\"\n"
    )
}

fn readme(loaded: &LoadedRobot, urdf: &str) -> String {
    let name = loaded.robot.name();
    let gaps = match without_bounds(loaded).as_slice() {
        [] => String::new(),
        joints => format!(
            "\nBefore the first command: the URDF states no largest speed of {}. `velocity_deg_s` in robot.toml does.\n",
            joints.join(", ")
        ),
    };
    let line = |task: Task, of: &str, settings: &[(Setting, &str)]| {
        let task = settings.iter().fold(Remedy::task(task, of), |task, (setting, value)| task.option(*setting, value));
        task.to_string().trim_matches('`').to_owned()
    };
    let run = |settings: &[(Setting, &str)]| line(Task::Run, "experiment.toml", settings);
    let export = |to, file| line(Task::Export, "E.json", &[(Setting::To, to), (Setting::Output, file)]);
    let design = [
        (Setting::Criterion, "d-optimal"),
        (Setting::Period, &PERIOD_S.to_string()),
        (Setting::Harmonics, &HARMONICS.to_string()),
        (Setting::Starts, "4"),
        (Setting::Output, "trajectory.toml"),
    ];
    let first = [
        line(Task::Design, "robot.toml", &design),
        run(&[(Setting::Output, "log.csv")]),
        line(Task::Identify, "log.toml", &[(Setting::Output, "E.json")]),
    ];
    let then = [
        run(&[(Setting::Seed, "2"), (Setting::Output, "other.csv")]),
        line(Task::Validate, "E.json other.csv", &[]),
        line(Task::Report, "E.json", &[(Setting::Output, "report")]),
        export("urdf", "identified.urdf"),
        export("c", "identified.c"),
    ];
    format!(
        "# {name}\n\nMade by {init} from {urdf}. First fill in the gaps of `robot.toml` that matter, and check it by {check}. \
         The next three commands, in this folder:\n{gaps}\n\
         ```sh\n{first}\n```\n\n\
         1. designs a motion that excites the parameters inside the limits of `robot.toml`, in seconds. {advise} takes \
            minutes: it compares motions and estimators on simulated arms around this one, and writes the best motion with \
            its experiment;\n\
         2. rehearses it on a simulated arm. The arm itself performs `trajectory.toml` by its own means, or by ROS 2:\n   \
            its log then takes the place of `log.csv`, and `log.toml` says what the columns are;\n\
         3. estimates the parameters, with intervals, and says what it found in the log.\n\n\
         | file | says |\n|---|---|\n\
         | `{urdf}` | kinematics, limits, nominal inertias |\n\
         | `robot.toml` | what the URDF has no place for: each line `# key = ?` is a gap |\n\
         | `experiment.toml` | how often and how fast the motion is sampled |\n\
         | `log.toml` | what the columns of the log are |\n\
         | `study.toml` | a study of motions and estimators on arms around this one, for when no gap is left in `robot.toml` |\n\n\
         Afterwards:\n\n\
         ```sh\n{then}\n```\n",
        check = Remedy::task(Task::Robot, "robot.toml"),
        advise = Remedy::task(Task::Advise, "robot.toml").option(Setting::Output, "advice"),
        init = Remedy::task(Task::Init, ""),
        first = first.join("\n"),
        then = then.join("\n"),
    )
}
