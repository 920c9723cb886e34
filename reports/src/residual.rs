//! What the residual of an estimate shows: figures, each with the sentence that it supports.

use serde::{Deserialize, Serialize};

use crate::{
    Axis, Dash, DocumentError, GroupStyle, Heading, Limit, Line, ScatterFigure, ScatterGroup, ScatterPanel,
    ScatterPoint, Section, TimePanel, TimeSeriesFigure,
};

/// Joints in one figure.
const PANELS: usize = 12;

/// The residual of one joint, on the equations of the fit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ResidualTrace {
    /// Name of the joint.
    pub joint: String,
    /// Times, s.
    #[serde(with = "crate::curve")]
    pub times: Vec<f64>,
    /// Measured less predicted torque.
    #[serde(with = "crate::curve")]
    pub residual: Vec<f64>,
    /// Velocity.
    #[serde(with = "crate::curve")]
    pub velocity: Vec<f64>,
    /// What the links take, by the estimate.
    #[serde(with = "crate::curve")]
    pub load: Vec<f64>,
    /// Position.
    #[serde(with = "crate::curve")]
    pub position: Vec<f64>,
    /// Lags, s; none where there are too few equations.
    #[serde(with = "crate::curve")]
    pub lags: Vec<f64>,
    /// The autocorrelation of the residual at each.
    #[serde(with = "crate::curve")]
    pub autocorrelation: Vec<f64>,
    /// What the autocorrelation of white noise stays within, in 95 % of cases.
    pub white_within: f64,
}

/// What the residual shows. The first sentence on each figure is its title, the others are below it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ResidualDiagnostics {
    /// Joint by joint; those without equations are left out.
    pub traces: Vec<ResidualTrace>,
    /// On the residual over time.
    pub over_time: Vec<String>,
    /// Over speed.
    pub over_speed: Vec<String>,
    /// Over load.
    pub over_load: Vec<String>,
    /// Over position.
    pub over_position: Vec<String>,
    /// On its autocorrelation.
    pub whiteness: Vec<String>,
}

impl ResidualDiagnostics {
    /// The section of a page.
    pub(crate) fn section(&self, unit: &str) -> Result<Section, DocumentError> {
        let section = Section::new("Diagnostics").text(
            "The residual on the equations of the fit. Sentences are of shapes that the model's parameters cannot take up; p-values \
             are adjusted over all joints and shapes of a figure. A shape that is found need not be the cause.",
        );
        if self.traces.is_empty() {
            return Ok(section.text("No joint has an equation."));
        }
        let residual = || Axis::linear("residual", unit);
        let over_time = TimeSeriesFigure {
            heading: headed("residual-time", "Residual over time", &self.over_time),
            time: Axis::linear("time", "s"),
            value: residual(),
            columns: 2,
            same_range: false,
            panels: self.lines(|trace| (&trace.times, &trace.residual), |_| Vec::new()),
        };
        let over_speed = self.scatter(
            headed("residual-velocity", "Residual over speed", &self.over_speed),
            [&Axis::linear("velocity, rad/s (m/s)", ""), &residual()],
            |trace| &trace.velocity,
        );
        let over_load = self.scatter(
            headed("residual-load", "Residual over load", &self.over_load),
            [&Axis::linear("torque that the links take", unit), &residual()],
            |trace| &trace.load,
        );
        let over_position = self.scatter(
            headed("residual-position", "Residual over position", &self.over_position),
            [&Axis::linear("position, rad (m)", ""), &residual()],
            |trace| &trace.position,
        );
        let section = others(section.figure(&over_time)?, &self.over_time);
        let section = others(section.figure(&over_speed)?, &self.over_speed);
        let section = others(section.figure(&over_load)?, &self.over_load);
        let section = others(section.figure(&over_position)?, &self.over_position);
        if self.traces.iter().any(|trace| trace.lags.is_empty()) {
            return Ok(section);
        }
        let white = |trace: &ResidualTrace| {
            vec![Limit::new(trace.white_within, "white noise"), Limit::new(-trace.white_within, "")]
        };
        let autocorrelation = TimeSeriesFigure {
            heading: headed("residual-autocorrelation", "Autocorrelation of the residual", &self.whiteness),
            time: Axis::linear("lag", "s"),
            value: Axis::linear("autocorrelation", ""),
            columns: 2,
            same_range: true,
            panels: self.lines(|trace| (&trace.lags, &trace.autocorrelation), white),
        };
        Ok(others(section.figure(&autocorrelation)?, &self.whiteness))
    }

    fn lines(
        &self,
        of: impl Fn(&ResidualTrace) -> (&Vec<f64>, &Vec<f64>),
        limits: impl Fn(&ResidualTrace) -> Vec<Limit>,
    ) -> Vec<TimePanel> {
        let panel = |trace| {
            let (times, values) = of(trace);
            let line = Line::new(
                "residual",
                GroupStyle { dash: Dash::Solid, ..GroupStyle::nth(2) },
                times.clone(),
                values.clone(),
            );
            TimePanel { title: trace.joint.clone(), lines: vec![line], limits: limits(trace) }
        };
        self.traces.iter().take(PANELS).map(panel).collect()
    }

    fn scatter(
        &self,
        heading: Heading,
        [x, y]: [&Axis; 2],
        along: impl Fn(&ResidualTrace) -> &Vec<f64>,
    ) -> ScatterFigure {
        let panel = |trace: &ResidualTrace| {
            let points = along(trace).iter().zip(&trace.residual);
            let points = points.map(|(&x, &residual)| ScatterPoint::new(x, residual)).collect();
            let groups = vec![ScatterGroup { label: "residual".into(), style: GroupStyle::nth(2), points }];
            ScatterPanel { title: trace.joint.clone(), x: x.clone(), y: y.clone(), groups, references: Vec::new() }
        };
        ScatterFigure { heading, columns: 2, panels: self.traces.iter().take(PANELS).map(panel).collect() }
    }
}

/// A figure whose title is the first sentence on it, if there is one: what the figure finds.
fn headed(name: &str, shown: &str, sentences: &[String]) -> Heading {
    match sentences.first() {
        Some(first) => Heading::new(name, first.trim_end_matches('.')).subtitle(shown).caption(format!("{shown}.")),
        None => Heading::new(name, shown),
    }
}

/// The sentences after the title's.
fn others(section: Section, sentences: &[String]) -> Section {
    if sentences.len() > 1 { section.list(sentences[1..].to_vec()) } else { section }
}
