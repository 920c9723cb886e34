//! `armid trajectory sample`

mod support;

use support::{armid, json, stderr, stdout, temporary, write};

/// One harmonic: q = 0.3 + 0.4/ω sin ωt − 0.2/ω cos ωt, ω = 2π/2 s.
const MOTION: &str = "period_s = 2.0\nharmonics = 1\n[[joint]]\nname = \"swing\"\na = [0.4]\nb = [0.2]\nq0 = 0.3\n";

fn rows(text: &str) -> Vec<Vec<f64>> {
    text.lines().skip(1).map(|line| line.split(',').map(|field| field.parse().expect("a number")).collect()).collect()
}

#[test]
fn analytic_one_harmonic_between_rest_and_rest() {
    let folder = temporary();
    let motion = write(folder.path(), "T.toml", MOTION);
    let table = folder.path().join("points.csv").display().to_string();
    let sample = ["trajectory", "sample", &motion, "--rate", "100", "--settle", "0.5", "--ramp", "1", "--periods", "2"];
    let said = stdout(&armid(sample.into_iter().chain(["-o", &table])).success());
    assert!(said.contains("no limits were checked: --robot names the arm"), "{said}");
    let text = std::fs::read_to_string(&table).expect("the table");
    assert!(text.starts_with("t,q1,qd1,qdd1\n"), "{}", &text[..40]);
    let points = rows(&text);
    // Settling, a ramp, a period that does not count and two that do, a ramp, and the last moment.
    assert_eq!(points.len(), 50 + 100 + 3 * 200 + 100 + 1);
    let omega = std::f64::consts::PI;
    for point in &points[150..750] {
        let (s, c) = (omega * (point[0] - 1.5)).sin_cos();
        let expected = [0.3 + (0.4 * s - 0.2 * c) / omega, 0.4 * c + 0.2 * s, omega * (0.2 * c - 0.4 * s)];
        for (found, expected) in point[1..].iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{point:?} {expected}");
        }
    }
    // At rest at both ends, without a jump of position or velocity in between.
    assert_eq!((points[0][2], points[849 + 1][2]), (0.0, 0.0));
    for pair in points.windows(2) {
        let [_, q, v, _] = pair[0][..] else { panic!("four columns") };
        assert!((pair[1][1] - q - 0.005 * (v + pair[1][2])).abs() < 1e-5, "{pair:?}");
    }
}

#[test]
fn identity_the_message_of_ros_holds_the_points_of_the_table() {
    let folder = temporary();
    let motion = write(folder.path(), "T.toml", MOTION);
    let sample = ["trajectory", "sample", &motion, "--rate", "50", "--periods", "1", "--speed", "50%", "-o", "-"];
    let table = rows(&stdout(&armid(sample).success()));
    let message = stdout(&armid(sample.into_iter().chain(["--to", "joint-trajectory"])).success());
    let message: serde_json::Value = serde_json::from_str(&message).expect("JSON");
    assert_eq!(message["joint_names"], serde_json::json!(["swing"]));
    let points = message["points"].as_array().expect("points");
    assert_eq!(points.len(), table.len());
    for (point, row) in points.iter().zip(&table) {
        let time = &point["time_from_start"];
        let seconds = time["sec"].as_f64().expect("s") + 1e-9 * time["nanosec"].as_f64().expect("ns");
        assert!((seconds - row[0]).abs() < 1e-9);
        let of = |key: &str| point[key][0].as_f64().expect("a number");
        assert_eq!([of("positions"), of("velocities"), of("accelerations")], row[1..]);
    }
}

#[test]
fn bad_input_says_what_the_arm_or_the_format_cannot() {
    let folder = temporary();
    let motion = write(folder.path(), "T.toml", MOTION);
    let fails = |more: &[&str]| {
        let sample = ["trajectory", "sample", &motion, "--rate", "100", "-o", "-"];
        stderr(&armid(sample.iter().chain(more)).failure().code(2))
    };
    assert!(fails(&["--to", "urscript"]).contains("urscript moves 6 joints, found 1"));
    assert!(fails(&["--robot", "crs-a460"]).contains("1"), "another number of joints");
    assert!(fails(&["--periods", "0"]).contains("periods is 0"), "{}", fails(&["--periods", "0"]));
    let experiment = format!("{}/../experiments/00-paper/experiment.toml", env!("CARGO_MANIFEST_DIR"));
    let sample = ["trajectory", "sample", &experiment, "--rate", "500", "--periods", "1", "--to", "urscript", "-o"];
    let program = folder.path().join("motion.script").display().to_string();
    let answer = json(&armid(sample.into_iter().chain([program.as_str(), "--json"])).success());
    assert_eq!(answer["joints"].as_array().map(Vec::len), Some(6));
    let program = std::fs::read_to_string(program).expect("the program");
    assert!(program.starts_with("def armid_motion():\n  movej(["), "{}", &program[..60]);
    assert!(program.ends_with("  stopj(2)\nend\n"));
    let joints = ["waist", "shoulder", "elbow", "wrist_roll", "wrist_pitch", "tool_roll"];
    let fast = joints.map(|name| format!("[[joint]]\nname = \"{name}\"\na = [30.0]\nb = [0.0]\nq0 = 0.0\n")).concat();
    let fast = write(folder.path(), "fast.toml", &format!("period_s = 2.0\nharmonics = 1\n{fast}"));
    let refused = ["trajectory", "sample", &fast, "--rate", "500", "--robot", "crs-a460", "-o", "-"];
    let refused = stderr(&armid(refused).failure().code(2));
    assert!(refused.contains("waist") && refused.contains("limit"), "{refused}");
}
