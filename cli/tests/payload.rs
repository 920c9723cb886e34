//! `armid identify --payload`: what the last link carries, from logs without it and with it.

#[path = "support/own_robot.rs"]
mod own_robot;
mod support;

use serde_json::Value;
use support::{armid, json, stderr, temporary, write};

const MAP: &str = "t=time_ms ms, q=pos_[1-6] deg, tau=torque_[1-6]";

/// The arm with a load on its last link: 0.5 kg become 2 kg, further out, and turn less easily.
fn loaded_urdf() -> String {
    let last = "<origin xyz=\"0.03 0.02 0.01\"/><mass value=\"0.5\"/>\n      <inertia ixx=\"0.001\" ixy=\"0\" ixz=\"0\" iyy=\"0.001\"";
    let loaded = "<origin xyz=\"0.06 0.01 0.03\"/><mass value=\"2\"/>\n      <inertia ixx=\"0.006\" ixy=\"0\" ixz=\"0\" iyy=\"0.007\"";
    let urdf = own_robot::urdf();
    assert!(urdf.contains(last), "{urdf}");
    urdf.replace(last, loaded).replace("izz=\"0.001\"", "izz=\"0.005\"")
}

/// The load: the last link of one URDF less that of the other, by hand.
fn expected() -> [f64; 10] {
    let body = |m: f64, c: [f64; 3], [xx, yy, zz]: [f64; 3]| {
        let [x, y, z] = c;
        [
            m,
            m * x,
            m * y,
            m * z,
            xx + m * (y * y + z * z),
            -m * x * y,
            -m * x * z,
            yy + m * (x * x + z * z),
            -m * y * z,
            zz + m * (x * x + y * y),
        ]
    };
    let (with, without) =
        (body(2.0, [0.06, 0.01, 0.03], [0.006, 0.007, 0.005]), body(0.5, [0.03, 0.02, 0.01], [0.001; 3]));
    std::array::from_fn(|k| with[k] - without[k])
}

/// The largest distance of a shown parameter from the load, in standard deviations; all ten are shown.
fn worst(found: &Value) -> f64 {
    let parameters = found["parameters"].as_array().expect("ten parameters");
    assert_eq!(parameters.len(), 10);
    let off = parameters.iter().zip(expected()).map(|(parameter, expected)| {
        let shown = &parameter["shown"];
        (shown["value"].as_f64().expect("a number") - expected).abs() / shown["std"].as_f64().expect("a number")
    });
    off.fold(0.0, f64::max)
}

#[test]
fn a_load_on_an_arm_of_a_urdf_is_found_within_its_intervals() {
    let folder = temporary();
    write(folder.path(), "arm.urdf", &own_robot::urdf());
    write(folder.path(), "loaded.urdf", &loaded_urdf());
    own_robot::log(folder.path(), "arm.urdf", "empty.csv", 0.0);
    own_robot::log(folder.path(), "loaded.urdf", "loaded.csv", 0.4);
    let path = |name: &str| folder.path().join(name).to_str().expect("a path in UTF-8").to_owned();
    let (robot, empty, loaded, out) = (path("arm.urdf"), path("empty.csv"), path("loaded.csv"), path("P.json"));
    let both = ["identify", "--payload", "--without", &empty, "--with", &loaded, "--robot", &robot, "--map", MAP];
    let done = armid(both.iter().copied().chain(["--json", "-o", &out]));
    assert!(matches!(done.get_output().status.code(), Some(0 | 1)), "{}", stderr(&done));
    let found = json(&done);
    assert_eq!(serde_json::from_str::<Value>(&std::fs::read_to_string(&out).unwrap()).unwrap(), found);
    assert_eq!((found["consistent"].as_bool(), found["link"].as_str()), (Some(true), Some("joint_6")));
    let mass = found["body"]["mass_kg"].as_f64().unwrap();
    assert!((mass - 1.5).abs() < 0.05, "{found}");
    assert!(worst(&found) < 5.0, "{} {found}", worst(&found));

    // The arm's estimate in place of its log: mapping and robot are remembered, the answer is the same.
    let estimate = path("E.json");
    let known = ["identify", &empty, "--robot", &robot, "--map", MAP, "--held-out", "none", "-o", &estimate];
    armid(known);
    let done = armid(["identify", "--payload", "--without", &estimate, "--with", &loaded, "--json"]);
    let again = json(&done);
    for (a, b) in found["parameters"].as_array().unwrap().iter().zip(again["parameters"].as_array().unwrap()) {
        let (a, b) = (&a["shown"], &b["shown"]);
        let off = (a["value"].as_f64().unwrap() - b["value"].as_f64().unwrap()) / a["std"].as_f64().unwrap();
        assert!(off.abs() < 1e-6, "{a} {b}");
    }

    // The logs the other way round: no load takes weight away.
    let exchanged = ["identify", "--payload", "--without", &loaded, "--with", &empty, "--robot", &robot, "--map", MAP];
    let done = armid(exchanged.iter().copied().chain(["--json"])).code(1);
    let found = json(&done);
    assert_eq!(found["negative_mass"]["cause"], "lighter", "{found}");
    assert!(found["parameters"][0]["shown"].is_null() && found["body"]["mass_kg"].as_f64().unwrap() > 0.0, "{found}");
    let said = armid(exchanged).code(1);
    let said = String::from_utf8_lossy(&said.get_output().stdout).into_owned();
    assert!(said.contains("the arm is lighter in the log with the load"), "{said}");
}

/// The simulated tool is a ball of 3 cm: `measurement/src/experiment/effects/tool.rs`.
#[test]
fn a_tool_on_the_a460_is_found_with_its_encoders_currents_and_converters() {
    let folder = temporary();
    let recorded = |name: &str, effects: &str| {
        let text = format!("robot = \"crs-a460\"\ntrajectory = \"table-one\"\nperiods = 4\n{effects}");
        let experiment = write(folder.path(), "x.toml", &text);
        let out = folder.path().join(name).to_str().expect("a path in UTF-8").to_owned();
        armid(["run", &experiment, "-o", &out]).success();
        out
    };
    let (without, with) = (recorded("A.mcap", ""), recorded("B.mcap", "run = 1\n[effects]\ntool = 1.0\n"));
    let done = armid(["identify", "--payload", "--without", &without, "--with", &with, "--json"]);
    let found = json(&done);
    let body = &found["body"];
    assert!((body["mass_kg"].as_f64().unwrap() - 1.0).abs() < 0.2, "{found}");
    let shown = |name: &str| {
        let all = found["parameters"].as_array().unwrap();
        let one = all.iter().find(|p| p["name"] == name).unwrap()["shown"].clone();
        (one["value"].as_f64().unwrap(), one["std"].as_f64().unwrap())
    };
    for (name, expected) in [("m", 1.0), ("mcx", 0.02), ("mcy", 0.0), ("mcz", 0.06)] {
        let (value, std) = shown(name);
        assert!((value - expected).abs() < 5.0 * std, "{name}: {value} ± {std}, expected {expected}");
    }
}

#[test]
fn what_makes_no_payload_is_refused() {
    for (arguments, wanted) in [
        (&["--payload"][..], "--without"),
        (&["--payload", "--without", "a.csv"], "--with"),
        (&["--without", "a.csv", "--with", "b.csv"], "--payload"),
        (&["--payload", "--without", "a.csv", "--with", "nowhere.csv", "--robot", "planar-2r"], "cannot be read"),
    ] {
        let fault = stderr(&armid(["identify"].iter().chain(arguments)).code(2));
        assert!(fault.contains(wanted), "{wanted} not in {fault}");
    }
}

#[test]
fn one_recording_is_not_both_with_and_without_a_load() {
    let folder = temporary();
    let joint = |name: &str, a: &str, b: &str| format!("\n[[joint]]\nname = \"{name}\"\na = {a}\nb = {b}\nq0 = 0.1\n");
    let motion = "period_s = 4.0\nharmonics = 2\n".to_owned()
        + &joint("shoulder", "[0.5, 0.3]", "[0.2, -0.3]")
        + &joint("elbow", "[-0.3, 0.4]", "[0.5, 0.3]");
    write(folder.path(), "T.toml", &motion);
    let plan = "robot = \"planar-2r\"\ntrajectory = \"T.toml\"\nrate_hz = 250\nperiods = 2\nramp_s = 1\n";
    let plan = write(folder.path(), "x.toml", plan);
    let log = folder.path().join("R.csv").to_str().unwrap().to_owned();
    armid(["run", &plan, "-o", &log]).success();
    // The same bytes under another name.
    let copy = write(folder.path(), "copy.csv", &std::fs::read_to_string(&log).unwrap());
    let columns = ["--robot", "planar-2r", "--columns", "rigid"];
    let both = ["identify", "--payload", "--without", &log, "--with", &copy];
    let fault = stderr(&armid(both.iter().chain(&columns)).code(2));
    assert!(fault.contains("(the same SHA-256), expected two recordings"), "{fault}");
}
