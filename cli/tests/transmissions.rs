//! Motors and links both measured: from an experiment with two encoders for each joint to the stiffness of its transmissions.

mod support;

use serde_json::Value;
use support::{armid, json, stdout, temporary, write};

/// Stiffnesses of the planar arm whose springs are wound up by 6 mrad at the ratings, 50 and 20 N·m.
const TRUTH: [f64; 2] = [50.0 / 6e-3, 20.0 / 6e-3];

fn check(estimate: &Value) {
    let transmissions = estimate["transmissions"].as_array().expect("a list");
    assert_eq!(transmissions.len(), 2);
    for (one, truth) in transmissions.iter().zip(TRUTH) {
        assert_eq!((one["verdict"].as_str(), one["unit"].as_str()), (Some("decided"), Some("N·m/rad")), "{one}");
        let end = |k: usize| one["stiffness"]["ci95"][k].as_f64().expect("a number");
        // Half as wide again: a test that holds in all but one of some hundred runs.
        let slack = 0.25 * (end(1) - end(0));
        assert!(end(0) - slack < truth && truth < end(1) + slack && end(1) - end(0) < 0.3 * truth, "{one} {truth}");
    }
}

#[test]
fn stiffness_is_found_in_a_recording_with_link_encoders_and_in_a_table_of_it() {
    let folder = temporary();
    let joint = |name: &str, a: &str, b: &str| format!("[[joint]]\nname = \"{name}\"\na = {a}\nb = {b}\nq0 = 0.4\n");
    let trajectory = "period_s = 5.0\nharmonics = 3\n".to_owned()
        + &joint("shoulder", "[0.5, 0.4, -0.3]", "[0.3, -0.4, 0.2]")
        + &joint("elbow", "[-0.7, 0.4, 0.3]", "[0.4, 0.5, -0.3]");
    write(folder.path(), "T.toml", &trajectory);
    let text = "robot = \"planar-2r\"\ntrajectory = \"T.toml\"\nperiods = 4\nrate_hz = 1000\nsettle_s = 1\nramp_s = 1\n\
                [sensing]\nlink_step = 1.2e-5\n[effects]\nelasticity = 6.0\n";
    let experiment = write(folder.path(), "experiment.toml", text);
    let out = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    armid(["run", &experiment, "-o", &out("R.mcap")]).success();
    check(&json(&armid(["identify", &out("R.mcap"), "--json"]).success()));
    let text = stdout(&armid(["identify", &out("R.mcap")]).success());
    assert!(text.contains("transmissions") && text.contains("decided"), "{text}");

    // As a table of something else: two seconds before the motion, a period that is discarded, four that count.
    armid(["run", &experiment, "-o", &out("R.csv")]).success();
    let table = out("R.csv");
    let arguments =
        ["identify", &table, "--robot", "planar-2r", "--period", "5", "--from", "7", "--until", "27", "--json"];
    let named = |map: &str| json(&armid(arguments.iter().chain(&["--held-out", "none", "--map", map])).success());
    check(&named("t=t, q=q[1-2], tau=tau[1-2], q_link=q_link[1-2]"));
    let one_encoder = named("t=t, q=q[1-2], tau=tau[1-2]");
    assert!(one_encoder.get("transmissions").is_none());
    // Degrees, and an experiment whose step is none.
    let degrees = std::fs::read_to_string(&table).unwrap().replace("q_link1,q_link2", "q_link1_deg,q_link2_deg");
    let found = json(
        &armid(
            ["identify", &write(folder.path(), "D.csv", &degrees)]
                .iter()
                .copied()
                .chain(arguments[2..].iter().copied()),
        )
        .success(),
    );
    assert!(found["transmissions"][0]["wind_up_rms"].as_f64().unwrap() > 0.1);
    let wrong = text_of(&experiment).replace("1.2e-5", "-1.0");
    let refused =
        support::stderr(&armid(["run", &write(folder.path(), "w.toml", &wrong), "-o", &out("W.mcap")]).code(2));
    assert!(refused.contains("link_step is -1"), "{refused}");
}

fn text_of(path: &str) -> String {
    std::fs::read_to_string(path).expect("a text")
}
