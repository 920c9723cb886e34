//! ROBOT on the command line: a bundled name, a robot file, or a chain in a URDF or MJCF tree.

use std::path::{Path, PathBuf};

use armid::model::format::{
    ChainEnds, FormatError, RelativeUncertainty, parse_mjcf, parse_nominal, parse_robot, parse_urdf,
};
use armid::model::{Robot, StandardParameters, bundled};
use armid::study::{Truth, truth_text};
use miette::Result;

use crate::atomic_file::read_text;
use crate::fault::{Fault, Text};
use crate::files::log::RecordedRobot;
use crate::suggestion;

/// Which robot.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct RobotArguments {
    /// A bundled name (`armid robot` lists them), a robot.toml, a .urdf or an MJCF .xml file
    pub(crate) robot: String,
    #[command(flatten)]
    pub(crate) chain: ChainArguments,
}

/// Which chain of a tree.
#[derive(Clone, Debug, Default, clap::Args)]
pub(crate) struct ChainArguments {
    /// Link at which the chain begins, in a URDF or MJCF tree
    #[arg(long, value_name = "LINK")]
    pub(crate) base_link: Option<String>,
    /// Link at which the chain ends, in a URDF or MJCF tree
    #[arg(long, value_name = "LINK")]
    pub(crate) tip_link: Option<String>,
}

/// A robot, the text that it came from, and what else is known about it.
#[derive(Clone, Debug)]
pub(crate) struct LoadedRobot {
    pub(crate) robot: Robot,
    /// The file itself, and what it is called.
    pub(crate) text: Text,
    /// What an experimenter would guess: `nominal.toml`.
    pub(crate) nominal: Option<StandardParameters>,
    /// How good that guess is.
    pub(crate) uncertainty: Option<RelativeUncertainty>,
    /// Its text.
    pub(crate) nominal_text: Option<Text>,
    /// The inertias that the file itself holds: a URDF or MJCF.
    pub(crate) own: Option<StandardParameters>,
    /// What was read otherwise than it is written, a sentence each.
    pub(crate) remarks: Vec<String>,
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
    /// What a simulated arm of this kind is made of. Nothing but a simulator may ask.
    pub(crate) fn truth(&self) -> Result<Truth> {
        let text = match (&self.truth, &self.own) {
            (TruthSource::Own, Some(own)) => return Ok(Truth::of(own.clone())),
            (TruthSource::Bundled(name), _) => {
                let text = truth_text(name).unwrap_or_default();
                Text::new(format!("models/{name}/truth.toml"), text)
            }
            (TruthSource::Folder(folder), _) => {
                let path = folder.join("truth.toml");
                if !path.is_file() {
                    let message = format!("{} is not there: a simulated arm is made of its parameters", path.display());
                    return Err(Fault::new(message).into());
                }
                read_text(&path)?
            }
            (TruthSource::Own, None) => {
                let message = format!("\"{}\" has no inertias to simulate with", self.robot.name());
                return Err(Fault::new(message).into());
            }
        };
        Ok(Truth::from_toml(&text.content, &self.robot).map_err(|fault| located(&text, &fault))?)
    }
}

impl RobotArguments {
    pub(crate) fn load(&self) -> Result<LoadedRobot> {
        load(&self.robot, &self.chain, None)
    }
}

/// Finds and reads a robot. Relative paths begin at `beside`, the folder of the file that names the robot.
pub(crate) fn load(name: &str, chain: &ChainArguments, beside: Option<&Path>) -> Result<LoadedRobot> {
    if let Some(entry) = bundled().iter().find(|entry| entry.name == name) {
        no_chain(chain, name)?;
        let text = Text::new(format!("models/{name}/robot.toml"), entry.robot);
        let robot = parse_robot(entry.robot).map_err(|fault| located(&text, &fault))?;
        let nominal_text = Text::new(format!("models/{name}/nominal.toml"), entry.nominal);
        let nominal = parse_nominal(entry.nominal, &robot).map_err(|fault| located(&nominal_text, &fault))?;
        return Ok(LoadedRobot {
            robot,
            text,
            nominal: Some(nominal.parameters),
            uncertainty: Some(nominal.relative_uncertainty),
            nominal_text: Some(nominal_text),
            own: None,
            remarks: Vec::new(),
            truth: TruthSource::Bundled(entry.name),
        });
    }
    let path = beside.map_or_else(|| PathBuf::from(name), |folder| folder.join(name));
    if !path.exists() {
        return Err(unknown(name, &path).into());
    }
    let path = if path.is_dir() { path.join("robot.toml") } else { path };
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("toml") => {
            no_chain(chain, name)?;
            load_toml(&path)
        }
        Some("urdf" | "xml") => tree(read_text(&path)?, chain),
        other => Err(Fault::new(format!(
            "{}: found a file ending in \"{}\", expected .toml, .urdf or .xml",
            path.display(),
            other.unwrap_or_default()
        ))
        .into()),
    }
}

fn load_toml(path: &Path) -> Result<LoadedRobot> {
    let text = read_text(path)?;
    let robot = parse_robot(&text.content).map_err(|fault| located(&text, &fault))?;
    let folder = path.parent().map_or_else(|| PathBuf::from("."), Path::to_path_buf);
    let beside = folder.join("nominal.toml");
    let nominal_text = if beside.is_file() { Some(read_text(&beside)?) } else { None };
    let nominal = match &nominal_text {
        Some(text) => Some(parse_nominal(&text.content, &robot).map_err(|fault| located(text, &fault))?),
        None => None,
    };
    Ok(LoadedRobot {
        robot,
        text,
        uncertainty: nominal.as_ref().map(|nominal| nominal.relative_uncertainty),
        nominal: nominal.map(|nominal| nominal.parameters),
        own: None,
        remarks: Vec::new(),
        truth: TruthSource::Folder(folder),
        nominal_text,
    })
}

/// The chain of a tree in XML.
fn tree(text: Text, chain: &ChainArguments) -> Result<LoadedRobot> {
    let ends = ChainEnds { base: chain.base_link.clone(), tip: chain.tip_link.clone() };
    let parse = if is_mjcf(&text.content) { parse_mjcf } else { parse_urdf };
    let model = parse(&text.content, &ends).map_err(|fault| located(&text, &fault))?;
    let mut remarks = model.remarks;
    if !model.locked.is_empty() {
        remarks.push(format!("joints off the chain are held at zero: {}", model.locked.join(", ")));
    }
    let own = Some(model.parameters);
    Ok(LoadedRobot {
        robot: model.robot,
        text,
        nominal: None,
        uncertainty: None,
        nominal_text: None,
        own,
        remarks,
        truth: TruthSource::Own,
    })
}

/// Is the first element, past declarations and comments, MuJoCo's?
fn is_mjcf(text: &str) -> bool {
    let mut rest = text.trim_start_matches('\u{feff}').trim_start();
    loop {
        let end = if rest.starts_with("<!--") {
            "-->"
        } else if rest.starts_with("<?") || rest.starts_with("<!") {
            ">"
        } else {
            return rest.starts_with("<mujoco");
        };
        let Some(at) = rest.find(end) else { return false };
        rest = rest[at + end.len()..].trim_start();
    }
}

/// The robot that a recording holds.
pub(crate) fn of_recording(name: &str, recorded: &RecordedRobot) -> Result<LoadedRobot> {
    let text = Text::new(format!("{name} (robot file)"), recorded.text.as_str());
    if recorded.text.trim_start().starts_with('<') {
        return tree(text, &recorded.chain);
    }
    let robot = parse_robot(&text.content).map_err(|fault| located(&text, &fault))?;
    let nominal_text = recorded.nominal.as_deref().map(|nominal| Text::new(format!("{name} (nominal file)"), nominal));
    let nominal = match &nominal_text {
        Some(text) => Some(parse_nominal(&text.content, &robot).map_err(|fault| located(text, &fault))?),
        None => None,
    };
    Ok(LoadedRobot {
        robot,
        text,
        uncertainty: nominal.as_ref().map(|nominal| nominal.relative_uncertainty),
        nominal: nominal.map(|nominal| nominal.parameters),
        nominal_text,
        own: None,
        remarks: Vec::new(),
        truth: TruthSource::Own,
    })
}

/// A fault of one of the library's text formats, shown in the text.
pub(crate) fn located(text: &Text, fault: &FormatError) -> Fault {
    let shown = Fault::new(&fault.message).maybe_help(suggestion::from_list_in(&fault.message));
    match &fault.span {
        Some(span) => shown.at(text, span.clone(), "here"),
        None => shown.at_line(text, fault.line, fault.column),
    }
}

fn no_chain(chain: &ChainArguments, name: &str) -> Result<()> {
    let given = [("--base-link", &chain.base_link), ("--tip-link", &chain.tip_link)];
    match given.iter().find(|(_, link)| link.is_some()) {
        Some((option, _)) => {
            let message =
                format!("{option} chooses a chain in a URDF or MJCF tree; \"{name}\" is a serial chain already");
            Err(Fault::new(message).into())
        }
        None => Ok(()),
    }
}

fn unknown(name: &str, path: &Path) -> Fault {
    let names: Vec<&str> = bundled().iter().map(|entry| entry.name).collect();
    let looks_like_path = name.contains(['/', '\\']) || path.extension().is_some();
    if looks_like_path {
        Fault::new(format!("robot file {} is not there", path.display()))
            .help(format!("bundled robots: {}", names.join(", ")))
    } else {
        Fault::new(format!("robot \"{name}\" is neither a bundled robot nor a file"))
            .help(suggestion::help(name, &names))
    }
}

#[cfg(test)]
mod tests {
    use super::is_mjcf;

    #[test]
    fn the_first_element_decides() {
        assert!(is_mjcf("<mujoco model=\"arm\"/>"));
        assert!(is_mjcf("\u{feff}<?xml version=\"1.0\"?>\n<!-- <robot> -->\n<mujoco/>"));
        assert!(!is_mjcf("<?xml version=\"1.0\"?><!-- <mujoco> --><robot name=\"arm\"/>"));
        assert!(!is_mjcf("<!-- never closed <mujoco>"));
    }
}
