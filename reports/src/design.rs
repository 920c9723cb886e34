//! What a design looks like: how it was found, and what it uses of its limits.

use armid::excitation::{CriterionKind, Design, HistoryPoint};
use armid::model::Robot;
use armid::number::significant;
use armid::study::LimitExample;
use armid::trajectory::PeriodicTrajectory;

use crate::{
    Axis, ConvergenceFigure, ConvergencePanel, Curve, GroupStyle, Heading, Limit, Line, Pose, PosesFigure, TimePanel,
    TimeSeriesFigure,
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
    let best = designs.iter().min_by(|a, b| a.cost().total_cmp(&b.cost()))?;
    let against =
        baseline.map_or_else(String::new, |drawn| format!(", random draws at {}", significant(drawn.value, 3)));
    let title = format!("{robot}: the best start ends at {}{against}", significant(best.value, 3));
    (!curves.is_empty()).then(|| ConvergenceFigure {
        heading: Heading::new("convergence", title)
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
        Some(CriterionKind::ModelError | CriterionKind::MeasuredTorque) => {
            Axis::log("error expected of predicted torque", "N·m")
        }
        None => Axis::linear(criterion, ""),
    }
}

/// One start's history, without the points at which the information was singular.
pub(crate) fn curve(label: &str, style: GroupStyle, history: &[HistoryPoint]) -> Curve {
    let points = history.iter().map(|point| (point.evaluations as f64, point.value));
    Curve::new(label, style.with_width(1.0), points.filter(|(_, value)| value.is_finite()).collect())
}

/// A design against its limits, one panel per joint that has any; `None` where no joint has.
pub fn limits_figure(
    example: &LimitExample,
    joints: &[String],
    heading: impl FnOnce(String) -> Heading,
) -> Option<TimeSeriesFigure> {
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
    let most = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let shares = quantities
        .iter()
        .flat_map(|(what, all)| all.iter().zip(joints).map(|(values, joint)| (joint, *what, most(values))));
    let (joint, what, share) = shares.max_by(|a, b| a.2.total_cmp(&b.2))?;
    let finding = format!("{joint} comes closest to a limit: {} % of its {what}", significant(100.0 * share, 3));
    (!panels.is_empty()).then(|| TimeSeriesFigure {
        heading: heading(finding).caption("Each quantity over its limit; position counts from the middle of its range. Torque is that of the nominal parameters, over the joint's rating."),
        time: Axis::linear("time", "s"),
        value: Axis::linear("share of the limit", ""),
        columns: 2,
        same_range: true,
        panels,
    })
}

/// Samples of a period in which poses are looked for.
const PATH: usize = 400;
/// Poses at equal times.
const STRIP: usize = 8;

/// How an arm moves over a period: poses at equal times, then where its end is highest, lowest, furthest out and fastest. The end is
/// the first point that the robot file names, or the origin of the last link's frame.
pub fn poses_figure(robot: &Robot, trajectory: &PeriodicTrajectory) -> PosesFigure {
    let states = trajectory.sample(PATH);
    let points = |k: usize| -> Vec<[f64; 3]> {
        let poses = robot.poses(states.q(k));
        let tip = robot.points().first().map(|point| point.place(&poses));
        let origins = poses.iter().map(|pose| pose.translation).chain(tip);
        std::iter::once([0.0; 3]).chain(origins.map(Into::into)).collect()
    };
    let end = |k: usize| points(k).last().copied().unwrap_or_default();
    let path: Vec<[f64; 3]> = (0..=PATH).map(|k| end(k % PATH)).collect();
    let step_s = trajectory.period_s() / PATH as f64;
    let length = |v: [f64; 3]| libm::sqrt(v.iter().map(|x| x * x).sum());
    let out = |k: usize| length([path[k][0], path[k][1], 0.0]);
    let speed = |k: usize| length([0, 1, 2].map(|axis| path[k + 1][axis] - path[k][axis])) / step_s;
    let most = |of: &dyn Fn(usize) -> f64| (0..PATH).max_by(|&a, &b| of(a).total_cmp(&of(b))).unwrap_or(0);
    let pose = |k: usize, why: String| Pose { title: format!("{:.2} s{why}", k as f64 * step_s), points: points(k) };
    let [highest, lowest, furthest, fastest] =
        [most(&|k| path[k][2]), most(&|k| -path[k][2]), most(&out), most(&speed)];
    let mut poses: Vec<Pose> = (0..STRIP).map(|k| pose(k * PATH / STRIP, String::new())).collect();
    poses.extend([
        pose(highest, format!(": highest, {:.2} m", path[highest][2])),
        pose(lowest, format!(": lowest, {:.2} m", path[lowest][2])),
        pose(furthest, format!(": furthest out, {:.2} m", out(furthest))),
        pose(fastest, format!(": fastest, {:.2} m/s", speed(fastest))),
    ]);
    let heading = Heading::new(
        "poses",
        format!(
            "{}: the end of the arm comes down to {:.2} m and reaches {:.2} m out",
            robot.name(),
            path[lowest][2],
            out(furthest)
        ),
    )
    .subtitle(format!(
        "one period of {} s, at full speed; heights above the origin of the base frame",
        trajectory.period_s()
    ))
    .caption("Lines join the origins of the joints' frames. All poses are seen from one side, at one scale.");
    PosesFigure { heading, poses, path }
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
        let limits = DesignLimits::motion();
        let mut problem = DesignProblem::new(planar_2r(), Columns::RIGID, CriterionKind::Condition, limits).unwrap();
        problem.set_budget(DesignBudget { evaluations: 20, ..DesignBudget::default() }).unwrap();
        let drawn = random_design(&problem, Seed::new(3), 0).unwrap();
        let without = Design { history: Vec::new(), ..drawn.clone() };
        let figure = design_convergence("arm", &[drawn.clone(), without.clone()], Some(&drawn)).unwrap();
        let labels: Vec<&str> = figure.panels[0].curves.iter().map(|curve| curve.label.as_str()).collect();
        assert_eq!(labels, ["optimiser", "random draws"]);
        assert!(design_convergence("arm", &[without], None).is_none());
        assert!(design_convergence("arm", &[], Some(&drawn)).is_none());
    }
}
