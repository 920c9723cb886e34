//! What `identify` says first: what a log's mistakes are, its period, its error, and what to do.

mod support;
#[path = "support/own_robot.rs"]
mod own_robot;

use std::path::Path;

use serde_json::Value;
use support::{armid, json, stdout, temporary, write};

const MAP: &str = "t=time_ms, q=pos_[1-6] deg, tau=torque_[1-6]";

/// A folder with a URDF and a log of the arm, and the paths of both.
fn lab() -> (tempfile::TempDir, String, String) {
    let folder = temporary();
    let urdf = write(folder.path(), "arm.urdf", &own_robot::urdf());
    own_robot::log(folder.path(), "arm.urdf", "log.csv", 0.0);
    let log = folder.path().join("log.csv").display().to_string();
    (folder, urdf, log)
}

/// The log with every row changed: time in ms, mode, positions in degrees, torques.
fn changed(folder: &Path, log: &str, name: &str, change: impl Fn(usize, &mut [f64])) -> String {
    let text = std::fs::read_to_string(log).expect("the log");
    let mut lines = text.lines();
    let mut out = lines.next().expect("headings").to_owned() + "\n";
    for (k, line) in lines.enumerate() {
        let mut row: Vec<f64> = line.split(',').map(|value| value.parse().expect("a number")).collect();
        change(k, &mut row);
        out += &row.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        out.push('\n');
    }
    write(folder, name, &out)
}

fn base(estimate: &Value) -> Vec<(String, f64)> {
    let of = |parameter: &Value| (parameter["name"].to_string(), parameter["value"].as_f64().expect("a value"));
    estimate["base"].as_array().expect("parameters").iter().map(of).collect()
}

#[test]
fn torques_that_are_all_reversed_are_named_first_and_the_correction_can_be_typed() {
    let (folder, urdf, log) = lab();
    let plain = json(&armid(["identify", &log, "--robot", &urdf, "--map", MAP, "--json"]).success());
    assert_eq!(plain["suspicions"], serde_json::json!([]));
    let reversed =
        changed(folder.path(), &log, "reversed.csv", |_, row| row[8..].iter_mut().for_each(|tau| *tau = -*tau));
    let found = json(&armid(["identify", &reversed, "--robot", &urdf, "--map", MAP, "--json"]).code(1));
    let suspicions = found["suspicions"].as_array().unwrap();
    assert_eq!((suspicions.len(), &suspicions[0]["mistake"]), (1, &"efforts-reversed".into()), "{suspicions:?}");
    assert!((suspicions[0]["slope"].as_f64().unwrap() + 1.0).abs() < 0.2, "{suspicions:?}");
    let advice = suspicions[0]["advice"].as_str().unwrap();
    let typed = advice.split("--map \"").last().unwrap().trim_end_matches('"');
    for map in [typed, &format!("{MAP} sign=-"), &format!("{MAP} sign=-/-/-/-/-/-"), &format!("{MAP} sign=------")] {
        let corrected = json(&armid(["identify", &reversed, "--robot", &urdf, "--map", map, "--json"]).success());
        assert_eq!(base(&corrected), base(&plain), "{map}");
    }
    let text = stdout(&armid(["identify", &reversed, "--robot", &urdf, "--map", MAP]).code(1));
    let first: String = text.lines().take(12).collect();
    assert!(first.contains("all torques are reversed") && first.contains("sign=-"), "{text}");
}

#[test]
fn efforts_that_are_too_small_look_like_currents() {
    let (folder, urdf, log) = lab();
    let gears = [90.0, 60.0, 40.0, 25.0, 15.0, 6.0];
    let small = changed(folder.path(), &log, "small.csv", |_, row| {
        row[8..].iter_mut().zip(gears).for_each(|(tau, gear)| *tau /= gear);
    });
    let found = json(&armid(["identify", &small, "--robot", &urdf, "--map", MAP, "--json"]).code(1));
    assert_eq!(found["suspicions"][0]["mistake"], "efforts-small", "{}", found["suspicions"]);
    assert!(found["suspicions"][0]["text"].as_str().unwrap().contains("look like currents, or torques at the motor"));
}

#[test]
fn the_period_is_found_and_what_is_stated_overrules_it() {
    let (folder, urdf, log) = lab();
    let identify = |more: &[&str]| {
        let all = ["identify", &log, "--robot", &urdf, "--map", MAP, "--json"];
        json(&armid(all.iter().chain(more)).success())
    };
    let found = identify(&[]);
    let periods = |found: &Value| -> Option<String> {
        let mut remarks = found["logs"][0]["remarks"].as_array().unwrap().iter().map(|remark| remark.as_str().unwrap());
        remarks.find(|remark| remark.contains("period")).map(str::to_owned)
    };
    // At rest 1 s, a ramp of 1 s, four periods of 4 s.
    let remark = periods(&found).unwrap();
    assert!(remark.starts_with("4.0 s period found, ") && remark.contains(" of them from "), "{remark}");
    let from: f64 = remark.split(" from ").nth(1).unwrap().trim_end_matches(" s").parse().unwrap();
    assert!((1.8..6.3).contains(&from), "{remark}");
    assert!(found["periods"].as_u64().unwrap() >= 2 && found["held_out"]["all_rows"]["total"].as_f64().unwrap() < 0.01);
    let stated = identify(&["--period", "4", "--from", "6"]);
    assert_eq!(periods(&stated), None);
    assert_eq!(stated["inputs"]["settings"]["from_s"], 6.0);
    let none = identify(&["--period", "none"]);
    assert_eq!((none["periods"].as_u64(), periods(&none)), (Some(1), None));

    // A validation on the log of the fit remembers where the periods begin.
    let out = folder.path().join("E.json").display().to_string();
    armid(["identify", &log, "--robot", &urdf, "--map", MAP, "--period", "4", "--from", "6", "-o", &out]).success();
    let verdict = json(&armid(["validate", &out, &log, "--json"]).success());
    assert!(verdict["residual"]["all_rows"]["total"].as_f64().unwrap() < 0.01, "{verdict}");
}

#[test]
fn the_first_screen_has_error_parameters_and_findings_and_no_expressions() {
    let (folder, urdf, log) = lab();
    let of =
        |more: &[&str]| stdout(&armid(["identify", &log, "--robot", &urdf, "--map", MAP].iter().chain(more)).success());
    let text = of(&[]);
    let screen: Vec<&str> = text.lines().take(20).collect();
    let at =
        |words: &str| screen.iter().position(|line| line.contains(words)).unwrap_or_else(|| panic!("{words}: {text}"));
    assert!(at("error of the held-out torque") < at("this motion determines"), "{text}");
    // A rehearsal has no noise: one line says so, and none compares with it.
    assert!(at("this motion determines") < at("this log has no noise"), "{text}");
    assert!(!text.contains("times the") && !text.contains("stands for"), "{text}");
    // 58 parameters do not fit on a screen of 40 lines; the last line says how they are shown.
    assert!(text.lines().count() <= 40 && text.contains("all 58 parameters with their intervals, and"), "{text}");
    let whole = of(&["-v"]);
    assert!(whole.contains("stands for") && whole.contains("  Fv6  "), "{whole}");
    let verdict = json(&armid(["identify", &log, "--robot", &urdf, "--map", MAP, "--json"]))["verdict"].clone();
    assert!(verdict["total"].as_f64().unwrap() < 0.01 && verdict["of"] == "held-out", "{verdict}");
    assert!(verdict["determined"].as_u64().unwrap() <= verdict["parameters"].as_u64().unwrap(), "{verdict}");

    // Rows that repeat the row before.
    let twice = changed(folder.path(), &log, "twice.csv", |_, _| {});
    let text = std::fs::read_to_string(&twice).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let held: Vec<String> = lines
        .iter()
        .enumerate()
        .map(|(k, line)| {
            let (own, before): (Vec<&str>, Vec<&str>) =
                (line.split(',').collect(), lines[k.max(2) - 1].split(',').collect());
            let q = if k > 1 && k % 4 == 0 { &before[2..8] } else { &own[2..8] };
            [&own[..2], q, &own[8..]].concat().join(",")
        })
        .collect();
    let held = write(folder.path(), "held.csv", &(held.join("\n") + "\n"));
    let arguments = ["identify", &held, "--robot", &urdf, "--map", MAP, "--json"];
    let found = json(&armid(arguments));
    let remark = found["logs"][0]["remarks"].to_string();
    assert!(remark.contains("% of the rows repeat the positions of the row before"), "{remark}");
}
