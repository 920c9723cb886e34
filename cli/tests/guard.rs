//! The guard on the command line, around simulated arms.

mod support;

use std::path::Path;

use support::{armid, experiment, json, stderr, stdout, temporary, write};

fn path(folder: &Path, name: &str) -> String {
    folder.join(name).to_str().expect("a path in UTF-8").to_owned()
}

#[test]
fn identity_a_guarded_run_has_the_samples_of_one_that_is_not() {
    let folder = temporary();
    let experiment = experiment(folder.path(), 1);
    let (plain, guarded) = (path(folder.path(), "plain.csv"), path(folder.path(), "guarded.csv"));
    armid(["run", &experiment, "-o", &plain]).success();
    let done = json(&armid(["run", &experiment, "--guard", "-o", &guarded, "--json"]).success());
    assert!(std::fs::read(&plain).unwrap() == std::fs::read(&guarded).unwrap());
    assert!(done["trip"].is_null());
    let used = done["guard"]["used"].as_object().unwrap();
    assert!(used.len() >= 7 && used.values().all(|used| used.as_f64().unwrap() < 1.0), "{used:?}");
    assert_eq!(done["guard"]["preflight"].as_array().unwrap().len(), 3);
}

#[test]
fn a_trip_ends_with_status_1_a_reason_and_a_recording_that_is_whole() {
    let folder = temporary();
    let base = std::fs::read_to_string(experiment(folder.path(), 1)).unwrap();
    let strict = write(folder.path(), "strict.toml", &format!("{base}\n[guard]\nfollowing_error_deg = 0.05\n"));
    let recording = path(folder.path(), "R.mcap");
    let done = json(&armid(["run", &strict, "--guard", "-o", &recording, "--json"]).code(1));
    assert_eq!((done["ending"].as_str(), done["trip"]["name"].as_str()), (Some("tripped"), Some("following-error")));
    assert_eq!((done["trip"]["action"].as_str(), done["trip"]["phase"].as_str()), (Some("cancel"), Some("settle")));
    assert!(done["trip"]["reason"].as_str().unwrap().contains("from its command, expected at most 0.0009 rad"));
    assert_eq!(done["recording"].as_str(), Some(format!("{recording}.part").as_str()));
    // MCAP's footer is there: the file was finished, not cut off. The reason is in it.
    let bytes = std::fs::read(format!("{recording}.part")).unwrap();
    assert!(bytes.ends_with(b"\x89MCAP0\r\n"));
    let holds = |text: &str| bytes.windows(text.len()).any(|window| window == text.as_bytes());
    assert!(holds("tripped") && holds("following-error"));
    let shown = stdout(&armid(["run", &strict, "--guard", "-o", &path(folder.path(), "again.mcap")]).code(1));
    assert!(
        shown.contains("tripped at t = ") && shown.contains("cancel asked for within 11 ms, the simulation ended"),
        "{shown}"
    );
}

/// What `armid design` writes by default, the guard takes, and it is performed to its end: on every robot that is bundled,
/// wherever its limits are.
#[test]
fn designs_by_default_settings_pass_the_preflight() {
    let folder = temporary();
    let listed = json(&armid(["robot", "--json"]).success());
    let robots: Vec<&str> = listed.as_array().unwrap().iter().map(|r| r["name"].as_str().unwrap()).collect();
    assert!(robots.len() >= 4, "{listed}");
    for robot in robots {
        let (design, recording) = (path(folder.path(), "T.toml"), path(folder.path(), &format!("{robot}.mcap")));
        let small = ["--starts", "1", "--evaluations", "60", "--no-baseline", "--period", "4", "--harmonics", "4"];
        let arguments = ["design", robot, "--criterion", "d-optimal", "-o", &design, "--json"];
        let found = json(&armid(arguments.iter().chain(&small)).success());
        let used = found["worst_limit_use"]["position"].as_f64().unwrap();
        assert!(used < 1.0, "{robot}: {used}");
        let text = format!(
            "robot = \"{robot}\"\ntrajectory = \"T.toml\"\nrate_hz = 500\nsettle_s = 0.2\ndiscarded_periods = 0\nperiods = 1\n"
        );
        let experiment = write(folder.path(), "experiment.toml", &text);
        let done = json(&armid(["run", &experiment, "--guard", "-o", &recording, "--json"]).success());
        let passed = done["guard"]["preflight"].as_array().unwrap();
        assert!(passed.iter().any(|check| check["check"] == "soft-limits"), "{robot}: {passed:?}");
        assert!(done["trip"].is_null(), "{robot}: {}", done["detail"]);
    }
}

#[test]
fn a_reduced_speed_slows_the_motion_and_watches_the_flange() {
    let folder = temporary();
    let experiment = experiment(folder.path(), 1);
    let recording = path(folder.path(), "R.mcap");
    let arguments = ["run", &experiment, "--guard", "--reduced-speed", "-o", &recording, "--json"];
    let done = json(&armid(arguments).success());
    assert!(done["speed"].as_f64().unwrap() < 1.0, "{}", done["speed"]);
    let used = done["guard"]["used"]["reduced-speed"].as_f64().unwrap();
    assert!(used > 0.7 && used < 1.0, "{used}");
    assert_eq!(done["guard"]["settings"]["reduced_speed_mm_s"], 250.0);
    // The period is whole, and longer than designed by what the speed says.
    let samples = done["period_s"].as_f64().unwrap() * done["rate_hz"].as_f64().unwrap();
    assert!((samples - samples.round()).abs() < 1e-6, "{samples}");
    assert!((done["period_s"].as_f64().unwrap() * done["speed"].as_f64().unwrap() - 10.0).abs() < 1e-9);
    let fault = stderr(&armid(["run", &experiment, "--reduced-speed", "5000"]).code(2));
    assert!(fault.contains("expected more than 0 and at most 1000 mm/s"), "{fault}");
}

#[test]
fn a_named_point_is_kept_below_the_line_and_a_first_run_stays_below_it() {
    let folder = temporary();
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/crs-a460");
    for file in ["robot.toml", "nominal.toml", "truth.toml"] {
        std::fs::copy(models.join(file), folder.path().join(file)).unwrap();
    }
    let robot = folder.path().join("robot.toml");
    let text = std::fs::read_to_string(&robot).unwrap();
    let text = format!("{text}\n[[point]]\nname = \"tip\"\nlink = \"tool_roll\"\nposition_m = [0, 0, 0.08]\n");
    std::fs::write(&robot, text).unwrap();
    let armed =
        "robot = \"robot.toml\"\ntrajectory = \"table-one\"\nrate_hz = 500\nperiods = 1\ndiscarded_periods = 0\n";
    let armed = write(folder.path(), "armed.toml", armed);
    let bare = armed.replace("armed.toml", "bare.toml");
    std::fs::write(&bare, std::fs::read_to_string(&armed).unwrap().replace("robot.toml", "crs-a460")).unwrap();
    let recording = path(folder.path(), "R.mcap");
    let speeds = [&bare, &armed].map(|experiment| {
        let arguments = ["run", experiment, "--guard", "--reduced-speed", "--first-run", "-o", &recording, "--json"];
        let done = json(&armid(arguments).success());
        let used = done["guard"]["used"]["reduced-speed"].as_f64().unwrap();
        assert!(used > 0.7 && used < 1.0, "{used}");
        let steps: Vec<f64> = done["steps"].as_array().unwrap().iter().map(|s| s["speed"].as_f64().unwrap()).collect();
        assert!(steps.len() == 2 && steps[0] == 0.1 && steps[1] < 0.5, "10 % and what the line allows: {steps:?}");
        assert_eq!(done["recording"].as_str(), Some(recording.as_str()));
        steps[1]
    });
    assert!(speeds[1] < speeds[0], "{speeds:?}");
}

#[test]
fn a_slower_run_and_a_first_run_say_their_speed() {
    let folder = temporary();
    let experiment = experiment(folder.path(), 1);
    let recording = path(folder.path(), "R.mcap");
    let done = json(&armid(["run", &experiment, "--guard", "--first-run", "-o", &recording, "--json"]).success());
    let speeds: Vec<f64> = done["steps"].as_array().unwrap().iter().map(|s| s["speed"].as_f64().unwrap()).collect();
    assert_eq!(speeds, [0.1, 0.5, 1.0]);
    let periods: Vec<f64> =
        done["steps"].as_array().unwrap().iter().map(|step| step["period_s"].as_f64().unwrap()).collect();
    assert_eq!(periods, [100.0, 20.0, 10.0]);
    for name in ["R-10.mcap", "R-50.mcap", "R.mcap"] {
        assert!(folder.path().join(name).is_file(), "{name}");
    }
    let fault = stderr(&armid(["run", &experiment, "--speed", "200%"]).code(2));
    assert!(fault.contains("expected a part of the designed speed"), "{fault}");
}

#[test]
fn a_wrong_line_of_the_guard_is_shown_with_its_place() {
    let folder = temporary();
    let base = "robot = \"crs-a460\"\ntrajectory = \"table-one\"\n";
    for (table, wanted) in [
        ("[guard]\nstale_ms = 0\n", "stale_ms is 0, expected more than 0, at most 1000"),
        ("[guard]\nstale = 3\n", "x.toml:4:1: unknown field `stale`"),
        ("[ros2]\ndomian = 3\n", "x.toml:4:1: unknown field `domian`"),
    ] {
        let file = write(folder.path(), "x.toml", &format!("{base}{table}"));
        let fault = stderr(&armid(["run", &file, "-o", &path(folder.path(), "R.mcap")]).code(2));
        assert!(fault.contains(wanted), "{wanted} not in {fault}");
    }
    // The soft limits are narrower than the motion.
    let file = write(folder.path(), "x.toml", &format!("{base}[guard]\nsoft_margin_deg = 30\n"));
    let fault = stderr(&armid(["run", &file, "--guard", "-o", &path(folder.path(), "R.mcap")]).code(2));
    assert!(fault.contains("preflight, soft-limits: found joint \"wrist_pitch\""), "{fault}");
    assert!(!folder.path().join("R.mcap.part").exists());
}

#[test]
fn nothing_real_moves_without_a_word_or_an_earlier_run() {
    let folder = temporary();
    let file = write(folder.path(), "x.toml", "robot = \"crs-a460\"\ntrajectory = \"table-one\"\narm = \"ros2\"\n");
    let recording = path(folder.path(), "R.mcap");
    let fault = stderr(&armid(["run", &file, "-o", &recording, "--yes-the-estop-works"]).code(2));
    assert!(fault.contains("100 % of the speed needs an earlier run of this motion on this arm at 50 %"), "{fault}");
    let fault = stderr(&armid(["run", &file, "--speed", "10%", "-o", &recording]).code(2));
    assert!(fault.contains("no operator confirmed that the emergency stop works"), "{fault}");
    // A simulated run is no earlier run of the real arm.
    let simulated = path(folder.path(), "S.mcap");
    armid(["run", &file, "--arm", "analytic", "--periods", "1", "-o", &simulated]).success();
    let fault =
        stderr(&armid(["run", &file, "-o", &recording, "--yes-the-estop-works", "--earlier", &simulated]).code(2));
    assert!(fault.contains("was recorded on arm analytic"), "{fault}");
}
