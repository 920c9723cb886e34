//! `armid design` against the collision shapes of a URDF: what is held, by closed form, and what not and why.

mod support;

use std::f64::consts::TAU;
use std::path::Path;

use serde_json::Value;
use support::{armid, json, stderr, stdout, temporary, write};

/// Lengths of a planar arm with vertical axes, m, and where a ball stands beside it.
const ARM: [f64; 2] = [0.4, 0.3];
const PILLAR: [f64; 2] = [0.35, 0.3];
/// Radii of the ball and of what is at the tip, m.
const RADII: [f64; 2] = [0.2, 0.05];
const CLEARANCE: f64 = 0.05;

/// The arm; `tip` is the geometry of what its second link carries at (0.3, 0, 0).
fn urdf(tip: &str) -> String {
    let link = |name: &str, collisions: &str| {
        format!(
            "<link name=\"{name}\"><inertial><origin xyz=\"0.2 0 0\"/><mass value=\"2\"/><inertia ixx=\"0.02\" ixy=\"0\" \
             ixz=\"0\" iyy=\"0.02\" iyz=\"0\" izz=\"0.02\"/></inertial>{collisions}</link>\n"
        )
    };
    let joint = |name: &str, parent: &str, child: &str, x: f64| {
        format!(
            "<joint name=\"{name}\" type=\"revolute\"><origin xyz=\"{x} 0 0\"/><parent link=\"{parent}\"/><child \
             link=\"{child}\"/><axis xyz=\"0 0 1\"/><limit lower=\"-2.5\" upper=\"2.5\" velocity=\"3\" effort=\"100\"/>\
             </joint>\n"
        )
    };
    let shape = |origin: &str, geometry: &str| {
        format!("<collision><origin {origin}/><geometry>{geometry}</geometry></collision>")
    };
    let pillar = format!("xyz=\"{} {} 0\"", PILLAR[0], PILLAR[1]);
    let base = shape(&pillar, &format!("<sphere radius=\"{}\"/>", RADII[0]))
        + &shape("xyz=\"0 0 -0.2\"", "<cylinder radius=\"0.06\" length=\"0.1\"/>");
    let upper = shape("xyz=\"0.2 0 0\" rpy=\"0 1.5707963267948966 0\"", "<capsule radius=\"0.02\" length=\"0.3\"/>")
        + &shape("xyz=\"0.1 0 -0.05\"", "<box size=\"0.1 0.04 0.04\"/>");
    format!(
        "<robot name=\"planar\">\n{}{}{}{}{}</robot>\n",
        link("base", &base),
        link("upper", &upper),
        link("lower", &shape(&format!("xyz=\"{} 0 0\"", ARM[1]), tip)),
        joint("shoulder", "base", "upper", 0.0),
        joint("elbow", "upper", "lower", ARM[0]),
    )
}

fn design(robot: &str, out: &Path, more: &[&str]) -> Value {
    let out = out.to_str().expect("a path in UTF-8");
    let arguments =
        ["design", robot, "--criterion", "d-optimal", "--columns", "rigid", "--starts", "2", "--no-baseline"];
    let rest = ["--json", "-o", out];
    json(&armid(arguments.iter().chain(&rest).chain(more)).success())
}

/// The least distance of the tip's ball from the pillar's along the trajectory of a file, by its own series and by hand.
fn nearest(trajectory: &Path) -> f64 {
    let file: toml::Table =
        std::fs::read_to_string(trajectory).expect("as it was written").parse().expect("as it was written");
    let omega = TAU / file["period_s"].as_float().expect("as it was written");
    let joints = file["joint"].as_array().expect("as it was written");
    let angle = |joint: &toml::Value, t: f64| {
        let list = |key: &str| -> Vec<f64> {
            joint[key]
                .as_array()
                .expect("as it was written")
                .iter()
                .map(|value| value.as_float().expect("as it was written"))
                .collect()
        };
        let terms = list("a").into_iter().zip(list("b")).enumerate().map(|(l, (a, b))| {
            let w = omega * (l + 1) as f64;
            (a * (w * t).sin() - b * (w * t).cos()) / w
        });
        joint["q0"].as_float().expect("as it was written") + terms.sum::<f64>()
    };
    let at = |k: usize| {
        let t = TAU / omega * k as f64 / 4001.0;
        let (q1, q2) = (angle(&joints[0], t), angle(&joints[1], t));
        let x = ARM[0] * q1.cos() + ARM[1] * (q1 + q2).cos() - PILLAR[0];
        let y = ARM[0] * q1.sin() + ARM[1] * (q1 + q2).sin() - PILLAR[1];
        x.hypot(y) - RADII[0] - RADII[1]
    };
    (0..4001).map(at).fold(f64::INFINITY, f64::min)
}

#[test]
fn analytic_a_design_keeps_the_primitives_of_a_urdf_apart() {
    let folder = temporary();
    let robot = write(folder.path(), "arm.urdf", &urdf(&format!("<sphere radius=\"{}\"/>", RADII[1])));
    let out = folder.path().join("T.toml");
    let found = design(&robot, &out, &["--clearance", &CLEARANCE.to_string()]);
    let shapes = &found["collision_shapes"];
    let kinds: Vec<&str> = shapes["held"].as_array().unwrap().iter().map(|s| s["kind"].as_str().unwrap()).collect();
    assert_eq!(kinds, ["sphere", "cylinder", "capsule", "box", "sphere"]);
    assert_eq!(shapes["not_held"], serde_json::json!([]));
    assert_eq!(shapes["pairs"], serde_json::json!([["base", "elbow"]]));
    assert!(shapes["pairs_not_held"].as_array().unwrap().iter().all(|pair| pair["reason"] == "follow each other"));
    let (stated, by_hand) = (found["worst_limit_use"]["clearance_m"].as_f64().unwrap(), nearest(&out));
    assert!(stated >= CLEARANCE && stated <= by_hand + 1e-9, "{stated} {by_hand}");
    // And that was a limit: without it, the same search comes nearer.
    let free = folder.path().join("F.toml");
    let ignored = design(&robot, &free, &["--ignore-clearance"]);
    assert!(ignored["collision_shapes"].is_null() && nearest(&free) < CLEARANCE, "{}", nearest(&free));
    // Performed with the same shapes; a motion that meets them is not.
    let run = |trajectory: &str| {
        let text = format!("robot = \"arm.urdf\"\ntrajectory = \"{trajectory}\"\nperiods = 1\nrate_hz = 100\n");
        let experiment = write(folder.path(), "x.toml", &text);
        armid(["run", &experiment, "-o", folder.path().join("R.csv").to_str().unwrap()])
    };
    run("T.toml").success();
    let text = stdout(&armid(["robot", &robot]).success());
    assert!(text.contains("Collision shapes") && text.contains("upper: capsule"), "{text}");
}

/// A tetrahedron around a ball of half the size, in STL; and one point, which lies inside.
const MESH: &str = "solid tip\nvertex 0.05 0 0\nvertex -0.05 0.05 0\nvertex -0.05 -0.05 0\nvertex 0 0 0.05\nvertex 0 0 0.01\n\
                    endsolid tip\n";

#[test]
fn meshes_are_found_by_their_package_or_named_with_the_reason() {
    let folder = temporary();
    for path in ["share/arm_description/urdf", "share/arm_description/meshes", "elsewhere/arm_description/meshes"] {
        std::fs::create_dir_all(folder.path().join(path)).unwrap();
    }
    let mesh = "share/arm_description/meshes/tip.stl";
    write(folder.path(), mesh, MESH);
    let text = urdf("<mesh filename=\"package://arm_description/meshes/tip.stl\" scale=\"2 2 2\"/>");
    let text = text.replace("<box size=\"0.1 0.04 0.04\"/>", "<box size=\"0.1 0.04\"/>");
    let robot = write(folder.path(), "share/arm_description/urdf/arm.urdf", &text);
    let out = folder.path().join("T.toml");
    let found = design(&robot, &out, &[]);
    let held = &found["collision_shapes"]["held"][3];
    assert_eq!(
        (held["kind"].as_str(), held["points"].as_u64(), held["body"].as_str()),
        (Some("mesh"), Some(4), Some("lower"))
    );
    assert!(held["file"].as_str().unwrap().ends_with(mesh), "{held}");
    // What cannot be read is no shape, and said.
    let odd = &found["collision_shapes"]["not_held"][0];
    let reason = odd["reason"].as_str().unwrap();
    assert!(
        odd["body"] == "upper" && reason.contains("line ") && reason.contains("expected 3 finite numbers"),
        "{odd}"
    );

    let there = folder.path().join("elsewhere/arm_description/meshes/tip.stl");
    std::fs::rename(folder.path().join(mesh), &there).unwrap();
    let missing = design(&robot, &out, &[]);
    let reason = missing["collision_shapes"]["not_held"][1]["reason"].as_str().unwrap().to_owned();
    assert!(reason.starts_with("package://arm_description/meshes/tip.stl not found"), "{reason}");
    assert!(reason.contains("--package-path"), "{reason}");
    let elsewhere = folder.path().join("elsewhere");
    let given = design(&robot, &out, &["--package-path", elsewhere.to_str().unwrap()]);
    assert_eq!(given["collision_shapes"]["held"][3]["file"].as_str(), there.to_str());
    let by_environment = assert_cmd::Command::new(support::program())
        .args(["design", &robot, "--criterion", "d-optimal", "--columns", "rigid", "--starts", "2"])
        .args(["--no-baseline", "-o", out.to_str().unwrap()])
        .env("ROS_PACKAGE_PATH", &elsewhere)
        .assert()
        .success();
    let text = stdout(&by_environment);
    assert!(text.contains("1 × mesh") && text.contains("not held: shape of \"upper\""), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
}

#[test]
fn a_file_that_is_no_mesh_is_named_and_the_rest_is_held() {
    let folder = temporary();
    write(folder.path(), "tip.stl", "solid tip\nvertex 1 2\nendsolid\n");
    let robot = write(folder.path(), "arm.urdf", &urdf("<mesh filename=\"tip.stl\"/>"));
    let found = design(&robot, &folder.path().join("T.toml"), &[]);
    let reason = found["collision_shapes"]["not_held"][0]["reason"].as_str().unwrap();
    assert!(reason.contains("tip.stl: line 2") && reason.contains("three numbers"), "{reason}");
    assert_eq!(found["collision_shapes"]["held"].as_array().unwrap().len(), 4);
    let fault = stderr(&armid(["design", &robot, "--criterion", "d-optimal", "--payload", "1"]).code(2));
    assert!(fault.contains("--payload"), "{fault}");
}
