//! A model as a Python file: its parameters as a dict, and the code that a simulator calls.
//!
//! The dict is also JSON, so that the file is read back without Python.

use armid::model::{Joint, Limits, ParameterId, ParameterKind, Robot, StandardParameters};
use armid_io::Error;

/// Joint friction of every identified law, for a simulator's step.
const FRICTION: &str = include_str!("friction.py");

/// Actuators of Isaac Lab.
const ISAAC: &str = include_str!("isaac.py");

/// Terms that the code of [`FRICTION`] computes, by their symbols; a rotor inertia is a simulator's own.
const LAWS: [&str; 10] = ["Ia", "Fv", "Fc", "Fo", "Fs", "Fl", "Fd", "Fq", "Fpc", "Fps"];

/// What stands before the dict and after it, and before and after the MJCF.
const OPENING: &str = "PARAMETERS = ";
const CLOSING: &str = "\n\n";
const MJCF: &str = "MJCF = r'''";
const MJCF_END: &str = "'''";

/// The file's text, for a simulator with this `name`; `map` is the JSON object of the parameters, `mjcf` the arm without friction,
/// for a file that applies it.
///
/// # Errors
/// [`Error`] where a parameter acts through a term that the file has no code for.
pub(super) fn write(
    name: &str,
    robot: &Robot,
    parameters: &StandardParameters,
    (map, mjcf): (&str, Option<&str>),
    header: &str,
) -> Result<String, Error> {
    for (index, drive) in parameters.drives.iter().enumerate() {
        for (term, value) in drive.iter() {
            if value != 0.0 && !LAWS.contains(&term.entry().symbol) {
                let id = ParameterId { kind: ParameterKind::Term(term), index };
                let what = term.entry().meaning;
                return Err(Error::new(format!("{name} has no place for {id}, {what}")));
            }
        }
    }
    let names: Vec<&str> = robot.joints().iter().map(|joint| joint.name.as_str()).collect();
    let limit = |of: fn(&Limits) -> f64| {
        let literal = |joint: &Joint| {
            let value = of(&joint.limits);
            if value.is_finite() { format!("{value:?}") } else { "None".to_owned() }
        };
        robot.joints().iter().map(literal).collect::<Vec<_>>().join(", ")
    };
    let code = match mjcf {
        Some(mjcf) => {
            format!("# The arm without friction.\n{MJCF}{}{MJCF_END}\n{FRICTION}", mjcf.replace(MJCF_END, "\""))
        }
        None => ISAAC.to_owned(),
    };
    Ok(format!(
        "\"\"\"{}\"\"\"\n\n# Joints, in the order of every list; a parameter's number counts from 1.\nJOINTS = {names:?}\n\
         # Largest torque, N·m (N), and speed, rad/s (m/s); None where the robot file states none.\nEFFORT = [{}]\nVELOCITY = [{}]\n\
         # SI units; inertias about the origin of each link's frame.\n{OPENING}{}{CLOSING}{code}",
        header.replace('\\', "/").replace('"', "'"),
        limit(|limits| limits.torque),
        limit(|limits| limits.velocity),
        map.trim_end(),
    ))
}

/// The JSON object of the parameters in such a file.
pub(super) fn parameters(text: &str) -> &str {
    between(text, OPENING, CLOSING)
}

/// The MJCF in such a file.
pub(super) fn mjcf(text: &str) -> &str {
    between(text, MJCF, MJCF_END)
}

fn between<'a>(text: &'a str, opening: &str, closing: &str) -> &'a str {
    let from = text.find(opening).map_or(0, |at| at + opening.len());
    let rest = &text[from..];
    &rest[..rest.find(closing).unwrap_or(rest.len())]
}
