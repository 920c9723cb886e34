//! What answers on an estimate call shares and joints.

use armid_io::ProcessedLog;

/// A share in percent.
pub(crate) fn percent(share: Option<f64>) -> String {
    share.map_or_else(|| "–".to_owned(), |share| format!("{:.2} %", 100.0 * share))
}

/// Names of the robot's joints.
pub(crate) fn joint_names(prepared: &ProcessedLog) -> Vec<String> {
    prepared.robot.robot.joints().iter().map(|joint| joint.name.clone()).collect()
}
