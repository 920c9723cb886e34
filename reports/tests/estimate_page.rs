//! The pages of one estimate and of two, with numbers made up here: their text, and each figure by its hash.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod golden;

use armid::estimation::{ComparedParameter, Comparison};
use armid_reports::{
    ComparisonInput, EstimateInput, ParameterRow, Prediction, ResidualDiagnostics, ResidualShares, ResidualTrace,
    TorqueTrace, comparison_document, estimate_document,
};
use golden::{assert_golden, text_of};

fn names(of: [&str; 2]) -> [String; 2] {
    of.map(str::to_owned)
}

/// Two sentences of a figure: its caption, and one below it.
fn sentences(of: &str) -> Vec<String> {
    names(["elbow: first of", "wrist: second of"]).map(|words| format!("{words} {of}.")).to_vec()
}

fn torque(joint: &str, scale: f64) -> TorqueTrace {
    TorqueTrace {
        joint: joint.into(),
        times: vec![0.0, 1.0, 2.0],
        measured: [1.0, 2.0, 1.5].map(|value| scale * value).to_vec(),
        predicted: [1.1, 1.9, 1.5].map(|value| scale * value).to_vec(),
    }
}

fn residual(joint: &str, scale: f64) -> ResidualTrace {
    ResidualTrace {
        joint: joint.into(),
        times: vec![0.0, 1.0, 2.0],
        residual: [-0.1, 0.1, 0.0].map(|value| scale * value).to_vec(),
        velocity: vec![0.0, 1.0, -1.0],
        load: vec![2.0, 1.0, 3.0],
        position: vec![0.5, 0.25, 0.125],
        lags: vec![1.0, 2.0],
        autocorrelation: vec![0.5, -0.25],
        white_within: 0.4,
    }
}

#[test]
fn golden_page_of_an_estimate() {
    let mut input = EstimateInput {
        robot: "arm".into(),
        subtitle: "wls".into(),
        verdict: vec!["The model **explains** it.".into()],
        joints: names(["elbow", "wrist"]).to_vec(),
        unit: "N·m".into(),
        bandwidth_hz: 20.0,
        shares: vec![
            ResidualShares { label: "used rows".into(), joints: vec![Some(5.0), Some(7.0)], total: Some(6.0) },
            ResidualShares { label: "held out".into(), joints: vec![Some(8.0), None], total: Some(8.5) },
        ],
        traces: vec![torque("elbow", 1.0), torque("wrist", -0.2)],
        traces_of: "used rows".into(),
        diagnostics: ResidualDiagnostics {
            traces: vec![residual("elbow", 1.0), residual("wrist", -0.2)],
            over_time: sentences("time"),
            over_speed: sentences("speed"),
            over_load: sentences("load"),
            over_position: sentences("position"),
            whiteness: sentences("lags"),
        },
        parameters: vec![ParameterRow {
            name: "Izz1".into(),
            expression: "Izz1 + Ia1".into(),
            value: 1.25,
            std: 0.01,
            interval: [1.23, 1.27],
            unit: "kg·m²".into(),
        }],
        left_out: vec!["the first second".into()],
        findings: vec!["the noise is taken from the residual".into()],
        provenance: vec![("log".into(), "a.csv".into())],
    };
    let mut text = text_of(&estimate_document(&input).unwrap());
    // Little data: no autocorrelation, nothing found, one sentence, then no equation at all.
    (input.left_out, input.findings) = (Vec::new(), Vec::new());
    input.diagnostics.traces[1].lags.clear();
    input.diagnostics.over_load.truncate(1);
    text += &text_of(&estimate_document(&input).unwrap());
    input.diagnostics.traces.clear();
    text += &text_of(&estimate_document(&input).unwrap());
    assert_golden("estimate.txt", &text);
}

#[test]
fn golden_page_of_two_estimates() {
    let parameter = |name: &str, value: [f64; 2], difference_std: f64| ComparedParameter {
        name: name.into(),
        unit: "kg·m²".into(),
        value,
        std: [0.01, 0.02],
        difference_std,
    };
    let mut input = ComparisonInput {
        comparison: Comparison {
            robot: "arm".into(),
            estimators: names(["wls", "ols"]),
            parameters: vec![parameter("Izz1", [1.25, 1.2], -2.236), parameter("Iyy2", [0.5, 0.51], 0.447)],
            alone: [vec!["Fv1".into(), "Fv2".into()], Vec::new()],
            beyond: 0.5,
            rms_difference_std: 1.612,
            residual_rms: [vec![0.1, 0.2], vec![0.15, 0.25]],
            noise_std: [vec![0.1, 0.2], vec![0.15, 0.25]],
            units: names(["N·m", "N·m"]).to_vec(),
        },
        labels: names(["first", "second"]),
        origins: names(["a.csv", "b.csv"]),
        joints: names(["elbow", "wrist"]).to_vec(),
        predictions: [Some(Prediction { rms: vec![0.1, 0.3], relative_rms: vec![0.02, 0.05] }), None],
    };
    let mut text = text_of(&comparison_document(&input).unwrap());
    input.predictions = [None, None];
    input.comparison.alone[0].clear();
    text += &text_of(&comparison_document(&input).unwrap());
    assert_golden("comparison.txt", &text);
}
