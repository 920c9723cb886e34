//! What settings and tasks are called on the command line.

use armid::remedy::{Setting, Task, Wording};

/// `--period 10`, `armid run EXPERIMENT -o R.mcap`.
pub(crate) struct Flags;

impl Wording for Flags {
    fn setting(&self, setting: Setting, value: Option<&str>) -> String {
        let flag = match setting {
            Setting::Output => "-o".to_owned(),
            other => format!("--{}", other.name()),
        };
        match value {
            None | Some("") => flag,
            Some(value) if value.contains([' ', '=', '#']) => format!("{flag} \"{value}\""),
            Some(value) => format!("{flag} {value}"),
        }
    }

    fn task(&self, task: Task, to: &str, settings: &[(Setting, String)]) -> String {
        let settings = settings.iter().map(|(setting, value)| self.setting(*setting, Some(value)));
        let words = ["armid", task.name(), to].into_iter().filter(|word| !word.is_empty()).map(str::to_owned);
        format!("`{}`", words.chain(settings).collect::<Vec<_>>().join(" "))
    }
}
