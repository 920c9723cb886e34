//! The intervals of a campaign over time on the robot.

use armid_io::Error;
use armid_reports::{Axis, ConvergenceFigure, ConvergencePanel, Curve, Dash, Figure, GroupStyle, Heading};

use super::answer::CampaignAnswer;
use super::stopping::Outcome;

/// Targets that are drawn, at most.
const PANELS: usize = 12;

/// The figure as SVG; `None` before the first round, or where no interval is finite.
pub(super) fn svg(answer: &CampaignAnswer) -> Result<Option<String>, Error> {
    let Some(last) = answer.rounds.last() else { return Ok(None) };
    let panels: Vec<_> = (0..answer.targets.len()).filter_map(|index| panel(answer, index)).take(PANELS).collect();
    if panels.is_empty() {
        return Ok(None);
    }
    let title = match answer.outcome {
        Outcome::Reached => format!("{}: targets reached after {:.0} s on the robot", answer.robot, last.total_s),
        Outcome::ModelError => format!("{}: errors of the model keep a target out of reach", answer.robot),
        Outcome::MostRounds => format!("{}: targets not reached in {} rounds", answer.robot, answer.rounds.len()),
        Outcome::Unfinished => format!("{}: targets not reached yet after {:.0} s", answer.robot, last.total_s),
    };
    let heading =
        Heading::new("progress", title).subtitle("half width of the interval, which holds for all rounds together");
    let figure = ConvergenceFigure { heading, columns: panels.len().min(3), panels };
    let fault = |fault| Error::new(format!("the figure of the campaign cannot be drawn: {fault}"));
    figure.svg().map(Some).map_err(fault)
}

fn panel(answer: &CampaignAnswer, index: usize) -> Option<ConvergencePanel> {
    let target = &answer.targets[index];
    let (factor, unit) = if target.is_share { (100.0, "%") } else { (1.0, answer.units[index].as_str()) };
    let curve = |name: &str, style: usize, of: &dyn Fn(usize) -> f64| {
        let points = answer.rounds.iter().enumerate().map(|(k, round)| (round.total_s, factor * of(k)));
        let points: Vec<_> = points.filter(|(_, value)| value.is_finite() && *value > 0.0).collect();
        (!points.is_empty()).then(|| Curve::new(name, GroupStyle::nth(style), points))
    };
    let widths = curve("interval", 0, &|k| answer.rounds[k].widths[index].half_width)?;
    let mut limit = curve("target", 1, &|_| target.limit())?;
    limit.style.dash = Dash::Dashed;
    let mut curves = vec![widths, limit];
    curves.extend(curve("by errors of the model", 2, &|k| answer.rounds[k].widths[index].by_model_error));
    Some(ConvergencePanel {
        title: target.to_string(),
        evaluations: Axis::linear("time on the robot", "s"),
        value: Axis::log(target.name(), unit),
        curves,
    })
}
