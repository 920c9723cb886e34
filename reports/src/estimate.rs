//! The page of one estimate: does it explain the torque, where not, and what it found.

use serde::{Deserialize, Serialize};

use crate::document::{Cell, Column, Table};
use crate::drawing::ticks::significant;
use crate::residual::ResidualDiagnostics;
use crate::{
    Axis, Bar, BarFigure, BarRow, Document, DocumentError, Group, GroupStyle, Heading, Line, Section, TimePanel,
    TimeSeriesFigure,
};

/// Joints in one figure.
const PANELS: usize = 12;

/// Measured and predicted torque of one joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TorqueTrace {
    /// Name of the joint.
    pub joint: String,
    /// Times, s.
    #[serde(with = "crate::curve")]
    pub times: Vec<f64>,
    /// Measured torque.
    #[serde(with = "crate::curve")]
    pub measured: Vec<f64>,
    /// Predicted torque.
    #[serde(with = "crate::curve")]
    pub predicted: Vec<f64>,
}

/// One base parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterRow {
    /// Its name.
    pub name: String,
    /// What it stands for.
    pub expression: String,
    /// Its value.
    pub value: f64,
    /// Standard deviation.
    pub std: f64,
    /// 95 % interval.
    pub interval: [f64; 2],
    /// Unit.
    pub unit: String,
}

/// Shares of the measured torque that are not explained, percent.
#[derive(Clone, Debug, PartialEq)]
pub struct ResidualShares {
    /// What they are of: rows of the fit, all rows, rows held out.
    pub label: String,
    /// Of each joint; `None` where nothing was measured.
    pub joints: Vec<Option<f64>>,
    /// Of all joints.
    pub total: Option<f64>,
}

/// What the page of an estimate shows.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimateInput {
    /// The robot.
    pub robot: String,
    /// Estimator, columns, logs, in words.
    pub subtitle: String,
    /// The verdict and its reason, a paragraph each.
    pub verdict: Vec<String>,
    /// Names of the joints.
    pub joints: Vec<String>,
    /// Unit of the torque.
    pub unit: String,
    /// Cut-off below which torque is compared, Hz.
    pub bandwidth_hz: f64,
    /// Shares on rows of the fit, all rows, rows held out.
    pub shares: Vec<ResidualShares>,
    /// Torque over time, joint by joint; of what is held out where anything is.
    pub traces: Vec<TorqueTrace>,
    /// What those are of.
    pub traces_of: String,
    /// What the residual of the fit shows.
    pub diagnostics: ResidualDiagnostics,
    /// Parameters.
    pub parameters: Vec<ParameterRow>,
    /// What was left out, and what was found in the logs.
    pub left_out: Vec<String>,
    /// Findings with their advice.
    pub findings: Vec<String>,
    /// What produced the estimate.
    pub provenance: Vec<(String, String)>,
}

/// The page of an estimate.
///
/// # Errors
/// [`DocumentError`] where a figure cannot be drawn.
pub fn estimate_document(input: &EstimateInput) -> Result<Document, DocumentError> {
    let document = Document::new(format!("{}: identified parameters", input.robot)).subtitle(input.subtitle.clone());
    let document = input.verdict.iter().fold(document, |document, paragraph| document.summary(paragraph.clone()));
    let document = document
        .section(torque(input)?)
        .section(shares(input)?)
        .section(input.diagnostics.section(&input.unit)?)
        .section(found(input));
    let document = document.section(parameters(input));
    let provenance = input.provenance.iter();
    let document =
        provenance.fold(document, |document, (name, value)| document.provenance(name.clone(), value.clone()));
    Ok(document.provenance("armid", env!("CARGO_PKG_VERSION")))
}

/// Measured and predicted torque of some joints; `of` says which rows, `unit` is that of the torque, `missed` what the prediction
/// leaves of it.
pub fn torque_figure(
    traces: &[TorqueTrace],
    of: &str,
    unit: &str,
    bandwidth_hz: f64,
    missed: Option<&ResidualShares>,
) -> TimeSeriesFigure {
    let finding = missed.and_then(|share| Some((&share.label, share.total?)));
    let title = finding.map_or_else(
        || "Measured and predicted torque".to_owned(),
        |(label, total)| format!("The prediction misses {} % of the torque ({label})", significant(total, 2)),
    );
    let panels = traces.iter().take(PANELS).map(|trace| TimePanel {
        title: trace.joint.clone(),
        lines: vec![
            Line::new("measured", GroupStyle::nth(0), trace.times.clone(), trace.measured.clone()),
            Line::new("predicted", GroupStyle::nth(1), trace.times.clone(), trace.predicted.clone()),
        ],
        limits: Vec::new(),
    });
    TimeSeriesFigure {
        heading: Heading::new("torque", title)
            .subtitle(format!("{of}, below {bandwidth_hz} Hz"))
            .caption("Both passed the same low pass. Where only one line shows, both are the same."),
        time: Axis::linear("time", "s"),
        value: Axis::linear("torque", unit),
        columns: 2,
        same_range: false,
        panels: panels.collect(),
    }
}

fn torque(input: &EstimateInput) -> Result<Section, DocumentError> {
    let missed = input.shares.last();
    let figure = torque_figure(&input.traces, &input.traces_of, &input.unit, input.bandwidth_hz, missed);
    Section::new("Torque").figure(&figure)
}

fn shares(input: &EstimateInput) -> Result<Section, DocumentError> {
    let rows = input.joints.iter().enumerate().map(|(j, joint)| BarRow {
        label: joint.clone(),
        bars: input.shares.iter().map(|share| share.joints[j].map(|value| Bar { value, interval: None })).collect(),
    });
    let total = BarRow {
        label: "total".into(),
        bars: input.shares.iter().map(|share| share.total.map(|value| Bar { value, interval: None })).collect(),
    };
    let figure = BarFigure {
        heading: Heading::new("shares", worst(input).unwrap_or_else(|| "Torque that is not explained".to_owned()))
            .subtitle("torque that is not explained")
            .caption("Bars: RMS of measured less predicted torque over the RMS of the measured."),
        value: Axis::linear("share of the measured RMS", "%"),
        groups: Group::assign(input.shares.iter().map(|share| share.label.clone())),
        rows: rows.chain(std::iter::once(total)).collect(),
        levels: Vec::new(),
        digits: Some(2),
    };
    Section::new("Residual").figure(&figure)
}

/// Where the last rows are explained worst.
fn worst(input: &EstimateInput) -> Option<String> {
    let last = input.shares.last()?;
    let named = input.joints.iter().zip(&last.joints).filter_map(|(joint, share)| share.map(|share| (joint, share)));
    let (joint, share) = named.max_by(|(_, a), (_, b)| a.total_cmp(b))?;
    Some(format!("{joint} is explained worst: {} % of its torque is missing ({})", significant(share, 2), last.label))
}

fn found(input: &EstimateInput) -> Section {
    let section = Section::new("What was found");
    let all: Vec<String> = input.left_out.iter().chain(&input.findings).cloned().collect();
    if all.is_empty() { section.text("Nothing was left out, and there are no findings.") } else { section.list(all) }
}

fn parameters(input: &EstimateInput) -> Section {
    let columns = Column::list("parameter | unit | #value | #std | #from | #to | stands for");
    let table = input.parameters.iter().fold(Table::new("Base parameters with 95 % intervals", columns), |table, p| {
        table.row(vec![
            Cell::text(p.name.clone()),
            Cell::text(p.unit.clone()),
            Cell::number(p.value, 5),
            Cell::number(p.std, 2),
            Cell::number(p.interval[0], 5),
            Cell::number(p.interval[1], 5),
            Cell::text(p.expression.clone()),
        ])
    });
    Section::new("Parameters").table(table)
}
