//! The engines on the command line: how far they agree, which are there, and what is said of one that is not.

mod support;

use assert_cmd::assert::Assert;
use support::{armid, experiment, json, stderr, temporary};

/// Runs `armid` with a MuJoCo library that the environment names.
fn with_library<const N: usize>(library: &std::path::Path, arguments: [&str; N]) -> Assert {
    assert_cmd::Command::new(assert_cmd::cargo::cargo_bin!("armid"))
        .env("ARMID_MUJOCO_LIB", library)
        .args(arguments)
        .assert()
}

#[test]
fn identity_engines_agree_and_say_so_in_numbers_and_a_figure() {
    let folder = temporary();
    let output = folder.path().join("agreement");
    let found = json(&armid(["agree", "planar-2r", "--json", "-o", output.to_str().unwrap()]).success());
    assert_eq!((&found["agrees"], &found["breaches"]), (&true.into(), &serde_json::json!([])));
    let engines = found["engines"].as_array().unwrap();
    let order = |i: usize| engines[i]["order"].as_f64().unwrap().round();
    assert_eq!((engines.len(), order(0), order(1), order(2)), (3, 4.0, 1.0, 4.0));
    for engine in engines {
        for key in ["equations", "free", "energy"] {
            assert!(engine[key].as_f64().unwrap() < 1e-2, "{engine}");
        }
        assert!(engine["errors"].as_array().unwrap().len() >= 5);
    }
    let pairs = found["pairs"].as_array().unwrap();
    assert!(pairs.len() == 3 && pairs.iter().all(|pair| pair["closed_loop"].as_array().unwrap().len() == 2));
    let stored = std::fs::read_to_string(output.join("agreement.json")).unwrap();
    assert_eq!(serde_json::from_str::<serde_json::Value>(&stored).unwrap(), found);
    let figure = std::fs::read_to_string(output.join("convergence.svg")).unwrap();
    assert!(figure.contains("mujoco") && figure.contains("rapier") && figure.contains("slope 4"));
}

#[test]
fn identity_every_version_of_mujoco_gives_the_same_motion() {
    let newer = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../third_party/mujoco-4.0.0");
    let name = if cfg!(target_os = "macos") { "libmujoco.4.0.0.dylib" } else { "libmujoco.so.4.0.0" };
    let library = newer.join(name);
    assert!(library.exists(), "run scripts/get-mujoco 4.0.0");
    let folder = temporary();
    let output = folder.path().join("agreement");
    let arguments = ["agree", "planar-2r", "--json", "-o", output.to_str().unwrap()];
    let doctor = json(&with_library(&library, ["doctor", "--json"]).success());
    assert_eq!(doctor["mujoco"]["version"], "4.0.0");
    let [newer, usual] = [with_library(&library, arguments), armid(arguments)].map(|run| json(&run.success()));
    let numbers = |found: &serde_json::Value| -> Vec<f64> {
        let pairs = found["pairs"].as_array().unwrap();
        let of = |pair: &serde_json::Value| {
            [&pair["free"], &pair["closed_loop"][0], &pair["closed_loop"][1]].map(|x| x.as_f64().unwrap())
        };
        pairs.iter().flat_map(of).collect()
    };
    // Sums run in another order in version 4.
    let (newer, usual) = (numbers(&newer), numbers(&usual));
    assert_eq!(newer.len(), 9);
    assert!(newer.iter().zip(&usual).all(|(a, b)| (a - b).abs() < 1e-10), "{newer:?} {usual:?}");
}

#[test]
fn a_library_that_is_not_there_not_whole_or_another_is_named_with_what_to_run() {
    let folder = temporary();
    let experiment = experiment(folder.path(), 1);
    let here = json(&armid(["doctor", "--json"]).success());
    assert_eq!(here["engines"], serde_json::json!(["analytic", "rapier", "mujoco"]), "run scripts/get-mujoco");
    assert_eq!(here["mujoco"]["version"], "3.17.0");
    assert!(here["cores"].as_u64().unwrap() >= 1 && here["simd"].is_array() && here["ros2"].is_object());

    let whole = std::fs::read(here["mujoco"]["library"].as_str().unwrap()).unwrap();
    let (cut, other) = (folder.path().join("libmujoco.cut"), folder.path().join("libmujoco.text"));
    std::fs::write(&cut, &whole[..whole.len() / 2]).unwrap();
    std::fs::write(&other, "not found").unwrap();
    let nowhere = folder.path().join("libmujoco.gone");
    let half = format!("found {} bytes, expected", whole.len() / 2);
    for (library, reason) in [(cut, half.as_str()), (other, "not a shared library"), (nowhere, "No such file")] {
        let fault = stderr(&with_library(&library, ["run", &experiment, "--arm", "mujoco"]).code(2));
        let fault: String = fault.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ");
        assert!(fault.contains(reason) && fault.contains("scripts/get-mujoco"), "{fault}");
        let agreement = folder.path().join("agreement");
        let fault = stderr(&with_library(&library, ["agree", "planar-2r", "-o", agreement.to_str().unwrap()]).code(2));
        assert!(fault.contains("ARMID_MUJOCO_LIB") || fault.contains("scripts/get-mujoco"), "{fault}");
        assert!(!agreement.exists(), "a comparison without the library that was named");
        let doctor = json(&with_library(&library, ["doctor", "--json"]).success());
        assert_eq!(doctor["engines"], serde_json::json!(["analytic", "rapier"]));
        assert!(doctor["mujoco"]["missing"].as_str().unwrap().contains(reason), "{}", doctor["mujoco"]);
    }
}
