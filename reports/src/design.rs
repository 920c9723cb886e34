//! What a design looks like: how it was found, and what it uses of its limits.

use armid::excitation::{CriterionKind, Design, HistoryPoint};
use armid::study::LimitExample;

use crate::{
    Axis, ConvergenceFigure, ConvergencePanel, Curve, GroupStyle, Heading, Limit, Line, TimePanel, TimeSeriesFigure,
};

/// How the designs of several starts converged, beside the best of random draws where there is one; `None` where no start has
/// a history.
pub fn design_convergence(robot: &str, designs: &[Design], baseline: Option<&Design>) -> Option<ConvergenceFigure> {
    let criterion = &designs.first()?.criterion;
    let optimised = designs.iter().map(|design| ("optimiser", 0, design));
    let drawn = baseline.map(|design| ("random draws", 1, design));
    let curves: Vec<Curve> = optimised
        .chain(drawn)
        .map(|(label, style, design)| curve(label, GroupStyle::nth(style), &design.history))
        .filter(|curve| !curve.points.is_empty())
        .collect();
    (!curves.is_empty()).then(|| ConvergenceFigure {
        heading: Heading::new("convergence", format!("{robot}: how the designs converge"))
            .subtitle(
                "best value so far against evaluations, one line per start; a gradient counts as one evaluation more",
            )
            .caption(format!("The criterion is {criterion}; a value counts once every limit holds.")),
        columns: 1,
        panels: vec![convergence_panel(String::new(), value_axis(criterion), curves)],
    })
}

/// The curves of one criterion with its axis.
pub(crate) fn convergence_panel(title: String, value: Axis, curves: Vec<Curve>) -> ConvergencePanel {
    ConvergencePanel { title, evaluations: Axis::linear("evaluations", ""), value, curves }
}

/// The axis of the criterion with this name; of one from outside of the list its name is all that is known.
pub(crate) fn value_axis(criterion: &str) -> Axis {
    match CriterionKind::parse(criterion) {
        Some(CriterionKind::Condition | CriterionKind::ConditionScaled | CriterionKind::ConditionInUnits) => {
            Axis::log("condition number", "")
        }
        Some(CriterionKind::DOptimal) => Axis::linear("ln det of the information", ""),
        Some(CriterionKind::AOptimal) => Axis::log("sum of variances per row", ""),
        Some(CriterionKind::EOptimal) => Axis::log("smallest eigenvalue per row", ""),
        Some(CriterionKind::ConditionPlusSigma) => Axis::log("condition number + 1/σ_min", ""),
        Some(CriterionKind::ConditionPlusD) => Axis::linear("condition number − ln det", ""),
        Some(CriterionKind::IOptimal) => Axis::log("variance of predicted torque, times rows", "(N·m)²"),
        Some(CriterionKind::ModelError) => Axis::log("error expected of predicted torque", "N·m"),
        None => Axis::linear(criterion, ""),
    }
}

/// One start's history, without the points at which the information was singular.
pub(crate) fn curve(label: &str, style: GroupStyle, history: &[HistoryPoint]) -> Curve {
    let points = history.iter().map(|point| (point.evaluations as f64, point.value));
    Curve::new(label, style.with_width(1.0), points.filter(|(_, value)| value.is_finite()).collect())
}

/// A design against its limits, one panel per joint that has any; `None` where no joint has.
pub fn limits_figure(example: &LimitExample, joints: &[String], heading: Heading) -> Option<TimeSeriesFigure> {
    let quantities = [
        ("position", &example.position),
        ("velocity", &example.velocity),
        ("acceleration", &example.acceleration),
        ("torque", &example.torque),
    ];
    let lines = |j: usize| -> Vec<Line> {
        let limited = quantities.iter().enumerate().filter(|(_, (_, values))| !values[j].is_empty());
        limited
            .map(|(i, (label, values))| {
                Line::new(*label, GroupStyle::nth(i), example.time_s.clone(), values[j].clone())
            })
            .collect()
    };
    let panels: Vec<TimePanel> = joints
        .iter()
        .enumerate()
        .map(|(j, joint)| TimePanel {
            title: joint.clone(),
            lines: lines(j),
            limits: vec![Limit::new(1.0, "limit"), Limit::new(-1.0, "limit")],
        })
        .filter(|panel| !panel.lines.is_empty())
        .collect();
    (!panels.is_empty()).then(|| TimeSeriesFigure {
        heading: heading.caption("Each quantity over its limit; position counts from the middle of its range. Torque is that of the nominal parameters, over the joint's rating."),
        time: Axis::linear("time", "s"),
        value: Axis::linear("share of the limit", ""),
        columns: 2,
        same_range: true,
        panels,
    })
}

#[cfg(test)]
mod tests {
    use armid::chains::planar_2r;
    use armid::excitation::{DesignBudget, DesignLimits, DesignProblem, random_design};
    use armid::model::Columns;
    use armid::seed::Seed;

    use super::*;

    #[test]
    fn a_curve_is_drawn_for_each_design_with_a_history() {
        let limits = DesignLimits::of_motion();
        let mut problem = DesignProblem::new(planar_2r(), Columns::RIGID, CriterionKind::Condition, limits).unwrap();
        problem.set_budget(DesignBudget::new(20).unwrap());
        let drawn = random_design(&problem, Seed::new(3), 0).unwrap();
        let without = Design { history: Vec::new(), ..drawn.clone() };
        let figure = design_convergence("arm", &[drawn.clone(), without.clone()], Some(&drawn)).unwrap();
        let labels: Vec<&str> = figure.panels[0].curves.iter().map(|curve| curve.label.as_str()).collect();
        assert_eq!(labels, ["optimiser", "random draws"]);
        assert!(design_convergence("arm", &[without], None).is_none());
        assert!(design_convergence("arm", &[], Some(&drawn)).is_none());
    }
}
