//! What helps against an error, in words that leave open how a reader sets a setting and starts a task?
//!
//! A command has flags, a library has fields, another language has keywords. A [`Remedy`] holds the settings and tasks with their values.
//! A program says by [`set_wording`] how they are called; without it they are called by their names.

use std::fmt;
use std::sync::OnceLock;

macro_rules! names {
    ($(#[$about:meta])* $kind:ident { $($variant:ident = $name:literal,)* }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum $kind { $(#[doc = $name] $variant,)* }

        crate::input::named! { $kind { $($variant: $name),* } }
    };
}

names! {
    /// Something that a user sets; its documentation is its name.
    Setting {
        Map = "map",
        Period = "period",
        From = "from",
        Until = "until",
        Rate = "rate",
        CutoffHz = "cutoff-hz",
        Effort = "effort",
        MeasuredVelocity = "measured-velocity",
        Robot = "robot",
        Estimator = "estimator",
        Columns = "columns",
        List = "list",
        Select = "select",
        Criterion = "criterion",
        Harmonics = "harmonics",
        Starts = "starts",
        Seed = "seed",
        Trajectory = "trajectory",
        Payload = "payload",
        PackagePath = "package-path",
        Stage = "stage",
        Resume = "resume",
        To = "to",
        Figure = "figure",
        Output = "output",
    }
}

names! {
    /// Something that a user does; its documentation is its name.
    Task {
        Robot = "robot",
        Init = "init",
        Advise = "advise",
        Reduce = "reduce",
        Design = "design",
        Run = "run",
        Identify = "identify",
        Validate = "validate",
        Export = "export",
        Report = "report",
        Study = "study",
        CalibrateTorqueConstant = "calibrate torque-constant",
    }
}

/// A piece of a remedy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Part {
    /// Words.
    Words(String),
    /// A setting, with its value where it has one.
    Setting(Setting, Option<String>),
    /// A task: what it is done to, and the settings that it takes.
    Task(Task, String, Vec<(Setting, String)>),
}

/// What helps. It is read from left to right.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::remedy::{Remedy, Setting, Task};
/// let help = Remedy::task(Task::Run, "EXPERIMENT").option(Setting::Output, "R.mcap").say(" makes one");
/// assert_eq!(help.to_string(), "`run EXPERIMENT, output R.mcap` makes one");
/// assert_eq!(Remedy::from("leave out ").setting(Setting::Period).to_string(), "leave out `period`");
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Remedy(pub Vec<Part>);

impl Remedy {
    /// Begins with a setting and its value.
    pub fn set(setting: Setting, value: impl Into<String>) -> Self {
        Self::default().assign(setting, value)
    }

    /// Begins with a task that is done to something, which may be nothing.
    pub fn task(task: Task, to: &str) -> Self {
        Self::default().perform(task, to)
    }

    /// Adds words.
    #[must_use]
    pub fn say(mut self, words: impl Into<String>) -> Self {
        self.0.push(Part::Words(words.into()));
        self
    }

    /// Adds a setting.
    #[must_use]
    pub fn setting(mut self, setting: Setting) -> Self {
        self.0.push(Part::Setting(setting, None));
        self
    }

    /// Adds a setting and its value.
    #[must_use]
    pub fn assign(mut self, setting: Setting, value: impl Into<String>) -> Self {
        self.0.push(Part::Setting(setting, Some(value.into())));
        self
    }

    /// Adds a task.
    #[must_use]
    pub fn perform(mut self, task: Task, to: &str) -> Self {
        self.0.push(Part::Task(task, to.to_owned(), Vec::new()));
        self
    }

    /// Adds a setting to the task before it. A setting without a value has an empty one.
    #[must_use]
    pub fn option(mut self, setting: Setting, value: &str) -> Self {
        if let Some(Part::Task(_, _, settings)) = self.0.last_mut() {
            settings.push((setting, value.to_owned()));
        }
        self
    }
}

impl<S: Into<String>> From<S> for Remedy {
    fn from(words: S) -> Self {
        Self(vec![Part::Words(words.into())])
    }
}

impl fmt::Display for Remedy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let wording = WORDING.get().copied().unwrap_or(&InWords);
        self.0.iter().try_for_each(|part| match part {
            Part::Words(words) => f.write_str(words),
            Part::Setting(setting, value) => f.write_str(&wording.setting(*setting, value.as_deref())),
            Part::Task(task, to, settings) => f.write_str(&wording.task(*task, to, settings)),
        })
    }
}

/// As a sentence.
impl serde::Serialize for Remedy {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// How readers call settings and tasks.
pub trait Wording: Sync {
    /// A setting, with its value where it has one.
    fn setting(&self, setting: Setting, value: Option<&str>) -> String;

    /// A task that is done to something, with its settings, of which those with an empty value have none.
    fn task(&self, task: Task, to: &str, settings: &[(Setting, String)]) -> String;
}

/// The wording of this process, as it has one language.
static WORDING: OnceLock<&'static dyn Wording> = OnceLock::new();

/// Sets how this process words remedies. The first call counts: a program makes it where it begins.
pub fn set_wording(wording: &'static dyn Wording) {
    let _ = WORDING.set(wording);
}

/// By their names.
struct InWords;

impl Wording for InWords {
    fn setting(&self, setting: Setting, value: Option<&str>) -> String {
        match value {
            None => format!("`{}`", setting.name()),
            Some(value) if value.contains([' ', '=']) => format!("{} \"{value}\"", setting.name()),
            Some(value) => format!("{} {value}", setting.name()),
        }
    }

    fn task(&self, task: Task, to: &str, settings: &[(Setting, String)]) -> String {
        let settings = settings.iter().map(|(setting, value)| format!("{} {value}", setting.name()));
        let words = std::iter::once(format!("{} {to}", task.name())).chain(settings);
        format!("`{}`", words.map(|words| words.trim_end().to_owned()).collect::<Vec<_>>().join(", "))
    }
}
