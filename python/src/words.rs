//! What settings and tasks are called in Python.

use armid::remedy::{Setting, Task, Wording};

/// `period=10`, `robot.design(criterion="d-optimal")`.
pub(crate) struct Keywords;

/// The keyword of a setting.
fn keyword(setting: Setting) -> String {
    match setting {
        Setting::From => "start".to_owned(),
        Setting::Output => "path".to_owned(),
        other => other.name().replace('-', "_"),
    }
}

/// A keyword with its value, as it is typed.
fn typed(setting: Setting, value: &str) -> String {
    let is_number = value.parse::<f64>().is_ok();
    match value {
        "" => format!("{}=True", keyword(setting)),
        _ if is_number || value == "none" => format!("{}={}", keyword(setting), value.replace("none", "None")),
        _ => format!("{}=\"{value}\"", keyword(setting)),
    }
}

impl Wording for Keywords {
    fn setting(&self, setting: Setting, value: Option<&str>) -> String {
        value.map_or_else(|| format!("`{}=`", keyword(setting)), |value| format!("`{}`", typed(setting, value)))
    }

    fn task(&self, task: Task, to: &str, settings: &[(Setting, String)]) -> String {
        let call = match task {
            Task::Reduce => "robot.reduce",
            Task::Design => "robot.design",
            Task::Run => "robot.simulate",
            Task::Identify => "robot.identify",
            Task::Validate => "estimate.validate",
            Task::Export => "estimate.export",
            Task::Report => "estimate.report",
            Task::Study => "armid.study",
            // What Python has no call for.
            other => return format!("the command `{}`", ["armid", other.name(), to].join(" ").trim_end()),
        };
        let settings: Vec<String> = settings.iter().map(|(setting, value)| typed(*setting, value)).collect();
        format!("`{call}({})`", settings.join(", "))
    }
}
