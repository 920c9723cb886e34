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
    for (to, name) in [("urdf", "arm.urdf"), ("mjcf", "arm.xml"), ("toml", "truth.toml"), ("json", "phi.json")] {
        let out = path(folder.path(), name);
        let done = json(&armid(["export", &estimate, "--to", to, "-o", &out, "--json"]).success());
        assert_eq!(done["consistent"], true, "{to}");
        assert!(done["chi_squared"].as_f64().unwrap() < done["chi_squared_limit"].as_f64().unwrap());
        let parameters = done["parameters"].as_array().unwrap();
        assert!(parameters.len() >= 78 && parameters.iter().all(|p| p["std"].as_f64().unwrap() >= 0.0), "{done}");
        assert!(done["reload"]["largest_relative_difference"].as_f64().unwrap() < 1e-9, "{done}");
        assert!(done["largest_deviation_std"].as_f64().unwrap() < 4.0);
    }
    // The map is what `armid dynamics` takes, the trees are robots of their own, and all say the same torque.
    let states = "q1,q2,q3,q4,q5,q6,qd1,qd2,qd3,qd4,qd5,qd6,qdd1,qdd2,qdd3,qdd4,qdd5,qdd6\n\
                  0.3,0.5,-0.4,0.2,0.9,-1,0,0,0,0,0,0,0,0,0,0,0,0\n";
    let states = write(folder.path(), "S.csv", states);
    let torque = |robot: &str, parameters: Option<&str>| -> Vec<f64> {
        let mut arguments = vec!["dynamics", robot, "--states", &states, "--quantity", "torque"];
        arguments.extend(parameters.iter().flat_map(|parameters| ["--parameters", parameters]));
        let text = stdout(&armid(arguments).success());
        text.lines().nth(1).unwrap().split(',').map(|x| x.parse().unwrap()).collect()
    };
    let map = path(folder.path(), "phi.json");
    let offsets: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(&map).unwrap()).unwrap();
    let expected = torque("crs-a460", Some(&map));
    for tree in ["arm.urdf", "arm.xml"] {
        let found = torque(&path(folder.path(), tree), None);
        for (joint, (found, expected)) in found.iter().zip(&expected).enumerate() {
            // At rest friction is nothing, and the offset has no place in either tree.
            let offset = offsets[format!("Fo{}", joint + 1)].as_f64().unwrap();
            assert!((found + offset - expected).abs() < 1e-9, "{tree} {joint}: {found} {expected}");
        }
    }
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
            text.contains(wanted) && text.contains("  waist (rad)") && text.contains("Iyy1 = "),
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

#[test]
fn base_parameters_that_no_arm_can_have_are_named_with_status_1() {
    let folder = temporary();
    let estimate = estimate(folder.path());
    let mut found: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(&estimate).unwrap()).unwrap();
    for parameter in found["base"].as_array_mut().unwrap() {
        if parameter["name"] == "Fv6" {
            parameter["value"] = (-3.0).into();
            parameter["ci95"] = serde_json::json!([-3.1, -2.9]);
        }
    }
    let impossible = write(folder.path(), "impossible.json", &found.to_string());
    let out = path(folder.path(), "arm.urdf");
    let done = json(&armid(["export", &impossible, "--to", "urdf", "-o", &out, "--json"]).code(1));
    assert!(done["outside"].as_array().unwrap().iter().any(|name| name == "Fv6"), "{done}");
    assert_eq!((done["consistent"].as_bool(), done["exact"].as_bool()), (Some(true), Some(false)));
    assert!(Path::new(&out).is_file());
}
