//! A robot file in which assumptions fill what a simulation needs and nobody stated.

use std::path::Path;

use armid::model::JointKind;
use armid::model::format::ChainEnds;
use armid::model::term::{COULOMB, ROTOR, Term, VISCOUS};
use armid::remedy::{Remedy, Setting, Task};
use toml::{Table, Value};

use super::begun_file::{begin, relative};
use super::find::load;
use super::loaded_robot::LoadedRobot;
use crate::error::Error;
use crate::text::Text;

/// Torque noise of a joint, as a share of its torque limit.
const NOISE: f64 = 0.01;
/// Step of an encoder at its joint, rad or m.
const STEP: [f64; 2] = [1e-4, 1e-5];
/// Coulomb friction, and viscous friction at the speed limit, as shares of the torque limit.
const FRICTION: f64 = 0.05;
/// Speed at which Coulomb friction has set in, as a share of the speed limit.
const ONSET: f64 = 0.02;
/// Rate of the servo of an arm whose file states none, Hz.
const SERVO_HZ: i64 = 1000;
/// Torque that a rotor takes on its way to the speed limit within half a second, as a share of the torque limit.
const ROTOR_SHARE: f64 = 0.02;

/// A robot file, and what was assumed in it.
#[derive(Clone, Debug, PartialEq)]
pub struct AssumedFile {
    /// The text.
    pub text: String,
    /// A sentence for each assumption.
    pub assumptions: Vec<String>,
    /// Files that belong beside it: their names and texts.
    pub beside: Vec<(&'static str, String)>,
}

/// The robot file at `place` of a robot over a URDF, with noise, encoder steps, friction and rotor inertias assumed where they are
/// not stated; `None` where noise and encoders are stated. `ends` choose the chain of a URDF. Noise of each joint's torque (n, N·m or N) that
/// was measured takes the place of what is stated or assumed.
///
/// # Errors
/// [`Error`] where the robot cannot be read, has no URDF to which something could be added, or a joint has no limits.
pub fn assume(name: &str, ends: &ChainEnds, place: &Path, noise: Option<&[f64]>) -> Result<Option<AssumedFile>, Error> {
    let loaded = load(name, ends, None)?;
    let is_stated = |joint: &armid::model::Joint| {
        (noise.is_some() || joint.drive.current_noise > 0.0) && joint.drive.counts_per_revolution > 0.0
    };
    let lacking = loaded.robot.joints().iter().find(|joint| !is_stated(joint));
    let Some(lacking) = lacking else {
        let Some(noise) = noise.filter(|noise| noise.len() == loaded.robot.dof()) else { return Ok(None) };
        let mut table = if loaded.urdf.is_some() {
            table(name, ends, place)?
        } else {
            loaded.text.content.parse::<Table>().map_err(|_| {
                Error::new(format!("{name} is no robot file, expected one in which noise can be stated"))
            })?
        };
        state_noise(&mut table, &loaded, noise)?;
        let text = toml::to_string(&table).map_err(Error::new)?;
        let nominal = loaded.nominal_text.as_ref().map(|text| ("nominal.toml", text.content.to_string()));
        let truth = loaded.truth_file()?.map(|text| ("truth.toml", text.content.to_string()));
        return Ok(Some(AssumedFile {
            text: format!("# The noise is that of an earlier log.\n\n{text}"),
            assumptions: Vec::new(),
            beside: nominal.into_iter().chain(truth).collect(),
        }));
    };
    if loaded.urdf.is_none() || loaded.nominal.is_some() {
        let message = format!(
            "joint \"{}\" of {name} has no current_noise_a or no encoder counts, expected both: without noise no design is better",
            lacking.name
        );
        return Err(Error::new(message));
    }
    let mut table = table(name, ends, place)?;
    let mut assumptions = Assumptions::default();
    if let Some(noise) = noise {
        state_noise(&mut table, &loaded, noise)?;
    }
    fill(&mut table, &loaded, &mut assumptions)?;
    let sentences = assumptions.sentences();
    let heading: String = sentences.iter().map(|sentence| format!("# Assumed: {sentence}.\n")).collect();
    let text = toml::to_string(&table).map_err(Error::new)?;
    Ok(Some(AssumedFile { text: format!("{heading}\n{text}"), assumptions: sentences, beside: Vec::new() }))
}

/// The robot file as a table whose paths begin at the folder of `place`.
fn table(name: &str, ends: &ChainEnds, place: &Path) -> Result<Table, Error> {
    let path = Path::new(name);
    let of_toml = |text: &str| text.parse::<Table>().map_err(Error::new);
    if path.extension().is_some_and(|extension| extension == "toml") {
        let mut table = of_toml(&Text::read(path)?.content)?;
        if let Some(Value::String(urdf)) = table.get_mut("urdf") {
            let there = path.parent().unwrap_or_else(|| Path::new("")).join(&*urdf);
            *urdf = relative(&there, place)?;
        }
        return Ok(table);
    }
    let mut table = of_toml(&begin(path, ends, place)?)?;
    // The rate of a begun file is for wrists without rotors, and these get some.
    inner(&mut table, "servo").insert("rate_hz".to_owned(), SERVO_HZ.into());
    Ok(table)
}

/// Which assumptions were made.
#[derive(Default)]
struct Assumptions {
    noise: bool,
    encoders: bool,
    friction: bool,
    rotors: bool,
}

impl Assumptions {
    fn sentences(&self) -> Vec<String> {
        let all = [
            (self.noise, format!("torque noise of {} % of each limit", 100.0 * NOISE)),
            (self.encoders, format!("encoder steps of {:?} rad ({:?} m)", STEP[0], STEP[1])),
            (self.friction, format!("Coulomb and viscous friction of {} % of each limit", 100.0 * FRICTION)),
            (self.rotors, format!("rotors that take {} % of each limit to full speed in 0.5 s", 100.0 * ROTOR_SHARE)),
        ];
        all.into_iter().filter(|(is_made, _)| *is_made).map(|(_, sentence)| sentence).collect()
    }
}

/// States the noise of each joint's torque.
fn state_noise(table: &mut Table, loaded: &LoadedRobot, noise: &[f64]) -> Result<(), Error> {
    for (joint, noise) in loaded.robot.joints().iter().zip(noise) {
        let drive = inner(joint_table(table, &joint.name)?, "drive");
        drive.insert("current_noise_a".to_owned(), rounded(noise / joint.drive.torque_per_ampere()));
    }
    Ok(())
}

/// The table of a joint, which is made where it is not there.
fn joint_table<'a>(table: &'a mut Table, name: &str) -> Result<&'a mut Table, Error> {
    let fault = || Error::new("found joint, expected [[joint]] tables");
    let joints = table.entry("joint").or_insert_with(|| Value::Array(Vec::new())).as_array_mut().ok_or_else(fault)?;
    let is_of = |table: &Value| table.get("name").and_then(Value::as_str) == Some(name);
    let at = joints.iter().position(is_of).unwrap_or_else(|| {
        joints.push(Value::Table(Table::from_iter([("name".to_owned(), Value::from(name))])));
        joints.len() - 1
    });
    joints[at].as_table_mut().ok_or_else(fault)
}

fn fill(table: &mut Table, loaded: &LoadedRobot, made: &mut Assumptions) -> Result<(), Error> {
    let own = loaded.guess();
    for (index, joint) in loaded.robot.joints().iter().enumerate() {
        let (torque, speed) = (joint.limits.torque, joint.limits.velocity);
        if !(torque.is_finite() && speed.is_finite()) {
            let message =
                format!("joint \"{}\" states no largest torque or speed, expected both in [joint.limits]", joint.name);
            let help = Remedy::task(Task::Robot, "arm.urdf").option(Setting::Output, "robot.toml");
            return Err(Error::new(message).help(help.say(" begins a robot file with its gaps marked")));
        }
        let entry = joint_table(table, &joint.name)?;
        let revolute = joint.kind == JointKind::Revolute;
        let by = |revolute_key: &'static str, prismatic_key: &'static str| {
            if revolute { revolute_key } else { prismatic_key }
        };
        let drive = inner(entry, "drive");
        if joint.drive.counts_per_revolution <= 0.0 {
            let counts = if revolute { std::f64::consts::TAU / STEP[0] } else { 1.0 / STEP[1] };
            drive.insert(by("counts_per_revolution", "counts_per_m").to_owned(), counts.round().into());
            made.encoders = true;
        }
        if joint.drive.current_noise <= 0.0 && !drive.contains_key("current_noise_a") {
            drive.insert("current_noise_a".to_owned(), rounded(NOISE * torque / joint.drive.torque_per_ampere()));
            made.noise = true;
        }
        let stated = |term: Term| own.is_some_and(|own| own.drives[index][term] != 0.0);
        if !stated(COULOMB) {
            drive.insert(by("coulomb_velocity_rad_s", "coulomb_velocity_m_s").to_owned(), rounded(ONSET * speed));
        }
        let terms = inner(entry, "terms");
        for (term, value) in [
            (COULOMB, FRICTION * torque),
            (VISCOUS, FRICTION * torque / speed),
            (ROTOR, ROTOR_SHARE * torque * 0.5 / speed),
        ] {
            if !stated(term) {
                terms.insert(term.entry().key.for_kind(joint.kind).to_owned(), rounded(value));
                if term == ROTOR { made.rotors = true } else { made.friction = true }
            }
        }
    }
    Ok(())
}

/// To three digits: an assumption has no more.
fn rounded(value: f64) -> Value {
    Value::from(format!("{value:.2e}").parse().unwrap_or(value))
}

/// A table in a table, which is made where it is not there.
fn inner<'a>(table: &'a mut Table, key: &str) -> &'a mut Table {
    let value = table.entry(key).or_insert_with(|| Value::Table(Table::new()));
    if !value.is_table() {
        *value = Value::Table(Table::new());
    }
    value.as_table_mut().expect("it is one now")
}
