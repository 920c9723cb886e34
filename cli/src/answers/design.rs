//! What `armid design` answers: as a text and as JSON.

use std::fmt::Write;
use std::path::PathBuf;

use armid::excitation::effort::WorstEfforts;
use armid::excitation::{Design, DesignProblem, ExcitationError, LimitKind, Termination, WorstUse};
use armid::model::{ParameterId, Robot};
use armid::trajectory::PeriodicTrajectory;
use armid_io::robot::HeldShapes;
use serde_json::{Value, json};

use crate::answers::clearance::ClearanceAnswer;
use crate::answers::separating::SeparatingExperiment;
use crate::terminal::{Align, Destination, Table, number};

/// How a start ended, in words.
fn ending(design: &Design, robot: &Robot) -> String {
    match &design.termination {
        Termination::Infeasible { limit, joint, worst } if *limit == LimitKind::Clearance => {
            let (found, required, t) = (number(worst.value), number(worst.limit), worst.t);
            format!("infeasible: {joint} {found} m apart at t = {t:.3} s, expected {required} m")
        }
        Termination::Infeasible { limit, worst, .. } => format!("infeasible: {limit} {}", used(worst, *limit, robot)),
        other => other.name().to_owned(),
    }
}

/// Where a limit is used most.
fn used(worst: &WorstUse, limit: LimitKind, robot: &Robot) -> String {
    let joint = &robot.joints()[worst.joint];
    let unit = limit.unit(joint.kind);
    let (value, most) = (number(worst.value), number(worst.limit));
    let time = if limit.has_time() { format!(", t = {:.3} s", worst.t) } else { String::new() };
    format!("{value} of {most} {unit} at joint \"{}\"{time}", joint.name)
}

/// Which limit is exceeded, where and by how much.
fn violation_json(design: &Design) -> Value {
    match &design.termination {
        Termination::Infeasible { limit, joint, worst } => json!({
            "limit": limit,
            "where": joint,
            "t": worst.t,
            "value": worst.value,
            "permitted": worst.limit,
            "excess": (worst.value.abs() - worst.limit.abs()).abs(),
        }),
        _ => Value::Null,
    }
}

fn start_json(design: &Design) -> Value {
    json!({
        "value": design.value,
        "termination": design.termination.name(),
        "iterations": design.iterations,
        "evaluations": design.evaluations,
        "violation": violation_json(design),
    })
}

/// The trajectory under the keys of its file.
fn trajectory_json(trajectory: &PeriodicTrajectory) -> Value {
    toml::from_str(&trajectory.to_toml()).expect("a trajectory file is TOML with finite numbers")
}

/// The gain of an experiment after those before it.
pub(crate) struct Gain {
    /// Estimates so far.
    estimates: usize,
    /// Median over base parameters of the bound after it over that so far.
    bound_ratio: f64,
    /// The same by one more experiment like those so far.
    by_repetition: f64,
}

/// Share of the bound of a repetition above which a redesign is no better than one.
const AS_GOOD: f64 = 0.99;

impl Gain {
    /// Of a design after so many estimates; `None` after none.
    pub(crate) fn of(
        problem: &DesignProblem,
        design: &Design,
        estimates: usize,
    ) -> Result<Option<Self>, ExcitationError> {
        let k = estimates as f64;
        let gain = |bound_ratio| Self { estimates, bound_ratio, by_repetition: (k / (k + 1.0)).sqrt() };
        Ok(problem.bound_ratio(&design.trajectory)?.map(gain))
    }

    fn json(&self) -> Value {
        json!({
            "estimates": self.estimates,
            "bound_ratio": self.bound_ratio,
            "bound_ratio_by_repetition": self.by_repetition,
        })
    }

    fn text(&self) -> String {
        let advice = if self.bound_ratio > AS_GOOD * self.by_repetition {
            "; this search found\n  nothing better than a repetition: add --starts, or begin --from the trajectory so far"
        } else {
            ""
        };
        format!(
            "\n  after {} estimate{} this experiment brings the bound to {:.1} % of what it is (median over\n  \
             parameters), one more like those so far to {:.1} %{advice}\n",
            self.estimates,
            if self.estimates == 1 { "" } else { "s" },
            100.0 * self.bound_ratio,
            100.0 * self.by_repetition
        )
    }
}

/// Everything that the answer shows.
pub(crate) struct DesignAnswer<'a> {
    pub(crate) seed: u64,
    pub(crate) problem: &'a DesignProblem,
    pub(crate) designs: &'a [Design],
    pub(crate) baseline: Option<&'a Design>,
    /// The best inside the limits, or where there is none, the one nearest to them.
    pub(crate) best: &'a Design,
    pub(crate) seconds: f64,
    pub(crate) destination: Destination,
    /// What was drawn beside it.
    pub(crate) figures: Vec<PathBuf>,
    /// What was read of the robot otherwise than it is written, and what was not.
    pub(crate) remarks: &'a [String],
    /// What clearances are held against.
    pub(crate) shapes: &'a HeldShapes,
    /// Mass (kg) and centre (m) of the heaviest load that it is made for.
    pub(crate) payload: Option<(f64, [f64; 3])>,
    /// Experiments that show what this one cannot, of what the robot file declares.
    pub(crate) separating: Vec<SeparatingExperiment>,
    /// What it adds to the information so far, where there is any.
    pub(crate) gain: Option<Gain>,
}

impl DesignAnswer<'_> {
    /// Names of the effects that the criterion expects; `None` of one that expects none.
    fn expected_effects(&self) -> Option<Vec<&str>> {
        let objective = self.problem.objective();
        let expected = objective.expected().filter(|_| objective.criterion().expects_effects())?;
        Some(expected.effects().iter().map(|effect| effect.name.as_str()).collect())
    }

    /// The heaviest load, and what it uses of torque and current.
    fn payload_json(&self) -> Option<Value> {
        let (mass, centre) = self.payload?;
        let used = self.problem.payload_use(&self.best.trajectory);
        let used = used.map(|WorstEfforts { torque, current }| {
            json!({
                "torque": torque.map(|used| used.peak.ratio),
                "torque_rms": torque.map(|used| used.mean_square.ratio),
                "current": current.map(|used| used.peak.ratio),
                "current_rms": current.map(|used| used.mean_square.ratio),
            })
        });
        Some(json!({ "mass_kg": mass, "centre_m": centre, "worst_limit_use": used }))
    }

    fn payload_text(&self) -> Option<String> {
        let (mass, centre) = self.payload?;
        let at = centre.iter().map(|&x| number(x)).collect::<Vec<_>>().join(", ");
        let mut text = format!("\n  made for a load on the last link, of at most {mass} kg at ({at}) m");
        let Some(WorstEfforts { torque, current }) = self.problem.payload_use(&self.best.trajectory) else {
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

    /// What is held where a clearance is.
    fn clearance(&self) -> Option<ClearanceAnswer<'_>> {
        let (robot, shapes) = (self.problem.robot(), self.shapes);
        self.problem.limits().clearance_m().map(|required_m| ClearanceAnswer { robot, required_m, shapes })
    }

    pub(crate) fn json(&self, interrupted: bool) -> Value {
        let (best, certificate) = (self.best, &self.best.certificate);
        let mut answer = json!({
            "robot": self.problem.robot().name(),
            "remarks": self.remarks,
            "collision_shapes": self.clearance().map(|clearance| clearance.json()),
            "criterion": best.criterion,
            "columns": self.problem.objective().columns().to_string(),
            "family": self.problem.space().family().name(),
            "seed": self.seed,
            "value": best.value,
            "expected": self.expected_effects(),
            "condition": certificate.condition,
            "condition_scaled": certificate.condition_scaled,
            "log_det_information": certificate.log_det_information,
            "condition_all": certificate.condition_all,
            "condition_scaled_all": certificate.condition_scaled_all,
            "log_det_information_all": certificate.log_det_information_all,
            "spectrum_all": certificate.spectrum,
            "deviations_all": certificate.deviations,
            "worst_limit_use": certificate.worst_limit_use,
            "worst": certificate.worst,
            "certificate_samples": certificate.samples,
            "ramp_s": certificate.ramp_s,
            "weakest_all": certificate.weakest,
            "uncertainty_multiple": certificate.uncertainty_multiple,
            "efforts_inside": certificate.efforts_inside,
            "clearance_required_m": self.problem.limits().clearance_m(),
            "payload": self.payload_json(),
            "robot_sha256": certificate.robot_sha256,
            "trajectory_sha256": certificate.trajectory_sha256,
            "iterations": best.iterations,
            "evaluations": best.evaluations,
            "seconds": self.seconds,
            "termination": if interrupted { "interrupted" } else { best.termination.name() },
            "violation": violation_json(best),
            "start": trajectory_json(&best.start),
            "trajectory": trajectory_json(&best.trajectory),
            "file": self.destination.path(),
            "figures": self.figures,
            "starts": self.designs.iter().map(start_json).collect::<Vec<_>>(),
            "baseline": self.baseline.map(start_json),
            "prior": self.gain.as_ref().map(Gain::json),
            "history": best.history,
        });
        // Keys more than the macro has room for.
        answer["bias_susceptibility"] = json!(certificate.bias_susceptibility);
        answer["separating_experiments"] = self.separating.iter().map(SeparatingExperiment::json).collect();
        answer
    }

    pub(crate) fn text(&self, verbose: bool) -> String {
        let (best, certificate) = (self.best, &self.best.certificate);
        let mut text = format!(
            "{}: {} over {} base parameters ({}), the best of {} starts in {:.2} s\n{} after {} iterations and {} \
             evaluations; {}\n\n",
            self.problem.robot().name(),
            best.criterion,
            self.problem.base().rank(),
            self.problem.objective().columns(),
            self.designs.len(),
            self.seconds,
            best.termination.name(),
            best.iterations,
            best.evaluations,
            self.destination,
        );
        if let Termination::Infeasible { .. } = best.termination {
            let _ = writeln!(
                text,
                "no trajectory within the limits was found in {} start{}; the nearest: {}\n",
                self.designs.len(),
                if self.designs.len() == 1 { "" } else { "s" },
                ending(best, self.problem.robot())
            );
        }
        let mut worth =
            Table::new(&[("", Align::Left), ("rigid columns", Align::Right), ("all columns", Align::Right)]);
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
        let mut limits = Table::new(&[("limit", Align::Left), ("used", Align::Right), ("most", Align::Left)]);
        let worst = &certificate.worst;
        for limit in LimitKind::ALL {
            let Some(case) = worst.of(limit) else { continue };
            let share = format!("{:.1} %", 100.0 * case.ratio);
            limits.row([limit.name().to_owned(), share, used(&case, limit, self.problem.robot())]);
        }
        let _ = write!(text, "\n{}", limits.render(2));
        if let Some(nearest) = &worst.clearance {
            let [first, second] = &nearest.pair;
            let (distance, t) = (number(nearest.distance_m), nearest.t);
            let _ = writeln!(text, "\n  nearest: {distance} m, \"{first}\" to \"{second}\", t = {t:.3} s");
        }
        text.push_str(&self.payload_text().unwrap_or_default());
        text.push('\n');
        match self.clearance() {
            Some(clearance) => text.push_str(&clearance.text(verbose)),
            None => text.push_str("  no clearance is held\n"),
        }
        for remark in self.remarks {
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
                .map_or("", |id| id.kind.unit(self.problem.robot().joints()[id.index].kind));
            let std = number(weak.deviation);
            let _ = writeln!(text, "  {:>8} {share:5.1} %, std {std} {unit}{relative}", weak.name);
        }
        if !self.separating.is_empty() {
            text.push_str("\n  what the robot file declares leaves no trace in the residual; what shows it:\n");
            text.extend(self.separating.iter().map(SeparatingExperiment::text));
        }
        if let Some(gain) = &self.gain {
            text.push_str(&gain.text());
        }
        if let Some(baseline) = self.baseline {
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
            let mut starts = Table::new(&[
                ("start", Align::Right),
                ("value", Align::Right),
                ("iterations", Align::Right),
                ("evaluations", Align::Right),
                ("ended", Align::Left),
            ]);
            for (start, design) in self.designs.iter().enumerate() {
                starts.row([
                    start.to_string(),
                    number(design.value),
                    design.iterations.to_string(),
                    design.evaluations.to_string(),
                    ending(design, self.problem.robot()),
                ]);
            }
            let _ = write!(text, "\n{}", starts.render(2));
        }
        text
    }
}
