//! `armid design`

mod support;

use std::f64::consts::TAU;
use std::path::Path;

use serde_json::Value;
use support::{armid, json, stderr, stdout, temporary};

fn path(folder: &Path, name: &str) -> String {
    folder.join(name).to_str().expect("a path in UTF-8").to_owned()
}

/// A small budget: the tests ask what is answered, not how good it is.
const SMALL: [&str; 6] = ["--starts", "2", "--evaluations", "40", "--columns", "rigid"];

fn design(criterion: &str, more: &[&str], out: &str) -> Value {
    let arguments = ["design", "crs-a460", "--criterion", criterion, "-o", out, "--json"];
    json(&armid(arguments.iter().chain(&SMALL).chain(more)).success())
}

#[test]
fn the_keys_of_the_contract_are_there_for_every_criterion() {
    let folder = temporary();
    for criterion in [
        "condition",
        "condition-scaled",
        "condition-in-units",
        "d-optimal",
        "a-optimal",
        "condition-plus-d",
        "i-optimal",
        "model-error",
    ] {
        let out = path(folder.path(), "T.toml");
        let found = design(criterion, &[], &out);
        assert_eq!(found["criterion"], criterion);
        for key in [
            "condition",
            "condition_scaled",
            "log_det_information",
            "condition_all",
            "condition_scaled_all",
            "log_det_information_all",
            "iterations",
            "evaluations",
            "seconds",
        ] {
            assert!(found[key].is_number(), "{key}");
        }
        for key in ["position", "velocity", "acceleration", "torque"] {
            let used = found["worst_limit_use"][key].as_f64().unwrap();
            assert!(used > 0.0 && used <= 1.0 + 1e-9, "{key}: {used}");
        }
        assert!(found["worst_limit_use"].get("clearance_m").is_some());
        assert!(found["certificate_samples"].as_u64().unwrap() >= 5000);
        assert!(found["termination"].is_string());
        let figures: Vec<&str> = found["figures"].as_array().unwrap().iter().map(|f| f.as_str().unwrap()).collect();
        assert_eq!(figures, ["T-convergence.svg", "T-limits.svg", "T-poses.svg"].map(|name| path(folder.path(), name)));
        assert!(figures.iter().all(|figure| Path::new(figure).is_file()));
        // Only rigid columns were asked for: both sets of figures are the same.
        assert_eq!(found["condition"], found["condition_all"]);
        let written: toml::Table = std::fs::read_to_string(&out).unwrap().parse().unwrap();
        assert_eq!(written["period_s"].as_float(), found["trajectory"]["period_s"].as_f64());
        assert_eq!(written["joint"][0]["a"][0].as_float(), found["trajectory"]["joint"][0]["a"][0].as_f64());
    }
}

#[test]
fn a_design_expects_what_it_is_told_of_and_predicts_where_it_is_told_to() {
    let folder = temporary();
    let out = |name: &str| path(folder.path(), name);
    let usual = design("model-error", &[], &out("usual.toml"));
    assert_eq!(usual["expected"], serde_json::json!(["load-friction", "elasticity"]));
    let told = design("model-error", &["--expect", "current-lag=3.0"], &out("told.toml"));
    assert_eq!(told["expected"], serde_json::json!(["current-lag"]));
    assert_ne!(told["trajectory"], usual["trajectory"]);
    let fast = design("i-optimal", &[], &out("fast.toml"));
    let aimed = design("i-optimal", &["--predict", &out("usual.toml")], &out("aimed.toml"));
    let moves = design("i-optimal", &["--predict", "point-to-point"], &out("moves.toml"));
    let slow = design("i-optimal", &["--predict", "slow"], &out("slow.toml"));
    let found = [&fast, &aimed, &moves, &slow].map(|design| &design["trajectory"]);
    assert!((1..4).all(|k| !found[..k].contains(&found[k])), "each set of motions has a design of its own");
    assert!(fast["expected"].is_null());
}

#[test]
fn identity_equal_seed_equal_trajectory_for_any_number_of_threads() {
    let folder = temporary();
    let mut texts = Vec::new();
    for (name, threads) in [("one.toml", "1"), ("two.toml", "2")] {
        let out = path(folder.path(), name);
        assert_cmd::Command::new(support::program())
            .args(["design", "crs-a460", "--criterion", "d-optimal", "-o", &out])
            .args(SMALL)
            .env("RAYON_NUM_THREADS", threads)
            .assert()
            .success();
        texts.push(std::fs::read_to_string(&out).unwrap());
    }
    assert_eq!(texts[0], texts[1]);
    let other = path(folder.path(), "other.toml");
    design("d-optimal", &["--seed", "2"], &other);
    assert_ne!(texts[0], std::fs::read_to_string(&other).unwrap());
}

/// The series written out from the file's own numbers, on a grid of its own, against the limits as `armid robot` says.
#[test]
fn identity_nothing_is_exceeded_on_another_grid() {
    let folder = temporary();
    let out = path(folder.path(), "T.toml");
    design("condition", &["--max-acceleration", "8"], &out);
    let robot = json(&armid(["robot", "crs-a460", "--json"]).success());
    let file: toml::Table = std::fs::read_to_string(&out).unwrap().parse().unwrap();
    let omega = TAU / file["period_s"].as_float().unwrap();
    for (moved, joint) in file["joint"].as_array().unwrap().iter().zip(robot["joints"].as_array().unwrap()) {
        assert_eq!(moved["name"].as_str(), joint["name"].as_str());
        let numbers = |key: &str| -> Vec<f64> {
            moved[key].as_array().unwrap().iter().map(|value| value.as_float().unwrap()).collect()
        };
        let (a, b, q0) = (numbers("a"), numbers("b"), moved["q0"].as_float().unwrap());
        let limits = &joint["limits"];
        let limit = |value: &Value| value.as_f64().unwrap();
        for k in 0..7001 {
            let t = k as f64 / 7001.0 * TAU / omega;
            let (mut q, mut qd, mut qdd) = (q0, 0.0, 0.0);
            for (l, (a, b)) in a.iter().zip(&b).enumerate() {
                let w = omega * (l + 1) as f64;
                let (sin, cos) = (w * t).sin_cos();
                q += a / w * sin - b / w * cos;
                qd += a * cos + b * sin;
                qdd += w * (b * cos - a * sin);
            }
            // Rounding alone.
            let slack = 1e-9;
            assert!(q >= limit(&limits["position"][0]) - slack && q <= limit(&limits["position"][1]) + slack);
            assert!(qd.abs() <= limit(&limits["velocity"]) + slack, "{} {qd}", moved["name"]);
            assert!(qdd.abs() <= 8.0 + slack, "{} {qdd}", moved["name"]);
        }
    }
    // And the designed trajectory can be performed.
    let experiment =
        support::write(folder.path(), "x.toml", "robot = \"crs-a460\"\ntrajectory = \"T.toml\"\nperiods = 1\n");
    armid(["run", &experiment, "-o", &path(folder.path(), "R.mcap")]).success();
}

#[test]
fn no_trajectory_within_the_limits_is_a_negative_verdict_with_the_nearest_written() {
    let folder = temporary();
    let out = path(folder.path(), "T.toml");
    // Gravity alone asks for more than a thousandth of the shoulder's rating.
    let robot = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../models/crs-a460/robot.toml")).unwrap();
    let nominal =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../models/crs-a460/nominal.toml")).unwrap();
    let weak = support::write(folder.path(), "robot.toml", &robot.replace("torque_nm = 66.08", "torque_nm = 0.06"));
    support::write(folder.path(), "nominal.toml", &nominal);
    let arguments = ["design", &weak, "--criterion", "d-optimal", "-o", &out];
    let text = stdout(&armid(arguments.iter().chain(&SMALL)).code(1));
    assert!(text.contains("no trajectory within the limits was found") && text.contains("torque"), "{text}");
    assert!(text.contains("\"shoulder\""), "{text}");
    let written = std::fs::read_to_string(&out).unwrap();
    assert!(written.contains("[certificate]"));
    // And it moves nothing.
    let experiment = support::write(folder.path(), "x.toml", "robot = \"robot.toml\"\ntrajectory = \"T.toml\"\n");
    let fault = stderr(&armid(["run", &experiment, "-o", &path(folder.path(), "R.mcap")]).code(2));
    assert!(fault.contains("torque") && fault.contains("exceeds its limit"), "{fault}");
}

#[test]
fn a_certificate_that_was_changed_or_is_of_other_parameters_moves_nothing() {
    let folder = temporary();
    let models = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/crs-a460/");
    let text = |name: &str| std::fs::read_to_string(format!("{models}{name}")).unwrap();
    let robot = support::write(folder.path(), "robot.toml", &text("robot.toml"));
    support::write(folder.path(), "nominal.toml", &text("nominal.toml"));
    support::write(folder.path(), "truth.toml", &text("truth.toml"));
    let (out, recording) = (path(folder.path(), "T.toml"), path(folder.path(), "R.mcap"));
    armid(["design", &robot, "--criterion", "d-optimal", "-o", &out].iter().chain(&SMALL)).success();
    let plan = "robot = \"robot.toml\"\ntrajectory = \"T.toml\"\nperiods = 1\n";
    let experiment = support::write(folder.path(), "x.toml", plan);
    let certified = std::fs::read_to_string(&out).unwrap();
    armid(["run", &experiment, "-o", &recording]).success();
    let refused = || {
        std::fs::remove_file(&recording).ok();
        let fault = stderr(&armid(["run", &experiment, "-o", &recording]).code(2));
        assert!(!Path::new(&recording).exists());
        fault
    };
    // One digit of one figure.
    let at = certified.find("\ncondition = ").unwrap() + "\ncondition = ".len();
    let mut changed = certified.clone();
    changed.replace_range(at..=at, if &certified[at..=at] == "9" { "8" } else { "9" });
    std::fs::write(&out, &changed).unwrap();
    assert!(refused().contains("has been changed since it was made"));
    std::fs::write(&out, &certified).unwrap();
    // Another guess of what the links weigh, after the design: a lighter one, by which no limit is passed.
    let lighter = text("nominal.toml").replace("mass_kg = 8.2", "mass_kg = 8.0");
    assert_ne!(lighter, text("nominal.toml"));
    support::write(folder.path(), "nominal.toml", &lighter);
    let fault = refused();
    assert!(fault.contains("is for nominal parameters"), "{fault}");
}

#[test]
fn impossible_settings_are_named() {
    let folder = temporary();
    let out = path(folder.path(), "T.toml");
    for (arguments, wanted) in [
        (vec!["--criterion", "d-optimum"], "d-optimal"),
        (vec!["--criterion", "condition", "--starts", "0"], "--starts is 0"),
        (vec!["--criterion", "condition", "--max-acceleration=-1"], "acceleration limit is -1"),
        (vec!["--criterion", "condition", "--period", "0"], "0"),
        (vec!["--criterion", "condition", "--harmonics", "0"], "0"),
        (vec!["--criterion", "condition", "--evaluations", "0"], "number of evaluations is 0"),
        (
            vec!["--criterion", "condition", "--expect", "elasticity"],
            "--expect with --criterion condition, expected model",
        ),
        (vec!["--criterion", "model-error", "--expect", "backlash"], "expected one of stribeck, load-friction"),
        (vec!["--criterion", "model-error", "--expect", "elasticity=90"], "at most 30 mrad"),
        (
            vec!["--criterion", "d-optimal", "--predict", "table-one"],
            "expected i-optimal, model-error or measured-torque",
        ),
        (vec!["--criterion", "i-optimal", "--predict", "fast"], "one of random, slow, point-to-point"),
        (vec![], "--criterion"),
    ] {
        let fault = stderr(&armid(["design", "crs-a460", "-o", &out].iter().chain(&arguments)).code(2));
        assert!(fault.contains(wanted), "{wanted} not in {fault}");
        assert!(!Path::new(&out).exists());
    }
}

#[test]
fn identity_a_search_from_a_trajectory_goes_on_where_that_one_ended() {
    let folder = temporary();
    let (first, further) = (path(folder.path(), "T1.toml"), path(folder.path(), "T2.toml"));
    let before = design("d-optimal", &[], &first);
    // The named trajectory alone, and once more beside the drawn starts, where it comes first.
    let mut alone = vec!["design", "crs-a460", "--criterion", "d-optimal", "--columns", "rigid", "--evaluations", "40"];
    alone.extend(["--starts", "0", "--from", &first, "-o", &further, "--json"]);
    let after = json(&armid(alone).success());
    assert_eq!(after["starts"].as_array().unwrap().len(), 1);
    assert!(after["value"].as_f64() >= before["value"].as_f64(), "{before} {after}");
    let three = design("d-optimal", &["--from", &first], &further);
    assert_eq!(three["starts"].as_array().unwrap().len(), 3);
    assert_eq!(three["starts"][0]["value"], after["starts"][0]["value"]);
    for (setting, value, wanted) in [("--family", "cubic-b-spline", "family"), ("--period", "12", "period")] {
        let arguments = ["design", "crs-a460", "--criterion", "d-optimal", "--from", &first, setting, value];
        let fault = stderr(&armid(arguments.iter().chain(&SMALL)).code(2));
        assert!(fault.contains("T1.toml") && fault.contains(wanted), "{fault}");
    }
}

#[test]
fn the_text_reads_at_a_hundred_columns() {
    let folder = temporary();
    let out = path(folder.path(), "T.toml");
    let arguments = ["design", "crs-a460", "--criterion", "d-optimal", "-o", &out, "-v", "--weighted"];
    let text = stdout(&armid(arguments.iter().chain(&SMALL)).success());
    assert!(text.contains("condition number") && text.contains("random trajectories"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
}

#[test]
fn identity_every_family_is_designed_with_a_frozen_joint_and_performed() {
    let folder = temporary();
    for (family, key) in [("fourier-quintic", "fourier-quintic"), ("cubic-b-spline", "b-spline")] {
        let out = path(folder.path(), "T.toml");
        let more = ["--family", family, "--harmonics", "4,4,4,2,2,2", "--freeze", "wrist_roll=0.2"];
        let found = design("d-optimal", &more, &out);
        assert_eq!(found["trajectory"]["family"], key);
        assert!(found["worst_limit_use"]["velocity"].as_f64().unwrap() <= 1.0 + 1e-9);
        let file: toml::Table = std::fs::read_to_string(&out).unwrap().parse().unwrap();
        let still = file["joint"].as_array().unwrap().iter().find(|joint| joint["name"].as_str() == Some("wrist_roll"));
        match still.unwrap().get("c") {
            // Shrinking about the mean of equal values leaves rounding.
            Some(c) => assert!(c.as_array().unwrap().iter().all(|c| (c.as_float().unwrap() - 0.2).abs() < 1e-12)),
            None => assert_eq!(still.unwrap()["q0"].as_float(), Some(0.2)),
        }
        let text = "robot = \"crs-a460\"\ntrajectory = \"T.toml\"\nperiods = 2\n";
        let experiment = support::write(folder.path(), "x.toml", text);
        armid(["run", &experiment, "-o", &path(folder.path(), "R.mcap")]).success();
    }
}

#[test]
fn identity_a_prior_adds_information_and_must_be_of_the_same_robot_and_columns() {
    let folder = temporary();
    let (recording, estimate) = (path(folder.path(), "R.mcap"), path(folder.path(), "E.json"));
    armid(["run", &support::experiment(folder.path(), 2), "-o", &recording]).success();
    armid(["identify", &recording, "--columns", "rigid", "-o", &estimate]).success();
    let out = path(folder.path(), "T.toml");
    let first = design("d-optimal", &["--prior", &estimate], &out);
    let once = first["value"].as_f64().unwrap();
    // Table I first, then one that is made for what it lacks: better than the same again.
    let [bought, repeated] =
        ["bound_ratio", "bound_ratio_by_repetition"].map(|key| first["prior"][key].as_f64().unwrap());
    assert!((repeated - 0.5_f64.sqrt()).abs() < 1e-12 && bought < 0.9 * repeated, "{bought} {repeated}");
    let again = ["--prior", &estimate, &estimate, "--from", &out, "--iterations", "0"];
    let twice = design("d-optimal", &again, &path(folder.path(), "again.toml"))["value"].as_f64().unwrap();
    // The information so far is a part of what is reported: along the same motion ln det rises with it, by at most 36 ln 2.
    assert!(twice > once && twice - once < 36.0 * 2.0_f64.ln(), "{once} {twice}");
    let refused = |robot: &str, criterion: &str, columns: &str| {
        let arguments = ["design", robot, "--criterion", criterion, "--columns", columns, "--prior", &estimate];
        stderr(&armid(arguments).code(2))
    };
    let text = refused("puma-560", "d-optimal", "rigid");
    assert!(text.contains("crs-a460") && text.contains("puma-560"), "{text}");
    let text = refused("crs-a460", "d-optimal", "rigid+rotor");
    assert!(text.contains("\"rigid\"") && text.contains("rigid+rotor"), "{text}");
    let text = refused("crs-a460", "condition", "rigid");
    assert!(
        ["d-optimal", "a-optimal", "e-optimal", "i-optimal", "model-error"].iter().all(|name| text.contains(name)),
        "{text}"
    );
    let changed = std::fs::read_to_string(&estimate).unwrap().replace("\"robot_sha256\": \"", "\"robot_sha256\": \"0");
    std::fs::write(&estimate, changed).unwrap();
    assert!(refused("crs-a460", "d-optimal", "rigid").contains("SHA-256"));
}

#[test]
fn what_the_robot_file_declares_has_an_experiment_that_shows_it() {
    let folder = temporary();
    let robot = path(folder.path(), "arm/robot.toml");
    std::fs::create_dir(folder.path().join("arm")).unwrap();
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/planar-2r");
    for file in std::fs::read_dir(models).unwrap() {
        let file = file.unwrap();
        std::fs::copy(file.path(), folder.path().join("arm").join(file.file_name())).unwrap();
    }
    let plain = std::fs::read_to_string(&robot).unwrap();
    let arguments =
        ["design", &robot, "--criterion", "d-optimal", "--period", "3", "--starts", "1", "--evaluations", "20"];
    let out = ["-o", &path(folder.path(), "T.toml")];
    let found = json(&armid(arguments.iter().chain(&out).chain(&["--json"])).success());
    assert_eq!(found["separating_experiments"], Value::Array(Vec::new()));
    std::fs::write(&robot, format!("{plain}\n[uncertainty]\ntorque_constant = 0.03\ncurrent_lag_s = 0.0005\n"))
        .unwrap();
    let text = stdout(&armid(arguments.iter().chain(&out)).success());
    assert!(
        text.contains("torque_constant (declared 0.03)") && text.contains("current_lag_s (declared 5.00e-4)"),
        "{text}"
    );
    // What is proposed can be typed.
    let proposed =
        text.lines().map(str::trim).find(|line| line.starts_with("armid design") && line.contains("--period 6"));
    let words: Vec<&str> = proposed.unwrap().split(' ').skip(1).collect();
    let to = path(folder.path(), "S.toml");
    let words = words.iter().map(|word| if *word == "S.toml" { to.as_str() } else { word });
    armid(words.chain(["--starts", "1", "--evaluations", "20"])).success();
    assert!(Path::new(&to).is_file());
}
