//! `armid advise`: a motion and an estimator for an arm before it moves.

mod support;

use support::{armid, json, stderr, stdout, temporary, write};

const TWO_JOINTS: &str = r#"<robot name="two"><link name="base"/>
<link name="upper"><inertial><origin xyz="0.2 0 0.05"/><mass value="3"/><inertia ixx="0.02" iyy="0.05" izz="0.05" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="fore"><inertial><origin xyz="0.1 0.02 0"/><mass value="1"/><inertia ixx="0.002" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="60" velocity="3"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="0.4 0 0"/><axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="20" velocity="3"/></joint>
</robot>"#;

#[test]
fn advice_on_a_urdf_names_what_it_assumed_and_its_experiment_runs() {
    let folder = temporary();
    let urdf = write(folder.path(), "two.urdf", TWO_JOINTS);
    let output = folder.path().join("advice");
    let place = output.display().to_string();
    let asked = [
        "advise",
        &urdf,
        "--base-link",
        "base",
        "--drive",
        "direct",
        "--minutes",
        "0.5",
        "--arms",
        "1",
        "--quiet",
        "-o",
        &place,
    ];
    let answer = json(&armid([&asked[..], &["--json"]].concat()).success());

    let candidates = answer["candidates"].as_array().expect("candidates");
    assert_eq!(candidates.len(), 12, "six designs with two estimators: no term is for effects of direct drives");
    let number = |candidate: &serde_json::Value, key: &str| candidate[key].as_f64().expect("a number");
    let expected = |candidate: &serde_json::Value| number(candidate, "expected");
    let is_in_order = |pair: &[serde_json::Value]| match [number(&pair[0], "near_best"), number(&pair[1], "near_best")]
    {
        [first, second] if first == second => expected(&pair[0]) <= expected(&pair[1]),
        [first, second] => first > second,
    };
    assert!(candidates.windows(2).all(is_in_order), "the best comes first");
    let assumed: Vec<&str> = answer["assumptions"].as_array().unwrap().iter().filter_map(|one| one.as_str()).collect();
    assert_eq!(assumed.len(), 4, "{assumed:?}");
    // What the model omits adds to the error, whatever the candidate.
    for candidate in candidates {
        let of = |level: usize| candidate["by_level"][level][1]["median"].as_f64().expect("a median");
        assert!(0.0 < of(0) && of(0) < of(3), "{candidate}");
    }

    let log = folder.path().join("log.csv").display().to_string();
    armid(["run", &output.join("experiment.toml").display().to_string(), "--quiet", "-o", &log]).success();
    let other = asked.map(|word| if word == "direct" { "belt" } else { word });
    assert!(stderr(&armid(other).code(2)).contains("another"), "a folder with another study is refused");
    let longer = |key: &str| answer["longer"][key].as_f64().expect("a number");
    assert!(longer("floor") <= longer("expected") && longer("expected") <= expected(&candidates[0]));

    // A log with repeated periods gives noise, and sizes of what it was tested for.
    let periodic = folder.path().join("log.mcap").display().to_string();
    armid(["run", &output.join("experiment.toml").display().to_string(), "--quiet", "-o", &periodic]).success();
    let stated = output.join("robot.toml").display().to_string();
    let place = folder.path().join("again").display().to_string();
    let asked = ["advise", &stated, "--drive", "belt", "--minutes", "0.5", "--arms", "1", "--log", &periodic];
    let answer = json(&armid([&asked[..], &["--quiet", "-o", &place, "--json"]].concat()).success());
    let taken: Vec<&str> = answer["from_log"].as_array().unwrap().iter().filter_map(|one| one.as_str()).collect();
    assert!(
        taken[0].starts_with("torque noise of ") && taken.iter().any(|one| one.starts_with("elasticity of ")),
        "{taken:?}"
    );
    let candidates = answer["candidates"].as_array().expect("candidates");
    let with = candidates.iter().filter(|of| of["columns"] == "rigid+rotor+friction+stribeck").count();
    assert_eq!(candidates.len() - with, 12, "as many without Stribeck friction");
    assert!((10..=12).contains(&with), "{with}: a motion that does not show it has no such candidate");
    let own = write(folder.path(), "robot.toml", "# mine\n");
    let here = folder.path().display().to_string();
    assert!(stderr(&armid(["advise", &urdf, "-o", &here]).code(2)).contains("is there already"));
    assert_eq!(std::fs::read_to_string(own).unwrap(), "# mine\n");
}

#[test]
fn what_cannot_be_assumed_is_asked_for() {
    let folder = temporary();
    let urdf = write(folder.path(), "two.urdf", &TWO_JOINTS.replace("effort=\"20\" ", ""));
    let place = folder.path().join("advice").display().to_string();
    let fault = stderr(&armid(["advise", &urdf, "-o", &place]).code(2));
    assert!(fault.contains("elbow") && fault.contains("limits"), "{fault}");
    let fault = stderr(&armid(["advise", "crs-a460", "--minutes", "0", "-o", &place]).code(2));
    assert!(fault.contains("--minutes"), "{fault}");
    assert!(stdout(&armid(["advise", "--help"]).success()).contains("planetary"));
}
