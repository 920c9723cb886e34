//! Values that programs in other languages get as JSON: the same after writing and reading, and refused where their parts
//! do not fit together.

use armid::dynamics::States;
use armid::experiment::{Phase, PhaseSpan, Recording};
use armid::model::EffortInterface;
use armid::provenance::Provenance;
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
        provenance: Provenance::new("swing", "name = \"swing\"\n", None),
    }
}

/// The value with one of its parts exchanged.
fn with(mut value: Value, part: &str, other: Value) -> Value {
    *value.pointer_mut(part).unwrap_or_else(|| panic!("{part} is not there")) = other;
    value
}

#[test]
fn identity_samples_and_recordings_read_back() {
    let text = serde_json::to_string(&samples()).unwrap();
    assert_eq!(serde_json::from_str::<Samples>(&text).unwrap(), samples());
    let text = serde_json::to_string(&recording()).unwrap();
    assert_eq!(serde_json::from_str::<Recording>(&text).unwrap(), recording());
}

#[test]
fn samples_whose_parts_do_not_fit_are_refused() {
    let value = serde_json::to_value(samples()).unwrap();
    for (part, other, expected) in [
        ("/tau", json!([1.0]), "tau has 1 entries, expected 8"),
        ("/states/qd", json!([1.0, 2.0]), "states.qd has 2 entries, expected 8"),
        ("/block", json!(0), "blocks of 0"),
        ("/used", json!([true]), "used has 1 entries, expected 4"),
        ("/torque_covariance", json!([[1.0, 0.0], [0.0]]), "a row of a matrix has 1 numbers, expected 2"),
        ("/torque_covariance", json!([[1.0]]), "rows of torque_covariance has 1 entries, expected 2"),
        ("/noise/weights", json!([]), "0 weights of 1 lags"),
        ("/noise/lags", json!([[[1.0]]]), "joints of noise has 1 entries, expected 2"),
    ] {
        let fault = serde_json::from_value::<Samples>(with(value.clone(), part, other)).unwrap_err().to_string();
        assert!(fault.contains(expected), "{part}: {fault}");
    }
}

#[test]
fn a_recording_whose_tables_do_not_fit_is_refused() {
    let value = serde_json::to_value(recording()).unwrap();
    for (part, other, expected) in [
        ("/q", json!([1.0]), "q has 1 entries, expected 3"),
        ("/voltage", json!([1.0]), "voltage has 1 entries, expected none or 3"),
        ("/joints", json!([]), "joints has 0 entries, expected 1"),
        ("/rate_hz", json!(0.0), "rate_hz is 0"),
    ] {
        let fault = serde_json::from_value::<Recording>(with(value.clone(), part, other)).unwrap_err().to_string();
        assert!(fault.contains(expected), "{part}: {fault}");
    }
}
