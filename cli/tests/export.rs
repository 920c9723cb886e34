//! `armid export`

mod support;

use std::path::Path;

use support::{armid, json, stderr, stdout, temporary, write};

fn path(folder: &Path, name: &str) -> String {
    folder.join(name).to_str().expect("a path in UTF-8").to_owned()
}

/// The estimate of a short recording of Table I.
fn estimate(folder: &Path) -> String {
    let (recording, estimate) = (path(folder, "R.mcap"), path(folder, "E.json"));
    armid(["run", &support::experiment(folder, 2), "-o", &recording]).success();
    armid(["identify", &recording, "-o", &estimate]).success();
    estimate
}

#[test]
fn identity_every_format_reads_back_with_the_torque_of_the_regressor() {
    let folder = temporary();
    let estimate = estimate(folder.path());
    let formats = [("urdf", "arm.urdf"), ("mjcf", "arm.xml"), ("toml", "truth.toml"), ("json", "phi.json")];
    let mut maps = Vec::new();
    for (to, name) in formats {
        let out = path(folder.path(), name);
        let answer = armid(["export", &estimate, "--to", to, "-o", &out, "--json"]);
        // The estimate is nearly exact, and trees have a plain sign of friction and no offset, URDF no rotors either.
        let tree = matches!(to, "urdf" | "mjcf");
        let done = json(&if tree { answer.code(1) } else { answer.success() });
        assert_eq!(done["consistent"], true, "{to}");
        assert_eq!(done["prediction"]["good"], !tree, "{done}");
        assert!(done["prediction"]["file"]["fit"].as_f64().unwrap() < 0.03, "{done}");
        let parameters = done["parameters"].as_array().unwrap();
        let shown = parameters.iter().filter(|p| p["ci95"].is_array()).count();
        assert!(
            parameters.len() >= 72 && shown > 12 && shown < parameters.len(),
            "{to}: {shown} of {}",
            parameters.len()
        );
        for sum in done["sums"].as_array().unwrap() {
            let (low, high) = (sum["ci95"][0].as_f64().unwrap(), sum["ci95"][1].as_f64().unwrap());
            assert!((low..=high).contains(&sum["value"].as_f64().unwrap()), "{sum}");
        }
        assert!(done["reload"]["largest_relative_difference"].as_f64().unwrap() < 1e-9, "{done}");
        let text = std::fs::read_to_string(&out).unwrap();
        assert_eq!(text.contains("predicts this log with"), to != "json", "{to}");
        if tree {
            let named = |p: &serde_json::Value| (p["name"].as_str().unwrap().to_owned(), p["value"].clone());
            let map = serde_json::Value::Object(parameters.iter().map(named).collect());
            maps.push((out.clone(), write(folder.path(), &format!("{to}.json"), &map.to_string())));
        }
        let lacking: Vec<&str> =
            done["lacking"].as_array().unwrap().iter().map(|l| l["term"].as_str().unwrap()).collect();
        assert_eq!(lacking.contains(&"rotor inertia"), to == "urdf", "{lacking:?}");
        assert_eq!(lacking.contains(&"Coulomb friction that sets in softly"), tree, "{lacking:?}");
    }
    // A tree is a robot of its own, and says the torque of the parameters in the answer: at rest friction is nothing.
    let states = "q1,q2,q3,q4,q5,q6,qd1,qd2,qd3,qd4,qd5,qd6,qdd1,qdd2,qdd3,qdd4,qdd5,qdd6\n\
                  0.3,0.5,-0.4,0.2,0.9,-1,0,0,0,0,0,0,0,0,0,0,0,0\n";
    let states = write(folder.path(), "S.csv", states);
    let torque = |robot: &str, parameters: Option<&str>| -> Vec<f64> {
        let mut arguments = vec!["dynamics", robot, "--states", &states, "--quantity", "torque"];
        arguments.extend(parameters.iter().flat_map(|parameters| ["--parameters", parameters]));
        let text = stdout(&armid(arguments).success());
        text.lines().nth(1).unwrap().split(',').map(|x| x.parse().unwrap()).collect()
    };
    for (tree, map) in &maps {
        for (found, expected) in torque(tree, None).iter().zip(torque("crs-a460", Some(map.as_str()))) {
            assert!((found - expected).abs() < 1e-9, "{tree}: {found} {expected}");
        }
    }
    assert_eq!(maps.len(), 2);
}

#[test]
fn a_file_predicts_another_log_by_itself_and_takes_numbers_in_place() {
    let folder = temporary();
    let estimate = estimate(folder.path());
    let (model, scene, again) =
        (path(folder.path(), "arm.xml"), path(folder.path(), "scene.xml"), path(folder.path(), "again.xml"));
    let recording = path(folder.path(), "R.mcap");
    let first = json(&armid(["export", &estimate, "--to", "mjcf", "-o", &model, "--json"]).code(1));
    let done =
        json(&armid(["validate", &model, &recording, "--robot", "crs-a460", "--limit", "1", "--json"]).success());
    assert_eq!((done["verdict"].as_str(), done["estimator"].as_str()), (Some("passed"), Some(model.as_str())));
    let share = done["residual"]["all_rows"]["total"].as_f64().unwrap();
    assert!((share - first["prediction"]["file"]["fit"].as_f64().unwrap()).abs() < 1e-6, "{share} {first}");
    // A scene of the same arm with other numbers, and things of its own.
    let text = std::fs::read_to_string(&model).unwrap();
    let text = text.replace("timestep=\"0.001\"", "timestep=\"0.004\"").replace("damping=\"", "damping=\"1");
    let text = text.replace("</mujoco>", "<actuator><motor joint=\"waist\" name=\"mine\"/></actuator></mujoco>");
    std::fs::write(&scene, text).unwrap();
    let done = json(&armid(["export", &estimate, "--to", "mjcf", "--into", &scene, "-o", &again, "--json"]).code(1));
    assert_eq!(done["prediction"], first["prediction"]);
    let text = std::fs::read_to_string(&again).unwrap();
    assert!(
        text.contains("timestep=\"0.004\"") && text.contains("name=\"mine\"") && text.contains("<!-- armid:"),
        "{text}"
    );
    let fault = stderr(&armid(["export", &estimate, "--to", "json", "--into", &scene]).code(2));
    assert!(fault.contains("--into is for urdf and mjcf"), "{fault}");
}

#[test]
fn a_log_that_is_gone_is_named() {
    let folder = temporary();
    let estimate = estimate(folder.path());
    let (recording, moved) = (path(folder.path(), "R.mcap"), path(folder.path(), "moved.mcap"));
    std::fs::rename(&recording, &moved).unwrap();
    let out = path(folder.path(), "phi.json");
    assert!(stderr(&armid(["export", &estimate, "--to", "json", "-o", &out]).code(2)).contains("R.mcap"));
    armid(["export", &estimate, "--to", "json", "-o", &out, "--log", &moved]).success();
    // Source code needs none.
    armid(["export", &estimate, "--to", "c", "-o", &path(folder.path(), "arm.c")]).success();
}

#[test]
fn source_code_has_the_torque_of_the_base_parameters_as_estimated() {
    let folder = temporary();
    let estimate = estimate(folder.path());
    let found: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(&estimate).unwrap()).unwrap();
    for (to, name, wanted) in [
        (
            "c",
            "arm.c",
            "void armid_inverse_dynamics(const double q[6], const double qd[6], const double qdd[6], double out[6])",
        ),
        ("rust", "arm.rs", "pub fn mass_matrix(q: &[f64; 6]) -> [f64; 36] {"),
    ] {
        let out = path(folder.path(), name);
        let done = json(&armid(["export", &estimate, "--to", to, "-o", &out, "--json"]).success());
        assert!(done["reload"]["largest_relative_difference"].as_f64().unwrap() < 1e-9, "{done}");
        assert!(done["operations"].as_u64().unwrap() < 1500, "{done}");
        assert_eq!(done["base"], serde_json::json!(bare(&found["base"])));
        let text = std::fs::read_to_string(&out).unwrap();
        assert!(
            text.contains(wanted)
                && text.contains("forward_dynamics(")
                && text.contains("  waist (rad)")
                && text.contains("Iyy1 = "),
            "{}",
            &text[..3000]
        );
    }
    // Columns whose laws are not written.
    let changed = found.to_string().replace("\"name\":\"Fc6\"", "\"name\":\"Fs6\"");
    let other = write(folder.path(), "other.json", &changed);
    let fault = stderr(&armid(["export", &other, "--to", "c"]).code(2));
    assert!(fault.contains("base parameters:") && fault.contains("Fs6"), "{fault}");
}

/// Base parameters without what `armid identify` writes beside them.
fn bare(base: &serde_json::Value) -> Vec<serde_json::Value> {
    let of = |parameter: &serde_json::Value| {
        let keys = ["name", "value", "std", "ci95", "unit"];
        keys.into_iter().map(|key| (key.to_owned(), parameter[key].clone())).collect::<serde_json::Map<_, _>>().into()
    };
    base.as_array().expect("a list").iter().map(of).collect()
}

#[test]
fn an_estimate_whose_search_did_not_end_is_said_to_be_one() {
    let folder = temporary();
    let estimate = estimate(folder.path());
    let text = std::fs::read_to_string(&estimate).unwrap();
    let mut found: serde_json::Value = serde_json::from_str(&text).unwrap();
    found["termination"] = serde_json::json!({ "kind": "iteration-limit", "iterations": 40, "last_step": 0.1 });
    let unfinished = write(folder.path(), "unfinished.json", &found.to_string());
    for to in ["urdf", "c"] {
        let out = path(folder.path(), to);
        let done = armid(["export", &unfinished, "--to", to, "-o", &out]).code(1);
        assert!(stderr(&done).contains("stopped after 40 iterations"), "{}", stderr(&done));
        assert!(Path::new(&out).exists());
    }
}

#[test]
fn an_estimate_of_another_robot_is_refused() {
    let folder = temporary();
    let estimate = estimate(folder.path());
    let refused = |more: &[&str]| stderr(&armid(["export", &estimate].iter().chain(more)).code(2));
    assert!(refused(&["--to", "urdf", "--robot", "puma-560"]).contains("puma-560"));
    assert!(refused(&["--to", "step"]).contains("urdf"));
    let text = std::fs::read_to_string(&estimate).unwrap();
    let changed = write(folder.path(), "changed.json", &text.replace("\"robot_sha256\": \"", "\"robot_sha256\": \"0"));
    assert!(stderr(&armid(["export", &changed, "--to", "urdf"]).code(2)).contains("SHA-256"));
    let broken = write(folder.path(), "broken.json", "{");
    assert!(stderr(&armid(["export", &broken, "--to", "urdf"]).code(2)).contains("expected an estimate"));
}
