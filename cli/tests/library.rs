//! What the library returns is what the command writes.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod support;

use armid::estimation::EstimatorKind;
use armid::excitation::CriterionKind;
use armid::observer::Unobserved;
use armid_io::log::process_all;
use armid_io::{Inputs, Log, LogSettings};
use armid_workflow::design::{DesignGoal, DesignSettings, design};
use armid_workflow::export::{Exchange, ExportSettings, export};
use armid_workflow::identification::{IdentifySettings, identify};
use armid_workflow::{ReductionSettings, reduce, validate};
use support::{armid, experiment, json, temporary};

#[test]
fn identity_a_design_of_the_library_is_that_of_the_command_byte_for_byte() {
    let folder = temporary();
    let out = folder.path().join("T.toml");
    let arguments = ["design", "planar-2r", "--criterion", "d-optimal", "--starts", "2", "--evaluations", "40"];
    let told = json(&armid(arguments.iter().chain(&["--json", "-o", out.to_str().unwrap()])).success());
    let goal = DesignGoal::Arm(CriterionKind::DOptimal.into());
    let settings = DesignSettings { starts: 2, evaluations: 40, ..DesignSettings::new(goal) };
    let loaded = armid_io::robot::find("planar-2r").unwrap();
    let answer = design(&loaded, &settings, &Unobserved).unwrap().unwrap();
    assert_eq!(answer.toml(), std::fs::read_to_string(&out).unwrap());
    let own = serde_json::to_value(&answer).unwrap();
    // What else the command says: where it wrote, and which commands follow.
    let beside = ["seconds", "file", "figures", "separating_experiments"];
    for (key, value) in told.as_object().unwrap().iter().filter(|(key, _)| !beside.contains(&key.as_str())) {
        assert_eq!(own.get(key), Some(value), "{key}");
    }
}

#[test]
fn identity_a_reduction_of_the_library_is_that_of_the_command() {
    let told = json(&armid(["reduce", "crs-a460", "--json"]).success());
    let loaded = armid_io::robot::find("crs-a460").unwrap();
    let answer = reduce(&loaded, &ReductionSettings::default()).unwrap();
    assert_eq!(serde_json::to_value(&answer).unwrap(), told);
}

#[test]
fn identity_the_file_of_an_estimate_is_the_answer_of_the_library() {
    let folder = temporary();
    let [log, out] = ["R.mcap", "E.json"].map(|name| folder.path().join(name).to_str().unwrap().to_owned());
    armid(["run", &experiment(folder.path(), 3), "-o", &log]).success();
    armid(["identify", &log, "--estimator", "ols,wls", "-o", &out]).success();
    let written: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(&out).unwrap()).unwrap();

    let read = Log::read(log.as_ref()).unwrap();
    let robot = read.robot().unwrap();
    let processed = process_all(vec![read], &robot, &LogSettings::default()).unwrap();
    // Where a log came from is the caller's to say.
    let inputs: Inputs = serde_json::from_value(written[0]["inputs"].clone()).unwrap();
    let estimators = vec![EstimatorKind::Ols, EstimatorKind::Wls];
    let settings = IdentifySettings { estimators, ..IdentifySettings::default() };
    let answer = identify(processed, Some(inputs), &settings, &Unobserved).unwrap();
    assert!(answer.is_sound() && !answer.interrupted);
    assert_eq!(serde_json::to_value(&answer).unwrap(), written);
}

#[test]
fn identity_a_validation_and_a_model_file_of_the_library_are_those_of_the_command() {
    let folder = temporary();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let [log, other, estimate, model] = ["R.mcap", "other.mcap", "E.json", "M.xml"].map(path);
    let plan = experiment(folder.path(), 3);
    armid(["run", &plan, "-o", &log]).success();
    armid(["run", &plan, "--seed", "9", "-o", &other]).success();
    armid(["identify", &log, "-o", &estimate]).success();
    let told = json(&armid(["validate", &estimate, &other, "--json"]).success());
    // An MJCF has no place for a soft onset of friction, which carries more than the noise of this log.
    let written = json(&armid(["export", &estimate, "--to", "mjcf", "-o", &model, "--json"]).code(1));

    let processed = |log: &str, settings: &LogSettings| {
        let read = Log::read(log.as_ref()).unwrap();
        let robot = read.robot().unwrap();
        process_all(vec![read], &robot, settings).unwrap()
    };
    let settings = LogSettings::default();
    let identified = armid_io::estimate::read(estimate.as_ref()).unwrap();
    let own = validate(
        std::slice::from_ref(&identified),
        &estimate,
        &processed(&other, &settings),
        [None; 2],
        0.1,
        &Unobserved,
    );
    let own = own.unwrap();
    assert!(own.passed());
    let mut own = serde_json::to_value(own).unwrap();
    // Two names of one file: as it was typed, and as it was read.
    own["logs"] = told["logs"].clone();
    assert_eq!(own, told);

    let log = processed(&log, &settings);
    let settings = ExportSettings { format: Exchange::Mjcf, into: None, file: Some(model.clone().into()) };
    let own = export(&identified, &estimate, log, &settings, &Unobserved).unwrap();
    assert!(!own.is_sound() && !own.lacking.is_empty());
    assert_eq!(own.text, std::fs::read_to_string(&model).unwrap());
    assert_eq!(serde_json::to_value(&own).unwrap(), written);
}
