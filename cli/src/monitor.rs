//! What `armid monitor` shows: a pure function of what was seen.

use std::fmt::Write;

use armid::model::{EffortInterface, Joint, JointKind, Robot};
use armid_hardware::guard::{Activity, GuardSettings, JointBounds};
use armid_hardware::monitor::Snapshot;

use crate::terminal::Table;

/// A state that is older than this is called old, s.
const OLD_S: f64 = 0.1;
/// A guard that has been silent for longer is called so, s.
const GONE_S: f64 = 2.0;

/// Everything that was seen of a robot whose guard has these settings, as lines of at most 100 columns.
pub(crate) fn text(robot: &Robot, settings: &GuardSettings, place: &str, snapshot: &Snapshot) -> String {
    let mut text = format!("{} on {place}\n", robot.name());
    let age = match snapshot.age_s {
        age if age.is_finite() => format!("{:.0} ms old{}", 1e3 * age, if age > OLD_S { ": OLD" } else { "" }),
        _ => "NO JOINT STATES".to_owned(),
    };
    let controller = snapshot.controller_state.as_deref().unwrap_or("not reported");
    let _ = writeln!(text, "joint states  {:.0} Hz, {age}; robot controller: {controller}", snapshot.rate_hz);
    let stamps = &snapshot.stamps;
    let _ = writeln!(
        text,
        "stamps        {} messages, lost {}, longest gap {:.1} ms, latest by {:.1} ms, twice {},\n\
         \x20             out of order {}, clock jumps {}",
        stamps.messages,
        stamps.lost,
        1e3 * stamps.longest_gap_s,
        1e3 * stamps.latest_s,
        stamps.duplicates,
        stamps.reordered,
        stamps.clock_jumps
    );
    if let Some(fault) = &snapshot.fault {
        let _ = writeln!(text, "fault         {fault}");
    }
    let effort = if robot.effort() == EffortInterface::Current { "current" } else { "effort" };
    let mut table = Table::of(&format!("joint | #position | #soft limits | #hard limits | #{effort} | #of clamp | "));
    let bounds = JointBounds::of_robot(robot, settings);
    for (j, (joint, bounds)) in robot.joints().iter().zip(&bounds).enumerate() {
        table.row(joint_row(joint, bounds, j, snapshot));
    }
    text + "\n" + &table.render(0) + "\n" + &guard(snapshot)
}

/// One joint, in the units that a person reads: degrees or millimetres.
fn joint_row(joint: &Joint, bounds: &JointBounds, j: usize, snapshot: &Snapshot) -> [String; 7] {
    let (unit, scale) = match joint.kind {
        JointKind::Revolute => ("°", 180.0 / std::f64::consts::PI),
        JointKind::Prismatic => ("mm", 1e3),
    };
    let absent = || "–".to_owned();
    let limits = |(low, high): (f64, f64)| {
        let end = |value: f64| if value.is_finite() { format!("{:.0}", scale * value) } else { absent() };
        format!("{} to {} {unit}", end(low), end(high))
    };
    let position = snapshot.row.as_ref().map(|row| row.q[j]);
    let effort = snapshot.row.as_ref().and_then(|row| row.effort.get(j).copied());
    let used = effort.map(|effort| effort.abs() / bounds.effort);
    let mut faults = Vec::new();
    if position.is_some_and(|q| !(q >= bounds.soft.0 && q <= bounds.soft.1)) {
        faults.push("OUTSIDE");
    }
    if used.is_some_and(|used| used > 1.0) {
        faults.push("ABOVE THE CLAMP");
    }
    [
        bounds.name.clone(),
        position.map_or_else(absent, |q| format!("{:.2} {unit}", scale * q)),
        limits(bounds.soft),
        limits(bounds.hard),
        effort.map_or_else(absent, |effort| format!("{effort:.3} {}", bounds.effort_unit)),
        used.map_or_else(absent, |used| format!("{:.0} %", 100.0 * used)),
        faults.join(", "),
    ]
}

/// What the guard does, and how much of each limit was used.
fn guard(snapshot: &Snapshot) -> String {
    let Some((state, age_s)) = &snapshot.guard else {
        return "guard  no reports: no run is under way in this domain\n".to_owned();
    };
    let word = match (&state.trip, state.doing) {
        (Some(_), _) => "TRIPPED",
        (None, Activity::Ended) => "ended",
        (None, _) if *age_s > GONE_S => "SILENT",
        (None, Activity::Approach) => "watching the approach",
        (None, Activity::Experiment) => "watching",
    };
    let (phase, mode) = (state.phase.name(), state.mode.name());
    let mut text =
        format!("guard  {word}, {phase} at t = {:.1} s, {mode} mode, reported {age_s:.1} s ago\n", state.t_s);
    if let Some(trip) = &state.trip {
        let _ = writeln!(text, "       {trip}");
    }
    text += "largest part of each limit used so far:\n";
    for (name, used) in &state.used {
        let full = (used.clamp(0.0, 1.0) * 24.0).round() as usize;
        let _ = writeln!(text, "  {name:<16}{}{} {:3.0} %", "█".repeat(full), "░".repeat(24 - full), 100.0 * used);
    }
    text
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use armid::experiment::Phase;
    use armid::model::{bundled, format::parse_robot};
    use armid_hardware::guard::{GuardState, Mode};
    use armid_hardware::link::{JointRow, StampFindings};

    use super::*;

    fn shown(change: impl FnOnce(&mut Snapshot)) -> String {
        let entry = bundled().iter().find(|entry| entry.name == "crs-a460").unwrap();
        let robot = parse_robot(entry.robot).unwrap();
        let q = [-20.0, 80.0, 0.0, 90.0, -50.0, 12.0].map(f64::to_radians).to_vec();
        let row = JointRow { stamp_ns: 7, q, qd: Vec::new(), effort: vec![0.5, 4.2, -1.1, 0.2, 0.1, -0.9] };
        let used = [("following-error", 0.12), ("soft-limit", 0.94), ("stale-state", 0.3)];
        let used: BTreeMap<String, f64> = used.into_iter().map(|(name, used)| (name.to_owned(), used)).collect();
        let (mode, doing, phase) = (Mode::Trajectory, Activity::Experiment, Phase::Record);
        let state = GuardState { mode, doing, phase, t_s: 12.3, used, trip: None };
        let mut snapshot = Snapshot {
            row: Some(row),
            age_s: 0.002,
            rate_hz: 499.6,
            stamps: StampFindings { messages: 6150, longest_gap_s: 0.0021, latest_s: 4e-4, ..StampFindings::default() },
            controller_state: Some("enabled".to_owned()),
            guard: Some((state, 0.05)),
            fault: None,
        };
        change(&mut snapshot);
        let shown = text(&robot, &GuardSettings::default(), "ROS domain 42, loopback", &snapshot);
        assert!(shown.lines().all(|line| line.chars().count() <= 100), "{shown}");
        shown
    }

    fn assert_shows(shown: &str, words: &[&str]) {
        for word in words {
            assert!(shown.contains(word), "\"{word}\" not in\n{shown}");
        }
    }

    #[test]
    fn a_healthy_run_is_shown_whole() {
        let healthy = [
            "crs-a460 on ROS domain 42",
            "500 Hz, 2 ms old; robot controller: enabled",
            "6150 messages, lost 0, longest gap 2.1 ms, latest by 0.4 ms, twice 0,",
            "out of order 0, clock jumps 0",
            "wrist_pitch ",
            "-20.00 °",
            "-175 to 175 °",
            "0.500 A",
            "watching, record at t = 12.3 s, trajectory mode, reported 0.1 s ago",
            "soft-limit      ███████████████████████░  94 %",
        ];
        let shown = shown(|_| {});
        assert_shows(&shown, &healthy);
        assert!(!["OLD", "OUTSIDE", "CLAMP", "TRIPPED"].iter().any(|word| shown.contains(word)), "{shown}");
    }

    #[test]
    fn what_is_wrong_is_shown() {
        let wrong = shown(|snapshot| {
            (snapshot.age_s, snapshot.rate_hz, snapshot.stamps.lost) = (f64::INFINITY, 0.0, 17);
            snapshot.controller_state = Some("estop".to_owned());
            snapshot.row.as_mut().unwrap().q[1] = 2.0;
            snapshot.row.as_mut().unwrap().effort[0] = 9.0;
            let (state, _) = snapshot.guard.as_mut().unwrap();
            state.trip = Some("position-jump: joint \"shoulder\": position moved".to_owned());
        });
        assert_shows(&wrong, &["NO JOINT STATES", "lost 17", "estop", "OUTSIDE", "ABOVE THE CLAMP", "TRIPPED"]);
        assert_shows(&wrong, &["position-jump: joint \"shoulder\""]);
        let nothing = shown(|snapshot| (snapshot.row, snapshot.guard) = (None, None));
        assert!(nothing.contains("no run is under way") && nothing.matches('–').count() == 18, "{nothing}");
    }
}
