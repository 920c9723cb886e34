//! What `armid design` says.

use std::fmt::Write;
use std::path::PathBuf;

use armid::excitation::effort::WorstEfforts;
use armid::excitation::{Design, LimitKind, Termination, WorstUse};
use armid::model::{ParameterId, Robot};
use armid_workflow::design::{DesignAnswer, Gain, HeaviestLoad};

use crate::answers::clearance;
use crate::answers::separating::SeparatingExperiment;
use crate::terminal::{Destination, Table, number};

/// How a start ended, in words.
fn ending(design: &Design, robot: &Robot) -> String {
    match &design.termination {
        Termination::Infeasible { limit, joint, worst } if *limit == LimitKind::Clearance => {
            let [found, required, t] = [worst.value, worst.limit, worst.t].map(number);
            format!("infeasible: {joint} {found} m apart at t = {t} s, expected {required} m")
        }
        Termination::Infeasible { limit, worst, .. } => {
            format!("infeasible: {} {}", limit.name(), used(worst, *limit, robot))
        }
        other => other.name().to_owned(),
    }
}

/// Where a limit is used most.
fn used(worst: &WorstUse, limit: LimitKind, robot: &Robot) -> String {
    let joint = &robot.joints()[worst.joint];
    let unit = limit.unit(joint.kind);
    let (value, most) = (number(worst.value), number(worst.limit));
    let time = if limit.has_time() { format!(", t = {} s", number(worst.t)) } else { String::new() };
    format!("{value} of {most} {unit} at joint \"{}\"{time}", joint.name)
}

/// What an experiment adds to those before it.
fn gain_text(gain: &Gain) -> String {
    let advice = if !gain.is_worth_it() {
        "; this search found\n  nothing better than a repetition: add --starts, or begin --from the trajectory so far"
    } else {
        ""
    };
    format!(
        "\n  after {} estimate{} this experiment brings the bound to {:.1} % of what it is (median over\n  \
         parameters), one more like those so far to {:.1} %{advice}\n",
        gain.estimates,
        if gain.estimates == 1 { "" } else { "s" },
        100.0 * gain.bound_ratio,
        100.0 * gain.by_repetition
    )
}

/// A design, and what was made of it.
pub(crate) struct DesignText<'a> {
    pub(crate) answer: &'a DesignAnswer,
    pub(crate) destination: Destination,
    /// What was drawn beside it.
    pub(crate) figures: Vec<PathBuf>,
    /// Experiments that show what this one cannot, of what the robot file declares.
    pub(crate) separating: Vec<SeparatingExperiment>,
}

impl DesignText<'_> {
    fn payload_text(&self) -> Option<String> {
        let HeaviestLoad { mass_kg: mass, centre_m: centre } = self.answer.load?;
        let at = centre.iter().map(|&x| number(x)).collect::<Vec<_>>().join(", ");
        let mut text = format!("\n  made for a load on the last link, of at most {mass} kg at ({at}) m");
        let Some(WorstEfforts { torque, current }) = self.answer.problem.payload_use(&self.answer.best.trajectory)
        else {
            text.push_str("; no limit of torque is held,\n  since the robot has no nominal parameters\n");
            return Some(text);
        };
        let uses = [("torque", torque), ("current", current)].into_iter().filter_map(|(name, used)| {
            let share = 100.0 * used?.peak.ratio;
            Some(format!("{share:.1} % of {name}"))
        });
        let uses: Vec<String> = uses.collect();
        let _ = write!(
            text,
            ",\n  which uses {}; the load has no shape that a clearance is held against\n",
            uses.join(", ")
        );
        Some(text)
    }

    pub(crate) fn text(&self, verbose: bool) -> String {
        let answer = self.answer;
        let (best, certificate) = (&answer.best, &answer.best.certificate);
        let mut text = format!(
            "{}: {} over {} base parameters ({}), the best of {} starts in {} s\n{} after {} iterations and {} \
             evaluations; {}\n\n",
            answer.problem.robot().name(),
            best.criterion,
            answer.problem.base().rank(),
            answer.problem.objective().columns,
            answer.designs.len(),
            number(answer.seconds),
            best.termination.name(),
            best.iterations,
            best.evaluations,
            self.destination,
        );
        if let Termination::Infeasible { .. } = best.termination {
            let _ = writeln!(
                text,
                "no trajectory within the limits was found in {} start{}; the nearest: {}\n",
                answer.designs.len(),
                if answer.designs.len() == 1 { "" } else { "s" },
                ending(best, answer.problem.robot())
            );
        }
        let mut worth = Table::of(" | #rigid columns | #all columns");
        for (name, rigid, all) in [
            ("condition number", certificate.condition, certificate.condition_all),
            ("with columns of unit length", certificate.condition_scaled, certificate.condition_scaled_all),
            ("ln det of the information", certificate.log_det_information, certificate.log_det_information_all),
        ] {
            worth.row([name.to_owned(), number(rigid), number(all)]);
        }
        if let Some(bias) = certificate.bias_susceptibility {
            worth.row(["bias susceptibility, ref. units per N·m".to_owned(), "–".to_owned(), number(bias)]);
        }
        text.push_str(&worth.render(2));
        let mut limits = Table::of("limit | #used | most");
        let worst = &certificate.worst;
        for limit in LimitKind::ALL {
            let Some(case) = worst.for_limit(limit) else { continue };
            let share = format!("{:.1} %", 100.0 * case.ratio);
            limits.row([limit.name().to_owned(), share, used(&case, limit, answer.problem.robot())]);
        }
        let _ = write!(text, "\n{}", limits.render(2));
        if let Some(nearest) = &worst.clearance {
            let [first, second] = &nearest.pair;
            let [distance, t] = [nearest.distance_m, nearest.t].map(number);
            let _ = writeln!(text, "\n  nearest: {distance} m, \"{first}\" to \"{second}\", t = {t} s");
        }
        text.push_str(&self.payload_text().unwrap_or_default());
        text.push('\n');
        match answer.clearance() {
            Some(held) => text.push_str(&clearance::text(&held, verbose)),
            None => text.push_str("  no clearance is held\n"),
        }
        for remark in &answer.remarks {
            let _ = writeln!(text, "  {remark}");
        }
        if let Some(inside) = &certificate.efforts_inside {
            let [low, high] = inside.ci95.map(|share| 100.0 * share);
            let _ = writeln!(
                text,
                "  of {} arms within the nominal uncertainty, {:.1} % ({low:.1} to {high:.1}) stay within all torque\n  \
                 and current limits",
                inside.draws,
                100.0 * inside.share
            );
        }
        let _ = writeln!(text, "\n  least identifiable (share of the weakest direction, std for 1 N·m of noise):");
        for weak in &certificate.weakest {
            let share = 100.0 * weak.share_of_weakest_direction;
            let relative =
                weak.relative_deviation.map_or_else(String::new, |x| format!(", {} of its nominal value", number(x)));
            let unit = ParameterId::parse(&weak.name)
                .map_or("", |id| id.kind.unit(answer.problem.robot().joints()[id.index].kind));
            let std = number(weak.deviation);
            let _ = writeln!(text, "  {:>8} {share:5.1} %, std {std} {unit}{relative}", weak.name);
        }
        if !self.separating.is_empty() {
            text.push_str("\n  what the robot file declares leaves no trace in the residual; what shows it:\n");
            text.extend(self.separating.iter().map(SeparatingExperiment::text));
        }
        if let Some(gain) = &answer.gain {
            text.push_str(&gain_text(gain));
        }
        if let Some(baseline) = &answer.baseline {
            let _ = writeln!(
                text,
                "\n  the best of {} random trajectories: {}; the design: {}",
                baseline.evaluations,
                number(baseline.value),
                number(best.value)
            );
        }
        for figure in &self.figures {
            let _ = writeln!(text, "  {}", figure.display());
        }
        if verbose {
            let mut starts = Table::of("#start | #value | #iterations | #evaluations | ended");
            for (start, design) in answer.designs.iter().enumerate() {
                starts.row([
                    start.to_string(),
                    number(design.value),
                    design.iterations.to_string(),
                    design.evaluations.to_string(),
                    ending(design, answer.problem.robot()),
                ]);
            }
            let _ = write!(text, "\n{}", starts.render(2));
        }
        text
    }
}
