//! `armid identify --drive-gains`: torque constants of all drives at once, by a load that is known.

mod support;

use serde_json::Value;
use support::{armid, json, stderr, stdout, temporary, write};

/// What the file of the A460 is made to state over what the simulated arm has.
const STATED: [f64; 6] = [1.0, 1.1, 1.0, 1.0, 0.8, 1.0];

/// The A460's file with wrong torque constants.
fn wrong_robot() -> String {
    let text = include_str!("../../models/crs-a460/robot.toml");
    let mut joint = 0;
    let line = |line: &str| {
        let Some(rest) = line.strip_prefix("torque_constant_nm_a = ") else { return line.to_owned() };
        let value: f64 = rest.split_whitespace().next().map_or(Ok(f64::NAN), str::parse).expect("a number");
        joint += 1;
        format!("torque_constant_nm_a = {:?}", value * STATED[joint - 1])
    };
    let lines: Vec<String> = text.lines().map(line).collect();
    assert_eq!(joint, 6);
    lines.join("\n") + "\n"
}

/// Table I on the simulated A460, whose own tool is a ball of 1 kg and 3 cm at (0.02, 0, 0.06) m.
fn recorded(folder: &std::path::Path, name: &str, effects: &str) -> String {
    let text = format!("robot = \"crs-a460\"\ntrajectory = \"table-one\"\nperiods = 4\n{effects}");
    let experiment = write(folder, "x.toml", &text);
    let out = folder.join(name).to_str().expect("a path in UTF-8").to_owned();
    armid(["run", &experiment, "-o", &out]).success();
    out
}

const LOAD: [&str; 4] =
    ["--payload-mass=1", "--payload-centre=0.02,0,0.06", "--payload-inertia", "3.6e-4,3.6e-4,3.6e-4"];

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|x| x.as_f64().expect("a number")).collect()
}

#[test]
fn wrong_constants_of_the_robot_file_are_found_and_their_correction_leaves_none() {
    let folder = temporary();
    let (without, with) =
        (recorded(folder.path(), "A.mcap", ""), recorded(folder.path(), "B.mcap", "run = 1\n[effects]\ntool = 1.0\n"));
    let robot = write(folder.path(), "robot.toml", &wrong_robot());
    let both = ["identify", "--drive-gains", "--without", &without, "--with", &with, "--robot"];
    let done = armid(both.iter().copied().chain([robot.as_str(), "--json"]).chain(LOAD));
    let found = json(&done.success());
    assert_eq!(found["taken"], "tls");
    for (joint, stated) in found["joints"].as_array().unwrap().iter().zip(STATED) {
        for method in ["ols", "wls", "tls", "ridge"] {
            let gain = &joint["by"][method]["ratio"];
            let (value, std) = (gain["value"].as_f64().unwrap(), joint["by"]["tls"]["ratio"]["std"].as_f64().unwrap());
            // 24 numbers of 6 independent draws: each within 4 standard deviations; what noise draws to zero is smaller.
            assert!((value - 1.0 / stated).abs() < 4.0 * std && std < 0.05, "{method} {joint}");
            assert_eq!(gain["ci95"].is_null() && gain["std"].is_null(), method != "tls", "{method} {joint}");
            let constant = &joint["by"][method]["torque_constant_nm_a"]["value"];
            assert!((constant.as_f64().unwrap() - value * joint["stated_nm_a"].as_f64().unwrap()).abs() < 1e-12);
        }
    }
    let inside = found["joints"].as_array().unwrap().iter().zip(STATED).filter(|(joint, stated)| {
        let ends = numbers(&joint["by"]["tls"]["ratio"]["ci95"]);
        ends[0] <= 1.0 / stated && 1.0 / stated <= ends[1]
    });
    assert!(inside.count() >= 5, "{found}");
    assert_eq!(found["wrong"], serde_json::json!(["shoulder", "wrist_pitch"]), "{found}");
    // All constants together move every parameter in proportion.
    for parameter in found["base"].as_array().unwrap() {
        let sum: f64 = numbers(&parameter["moved_per_unit_of_gain"]).iter().sum();
        let value = parameter["by_stated_constants"].as_f64().unwrap();
        assert!((sum - value).abs() < 1e-6 * value.abs().max(1e-3), "{parameter}");
    }

    // The lines for the robot file: with them no constant is wrong any more.
    let lines: Vec<&str> = found["corrected"].as_str().unwrap().lines().collect();
    let mut lines = lines.iter().map(|line| line.split('#').next().unwrap());
    let corrected: Vec<String> = wrong_robot()
        .lines()
        .map(|line| if line.starts_with("torque_constant_nm_a") { lines.next().unwrap() } else { line }.to_owned())
        .collect();
    let robot = write(folder.path(), "corrected.toml", &(corrected.join("\n") + "\n"));
    let done = armid(both.iter().copied().chain([robot.as_str()]).chain(LOAD)).success();
    let text = stdout(&done);
    assert!(text.contains("No constant differs") && !text.contains("→ in the table [joint.drive]"), "{text}");

    // The load is on the other log: no gain is shown, and it is said.
    let swapped = ["identify", "--drive-gains", "--without", &with, "--with", &without, "--json"];
    let found = json(&armid(swapped.iter().copied().chain(LOAD)).code(1));
    assert!(!found["not_shown"].as_array().unwrap().is_empty() && found["corrected"].is_null(), "{found}");
}

#[test]
fn what_shows_no_drive_gain_is_refused_with_a_next_step() {
    let folder = temporary();
    let joint = |name: &str, a: &str, b: &str| format!("\n[[joint]]\nname = \"{name}\"\na = {a}\nb = {b}\nq0 = 0.1\n");
    let motion = "period_s = 4.0\nharmonics = 2\n".to_owned()
        + &joint("shoulder", "[0.5, 0.3]", "[0.2, -0.3]")
        + &joint("elbow", "[-0.3, 0.4]", "[0.5, 0.3]");
    write(folder.path(), "T.toml", &motion);
    let log = |name: &str, run: u32| {
        let plan = format!(
            "robot = \"planar-2r\"\ntrajectory = \"T.toml\"\nrate_hz = 250\nperiods = 2\nramp_s = 1\nrun = {run}\n"
        );
        let plan = write(folder.path(), "x.toml", &plan);
        let log = folder.path().join(name).to_str().unwrap().to_owned();
        armid(["run", &plan, "-o", &log]).success();
        log
    };
    let (without, with) = (log("A.mcap", 0), log("B.mcap", 1));
    let both = ["identify", "--drive-gains", "--without", &without, "--with", &with];
    let one = ["identify", "--drive-gains", "--without", &without, "--with", &without];
    let no_load: &[&str] = &[];
    for (logs, more, wanted) in [
        (&both[..], no_load, "the load is not known: --payload-mass is missing"),
        (&both, &["--payload-mass", "1"], "the load is not known: --payload-centre is missing"),
        (&both, &["--payload-mass", "0", "--payload-centre", "0,0,0"], "expected a finite mass above zero"),
        (&both, &["--payload-mass", "1", "--payload-centre", "0,0"], "--payload-centre has 2 numbers"),
        (&both, &["--payload-mass=1", "--payload-centre=0,0,0", "--payload-inertia=1,0,0"], "no body has this"),
        (&one, &LOAD, "(the same SHA-256), expected two recordings"),
        // The planar arm reports torques.
        (&both, &LOAD, "holds torques, expected motor currents"),
    ] {
        let fault = stderr(&armid(logs.iter().chain(more)).code(2));
        assert!(fault.contains(wanted) && fault.contains("armid"), "{wanted} not in {fault}");
    }
    for (arguments, wanted) in [
        (&["--drive-gains", "--payload-mass", "1"][..], "--without"),
        (&["--payload-mass", "1", "log.csv"], "--drive-gains"),
        (&["--drive-gains", "--payload", "--without", "a", "--with", "b"], "cannot be used with"),
        (&["--drive-gains", "--estimator", "ols", "--without", "a", "--with", "b"], "cannot be used with"),
    ] {
        let fault = stderr(&armid(["identify"].iter().chain(arguments)).code(2));
        assert!(fault.contains(wanted), "{wanted} not in {fault}");
    }
}
