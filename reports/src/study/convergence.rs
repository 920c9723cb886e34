//! How the optimiser got there.

use std::collections::BTreeSet;

use armid::excitation::CriterionKind;
use armid::study::{ReportInput, StudyDesign, criterion_in_words};

use super::titles;
use crate::design::{convergence_panel, value_axis};
use crate::{ConvergenceFigure, ConvergencePanel, Curve, DocumentError, GroupStyle, Heading, Section};

/// Curves that one panel holds.
const CURVES: usize = 200;

pub(super) fn section(input: &ReportInput) -> Result<Section, DocumentError> {
    let result = &input.result;
    let listed: Vec<&str> = CriterionKind::ALL.iter().map(|kind| kind.name()).collect();
    // Those from outside come last.
    let own = result.designs.iter().filter_map(|design| design.criterion.as_deref());
    let own: BTreeSet<&str> = own.filter(|name| !listed.contains(name)).collect();
    let panels: Vec<ConvergencePanel> = listed
        .iter()
        .copied()
        .chain(own)
        .filter_map(|criterion| {
            let searched =
                |design: &&StudyDesign| design.criterion.as_deref() == Some(criterion) && design.history.len() > 1;
            let mut designs: Vec<&StudyDesign> = result.designs.iter().filter(searched).collect();
            if designs.len() > CURVES {
                // The first starts of every family.
                designs.sort_by_key(|design| design.start);
                designs.truncate(CURVES);
            }
            let curves: Vec<Curve> = designs.into_iter().map(|design| curve(input, design)).collect();
            (!curves.is_empty()).then(|| convergence_panel(criterion.to_owned(), value_axis(criterion), curves))
        })
        .collect();
    let section = Section::new("Convergence of the designs");
    if panels.is_empty() {
        return Ok(section.text("Nothing was optimised."));
    }
    let figure = ConvergenceFigure {
        heading: Heading::new("convergence", titles::convergence(input).unwrap_or_else(|| "How the designs converge".to_owned()))
            .subtitle("best value so far against evaluations, one line per start; a gradient counts as one evaluation more")
            .caption("Condition numbers fall, the information rises. Random draws are chosen by the same criterion at the same number of evaluations. Of more than 200 designs by one criterion the first starts are shown."),
        columns: panels.len().min(3),
        panels,
    };
    section.figure(&figure)
}

fn curve(input: &ReportInput, design: &StudyDesign) -> Curve {
    let family = &input.result.plan.designs[design.family].name;
    let style = GroupStyle::for_name(family).unwrap_or_else(|| GroupStyle::nth(design.family));
    crate::design::curve(&criterion_in_words(family), style, &design.history)
}
