//! Trajectories against limits.

use armid::study::{LimitExample, ReportInput, capitalised, criterion_in_words};

use crate::heading::file_stem;
use crate::{Cell, Column, DocumentError, Heading, Section, Table, TimeSeriesFigure, limits_figure};

/// Designs that are drawn: of a grid the first few.
const EXAMPLES: usize = 12;

pub(super) fn section(input: &ReportInput) -> Result<Section, DocumentError> {
    let result = &input.result;
    let mut section = Section::new("Trajectories and limits").text(
        "Position, velocity, acceleration and the torque of the nominal parameters, each over its limit: at 1 a limit is reached. Limits hold between samples too.",
    );
    for figure in input.examples.limits.iter().take(EXAMPLES).filter_map(|example| figure(example, input)) {
        section = section.figure(&figure)?;
    }
    let mut table = Table::new(
        "Every design: condition numbers and information of the rigid base columns and of all estimated ones, and the worst use of each limit. Bias susceptibility: the largest norm of the parameter error, in reference units, by 1 N·m RMS of any unmodelled torque.",
        Column::list(
            "criterion | #start | #evaluations | ended | #condition, rigid | #condition | #scaled | #ln det | \
             #bias susceptibility [per N·m] | #position [%] | #velocity [%] | #acceleration [%] | #torque [%]",
        ),
    );
    for design in &result.designs {
        let c = &design.certificate;
        let percent = |value: f64| Cell::fixed(100.0 * value, 1);
        table = table.row(vec![
            Cell::text(&result.plan.designs[design.family].name),
            Cell::count(design.start),
            Cell::count(design.evaluations),
            design.termination.as_ref().map_or(Cell::Missing, |t| Cell::text(t.name())),
            Cell::number(c.condition, 4),
            Cell::number(c.condition_all, 4),
            Cell::number(c.condition_scaled_all, 4),
            Cell::number(c.log_det_information_all, 4),
            c.bias_susceptibility.filter(|bias| bias.is_finite()).map_or(Cell::Missing, |bias| Cell::number(bias, 3)),
            percent(c.worst_limit_use.position),
            percent(c.worst_limit_use.velocity),
            percent(c.worst_limit_use.acceleration),
            c.worst_limit_use.torque.map_or(Cell::Missing, percent),
        ]);
    }
    Ok(section.table(table))
}

fn figure(example: &LimitExample, input: &ReportInput) -> Option<TimeSeriesFigure> {
    let joints: Vec<String> = input.result.joints.iter().map(|joint| joint.name.clone()).collect();
    let name = format!("limits-{}", file_stem(&example.family));
    let family = capitalised(&criterion_in_words(&example.family));
    limits_figure(example, &joints, |finding| {
        Heading::new(name, format!("{family} design: {finding}"))
            .subtitle(format!("design {} of the study", example.design))
    })
}
