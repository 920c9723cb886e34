//! `armid design`

use std::path::PathBuf;

use armid::excitation::{CriterionKind, DEFAULT_EVALUATIONS};
use armid::experiment::{EffectKind, Effects};
use armid::input::size::{DESIGNS, HARMONICS, PERIOD_S};
use armid::model::Columns;
use armid::trajectory::Family;
use armid_io::Error;
use armid_workflow::design::{DesignGoal, DesignSettings, design};
use miette::Result;

use crate::answers::design::DesignText;
use crate::answers::separating::SeparatingExperiment;
use crate::arguments::{LimitArguments, MeshArguments, PayloadArguments, RobotArguments, columns, one_of};
use crate::terminal::{Answer, Console, Ending, Watch, report_folder};

const AFTER_HELP: &str = "\
Every start gets other random velocities and --evaluations evaluations of the criterion (a gradient counts \
as one more). The best start within all limits is written with its certificate. If none is within the \
limits, the nearest is written and the exit status is 1. Equal seeds give equal trajectories. Limits: `armid \
help limits`.

Examples:
  armid design crs-a460 --criterion d-optimal -o T.toml
  armid design crs-a460 --criterion condition --columns rigid --starts 8 --seed 3 --json -o T.toml
  armid design crs-a460 --criterion d-optimal --prior E.json --from T.toml -o T2.toml
  armid design crs-a460 --criterion model-error --expect load-friction,elasticity=3.0 -o T.toml
  armid design crs-a460 --criterion a-optimal --family cubic-b-spline --freeze wrist_roll=0 -o T.toml
  armid design crs-a460 --payload 1.5 --payload-centre 0,0,0.05 -o L.toml
  armid design arm.urdf --criterion condition-scaled --period 20 --harmonics 7 -o T.toml";

/// Design a trajectory that excites the parameters best within the limits
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    /// Criterion
    #[arg(long, value_parser = one_of(&CriterionKind::ALL, CriterionKind::name), required_unless_present = "payload")]
    criterion: Option<CriterionKind>,
    #[command(flatten)]
    payload: PayloadArguments,
    /// Which parameters are to be estimated
    #[arg(long, default_value = "rigid+rotor+friction", value_parser = columns)]
    columns: Columns,
    /// Short for --columns rigid
    #[arg(long, conflicts_with = "columns")]
    no_friction: bool,
    /// Period, s
    #[arg(long, value_name = "S", default_value_t = 10.0)]
    period: f64,
    /// Family of trajectories
    #[arg(long, default_value = "fourier", value_parser = one_of(&Family::ALL, Family::name))]
    family: Family,
    /// Harmonics of all joints, or of each (splines: 2N+1 knots)
    #[arg(long, value_name = "N", default_value = "5", value_delimiter = ',')]
    harmonics: Vec<usize>,
    /// Joint that stays at this position, rad
    #[arg(long, value_name = "JOINT=RAD", value_delimiter = ',', value_parser = frozen_joint)]
    freeze: Vec<(String, f64)>,
    /// Seed of the first guesses
    #[arg(long, value_name = "K", default_value_t = 1)]
    seed: u64,
    /// Independent starts
    #[arg(long, value_name = "N", default_value_t = 8)]
    starts: u64,
    /// More starts: trajectories of the same family, period and joints
    #[arg(long, value_name = "T.toml", num_args = 1..)]
    from: Vec<String>,
    /// Evaluations of the criterion that each start may use
    #[arg(long, value_name = "N", default_value_t = DEFAULT_EVALUATIONS)]
    evaluations: usize,
    /// Steps of the optimiser that each start may take
    #[arg(long, value_name = "N")]
    iterations: Option<usize>,
    #[command(flatten)]
    limits: LimitArguments,
    #[command(flatten)]
    meshes: MeshArguments,
    /// Weight d-optimal by the noise that the drives state
    #[arg(long)]
    weighted: bool,
    /// Estimates of earlier experiments, whose information is added
    #[arg(long, value_name = "E.json", num_args = 1.., conflicts_with = "weighted")]
    prior: Vec<PathBuf>,
    /// Effects that model-error or measured-torque expects [default: usual ones]
    #[arg(long, value_name = "EFFECT[=MAGNITUDE]", value_delimiter = ',', value_parser = expected_effect)]
    expect: Vec<(EffectKind, f64)>,
    /// Motions to predict: slow, point-to-point, or trajectories [default: random]
    #[arg(long, value_name = "KIND|T.toml", num_args = 1..)]
    predict: Vec<String>,
    /// Recorded periods that model-error and measured-torque assume
    #[arg(long, value_name = "N", default_value_t = 10)]
    periods: usize,
    /// Skip the baseline: as many random trajectories as a start may evaluate
    #[arg(long)]
    no_baseline: bool,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let settings = arguments.settings()?;
    let loaded = arguments.robot.load()?;
    let destination = console.text_or(|| {
        let criterion = arguments.criterion.map_or(PAYLOAD, CriterionKind::name);
        let folder = format!("{}-{criterion}", loaded.robot.name());
        Ok(report_folder("name of the robot", &folder)?.join("trajectory.toml"))
    })?;
    let Some(answer) = design(&loaded, &settings, &Watch::new(console))? else { return Ok(Ending::Interrupted) };
    console.deliver(&destination, &answer.toml())?;
    let figures = destination.path().map_or(Ok(Vec::new()), |path| answer.draw(path))?;
    let separating = SeparatingExperiment::of(
        answer.problem.robot().uncertainty(),
        &arguments.robot.robot,
        answer.best.trajectory.period_s(),
    );
    let mut json = serde_json::to_value(&answer).map_err(Error::new)?;
    json["file"] = serde_json::json!(destination.path());
    json["figures"] = serde_json::json!(figures);
    json["separating_experiments"] = separating.iter().map(SeparatingExperiment::json).collect();
    let text = DesignText { answer: &answer, destination, figures, separating }.text(console.global.verbose);
    console.show(&Answer { text, json })?;
    Ok(match (answer.interrupted, answer.is_feasible()) {
        (true, _) => Ending::Interrupted,
        (false, true) => Ending::Done,
        (false, false) => Ending::Negative,
    })
}

/// What the folder of a design for a load is named after.
const PAYLOAD: &str = "payload";

impl Arguments {
    fn settings(&self) -> Result<DesignSettings, Error> {
        if self.starts == 0 && self.from.is_empty() {
            let message = "--starts is 0, expected at least 1, or a trajectory --from which to start";
            return Err(Error::new(message));
        }
        self.harmonics.iter().try_for_each(|&one| HARMONICS.check_count("--harmonics", one))?;
        if self.period.is_finite() {
            PERIOD_S.check("--period", self.period)?;
        }
        DESIGNS.check("--starts", self.starts as f64)?;
        let goal = match self.criterion {
            Some(kind) => {
                self.check_use(kind)?;
                DesignGoal::Arm(kind.into())
            }
            None => DesignGoal::Load(self.payload.heaviest()?),
        };
        Ok(DesignSettings {
            columns: if self.no_friction { Columns::RIGID } else { self.columns },
            period_s: self.period,
            family: self.family,
            harmonics: self.harmonics.clone(),
            frozen: self.freeze.clone(),
            seed: self.seed,
            starts: self.starts,
            from: self.from.clone(),
            evaluations: self.evaluations,
            iterations: self.iterations,
            limits: self.limits.settings(),
            max_acceleration: self.limits.max_acceleration,
            keep_above_m: self.limits.keep_above,
            packages: self.meshes.packages(),
            weighted: self.weighted,
            prior: self.prior.clone(),
            expected: self.expect.iter().fold(Effects::none(), |all, &(effect, size)| all.with_effect(effect, size)),
            predict: self.predict.clone(),
            periods: self.periods,
            baseline: !self.no_baseline,
            ..DesignSettings::new(goal)
        })
    }

    /// Options that only some criteria have a use for.
    fn check_use(&self, kind: CriterionKind) -> Result<(), Error> {
        let expects_effects = kind.criterion().expects_effects();
        for (is_refused, option, expected) in [
            (!self.expect.is_empty() && !expects_effects, "--expect", "model-error or measured-torque"),
            (
                !self.predict.is_empty() && !kind.criterion().asks_for_prediction(),
                "--predict",
                "i-optimal, model-error or measured-torque",
            ),
        ] {
            if is_refused {
                let message = format!("{option} with --criterion {}, expected {expected}", kind.name());
                return Err(Error::new(message).help("`armid design --help` says what each criterion asks for"));
            }
        }
        Ok(())
    }
}

/// `wrist_roll=0.0` as a joint's name and its position.
fn frozen_joint(text: &str) -> std::result::Result<(String, f64), String> {
    let parts = text.split_once('=').and_then(|(name, place)| Some((name.to_owned(), place.parse::<f64>().ok()?)));
    parts.filter(|(_, place)| place.is_finite()).ok_or_else(|| "expected JOINT=RAD, as wrist_roll=0.0".to_owned())
}

/// `elasticity` or `elasticity=3.0` as an effect and its magnitude.
fn expected_effect(text: &str) -> std::result::Result<(EffectKind, f64), String> {
    let (name, size) = text.split_once('=').map_or((text, None), |(name, size)| (name, Some(size)));
    let names = || Effects::EXPECTABLE.map(EffectKind::name).join(", ");
    let kind = EffectKind::parse(name).filter(|kind| Effects::EXPECTABLE.contains(kind));
    let kind = kind.ok_or_else(|| format!("expected one of {}", names()))?;
    let entry = kind.entry();
    let size = size.map_or(Some(entry.realistic), |size| size.parse().ok());
    let size = size.filter(|size| (f64::MIN_POSITIVE..=entry.most).contains(size));
    size.map(|size| (kind, size))
        .ok_or_else(|| format!("expected a magnitude above 0 and at most {} {}", entry.most, entry.unit))
}
