//! A robot as it was found: its value, its text, and what else is known about it.

use std::path::{Path, PathBuf};

use armid::model::format::{ChainEnds, RelativeUncertainty, parse_nominal, parse_robot};
use armid::model::{BundledRobot, Drive, EffortInterface, Robot, StandardParameters};
use armid::study::{Truth, truth_text};

use super::tree;
use crate::error::Error;
use crate::text::Text;

/// A robot, the text that it came from, and what else is known about it.
#[derive(Clone, Debug)]
pub struct LoadedRobot {
    /// The robot.
    pub robot: Robot,
    /// The file itself, and what it is called.
    pub text: Text,
    /// What an experimenter would guess: `nominal.toml`.
    pub nominal: Option<StandardParameters>,
    /// How good that guess is.
    pub uncertainty: Option<RelativeUncertainty>,
    /// Its text.
    pub nominal_text: Option<Text>,
    /// The inertias that the file itself holds: a URDF or MJCF.
    pub own: Option<StandardParameters>,
    /// What was read otherwise than it is written, a sentence each.
    pub remarks: Vec<String>,
    /// The chain that was read, where the text is a URDF.
    pub urdf: Option<ChainEnds>,
    /// Where the parameters are that a simulated arm is made of.
    truth: TruthSource,
}

#[derive(Clone, Debug)]
enum TruthSource {
    /// Compiled in, under this name.
    Bundled(&'static str),
    /// `truth.toml` in this folder.
    Folder(PathBuf),
    /// The file's own inertias.
    Own,
}

impl LoadedRobot {
    /// What is known without an experiment: the nominal parameters, or the inertias of the file itself.
    #[must_use]
    pub fn guess(&self) -> Option<&StandardParameters> {
        self.nominal.as_ref().or(self.own.as_ref())
    }

    /// What a simulated arm of this kind is made of. Nothing but a simulator may ask.
    ///
    /// # Errors
    /// [`Error`] where nothing says it, or what does cannot be read.
    pub fn truth(&self) -> Result<Truth, Error> {
        let text = match (&self.truth, &self.own) {
            (TruthSource::Own, Some(own)) => return Ok(Truth::of(own.clone())),
            (TruthSource::Bundled(name), _) => {
                let text = truth_text(name).unwrap_or_default();
                Text::new(format!("models/{name}/truth.toml"), text)
            }
            (TruthSource::Folder(folder), _) => {
                let path = folder.join("truth.toml");
                if !path.is_file() {
                    let message = format!("{} not found: a simulated arm is made of its parameters", path.display());
                    return Err(Error::unknown(message));
                }
                Text::read(&path)?
            }
            (TruthSource::Own, None) => {
                let message = format!("\"{}\" has no inertias to simulate with", self.robot.name());
                return Err(Error::new(message));
            }
        };
        Truth::from_toml(&text.content, &self.robot).map_err(|error| Error::of_format(&text, &error))
    }

    /// Torque follows from the efforts of a log: a robot from a URDF or MJCF says neither torque constants nor gears, and
    /// currents are no torques.
    ///
    /// # Errors
    /// [`Error`] where the efforts are currents and no drive has a torque constant. `name` is that of the log.
    pub(crate) fn check_constants(&self, effort: EffortInterface, name: &str) -> Result<(), Error> {
        let ideal = |drive: &Drive| drive.torque_constant == 1.0 && drive.gear == 1.0;
        if effort == EffortInterface::Torque
            || self.own.is_none()
            || !self.robot.joints().iter().all(|joint| ideal(&joint.drive))
        {
            return Ok(());
        }
        let message = format!(
            "{name} holds currents, and robot \"{}\" has neither torque constants nor gear ratios: torque cannot be computed",
            self.robot.name()
        );
        Err(Error::mismatch(message).help(
            "state them beside the columns: --map \"…, current=i_[1-6] constant=0.05 gear=100\" (N·m/A at the motor; values of \
             each joint with / between them)",
        ))
    }

    /// A robot that is compiled in.
    pub(super) fn bundled(entry: &BundledRobot) -> Result<Self, Error> {
        let text = Text::new(format!("models/{}/robot.toml", entry.name), entry.robot);
        let nominal = Text::new(format!("models/{}/nominal.toml", entry.name), entry.nominal);
        Self::of_texts(text, Some(nominal), TruthSource::Bundled(entry.name))
    }

    /// A robot file; `nominal.toml` and `truth.toml` lie beside it.
    pub(super) fn file(path: &Path) -> Result<Self, Error> {
        let text = Text::read(path)?;
        let folder = path.parent().map_or_else(|| PathBuf::from("."), Path::to_path_buf);
        let beside = folder.join("nominal.toml");
        let nominal = if beside.is_file() { Some(Text::read(&beside)?) } else { None };
        Self::of_texts(text, nominal, TruthSource::Folder(folder))
    }

    /// The robot that a recording holds: texts.
    pub(crate) fn recorded(name: &str, robot: &str, nominal: Option<&str>, chain: &ChainEnds) -> Result<Self, Error> {
        let text = Text::new(format!("{name} (robot file)"), robot);
        if robot.trim_start().starts_with('<') {
            return Self::tree(text, chain);
        }
        let nominal = nominal.map(|nominal| Text::new(format!("{name} (nominal file)"), nominal));
        Self::of_texts(text, nominal, TruthSource::Own)
    }

    /// The chain of a tree in XML.
    pub(super) fn tree(text: Text, chain: &ChainEnds) -> Result<Self, Error> {
        let model = tree::parse(&text, chain)?;
        let mut remarks = model.remarks;
        if !model.locked.is_empty() {
            remarks.push(format!("joints off the chain are held at zero: {}", model.locked.join(", ")));
        }
        let urdf = (!tree::is_mjcf(&text.content)).then(|| chain.clone());
        Ok(Self {
            robot: model.robot,
            urdf,
            text,
            nominal: None,
            uncertainty: None,
            nominal_text: None,
            own: Some(model.parameters),
            remarks,
            truth: TruthSource::Own,
        })
    }

    fn of_texts(text: Text, nominal_text: Option<Text>, truth: TruthSource) -> Result<Self, Error> {
        let robot = parse_robot(&text.content).map_err(|error| Error::of_format(&text, &error))?;
        let nominal = match &nominal_text {
            Some(text) => Some(parse_nominal(&text.content, &robot).map_err(|error| Error::of_format(text, &error))?),
            None => None,
        };
        Ok(Self {
            robot,
            text,
            uncertainty: nominal.as_ref().map(|nominal| nominal.relative_uncertainty.clone()),
            nominal: nominal.map(|nominal| nominal.parameters),
            nominal_text,
            own: None,
            remarks: Vec::new(),
            urdf: None,
            truth,
        })
    }
}
