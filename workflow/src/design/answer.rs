//! What a design answers.

use std::path::{Path, PathBuf};

use armid::excitation::effort::WorstEfforts;
use armid::excitation::{Design, DesignProblem, ExcitationError, Termination};
use armid::study::LimitExample;
use armid::trajectory::PeriodicTrajectory;
use armid_io::robot::HeldShapes;
use armid_io::{Error, output};
use armid_reports::{Figure, Heading, design_convergence, limits_figure, poses_figure};
use serde::{Serialize, Serializer};
use serde_json::{Value, json};

use super::clearance::HeldClearance;
use super::settings::HeaviestLoad;

/// A design, and what it was found among. It serialises to the keys of the command's answer.
#[derive(Clone, Debug)]
pub struct DesignAnswer {
    /// Seed of the first guesses.
    pub seed: u64,
    /// What was asked.
    pub problem: DesignProblem,
    /// The designs of all starts.
    pub designs: Vec<Design>,
    /// The best of random trajectories.
    pub baseline: Option<Design>,
    /// The best inside the limits, or where there is none, the one nearest to them.
    pub best: Design,
    /// Wall time of the search, s.
    pub seconds: f64,
    /// Whether an observer ended the search early.
    pub interrupted: bool,
    /// What was read of the robot otherwise than it is written, and what was not.
    pub remarks: Vec<String>,
    /// What clearances are held against.
    pub shapes: HeldShapes,
    /// The load that it is made for.
    pub load: Option<HeaviestLoad>,
    /// What it adds to earlier estimates, where there are any.
    pub gain: Option<Gain>,
}

/// The gain of an experiment after those before it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Gain {
    /// Estimates so far.
    pub estimates: usize,
    /// Median over base parameters of the bound after it over that so far.
    pub bound_ratio: f64,
    /// Median over base parameters of the bound after one more experiment like those so far, over that so far.
    #[serde(rename = "bound_ratio_by_repetition")]
    pub by_repetition: f64,
}

/// Share of the bound of a repetition above which a redesign is no better than one.
const AS_GOOD: f64 = 0.99;

impl Gain {
    /// Of a design after so many estimates; `None` after none.
    pub(super) fn of(
        problem: &DesignProblem,
        design: &Design,
        estimates: usize,
    ) -> Result<Option<Self>, ExcitationError> {
        let k = estimates as f64;
        let gain = |bound_ratio| Self { estimates, bound_ratio, by_repetition: (k / (k + 1.0)).sqrt() };
        Ok(problem.bound_ratio(&design.trajectory)?.map(gain))
    }

    /// Is it better than a repetition?
    pub fn is_worth_it(&self) -> bool {
        self.bound_ratio <= AS_GOOD * self.by_repetition
    }
}

impl DesignAnswer {
    /// Does the design hold all limits, and does it show all chosen parameters?
    pub const fn is_feasible(&self) -> bool {
        self.best.termination.is_feasible()
    }

    /// The trajectory with its certificate, as the text of a file.
    pub fn toml(&self) -> String {
        self.best.certificate.to_toml_with(&self.best.trajectory)
    }

    /// Draws how the design was found and what it uses of its limits, beside the file of the trajectory; returns the figures.
    ///
    /// # Errors
    /// [`Error`] where a figure cannot be drawn or written.
    pub fn draw(&self, path: &Path) -> Result<Vec<PathBuf>, Error> {
        let robot = self.problem.robot().name();
        let joints: Vec<String> = self.problem.robot().joints().iter().map(|joint| joint.name.clone()).collect();
        let example =
            LimitExample::new(self.problem.robot(), self.problem.limits().nominal.as_ref(), &self.best.trajectory);
        let convergence = design_convergence(robot, &self.designs, self.baseline.as_ref());
        let limits = limits_figure(&example, &joints, |finding| {
            Heading::new("limits", format!("{robot}: {finding}"))
                .subtitle(format!("one period, optimised for {}", self.best.criterion))
        });
        let poses = poses_figure(self.problem.robot(), &self.best.trajectory);
        let drawn = [
            convergence.map(|figure| ("convergence", figure.svg())),
            limits.map(|figure| ("limits", figure.svg())),
            Some(("poses", poses.svg())),
        ];
        let mut written = Vec::new();
        for (name, svg) in drawn.into_iter().flatten() {
            let svg = svg.map_err(|fault| Error::new(format!("the figure \"{name}\" cannot be drawn: {fault}")))?;
            let mut file = path.with_extension("").into_os_string();
            file.push(format!("-{name}.svg"));
            let file = PathBuf::from(file);
            output::write_text(&file, &svg)?;
            written.push(file);
        }
        Ok(written)
    }

    /// What is held where a clearance is.
    pub fn clearance(&self) -> Option<HeldClearance<'_>> {
        let (robot, shapes) = (self.problem.robot(), &self.shapes);
        self.problem.limits().clearance_m.map(|required_m| HeldClearance { robot, required_m, shapes })
    }

    /// Names of the effects that the criterion expects; `None` of one that expects none.
    fn expected_effects(&self) -> Option<Vec<&str>> {
        let objective = self.problem.objective();
        let expected = objective.expected.as_ref().filter(|_| objective.criterion.expects_effects())?;
        Some(expected.effects.iter().map(|effect| effect.name.as_str()).collect())
    }

    /// The heaviest load, and what it uses of torque and current.
    fn load_json(&self) -> Option<Value> {
        let HeaviestLoad { mass_kg, centre_m } = self.load?;
        let used = self.problem.payload_use(&self.best.trajectory);
        let used = used.map(|WorstEfforts { torque, current }| {
            json!({
                "torque": torque.map(|used| used.peak.ratio),
                "torque_rms": torque.map(|used| used.mean_square.ratio),
                "current": current.map(|used| used.peak.ratio),
                "current_rms": current.map(|used| used.mean_square.ratio),
            })
        });
        Some(json!({ "mass_kg": mass_kg, "centre_m": centre_m, "worst_limit_use": used }))
    }
}

impl Serialize for DesignAnswer {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (best, certificate) = (&self.best, &self.best.certificate);
        let is_lost = self.interrupted && !self.is_feasible();
        let mut answer = json!({
            "robot": self.problem.robot().name(),
            "remarks": self.remarks,
            "collision_shapes": self.clearance(),
            "criterion": best.criterion,
            "columns": self.problem.objective().columns.to_string(),
            "family": self.problem.space().family.name(),
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
            "bias_susceptibility": certificate.bias_susceptibility,
            "worst_limit_use": certificate.worst_limit_use,
            "worst": certificate.worst,
            "certificate_samples": certificate.samples,
            "ramp_s": certificate.ramp_s,
            "weakest_all": certificate.weakest,
            "uncertainty_multiple": certificate.uncertainty_multiple,
            "efforts_inside": certificate.efforts_inside,
            "clearance_required_m": self.problem.limits().clearance_m,
            "payload": self.load_json(),
            "robot_sha256": certificate.robot_sha256,
            "trajectory_sha256": certificate.trajectory_sha256,
        });
        let more = json!({
            "iterations": best.iterations,
            "evaluations": best.evaluations,
            "seconds": self.seconds,
            "termination": if is_lost { Termination::Interrupted.name() } else { best.termination.name() },
            "violation": violation_json(best),
            "start": trajectory_json(&best.start),
            "trajectory": trajectory_json(&best.trajectory),
            "starts": self.designs.iter().map(start_json).collect::<Vec<_>>(),
            "baseline": self.baseline.as_ref().map(start_json),
            "prior": self.gain,
            "history": best.history,
        });
        // In two parts: the macro has room for no more.
        if let (Value::Object(all), Value::Object(more)) = (&mut answer, more) {
            all.extend(more);
        }
        answer.serialize(serializer)
    }
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
