//! Values that programs in other languages get as JSON: the same after writing and reading, and refused where their parts
//! do not fit together.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use armid::base::{BaseReduction, Method, reduce};
use armid::dynamics::{Dynamics, States};
use armid::estimation::{Estimate, EstimatorKind, Identification};
use armid::excitation::{CriterionKind, Design, DesignLimits, DesignProblem, design};
use armid::experiment::{Phase, PhaseSpan, Recording};
use armid::model::format::{parse_nominal, parse_robot};
use armid::model::{Columns, EffortInterface, MotorCircuit, Obstacle, Robot, bundled};
use armid::provenance::Provenance;
use armid::seed::Seed;
use armid::signal::{NoiseModel, Samples};
use nalgebra::dmatrix;
use serde_json::{Value, json};

fn samples() -> Samples {
    let mut states = States::new(2);
    for k in 0..4 {
        let x = 0.1 + f64::from(k);
        states.push(&[x, 1.0 / x], &[-x, 1e-17], &[f64::MIN_POSITIVE, x * x]);
    }
    let mut samples = Samples::exact(states, vec![0.1; 8], vec!["N·m".to_owned(), "N".to_owned()], 250.0);
    samples.block = 2;
    samples.used = vec![true, false, true, true];
    samples.torque_covariance = Some(dmatrix![0.1, 0.01; 0.01, 0.3]);
    samples.noise = Some(NoiseModel::white(dmatrix![0.1, 0.01; 0.01, 0.3], true, 90.0));
    samples
}

fn recording() -> Recording {
    Recording {
        robot: "swing".to_owned(),
        robot_text: "name = \"swing\"\n".to_owned(),
        dof: 1,
        rate_hz: 100.0,
        joints: vec!["hinge".to_owned()],
        effort_unit: EffortInterface::Current,
        phases: vec![PhaseSpan { phase: Phase::Record, samples: 0..3 }],
        trajectory: armid::trajectory::PeriodicTrajectory::from_toml(
            "period_s = 1.0\nharmonics = 1\n[[joint]]\nname = \"hinge\"\na = [0.2]\nb = [0.1]\nq0 = 0.1\n",
        )
        .expect("a trajectory"),
        period_samples: 100,
        t: vec![0.0, 0.01, 0.02],
        q: vec![0.1, 0.2, 0.30000000000000004],
        effort: vec![1.0, -1.0, 0.5],
        voltage: Vec::new(),
        link_q: Vec::new(),
        provenance: Provenance::new("swing", "name = \"swing\"\n", None),
    }
}

fn bundled_robot(name: &str) -> Robot {
    let entry = bundled().iter().find(|entry| entry.name == name).expect("a bundled robot");
    parse_robot(entry.robot).expect("a robot")
}

/// A robot of which nothing is limited: JSON has no number for that.
fn unlimited_robot() -> Robot {
    let text = "name = \"slider\"\nconvention = \"modified\"\neffort = \"torque\"\n[[joint]]\nname = \"slide\"\n\
                kind = \"prismatic\"\ndh = { offset_deg = 30, d_m = 0, a_m = 0.1, alpha_deg = 90 }\n";
    let circuit =
        MotorCircuit { resistance: 1.0, inductance: 0.0, back_emf: 0.1, brush_drop: 0.0, supply: f64::INFINITY };
    let robot = parse_robot(text).expect("a robot").with_obstacle(Obstacle::everything_below("table", 0.2));
    robot.with_joints(|joint| joint.drive.circuit = Some(circuit)).expect("a robot")
}

fn estimate() -> Estimate {
    let (robot, states) = (bundled_robot("planar-2r"), states());
    let entry = bundled().iter().find(|entry| entry.name == "planar-2r").expect("a bundled robot");
    let nominal = parse_nominal(entry.nominal, &robot).expect("nominal parameters").parameters;
    let (mut dynamics, mut tau) = (Dynamics::new(&robot, &nominal), Vec::new());
    for k in 0..states.len() {
        let mut one = [0.0; 2];
        dynamics.inverse(states.q(k), states.qd(k), states.qdd(k), &mut one);
        // What no parameter explains.
        tau.extend(one.map(|x| x + 1e-3 * libm::sin(k as f64)));
    }
    let samples = Samples::exact(states, tau, vec!["N·m".to_owned(); 2], 100.0);
    let identification = Identification::new(&robot, Columns::RIGID).expect("a reduction").with_nominal(&nominal);
    identification.estimate(&samples, EstimatorKind::Wls.estimator()).expect("an estimate")
}

fn states() -> States {
    let mut states = States::new(2);
    for k in 0..60 {
        let x = f64::from(k);
        let [q, qd, qdd] = [0.3, 0.7, 1.1].map(|w| [libm::sin(w * x), libm::cos(1.7 * w * x)]);
        states.push(&q, &qd, &qdd);
    }
    states
}

fn small_design(robot: Robot) -> Design {
    let problem =
        DesignProblem::new(robot, Columns::RIGID, CriterionKind::DOptimal, DesignLimits::motion()).expect("a problem");
    design(&problem, Seed::new(1), 0).expect("a design")
}

/// The value with one of its parts exchanged.
fn with(mut value: Value, part: &str, other: Value) -> Value {
    *value.pointer_mut(part).unwrap_or_else(|| panic!("{part} is not there")) = other;
    value
}

fn read_back<T: serde::Serialize + serde::de::DeserializeOwned + PartialEq + std::fmt::Debug>(value: &T) {
    let text = serde_json::to_string(value).unwrap();
    assert_eq!(serde_json::from_str::<T>(&text).unwrap(), *value, "{text}");
}

/// Each exchanged part is refused, with this in the message.
fn refused<T: serde::de::DeserializeOwned + std::fmt::Debug>(value: &Value, parts: &[(&str, Value, &str)]) {
    for (part, other, expected) in parts {
        let fault = serde_json::from_value::<T>(with(value.clone(), part, other.clone())).unwrap_err().to_string();
        assert!(fault.contains(expected), "{part}: {fault}");
    }
}

#[test]
fn identity_robots_read_back() {
    for entry in bundled() {
        read_back(&bundled_robot(entry.name));
    }
    read_back(&unlimited_robot());
    let limits = &serde_json::to_value(unlimited_robot()).unwrap()["joints"][0]["limits"];
    assert_eq!((&limits["position"], &limits["velocity"]), (&json!([null, null]), &Value::Null));
    // The axes are derived: they are made again, not read.
    let text = serde_json::to_string(&unlimited_robot()).unwrap();
    assert_eq!(serde_json::from_str::<Robot>(&text).unwrap().axes(), unlimited_robot().axes());
}

#[test]
fn a_robot_that_cannot_be_is_refused() {
    let value = serde_json::to_value(bundled_robot("crs-a460")).unwrap();
    refused::<Robot>(
        &value,
        &[
            ("/joints", json!([]), "has no joints"),
            ("/joints/1/name", value["joints"][0]["name"].clone(), "occurs twice"),
            ("/joints/0/limits/position", json!([1.0, -1.0]), "position limit is 1 to -1"),
            ("/joints/0/limits/velocity", json!(-1.0), "velocity limit is -1"),
            ("/joints/0/drive/gear", json!(0.0), "gear ratio is 0"),
            ("/joints/0/after/rotation/0/0", json!(2.0), "orthonormal"),
            ("/joints/0/dh/1/a", json!(0.5), "DH row"),
            ("/coupling", json!([[1.0, 0.0], [0.0, 1.0]]), "coupling is a 2 × 2 matrix"),
            ("/servo/rate_hz", json!(0.0), "servo: rate_hz is 0"),
            ("/shapes/0/link", json!(7), "link is 7"),
            ("/shapes/0/solid/radius", json!(-0.1), "shape 1: radius is -0.1"),
            ("/may_touch", json!([[0, 7]]), "links 0 and 7 may touch"),
            ("/obstacles", json!([{"kind": "floor", "z": null}]), "invalid type: null"),
            (
                "/obstacles",
                json!([{"kind": "plane", "name": "wall", "normal": [0.0, 2.0, 0.0], "offset": 0.0}]),
                "obstacle \"wall\": normal",
            ),
        ],
    );
    let circuit = serde_json::to_value(unlimited_robot()).unwrap();
    refused::<Robot>(&circuit, &[("/joints/0/drive/circuit/resistance", json!(0.0), "resistance is 0")]);
}

#[test]
fn identity_reductions_read_back() {
    for name in ["crs-a460", "planar-2r"] {
        for columns in [Columns::RIGID, Columns::RIGID_ROTOR_FRICTION] {
            read_back(&reduce(&bundled_robot(name), columns, Method::Structural, Seed::new(0)).unwrap());
        }
    }
    // No base parameters at all.
    let none =
        BaseReduction::from_stack(&[armid::model::ParameterId::parse("m1").unwrap()], &dmatrix![0.0; 0.0], Method::Qr);
    assert_eq!(none.rank(), 0);
    read_back(&none);
}

#[test]
fn a_reduction_that_is_none_is_refused() {
    let base = reduce(&bundled_robot("planar-2r"), Columns::RIGID, Method::Structural, Seed::new(0)).unwrap();
    let (value, kept) = (serde_json::to_value(&base).unwrap(), base.kept[0]);
    refused::<BaseReduction>(
        &value,
        &[
            ("/parameters/0", json!("mass1"), "parameter \"mass1\""),
            ("/parameters/0", value["parameters"][1].clone(), "occurs twice"),
            ("/kept", json!([0]), "K is"),
            (&format!("/k/0/{kept}"), json!(2.0), "expected 1"),
            ("/categories", json!([]), "0 categories"),
            (&format!("/categories/{kept}"), json!("unidentifiable"), "is unidentifiable, expected"),
            ("/method", json!("guess"), "unknown variant"),
        ],
    );
}

#[test]
fn identity_estimates_read_back() {
    read_back(&estimate());
    read_back(&Estimate { condition: f64::INFINITY, ..estimate() });
}

#[test]
fn an_estimate_whose_parts_do_not_fit_is_refused() {
    let value = serde_json::to_value(estimate()).unwrap();
    refused::<Estimate>(
        &value,
        &[
            ("/covariance", json!([]), "covariance has 0 entries"),
            ("/covariance/0", json!([1.0]), "a row of covariance has 1 entries"),
            ("/units", json!(["N·m"]), "expected 1"),
            ("/base/0/std", json!(-1.0), "a deviation not below zero"),
            ("/base/0/value", json!(1e9), "an interval around the value"),
        ],
    );
}

#[test]
fn identity_designs_read_back() {
    let limited = small_design(bundled_robot("planar-2r"));
    assert!(limited.value.is_finite());
    read_back(&limited);
    // Singular, with limits that are not stated: infinite figures of both signs.
    let mut singular = limited;
    singular.value = f64::NEG_INFINITY;
    singular.history[0].value = f64::NEG_INFINITY;
    read_back(&singular);
}

#[test]
fn a_design_whose_certificate_is_not_its_own_is_refused() {
    let value = serde_json::to_value(small_design(bundled_robot("planar-2r"))).unwrap();
    refused::<Design>(
        &value,
        &[
            ("/trajectory/joints/0/q0", json!(0.01), "the certificate is that of another trajectory"),
            ("/trajectory/joints/0/a", json!([0.01]), "expected"),
            ("/trajectory/period_s", json!(0.0), "expected"),
            ("/certificate/condition", json!(1.0), "the certificate was changed"),
            ("/start/joints", json!([]), "expected"),
        ],
    );
}

#[test]
fn identity_samples_and_recordings_read_back() {
    read_back(&samples());
    read_back(&recording());
}

#[test]
fn samples_whose_parts_do_not_fit_are_refused() {
    let value = serde_json::to_value(samples()).unwrap();
    refused::<Samples>(
        &value,
        &[
            ("/tau", json!([1.0]), "tau has 1 entries, expected 8"),
            ("/states/qd", json!([1.0, 2.0]), "states.qd has 2 entries, expected 8"),
            ("/block", json!(0), "blocks of 0"),
            ("/used", json!([true]), "used has 1 entries, expected 4"),
            ("/torque_covariance", json!([[1.0, 0.0], [0.0]]), "a row of a matrix has 1 numbers, expected 2"),
            ("/torque_covariance", json!([[1.0]]), "rows of torque_covariance has 1 entries, expected 2"),
            ("/noise/weights", json!([]), "0 weights of 1 lags"),
            ("/noise/lags", json!([[[1.0]]]), "joints of noise has 1 entries, expected 2"),
        ],
    );
}

#[test]
fn a_recording_whose_tables_do_not_fit_is_refused() {
    let value = serde_json::to_value(recording()).unwrap();
    refused::<Recording>(
        &value,
        &[
            ("/q", json!([1.0]), "q has 1 entries, expected 3"),
            ("/voltage", json!([1.0]), "voltage has 1 entries, expected none or 3"),
            ("/joints", json!([]), "joints has 0 entries, expected 1"),
            ("/rate_hz", json!(0.0), "rate_hz is 0"),
        ],
    );
}
