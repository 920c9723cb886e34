//! `armid identify` and `armid validate`

mod support;

use std::path::Path;

use serde_json::Value;
use support::{armid, experiment, json, stderr, stdout, temporary, write};

fn path(folder: &Path, name: &str) -> String {
    folder.join(name).to_str().expect("a path in UTF-8").to_owned()
}

/// A recording of Table I.
fn record(folder: &Path, name: &str, seed: &str) -> String {
    let recording = path(folder, name);
    armid(["run", &experiment(folder, 3), "--seed", seed, "-o", &recording]).success();
    recording
}

#[test]
fn the_page_of_an_estimate_is_the_same_with_its_log_and_without() {
    let folder = temporary();
    let recording = record(folder.path(), "R.mcap", "3");
    let out = path(folder.path(), "E.json");
    armid(["identify", &recording, "-o", &out]).success();
    let page = |name: &str, more: &[&str]| {
        let place = path(folder.path(), name);
        armid([&["report", &out, "-o", &place][..], more].concat()).success();
        std::fs::read_to_string(Path::new(&place).join("report.html")).expect("a page")
    };
    let of_log = page("of-log", &["--robot", "crs-a460"]);
    std::fs::remove_file(&recording).expect("a log");
    assert!(page("of-file", &[]) == of_log, "the pages differ");
    // Without its figures the log is needed.
    let mut without: Value = serde_json::from_str(&std::fs::read_to_string(&out).unwrap()).unwrap();
    without.as_object_mut().expect("an object").remove("figures").expect("figures");
    let old = write(folder.path(), "old.json", &without.to_string());
    assert!(stderr(&armid(["report", &old, "-o", &path(folder.path(), "old")]).code(2)).contains("R.mcap"));
}

fn value(estimate: &Value, name: &str) -> f64 {
    let base = estimate["base"].as_array().expect("a list");
    let found = base.iter().find(|parameter| parameter["name"] == name).expect("a parameter");
    found["value"].as_f64().expect("a number")
}

#[test]
fn the_keys_of_the_contract_are_there_and_friction_is_that_of_the_simulated_arm() {
    let folder = temporary();
    let recording = record(folder.path(), "R.mcap", "3");
    let out = path(folder.path(), "E.json");
    let estimate = json(&armid(["identify", &recording, "-o", &out, "--json"]).success());
    for key in [
        "estimator",
        "base",
        "standard",
        "consistent",
        "residual_rms",
        "noise_std",
        "units",
        "condition",
        "findings",
        "termination",
    ] {
        assert!(estimate.get(key).is_some(), "{key}");
    }
    assert_eq!(estimate["estimator"], "wls");
    assert_eq!(estimate["base"].as_array().unwrap().len(), 58);
    for key in ["name", "value", "std", "ci95"] {
        assert!(estimate["base"][0].get(key).is_some(), "{key}");
    }
    assert_eq!(estimate["ci95"], Value::Null);
    assert_eq!(estimate["base"][0]["ci95"].as_array().unwrap().len(), 2);
    assert_eq!(estimate["standard"].as_array().unwrap().len(), 84);
    assert_eq!(estimate["units"], Value::from(vec!["N·m"; 6]));
    for key in ["residual_rms", "noise_std"] {
        assert_eq!(estimate[key].as_array().unwrap().len(), 6);
    }
    let written: Value = serde_json::from_str(&std::fs::read_to_string(&out).unwrap()).unwrap();
    assert_eq!(written, estimate);

    // Friction stands in the base alone; the file that the simulator reads has it. Three periods of 10 s give it to
    // a hundredth and better; the bound is 3 % for the bias of the servo's delay.
    let truth = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../models/crs-a460/truth.toml")).unwrap();
    let truth: toml::Table = truth.parse().unwrap();
    for (k, drive) in truth["drive"].as_array().unwrap().iter().enumerate() {
        for (symbol, key) in [("Fv", "viscous_nm_s_rad"), ("Fc", "coulomb_nm")] {
            let (found, expected) = (value(&estimate, &format!("{symbol}{}", k + 1)), drive[key].as_float().unwrap());
            assert!((found / expected - 1.0).abs() < 0.03, "{symbol}{}: {found} {expected}", k + 1);
        }
    }
}

#[test]
fn identity_a_csv_gives_what_the_recording_gives() {
    let folder = temporary();
    let recording = record(folder.path(), "R.mcap", "3");
    let csv = path(folder.path(), "R.csv");
    armid(["run", &path(folder.path(), "experiment.toml"), "--seed", "3", "-o", &csv]).success();
    let direct = json(&armid(["identify", &recording, "--json"]).success());
    // The periods that count begin after 1 s at rest, 2 s of ramp and 10 s thrown away.
    let log = ["identify", &csv, "--robot", "crs-a460", "--period", "10", "--skip", "13", "--json"];
    let through_csv = json(&armid(log).success());
    assert_eq!(through_csv["periods"], 3);
    for (a, b) in direct["base"].as_array().unwrap().iter().zip(through_csv["base"].as_array().unwrap()) {
        let (value, other, std) =
            (a["value"].as_f64().unwrap(), b["value"].as_f64().unwrap(), a["std"].as_f64().unwrap());
        // The same samples; the band of each joint's position is found in them, not known beforehand.
        assert!((value - other).abs() < std, "{a} {b}");
    }
    let fault = stderr(&armid(["identify", &csv]).code(2));
    assert!(fault.contains("does not name its robot, expected --robot"), "{fault}");
    let fault = stderr(&armid(["identify", &csv, "--robot", "crs-a460", "--period", "0.0333"]).code(2));
    assert!(fault.contains("a period of 0.0333 s is 33.300 samples"), "{fault}");
    let fault = stderr(&armid(["identify", &recording, "--period", "10"]).code(2));
    assert!(fault.contains("states its own period"), "{fault}");
    let aperiodic = json(&armid(["identify", &csv, "--robot", "crs-a460", "--period", "none", "--json"]).success());
    assert_eq!(aperiodic["interval_basis"], "residual");
}

#[test]
fn a_csv_with_a_wrong_header_is_shown_with_line_and_column() {
    let folder = temporary();
    for (text, wanted) in [
        ("when,q1,tau1\n0,1,2\n", "log.csv:1:1: heading \"t\" is missing"),
        ("t,q1,q2,tau1\n0,1,2,3\n", "log.csv:1:1: heading \"tau2\" is missing"),
        ("t,q1,tau1\n0,1,2\n0.001,x,2\n", "log.csv:3:7: q1: found \"x\""),
        ("t,q1,tau1\n0,1,2\n0.001,1,2\n0.002,1\n", "log.csv:4:1: found 2 values, expected 3"),
        ("t,q1,tau1\n0,1,2\n0.001,1,2\n5,1,2\n5.001,1,2\n", "t: no segment of 0.5 s without a break"),
        ("t,q1,tau1\n0,1,2\n0.001,1,2\n", "log.csv holds 1 joints, expected the 6 of robot \"crs-a460\""),
    ] {
        let log = write(folder.path(), "log.csv", text);
        let fault = stderr(&armid(["identify", &log, "--robot", "crs-a460"]).code(2));
        assert!(fault.contains(wanted), "{wanted} not in {fault}");
    }
}

#[test]
fn estimators_that_simulate_begin_where_they_are_told_and_others_do_not_care() {
    let folder = temporary();
    let recording = record(folder.path(), "R.mcap", "3");
    let from = |start: &[&str]| {
        let asked = ["identify", recording.as_str(), "--estimator", "wls,iv", "--json"];
        json(&armid(asked.iter().copied().chain(start.iter().copied())).success())
    };
    let fit = from(&[]);
    // The full set that weighted least squares gives, a fifth larger.
    let larger = |parameter: &Value| {
        let value = 1.2 * parameter["value"].as_f64().expect("a number");
        (parameter["name"].as_str().expect("a name").to_owned(), Value::from(value))
    };
    let set: serde_json::Map<String, Value> =
        fit[0]["standard"].as_array().expect("a list").iter().map(larger).collect();
    let start = write(folder.path(), "start.json", &Value::from(set).to_string());
    let begun = from(&["--start", &start]);
    assert_eq!(fit[0]["base"], begun[0]["base"]);
    let (found, expected) = (value(&begun[1], "Fc1"), value(&fit[1], "Fc1"));
    assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    let wrong = write(folder.path(), "wrong.json", "{\"zz1\": 1}");
    let fault = stderr(&armid(["identify", &recording, "--start", &wrong]).code(2));
    assert!(fault.contains("zz1"), "{fault}");
}

#[test]
fn estimators_that_simulate_know_the_servo_or_say_what_is_missing() {
    let folder = temporary();
    let recording = record(folder.path(), "R.mcap", "3");
    let all = json(&armid(["identify", &recording, "--estimator", "wls,iv,didim", "--json"]).success());
    for estimate in all.as_array().unwrap() {
        // Friction of the simulated waist, as by weighted least squares.
        let (found, expected) = (value(estimate, "Fc1"), value(&all[0], "Fc1"));
        assert!((found / expected - 1.0).abs() < 0.05, "{}: {found} {expected}", estimate["estimator"]);
    }
    let kinds: Vec<&str> =
        all[1]["findings"].as_array().unwrap().iter().filter_map(|finding| finding["kind"].as_str()).collect();
    assert!(kinds.contains(&"durbin-wu-hausman"), "{kinds:?}");
    // The same arm, whose file does not state a servo.
    let robot = path(folder.path(), "robot.toml");
    armid(["robot", "crs-a460", "-o", &robot]).success();
    let text = std::fs::read_to_string(&robot).unwrap();
    let (before, rest) = text.split_once("[servo]").unwrap();
    let (_, after) = rest.split_once("[[joint]]").unwrap();
    std::fs::write(&robot, format!("{before}[[joint]]{after}")).unwrap();
    let fault = stderr(&armid(["identify", &recording, "--robot", &robot, "--estimator", "didim"]).code(2));
    let words: Vec<&str> = fault.split_whitespace().collect();
    assert!(words.join(" ").contains("[servo]"), "{fault}");
    // A table of something else holds no commanded motion.
    let rows = (0..400)
        .map(|k| format!("{},{},{},1,2\n", 0.01 * f64::from(k), 0.01 * f64::from(k % 50), 0.02 * f64::from(k % 30)));
    let log = write(folder.path(), "log.csv", &format!("t,q1,q2,tau1,tau2\n{}", rows.collect::<String>()));
    let asked = ["identify", &log, "--robot", "planar-2r", "--no-friction", "--estimator", "iv"];
    let fault = stderr(&armid(asked).code(2));
    let words: Vec<&str> = fault.split_whitespace().collect();
    assert!(words.join(" ").contains("recording of armid's own"), "{fault}");
}

#[test]
fn estimators_are_listed_and_several_answer_together() {
    let list = json(&armid(["identify", "--list", "--json"]).success());
    let names: Vec<&str> = list.as_array().unwrap().iter().map(|entry| entry["name"].as_str().unwrap()).collect();
    let expected = "ols wls irls-huber irls-tukey irls-cauchy mm tls ridge essential ml iv didim clie cloe ekf pf \
                    pc-ols pc-wls pc-irls pc-iv pc-didim pc-ols-euclidean pc-ols-entropic pc-ols-pullback";
    assert_eq!(names.join(" "), expected);
    let folder = temporary();
    let recording = record(folder.path(), "R.mcap", "3");
    let out = path(folder.path(), "E.json");
    let both = ["identify", &recording, "--estimator", "ols,wls", "--no-friction", "-o", &out, "--json"];
    let both = json(&armid(both).success());
    assert_eq!((both[0]["estimator"].as_str(), both[1]["estimator"].as_str()), (Some("ols"), Some("wls")));
    assert_eq!(both[0]["base"].as_array().unwrap().len(), 36);
    let alias = json(&armid(["identify", &recording, "--estimator", "ukf", "--no-friction", "--json"]).success());
    assert_eq!(alias["estimator"], "ekf");
    let fault = stderr(&armid(["identify", &recording, "--estimator", "wsl"]).code(2));
    assert!(fault.contains("wls"), "{fault}");
    // A model without friction misses much: both fail, and the list is validated one by one.
    let verdicts = json(&armid(["validate", &out, &recording, "--limit", "0.05", "--json"]).code(1));
    assert_eq!(verdicts.as_array().unwrap().len(), 2);
    assert_eq!(verdicts[0]["verdict"], "failed");
    let text = stdout(&armid(["identify", &recording, "-v"]).success());
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
}

#[test]
fn validation_passes_on_another_recording_and_fails_a_hard_limit() {
    let folder = temporary();
    let recording = record(folder.path(), "R.mcap", "3");
    let other = record(folder.path(), "V.mcap", "4");
    let estimate = path(folder.path(), "E.json");
    armid(["identify", &recording, "-o", &estimate]).success();
    let verdict = json(&armid(["validate", &estimate, &other, "--json"]).success());
    for key in ["rms", "units", "relative_rms"] {
        assert_eq!(verdict[key].as_array().unwrap().len(), 6, "{key}");
    }
    assert_eq!(verdict["verdict"], "passed");
    let verdict = json(&armid(["validate", &estimate, &other, "--limit", "1e-6", "--json"]).code(1));
    assert_eq!(verdict["verdict"], "failed");
    let text = stdout(&armid(["validate", &estimate, &other]).success());
    assert!(text.contains("passed") && text.contains("wrist_roll"), "{text}");
}

#[test]
fn an_estimate_that_is_none_is_shown_with_line_and_column() {
    let folder = temporary();
    let recording = record(folder.path(), "R.mcap", "3");
    let broken = write(folder.path(), "E.json", "{\n  \"estimator\": wls\n}\n");
    let fault = stderr(&armid(["validate", &broken, &recording]).code(2));
    assert!(fault.contains("E.json:2:16: ") && fault.contains("expected an estimate"), "{fault}");
    let good = path(folder.path(), "good.json");
    armid(["identify", &recording, "-o", &good]).success();
    let other = std::fs::read_to_string(&good)
        .unwrap()
        .replace("\"robot\": \"crs-a460\",\n  \"sam", "\"robot\": \"arm\",\n  \"sam");
    let other = write(folder.path(), "other.json", &other);
    let fault = stderr(&armid(["validate", &other, &recording]).code(2));
    assert!(fault.contains("is of robot \"arm\", expected \"crs-a460\""), "{fault}");
}

#[test]
fn a_motion_that_does_not_excite_is_refused_with_advice() {
    let folder = temporary();
    let mut text = "period_s = 10.0\nharmonics = 1\n".to_owned();
    for name in ["waist", "shoulder", "elbow", "wrist_roll", "wrist_pitch", "tool_roll"] {
        let a = if name == "waist" { 0.5 } else { 0.0 };
        text += &format!("\n[[joint]]\nname = \"{name}\"\na = [{a:?}]\nb = [0.0]\nq0 = 0.1\n");
    }
    write(folder.path(), "T.toml", &text);
    let file = write(folder.path(), "x.toml", "robot = \"crs-a460\"\ntrajectory = \"T.toml\"\nperiods = 2\n");
    let recording = path(folder.path(), "R.mcap");
    armid(["run", &file, "-o", &recording]).success();
    let fault = stderr(&armid(["identify", &recording]).code(2));
    assert!(fault.contains("is not excited") && fault.contains("armid design"), "{fault}");
}

#[test]
fn a_joint_in_which_a_payload_does_not_show_is_named_and_the_others_are_reported() {
    let folder = temporary();
    let output = folder.path().join("constants.json");
    // Symmetric about the axis of the last joint: it adds nothing there.
    let payload = ["calibrate", "payload", "crs-a460", "--mass-kg", "1", "--centre-m", "0,0,0.05", "--periods", "2"];
    let done = armid(payload.into_iter().chain(["-o", output.to_str().unwrap(), "--json"])).code(1);
    let found = json(&done);
    let names = |key: &str| -> Vec<String> {
        found[key].as_array().unwrap().iter().map(|joint| joint["joint"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(names("joints"), ["waist", "shoulder", "elbow", "wrist_roll", "wrist_pitch"]);
    assert_eq!(names("findings"), ["tool_roll"]);
    assert!(found["findings"][0]["text"].as_str().unwrap().contains("joint \"tool_roll\": the payload adds 0.000 N·m"));
    assert!(output.is_file() && output.with_extension("svg").is_file());
}

#[test]
fn two_estimates_side_by_side_name_their_joints() {
    let folder = temporary();
    for seed in ["1", "2"] {
        let recording = record(folder.path(), &format!("R{seed}.mcap"), seed);
        armid(["identify", &recording, "-o", &path(folder.path(), &format!("E{seed}.json"))]).success();
    }
    let [first, second] = ["E1.json", "E2.json"].map(|name| path(folder.path(), name));
    let page = path(folder.path(), "page");
    let found = json(&armid(["report", "--compare", &first, &second, "-o", &page, "--json"]).success());
    assert_eq!(found["parameters"].as_array().unwrap().len(), 58);
    let html = std::fs::read_to_string(folder.path().join("page/report.html")).unwrap();
    assert!(html.contains("waist") && html.contains("wrist_roll") && !html.contains("joint 1"));
    // Estimates of an arm that is not bundled: numbers.
    let renamed = std::fs::read_to_string(&first).unwrap().replace("\"crs-a460\"", "\"someone-s-arm\"");
    for file in [&first, &second] {
        std::fs::write(file, &renamed).unwrap();
    }
    armid(["report", "--compare", &first, &second, "-o", &page]).success();
    let html = std::fs::read_to_string(folder.path().join("page/report.html")).unwrap();
    assert!(html.contains("joint 1") && !html.contains("waist"));
}

#[test]
fn select_reports_the_terms_that_the_simulated_arm_has() {
    let folder = temporary();
    let recording = record(folder.path(), "R.mcap", "4");
    let out = path(folder.path(), "E.json");
    let choice = "--select=rigid+rotor+friction+stribeck+spring";
    let estimate = json(&armid(["identify", &recording, choice, "-o", &out, "--json"]).success());
    let selection = &estimate["selection"];
    let verdict = |name: &str| {
        let terms = selection["terms"].as_array().expect("a list");
        terms.iter().find(|term| term["term"] == name).expect("a term")["verdict"].clone()
    };
    for (term, expected) in [("viscous", "supported"), ("coulomb", "supported"), ("spring", "not-supported")] {
        assert_eq!(verdict(term), expected, "{term}: {selection}");
    }
    assert_eq!(selection["columns"], estimate["columns"]);
    for term in selection["terms"].as_array().unwrap() {
        let named = estimate["columns"].as_str().unwrap().contains(term["term"].as_str().unwrap());
        let friction = estimate["columns"].as_str().unwrap().contains("friction");
        let usual = ["viscous", "coulomb", "offset"].contains(&term["term"].as_str().unwrap());
        assert_eq!(term["verdict"] == "supported", named || (friction && usual), "{term}");
        assert!(term["f"].is_null() || term["f"]["p_value"].is_number());
        assert!(term["held_out"].is_null() || term["held_out"]["data"] == "folds");
    }
    // What is written is an estimate that other commands read.
    armid(["validate", &out, &recording]).success();
    let text = stdout(&armid(["identify", &recording, choice]).success());
    assert!(text.contains("terms that the log supports") && text.contains("not supported"), "{text}");
    // Friction of the load is tested beside them and is no column; averaged periods say nothing of a warming gear.
    let choice = "--select=rigid+rotor+friction+load+warming";
    let estimate = json(&armid(["identify", &recording, choice, "--json"]).success());
    assert_eq!(estimate["columns"], "rigid+rotor+friction");
    let terms = estimate["selection"]["terms"].as_array().unwrap();
    let verdict = |name: &str| terms.iter().find(|term| term["term"] == name).expect("a term")["verdict"].clone();
    assert_eq!([verdict("load"), verdict("warming")], ["not-supported", "not-excited"], "{terms:?}");
    let refused = stderr(&armid(["identify", &recording, "--select=rigid+lod"]).code(2));
    assert!(refused.contains("\"rigid+lod\""), "{refused}");
    let both = stderr(&armid(["identify", &recording, "--select", "--columns", "rigid"]).code(2));
    assert!(both.contains("--columns"), "{both}");
}

#[test]
fn the_speed_at_which_friction_falls_is_asked_for_by_name() {
    let folder = temporary();
    let recording = record(folder.path(), "R.mcap", "5");
    let refused = stderr(&armid(["identify", &recording, "--stribeck-speed"]).code(2));
    assert!(refused.contains("Stribeck"), "{refused}");
    let (columns, out) = ("rigid+rotor+friction+stribeck", path(folder.path(), "E.json"));
    let choice = ["identify", &recording, "--columns", columns, "--stribeck-speed"];
    let estimate = json(&armid(choice.into_iter().chain(["-o", &out, "--json"])).success());
    let speeds = &estimate["stribeck_speed"];
    assert_eq!(speeds["joints"].as_array().unwrap().len(), 6, "{speeds}");
    // The simulated arm has no such friction.
    assert_eq!(speeds["not_shown"].as_array().unwrap().len(), 6, "{speeds}");
    assert!(speeds["joints"].as_array().unwrap().iter().all(|joint| joint["speed"].is_null()));
    assert_eq!(estimate["columns"], columns);
    armid(["validate", &out, &recording]).success();
    let text = stdout(&armid(choice).success());
    assert!(text.contains("speeds at which friction falls") && text.contains("Not shown"), "{text}");
    // The onset is asked for in a recording of armid's own, and an estimate holds the speeds that it was made with.
    assert!(estimate["onset_speed"].is_null(), "{estimate}");
    let load = "rigid+rotor+friction+load";
    let choice = ["identify", &recording, "--columns", load, "--onset-speed", "found", "-o", &out, "--json"];
    let estimate = json(&armid(choice).success());
    assert_eq!(estimate["onset_speed"]["joints"].as_array().unwrap().len(), 6, "{estimate}");
    assert_eq!(estimate["shape"].as_array().unwrap().len(), 6, "{estimate}");
    assert!(estimate["shape"].as_array().unwrap().iter().all(|of| of["coulomb_velocity_rad_s"].is_number()));
    assert_eq!(
        estimate["base"].as_array().unwrap().iter().filter(|of| of["name"].as_str().unwrap().starts_with("Fl")).count(),
        6
    );
    armid(["validate", &out, &recording]).success();
}
