//! `armid dynamics`

mod support;

use support::{armid, json, stderr, stdout, temporary, write};

/// A rod of 2 kg whose centre of mass hangs 0.5 m below a hinge about y; 0.6 kg·m² about the hinge, 0.3 N·m·s/rad.
const PENDULUM: &str = r#"<robot name="pendulum"><link name="world"/>
  <link name="rod"><inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.01"/></inertial></link>
  <joint name="swing" type="continuous"><parent link="world"/><child link="rod"/><axis xyz="0 1 0"/>
    <dynamics damping="0.3"/></joint></robot>"#;

/// The rod in MuJoCo's format: its inertia is given about the centre of mass, too.
const PENDULUM_MJCF: &str = r#"<!-- a rod --><mujoco model="pendulum"><compiler angle="radian"/><worldbody><body name="rod">
  <joint name="swing" type="hinge" axis="0 1 0" damping="0.3"/>
  <inertial pos="0 0 -0.5" mass="2" diaginertia="0.1 0.1 0.01"/></body></worldbody></mujoco>"#;

/// Rows of a CSV of numbers below its heading.
fn rows(text: &str) -> Vec<Vec<f64>> {
    text.lines().skip(1).map(|line| line.split(',').map(|field| field.parse().expect("a number")).collect()).collect()
}

#[test]
fn analytic_pendulum_in_all_four_quantities() {
    let folder = temporary();
    let robot = write(folder.path(), "pendulum.urdf", PENDULUM);
    let states = write(folder.path(), "s.csv", "q1,qd1,qdd1\n0.7,1.5,-2\n0,0,1\n");
    // τ = I q̈ + m g l sin q + Fv q̇
    let expected = [0.6 * -2.0 + 2.0 * 9.81 * 0.5 * 0.7_f64.sin() + 0.3 * 1.5, 0.6];
    let answer = stdout(&armid(["dynamics", &robot, "--states", &states, "--quantity", "torque"]).success());
    assert!(answer.starts_with("tau1\n"), "{answer}");
    for (row, expected) in rows(&answer).iter().zip(expected) {
        assert!((row[0] - expected).abs() < 1e-14, "{row:?} {expected}");
    }
    let efforts =
        write(folder.path(), "tau.csv", &format!("q1,qd1,tau1\n0.7,1.5,{}\n0,0,{}\n", expected[0], expected[1]));
    let answer = stdout(&armid(["dynamics", &robot, "--states", &efforts, "--quantity", "acceleration"]).success());
    assert!(answer.starts_with("qdd1\n"), "{answer}");
    for (row, expected) in rows(&answer).iter().zip([-2.0, 1.0]) {
        assert!((row[0] - expected).abs() < 1e-13, "{row:?} {expected}");
    }
    let answer = stdout(&armid(["dynamics", &robot, "--states", &states, "--quantity", "mass-matrix"]).success());
    assert!(answer.starts_with("sample,row,m1\n0,1,0.6"), "{answer}");
    let arguments =
        ["dynamics", &robot, "--states", &states, "--quantity", "regressor", "--columns", "rigid+rotor+friction"];
    let answer = stdout(&armid(arguments).success());
    let heading = "sample,joint,m1,mcx1,mcy1,mcz1,Ixx1,Ixy1,Ixz1,Iyy1,Iyz1,Izz1,Ia1,Fv1,Fc1,Fo1";
    assert_eq!(answer.lines().next(), Some(heading));
    // Columns of mcz, Iyy, Ia, Fv and Fo: −g sin q (the mass hangs at −z), q̈, q̈, q̇, 1.
    let row = &rows(&answer)[0];
    for (column, expected) in [(5, -9.81 * 0.7_f64.sin()), (9, -2.0), (12, -2.0), (13, 1.5), (15, 1.0)] {
        assert!((row[column] - expected).abs() < 1e-14, "{column}: {row:?}");
    }
}

#[test]
fn identity_urdf_and_mjcf_of_one_rod_swing_alike() {
    let folder = temporary();
    let states = write(folder.path(), "s.csv", "q1,qd1,qdd1\n0.7,1.5,-2\n0,0,1\n");
    let torque = |name: &str, text: &str| {
        let robot = write(folder.path(), name, text);
        rows(&stdout(&armid(["dynamics", &robot, "--states", &states, "--quantity", "torque"]).success()))
    };
    let (urdf, mjcf) = (torque("rod.urdf", PENDULUM), torque("rod.xml", PENDULUM_MJCF));
    for (a, b) in urdf.iter().zip(&mjcf) {
        assert!((a[0] - b[0]).abs() < 1e-14, "{a:?} {b:?}");
    }
}

#[test]
fn the_bundled_robot_asks_for_parameters_and_takes_a_map() {
    let folder = temporary();
    let headings: Vec<String> =
        ["q", "qd", "qdd"].iter().flat_map(|p| (1..=6).map(move |k| format!("{p}{k}"))).collect();
    let zeros = vec!["0"; 18].join(",");
    let states = write(folder.path(), "s.csv", &format!("{}\n{zeros}\n", headings.join(",")));
    for quantity in ["torque", "mass-matrix", "acceleration"] {
        let states = if quantity == "acceleration" {
            write(folder.path(), "t.csv", &format!("{}\n{zeros}\n", headings.join(",").replace("qdd", "tau")))
        } else {
            states.clone()
        };
        let fault = stderr(&armid(["dynamics", "crs-a460", "--states", &states, "--quantity", quantity]).code(2));
        assert!(fault.contains("needs --parameters"), "{fault}");
    }
    // At zero the arm stands straight up: joint 2 turns about −y, so a mass at x of link 2's frame, which points up,
    // has no moment, and one at its y, which points along −x of the base, has m g y.
    let parameters = write(folder.path(), "p.toml", "mcy2 = 0.5\nFo4 = 0.25\n");
    let arguments = ["dynamics", "crs-a460", "--states", &states, "--quantity", "torque", "--parameters", &parameters];
    let torque = rows(&stdout(&armid(arguments).success()));
    assert!((torque[0][1].abs() - 0.5 * 9.81).abs() < 1e-13 && torque[0][3] == 0.25, "{torque:?}");
    let map = write(folder.path(), "p.json", "{\"mcy2\": 0.5, \"Fo4\": 0.25}");
    let arguments =
        ["dynamics", "crs-a460", "--states", &states, "--quantity", "torque", "--parameters", &map, "--json"];
    let answer = json(&armid(arguments).success());
    assert_eq!(answer["headings"][3], "tau4");
    assert_eq!(answer["rows"][0][3], 0.25);
    let typo = write(folder.path(), "typo.toml", "mcy2 = 0.5\nmcq3 = 1\n");
    let arguments = ["dynamics", "crs-a460", "--states", &states, "--quantity", "torque", "--parameters", &typo];
    let fault = stderr(&armid(arguments).code(2));
    assert!(fault.contains("typo.toml:2:8: parameter \"mcq3\""), "{fault}");
    // The regressor needs no parameters.
    armid(["dynamics", "crs-a460", "--states", &states, "--quantity", "regressor"]).success();
}

#[test]
fn a_wrong_states_file_is_shown_with_line_and_column() {
    let folder = temporary();
    let robot = write(folder.path(), "pendulum.urdf", PENDULUM);
    for (text, wanted) in [
        ("q1,qd1,gdd1\n1,2,3\n", "s.csv:1:1: heading \"qdd1\" is missing"),
        ("q1,qd1,qdd1\n1,2,3\n4,5,x6\n", "s.csv:3:5: qdd1: found \"x6\", expected a finite number"),
        ("q1,qd1,qdd1\n1,2\n", "s.csv:2:1: found 2 values, expected 3"),
        ("q1,qd1,qdd1\n", "s.csv holds no states"),
        ("", "s.csv is empty"),
    ] {
        let states = write(folder.path(), "s.csv", text);
        let fault = stderr(&armid(["dynamics", &robot, "--states", &states, "--quantity", "torque"]).code(2));
        assert!(fault.contains(wanted), "{wanted} not in {fault}");
    }
    let fault = stderr(&armid(["dynamics", &robot, "--states", "none.csv", "--quantity", "torque"]).code(2));
    assert!(fault.contains("none.csv cannot be read"), "{fault}");
}

#[test]
fn output_brings_back_every_bit() {
    let folder = temporary();
    let robot = write(folder.path(), "pendulum.urdf", PENDULUM);
    let states = write(folder.path(), "s.csv", "q1,qd1,qdd1\n0.1,0.2,0.3\n");
    let path = folder.path().join("tau.csv");
    let arguments = ["dynamics", &robot, "--states", &states, "--quantity", "torque", "-o", path.to_str().unwrap()];
    assert_eq!(stdout(&armid(arguments).success()), "");
    let torque = rows(&std::fs::read_to_string(&path).unwrap())[0][0];
    let answer = json(&armid(["dynamics", &robot, "--states", &states, "--quantity", "torque", "--json"]).success());
    assert_eq!(answer["rows"][0][0].as_f64().unwrap().to_bits(), torque.to_bits());
}
