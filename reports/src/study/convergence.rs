//! How the optimiser got there.

use armid::excitation::CriterionKind;
use armid::study::{StudyDesign, StudyStory};

use crate::{Axis, ConvergenceFigure, ConvergencePanel, Curve, DocumentError, GroupStyle, Heading, Section};

pub(super) fn section(story: &StudyStory) -> Result<Section, DocumentError> {
    let result = &story.result;
    let panels: Vec<ConvergencePanel> = CriterionKind::ALL
        .into_iter()
        .filter_map(|criterion| {
            let curves: Vec<Curve> = result
                .designs
                .iter()
                .filter(|design| design.criterion == Some(criterion) && design.history.len() > 1)
                .map(|design| curve(story, design))
                .collect();
            (!curves.is_empty()).then(|| ConvergencePanel {
                title: criterion.name().to_owned(),
                evaluations: Axis::linear("evaluations", ""),
                value: match criterion {
                    CriterionKind::Condition | CriterionKind::ConditionScaled => Axis::log("condition number", ""),
                    CriterionKind::DOptimal => Axis::linear("ln det of the information", ""),
                    CriterionKind::AOptimal => Axis::log("sum of variances per row", ""),
                    CriterionKind::EOptimal => Axis::log("smallest eigenvalue per row", ""),
                    CriterionKind::ConditionPlusSigma => Axis::log("condition number + 1/σ_min", ""),
                    CriterionKind::ConditionPlusD => Axis::linear("condition number − ln det", ""),
                },
                curves,
            })
        })
        .collect();
    let section = Section::new("Convergence of the designs");
    if panels.is_empty() {
        return Ok(section.text("Nothing was optimised."));
    }
    let figure = ConvergenceFigure {
        heading: Heading::new("convergence", "How the designs converge")
            .subtitle("best value so far against evaluations, one line per start; a gradient counts as one evaluation more")
            .caption("Condition numbers fall, the information rises. Random draws are chosen by the same criterion at the same number of evaluations."),
        columns: panels.len().min(3),
        panels,
    };
    section.figure(&figure)
}

fn curve(story: &StudyStory, design: &StudyDesign) -> Curve {
    let family = &story.result.plan.designs[design.family].name;
    let style = GroupStyle::of(family).unwrap_or_else(|| GroupStyle::nth(design.family));
    let points = design.history.iter().map(|p| (p.evaluations as f64, p.value)).collect();
    Curve::new(family, style.with_width(1.0), points)
}
