//! An experiment with the arm that performs it: what `experiment.toml` says in `arm`, `[ros2]` and `[guard]`.

use armid_hardware::guard::{Confirmation, GuardSettings};
use armid_hardware::link::LinkSettings;
use armid_io::{Error, Text, experiment, suggestion};
use armid_sim::Engine;
use serde::Deserialize;
use toml::Spanned;

use super::ArmKind;

/// The keys about the arm; those about the experiment are read by `armid-io`.
#[derive(Deserialize)]
struct File {
    arm: Option<Spanned<String>>,
    ros2: Option<Spanned<LinkSettings>>,
    guard: Option<Spanned<GuardSettings>>,
}

/// An experiment and its arm.
#[derive(Clone, Debug)]
pub(crate) struct Experiment {
    /// What is performed.
    pub(crate) planned: experiment::Experiment,
    /// What performs it.
    pub(crate) arm: ArmKind,
    /// How the robot of `arm = "ros2"` is reached.
    pub(crate) ros2: LinkSettings,
    /// Limits of the guard.
    pub(crate) guard: GuardSettings,
    /// Whether a simulated arm is watched too.
    pub(crate) guarded: bool,
    /// The operator's confirmation that a real arm may move.
    pub(crate) confirmation: Option<Confirmation>,
}

impl Experiment {
    /// Finds and reads an experiment: a bundled name, a folder, or the TOML itself.
    pub(crate) fn load(name: &str) -> Result<Self, Error> {
        Self::of(experiment::load(name)?)
    }

    fn of(planned: experiment::Experiment) -> Result<Self, Error> {
        let text = &planned.text;
        let file: File = toml::from_str(&text.content).map_err(|error| Error::of_toml(text, &error))?;
        let arm = file.arm.as_ref().map_or(Ok(ArmKind::Simulated(Engine::Analytic)), |name| arm(name, text))?;
        let ros2 = checked(text, file.ros2, LinkSettings::check)?;
        let guard = checked(text, file.guard, GuardSettings::check)?;
        Ok(Self { planned, arm, ros2, guard, guarded: false, confirmation: None })
    }
}

/// A table of settings, or the default where there is none.
fn checked<T: Default, E: std::fmt::Display>(
    text: &Text,
    table: Option<Spanned<T>>,
    check: impl Fn(&T) -> Result<(), E>,
) -> Result<T, Error> {
    let Some(table) = table else { return Ok(T::default()) };
    check(table.get_ref()).map_err(|fault| Error::new(fault).at_span(text, table.span(), "in this table"))?;
    Ok(table.into_inner())
}

fn arm(name: &Spanned<String>, text: &Text) -> Result<ArmKind, Error> {
    ArmKind::parse(name.get_ref()).ok_or_else(|| {
        let names = ArmKind::ALL.map(ArmKind::name);
        Error::new(format!("arm is \"{}\", expected one of {}", name.get_ref(), names.join(", ")))
            .at_span(text, name.span(), "here")
            .maybe_help(suggestion::nearest(name.get_ref(), names).map(|near| format!("did you mean \"{near}\"?")))
    })
}
