//! `armid campaign`: round by round until a target is reached.

mod support;

use std::path::Path;

use support::{armid, armid_in, files, json, stderr, stdout, temporary, write};

/// A small experiment on the planar arm.
fn planar(folder: &Path) -> String {
    let text = "name = \"small\"\nrobot = \"planar-2r\"\nrate_hz = 250.0\nperiods = 3\n";
    write(folder, "small.toml", text)
}

const SMALL: [&str; 8] = ["--period", "4", "--starts", "1", "--evaluations", "40", "--until", "torque <= 0.34 %"];

#[test]
fn a_campaign_goes_on_where_it_ended_and_to_the_same_bytes() {
    let folder = temporary();
    let (plan, place) = (planar(folder.path()), folder.path().join("campaign"));
    let there = place.display().to_string();
    let asked = [&["campaign", &plan][..], &SMALL, &["--quiet", "-o", &there]].concat();
    let answer = json(&armid([&asked[..], &["--json"]].concat()).success());
    assert_eq!(answer["outcome"], "reached");
    let rounds = answer["rounds"].as_array().expect("rounds").len();
    assert!(rounds >= 2, "{answer}");
    let whole = files(&place);
    assert!(whole.keys().any(|name| name == "progress.svg"), "{:?}", whole.keys());

    // As if it had been killed while the last round was recorded, and later while it was identified.
    let last = place.join(format!("rounds/{rounds:02}"));
    for lost in [&["E.json", "log.mcap"][..], &["E.json"]] {
        lost.iter().for_each(|name| std::fs::remove_file(last.join(name)).expect("a file of the round"));
        std::fs::write(last.join("log.mcap.part"), "cut off").expect("a file");
        assert!(stdout(&armid(["campaign", &there]).success()).contains("every target is reached"));
        let _ = std::fs::remove_file(last.join("log.mcap.part"));
        assert!(files(&place) == whole);
    }
    // Another tool's file of the estimate is tested on the logs of the rounds, from any folder. A URDF lacks terms, whatever it predicts.
    let export = ["export", "campaign/estimate.json", "--to", "urdf", "-o", "arm.urdf", "--json"];
    let file = json(&armid_in(folder.path(), export));
    assert!(file["prediction"]["file"]["fit"].is_f64() && folder.path().join("arm.urdf").is_file(), "{file}");
    let estimate: serde_json::Value = serde_json::from_slice(&whole["estimate.json"]).expect("an estimate");
    assert_eq!(
        estimate["inputs"]["logs"].as_array().and_then(|logs| logs.last()),
        Some(&format!("rounds/{rounds:02}/log.mcap").into())
    );
    assert!(stderr(&armid(["campaign", &there, "--rounds", "3"]).code(2)).contains("has its settings"));
    assert!(stderr(&armid(["campaign", &there, "--log", "x.csv"]).code(2)).contains("not by hand"));
}

#[test]
fn by_hand_every_round_waits_for_its_log() {
    let folder = temporary();
    let (plan, place) = (planar(folder.path()), folder.path().join("campaign"));
    let there = place.display().to_string();
    let mut told =
        armid([&["campaign", &plan][..], &SMALL, &["--by-hand", "--quiet", "-o", &there]].concat()).success();
    for round in 1..=8 {
        let said = stdout(&told);
        if said.contains("every target is reached") {
            assert!(round > 2, "{said}");
            return;
        }
        let own = place.join(format!("rounds/{round:02}"));
        assert!(said.contains("--log FILE") && own.join("points.csv").is_file(), "{said}");
        let log = own.join("brought.csv").display().to_string();
        armid(["run", &own.join("experiment.toml").display().to_string(), "--quiet", "-o", &log]).success();
        told = armid(["campaign", &there, "--log", &log]).success();
    }
    panic!("eight rounds did not reach the target: {}", stdout(&told));
}

#[test]
fn what_is_no_target_is_refused_with_what_was_expected() {
    let folder = temporary();
    let there = folder.path().join("campaign").display().to_string();
    let fault = |target: &str| stderr(&armid(["campaign", "planar-2r", "--until", target, "-o", &there]).code(2));
    assert!(fault("torque < 3 %").contains("torque <= 3 %"));
    assert!(fault("Fc3 <= 3 %").contains("did you mean \"Fc"));
    assert!(stderr(&armid(["campaign", "planar-2r", "-o", &there]).code(2)).contains("no target"));
}
