//! Measured against predicted torque.

use armid::study::ReportInput;

use super::titles;
use crate::{Axis, DocumentError, GroupStyle, Heading, Line, Section, TimePanel, TimeSeriesFigure};

pub(super) fn section(input: &ReportInput) -> Result<Section, DocumentError> {
    let section = Section::new("Measured and predicted torque");
    let Some(example) = &input.examples.prediction else {
        return Ok(section.text("No run gave an estimate to predict with."));
    };
    let panels = input
        .result
        .joints
        .iter()
        .enumerate()
        .map(|(j, joint)| {
            let residual = example.measured[j].iter().zip(&example.predicted[j]).map(|(m, p)| m - p).collect();
            let line = |label: &str, style: GroupStyle, values: Vec<f64>| {
                Line::new(label, style, example.time_s.clone(), values)
            };
            TimePanel {
                title: format!("{}: residual {:.3} {} RMS", joint.name, example.rms[j], joint.effort_unit),
                lines: vec![
                    line("measured", GroupStyle::nth(0), example.measured[j].clone()),
                    line("predicted", GroupStyle::nth(1), example.predicted[j].clone()),
                    line("measured − predicted", GroupStyle::nth(3).with_width(1.0), residual),
                ],
                limits: Vec::new(),
            }
        })
        .collect();
    let joints: Vec<String> = input.result.joints.iter().map(|joint| joint.name.clone()).collect();
    let title = titles::prediction(example, &joints);
    let figure = TimeSeriesFigure {
        heading: Heading::new("prediction", title.unwrap_or_else(|| "Torque along a held-out trajectory".to_owned()))
            .subtitle(format!("torque along a held-out trajectory; estimate: {} from a {} design", example.estimator, example.family))
            .caption("Measured: mean over the recorded periods of a validation experiment. Predicted: the estimate, at the measured positions and their derivatives."),
        time: Axis::linear("time", "s"),
        value: Axis::linear("torque", "N·m"),
        columns: 2,
        same_range: false,
        panels,
    };
    section.figure(&figure)
}
