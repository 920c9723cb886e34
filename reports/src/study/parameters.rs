//! Parameter by parameter: bias, spread against its bound, coverage.

use armid::study::{FamilyScore, ReportInput, criterion_in_words};

use super::titles;
use crate::{
    Axis, Band, Cell, Column, CoverageFigure, CoverageRow, DocumentError, Group, Heading, Interval, IntervalFigure,
    IntervalRow, Level, Section, Table,
};

pub(super) fn section(input: &ReportInput) -> Result<Section, DocumentError> {
    let result = &input.result;
    let estimator = input.result.shown_estimator();
    let families: Vec<&FamilyScore> =
        result.findings().families.iter().filter(|f| f.estimator == estimator && f.runs > 1).collect();
    let section = Section::new("Parameters");
    if families.is_empty() {
        return Ok(section.text("No criterion has enough runs."));
    }
    let groups = Group::assign(families.iter().map(|f| criterion_in_words(&f.family)));
    let bias = IntervalFigure {
        heading: Heading::new("bias", titles::bias(&families).unwrap_or_else(|| "Bias of the base parameters".to_owned()))
            .subtitle(format!("bias of the base parameters, estimator {estimator}, in the declared reference units"))
            .caption("Mean error over runs with its 95 % interval, designs taken as the units; an interval that leaves out zero shows a bias."),
        value: Axis::linear("bias", "reference units"),
        groups: groups.clone(),
        rows: result
            .parameters
            .iter()
            .enumerate()
            .map(|(i, parameter)| IntervalRow {
                label: parameter.name.clone(),
                cells: families
                    .iter()
                    .map(|family| {
                        let score = &family.parameters[i];
                        let unit = parameter.reference_unit;
                        score.bias_interval.map(|b| Interval::new(score.bias / unit, b.low / unit, b.high / unit))
                    })
                    .collect(),
            })
            .collect(),
        levels: vec![Level::new(0.0, "no bias")],
        band: None,
    };
    let coverage = CoverageFigure {
        heading: Heading::new("coverage", titles::coverage(&families).unwrap_or_else(|| "Coverage".to_owned()))
            .subtitle(format!("estimator {estimator}, through the whole chain"))
            .caption("Share of runs with its 95 % Wilson interval. Averaging, derivatives and decimation are part of the chain; what is below 95 % is bias that no interval from noise can cover."),
        groups,
        rows: result
            .parameters
            .iter()
            .enumerate()
            .map(|(i, parameter)| CoverageRow {
                label: parameter.name.clone(),
                percent: families
                    .iter()
                    .map(|family| {
                        let score = &family.parameters[i];
                        score.coverage_interval.map(|c| {
                            Interval::new(100.0 * score.coverage, 100.0 * c.low, 100.0 * c.high)
                        })
                    })
                    .collect(),
            })
            .collect(),
        nominal_percent: 95.0,
        band: Band::new(93.0, 97.0, "93 to 97 %"),
    };
    Ok(section.figure(&bias)?.figure(&coverage)?.table(table(input, &families)))
}

fn table(input: &ReportInput, families: &[&FamilyScore]) -> Table {
    let mut table = Table::new(
        "Every base parameter for every criterion. Bound: the Cramér–Rao standard deviation at the noise-free motion, all raw samples of all periods.",
        Column::list(
            "parameter | combination | unit | criterion | #true value | #bias | #std | #stated std | #bound | \
             #RMSE | #coverage [%]",
        ),
    );
    for (i, parameter) in input.result.parameters.iter().enumerate() {
        for family in families {
            let s = &family.parameters[i];
            table = table.row(vec![
                Cell::text(&parameter.name),
                Cell::text(&parameter.expression),
                Cell::text(&parameter.unit),
                Cell::text(&family.family),
                Cell::number(parameter.truth, 4),
                Cell::number(s.bias, 2),
                s.std.map_or(Cell::Missing, |std| Cell::number(std, 3)),
                Cell::number(s.stated_std, 3),
                Cell::number(s.bound_std, 3),
                Cell::number(s.rmse, 3),
                Cell::fixed(100.0 * s.coverage, 1),
            ]);
        }
    }
    table
}
