//! A robot as it was found: its value, its text, and what else is known about it.

use std::path::{Path, PathBuf};

use armid::model::format::{
    ChainEnds, CollisionShape, RelativeUncertainty, RobotModel, embed_urdf, named_urdf, parse_nominal,
    parse_robot_model,
};
use armid::model::{BundledRobot, Drive, EffortInterface, Robot, StandardParameters};
use armid::remedy::{Remedy, Setting, Task};
use armid::study::{Truth, truth_text};

use super::held_shapes::{HeldShapes, hold};
use super::package_path::PackagePath;
use super::tree;
use crate::error::Error;
use crate::text::Text;

/// A robot, the text that it came from, and what else is known about it.
#[derive(Clone, Debug)]
pub struct LoadedRobot {
    /// The robot.
    pub robot: Robot,
    /// The file itself, and what it is called; a robot file over a URDF holds that file's text at its end.
    pub text: Text,
    /// What an experimenter would guess: `nominal.toml`.
    pub nominal: Option<StandardParameters>,
    /// How good that guess is.
    pub uncertainty: Option<RelativeUncertainty>,
    /// Its text.
    pub nominal_text: Option<Text>,
    /// The inertias that the file itself holds: a URDF or MJCF, or a robot file over a URDF.
    pub own: Option<StandardParameters>,
    /// What was read otherwise than it is written, a sentence each.
    pub remarks: Vec<String>,
    /// The URDF that it was read from, where it was.
    pub urdf: Option<ChainSource>,
    /// The MJCF that it was read from, where it was.
    pub mjcf: Option<ChainSource>,
    /// Collision shapes of that URDF; the robot has none of them unless [`Self::hold_collision_shapes`] gave them to it.
    pub collisions: Vec<CollisionShape>,
    /// The folder of the URDF, to which the files of meshes are relative; `None` where its text came with a recording.
    pub urdf_folder: Option<PathBuf>,
    /// Where the parameters are that a simulated arm is made of.
    truth: TruthSource,
}

/// A URDF or MJCF and the chain in it.
#[derive(Clone, Debug)]
pub struct ChainSource {
    /// The file.
    pub text: Text,
    /// Which chain was read.
    pub ends: ChainEnds,
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
    pub fn guess(&self) -> Option<&StandardParameters> {
        self.nominal.as_ref().or(self.own.as_ref())
    }

    /// What a simulated arm of this kind is made of. Nothing but a simulator may ask.
    ///
    /// # Errors
    /// [`Error`] where nothing says it, or what does cannot be read.
    pub fn truth(&self) -> Result<Truth, Error> {
        let Some(text) = self.truth_file()? else {
            return match (&self.own, &self.truth) {
                // What the URDF and the file itself state.
                (Some(own), _) => Ok(Truth::without_effects(own.clone())),
                (None, TruthSource::Folder(folder)) => {
                    let path = folder.join("truth.toml");
                    let message = format!("{} not found: a simulated arm is made of its parameters", path.display());
                    let help = Remedy::task(Task::Export, "E.json").option(Setting::To, "toml");
                    let help = help.option(Setting::Output, "truth.toml");
                    let help = help.say(" makes one of an estimate; a robot file over a URDF has its inertias");
                    Err(Error::unknown(message).help(help))
                }
                (None, _) => Err(Error::new(format!("\"{}\" has no inertias to simulate with", self.robot.name()))),
            };
        };
        Truth::from_toml(&text.content, &self.robot).map_err(|error| Error::of_format(&text, &error))
    }

    /// The file of those parameters, where there is one.
    pub(super) fn truth_file(&self) -> Result<Option<Text>, Error> {
        match &self.truth {
            TruthSource::Bundled(name) => {
                Ok(Some(Text::new(format!("models/{name}/truth.toml"), truth_text(name).unwrap_or_default())))
            }
            TruthSource::Folder(folder) => {
                let path = folder.join("truth.toml");
                path.is_file().then(|| Text::read(&path)).transpose()
            }
            TruthSource::Own => Ok(None),
        }
    }

    /// Gives the robot the collision shapes of its URDF, so that clearances are held against them: boxes, balls and capsules as
    /// they are, cylinders and the hulls of meshes within the margin of a [`Hull`](armid::model::Hull). Files of meshes are
    /// found by `packages`. A shape that cannot be had is left out with its reason. Pairs of links that come within
    /// `clearance` (m) in nearly every posture ([`armid::excitation::clearance::touching_links`]) may touch.
    ///
    /// # Errors
    /// [`Error`] where there are too many shapes, or one is not possible.
    pub fn hold_collision_shapes(&mut self, packages: &PackagePath, clearance: f64) -> Result<HeldShapes, Error> {
        let folder = self.urdf_folder.as_deref();
        let (robot, held) = hold(&self.robot, &self.collisions, packages, folder, clearance)?;
        self.robot = robot;
        Ok(held)
    }

    /// Torque follows from the efforts of a log: a robot from a URDF or MJCF says neither torque constants nor gears, and
    /// currents are no torques.
    ///
    /// # Errors
    /// [`Error`] where the efforts are currents and a drive has no torque constant. `name` is that of the log, `mapping` one that
    /// states constants beside its columns.
    pub(crate) fn check_constants(
        &self,
        effort: EffortInterface,
        name: &str,
        mapping: Option<&str>,
    ) -> Result<(), Error> {
        // A file that says "torque" may leave the constant out: one N·m at the joint for each A is none.
        let lacks = |drive: &Drive| (drive.torque_per_ampere() - 1.0).abs() < 1e-12;
        let lacking = self.robot.joints().iter().filter(|joint| lacks(&joint.drive));
        let lacking: Vec<&str> = lacking.map(|joint| joint.name.as_str()).collect();
        if effort == EffortInterface::Torque || self.own.is_none() || lacking.is_empty() {
            return Ok(());
        }
        let robot = self.robot.name();
        let message = if lacking.len() == self.robot.dof() {
            format!(
                "{name} holds currents, and robot \"{robot}\" has neither torque constants nor gear ratios: torque cannot be \
                 computed"
            )
        } else {
            format!(
                "{name} holds currents, and robot \"{robot}\" has no torque constant of the joints {}: torque cannot be computed",
                lacking.join(", ")
            )
        };
        let mapping = mapping.unwrap_or("…, current=i_[1-6] constant=0.05 gear=100");
        let help = Remedy::from("state them beside the columns: ").assign(Setting::Map, mapping);
        let words =
            " (N·m/A at the motor, turns of the motor; values of each joint with / between them), or in a robot file: ";
        let help = help.say(words).perform(Task::Robot, "arm.urdf").option(Setting::Output, "robot.toml");
        let help = help.say(" begins one");
        Err(Error::mismatch(message).help(help))
    }

    /// A robot that is compiled in.
    pub(super) fn bundled(entry: &BundledRobot) -> Result<Self, Error> {
        let text = Text::new(format!("models/{}/robot.toml", entry.name), entry.robot);
        let nominal = Text::new(format!("models/{}/nominal.toml", entry.name), entry.nominal);
        Self::of_texts(text, Some(nominal), TruthSource::Bundled(entry.name), None)
    }

    /// A robot file; `nominal.toml` and `truth.toml` lie beside it.
    pub(super) fn file(path: &Path) -> Result<Self, Error> {
        let text = Text::read(path)?;
        let folder = path.parent().map_or_else(|| PathBuf::from("."), Path::to_path_buf);
        let (text, urdf_folder) = with_urdf(text, &folder)?;
        let beside = folder.join("nominal.toml");
        let nominal = if beside.is_file() { Some(Text::read(&beside)?) } else { None };
        Self::of_texts(text, nominal, TruthSource::Folder(folder), urdf_folder)
    }

    /// The robot that a recording holds: texts.
    pub(crate) fn recorded(name: &str, robot: &str, nominal: Option<&str>, chain: &ChainEnds) -> Result<Self, Error> {
        let text = Text::new(format!("{name} (robot file)"), robot);
        if robot.trim_start().starts_with('<') {
            return Self::tree(text, chain, None);
        }
        let nominal = nominal.map(|nominal| Text::new(format!("{name} (nominal file)"), nominal));
        Self::of_texts(text, nominal, TruthSource::Own, None)
    }

    /// The chain of a tree in XML, whose file lies in `folder`.
    pub(super) fn tree(text: Text, chain: &ChainEnds, folder: Option<PathBuf>) -> Result<Self, Error> {
        let model = tree::parse(&text, chain)?;
        let mut remarks = model.remarks;
        if !model.locked.is_empty() {
            remarks.push(held(&model.locked));
        }
        let source = ChainSource { text: text.clone(), ends: chain.clone() };
        let (urdf, mjcf) = if tree::is_mjcf(&text.content) { (None, Some(source)) } else { (Some(source), None) };
        Ok(Self {
            robot: model.robot,
            urdf,
            mjcf,
            text,
            nominal: None,
            uncertainty: None,
            nominal_text: None,
            own: Some(model.parameters),
            remarks,
            collisions: model.collisions,
            urdf_folder: folder,
            truth: TruthSource::Own,
        })
    }

    fn of_texts(
        text: Text,
        nominal_text: Option<Text>,
        truth: TruthSource,
        urdf_folder: Option<PathBuf>,
    ) -> Result<Self, Error> {
        let read = parse_robot_model(&text.content).map_err(|error| Error::of_format(&text, &error))?;
        let RobotModel { robot, parameters: own, locked, collisions, mut remarks } = read;
        if !locked.is_empty() {
            remarks.push(held(&locked));
        }
        let reference = named_urdf(&text.content).map_err(|error| Error::of_format(&text, &error))?;
        let urdf = reference.and_then(|reference| {
            let (name, ends) = (reference.path, reference.ends);
            reference.text.map(|content| ChainSource { text: Text::new(name, content), ends })
        });
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
            own,
            remarks,
            urdf,
            mjcf: None,
            collisions,
            urdf_folder,
            truth,
        })
    }
}

/// A sentence on joints that do not move.
fn held(locked: &[String]) -> String {
    format!("joints off the chain are held at zero: {}", locked.join(", "))
}

/// A robot file with the URDF that it names, which lies relative to `folder`, and the folder of that.
fn with_urdf(text: Text, folder: &Path) -> Result<(Text, Option<PathBuf>), Error> {
    let reference = named_urdf(&text.content).map_err(|error| Error::of_format(&text, &error))?;
    let Some(reference) = reference.filter(|reference| reference.text.is_none()) else { return Ok((text, None)) };
    let path = folder.join(&reference.path);
    if !path.is_file() {
        let message = format!("URDF not found: {}", path.display());
        let help = "urdf is a path relative to the robot file";
        return Err(Error::unknown(message).help(help).at_span(&text, reference.span, "here"));
    }
    let urdf = Text::read(&path)?;
    // A fault in the URDF is shown there.
    tree::parse(&urdf, &reference.ends)?;
    let whole = Text::new(&text.name, embed_urdf(&text.content, &urdf.content));
    Ok((whole, path.parent().map(Path::to_path_buf)))
}
