//! `armid agree`

use std::fmt::Write;
use std::path::{Path, PathBuf};

use armid::experiment::ExperimentPlan;
use armid::model::JointKind;
use armid::seed::Seed;
use armid::trajectory::PeriodicTrajectory;
use armid_io::output::pretty;
use armid_io::{Error, LoadedRobot, output, trajectory};
use armid_reports::{Axis, Figure, Group, Heading, Reference, ScatterFigure, ScatterGroup, ScatterPanel, ScatterPoint};
use armid_sim::agreement::{Absent, Agreement, Breach, Case, EngineAgreement, agree, safe_motion};
use armid_sim::{Engine, MujocoStatus};
use miette::Result;
use serde_json::{Value, json};

use crate::arguments::RobotArguments;
use crate::terminal::{Answer, Console, Ending, Table, number, report_folder, stated};

const AFTER_HELP: &str = "\
Free motion without friction is compared with the articulated-body algorithm at finer steps. In the closed \
loop each engine performs one period under the robot's servo, with friction and ideal sensors. Without \
--trajectory the A460 follows Table I of Radkhah et al. (2007).

Exit status 1: a tolerance is exceeded.

Examples:
  armid agree crs-a460
  armid agree puma-560 --json -o reports/puma-agreement
  armid agree arm.urdf --trajectory T.toml";

/// Measure how far the simulated arms agree, with their order of convergence
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    /// The motion of the closed loop: a trajectory file, or table-one
    #[arg(long, value_name = "T.toml")]
    trajectory: Option<String>,
    /// Seed of the random states
    #[arg(long, value_name = "K", default_value_t = 1)]
    seed: u64,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    // A library that somebody names has to be in the comparison.
    if let Some(fault) = MujocoStatus::named_but_unusable() {
        return Err(Error::new(fault).into());
    }
    let loaded = arguments.robot.load()?;
    let name = format!("{}-agreement", loaded.robot.name());
    let folder = console.output_or(|| report_folder("name of the robot", &name))?;
    let truth = loaded.truth()?.parameters;
    let nominal = loaded.nominal.clone().unwrap_or_else(|| truth.clone());
    let seed = Seed::new(arguments.seed);
    let motion = motion(arguments, &loaded, &nominal, seed)?;
    let plan = ExperimentPlan::new(motion).with_periods(1);
    plan.check(loaded.robot.dof()).map_err(Error::new)?;
    let case = Case { robot: &loaded.robot, nominal: &nominal, truth: &truth, plan: &plan, seed };
    let agreement = agree(&case, &Engine::ALL);
    if let (true, Some(first)) = (agreement.engines.is_empty(), agreement.absent.first().or(agreement.failed.first())) {
        return Err(Error::new(format!("{}: {}", first.engine.name(), first.reason)).into());
    }
    let breaches = agreement.breaches();
    let json = answer(&agreement, &breaches)?;
    let figure = figure(&agreement, &loaded);
    let svg = figure.svg().map_err(|fault| Error::new(format!("the figure cannot be drawn: {fault}")))?;
    let drawn = folder.join(format!("{}.svg", figure.name()));
    output::write_text(&folder.join("agreement.json"), &pretty(&json))?;
    output::write_text(&drawn, &svg)?;
    console.show(&Answer { text: text(&agreement, &breaches, &loaded, &drawn), json })?;
    Ok(if agreement.holds() { Ending::Done } else { Ending::Negative })
}

fn motion(
    arguments: &Arguments,
    loaded: &LoadedRobot,
    nominal: &armid::model::StandardParameters,
    seed: Seed,
) -> Result<PeriodicTrajectory> {
    let usual = (loaded.robot.name() == "crs-a460").then_some("table-one");
    match arguments.trajectory.as_deref().or(usual) {
        Some(name) => Ok(trajectory::load(name, None, &loaded.robot)?),
        None => safe_motion(&loaded.robot, nominal, seed)
            .map(PeriodicTrajectory::from)
            .map_err(|fault| Error::new(fault).into()),
    }
}

fn answer(agreement: &Agreement, breaches: &[Breach]) -> Result<Value> {
    let fault = |error: serde_json::Error| Error::new(format!("the certificate cannot be written: {error}"));
    let mut json = serde_json::to_value(agreement).map_err(fault)?;
    json["agrees"] = json!(agreement.holds());
    json["breaches"] = serde_json::to_value(breaches).map_err(fault)?;
    Ok(json)
}

fn text(agreement: &Agreement, breaches: &[Breach], loaded: &LoadedRobot, drawn: &Path) -> String {
    let mut text = format!(
        "{}: free motion over {} s, in which joints move {} rad (m) at most; steps of {} s unless another is named\n\n",
        agreement.robot,
        stated(agreement.horizon_s),
        stated(agreement.travel),
        stated(agreement.step_s),
    );
    let mut engines = Table::of("engine | #order | #error, rad (m) | #of the way | #energy | #torque residual");
    for own in &agreement.engines {
        let error = own.free * agreement.travel;
        let order = own.order.map_or_else(|| "–".to_owned(), |order| format!("{order:.3}"));
        let cells = [error, own.free, own.energy, own.equations].map(number);
        let [error, free, energy, equations] = cells;
        engines.row([own.engine.name().to_owned(), order, error, free, energy, equations]);
    }
    text.push_str(&engines.render(2));
    if !agreement.pairs.is_empty() {
        let mut pairs = Table::of("engines | #free motion | #closed loop | at joint");
        for pair in &agreement.pairs {
            let most = pair.largest();
            let joint = pair.closed_loop.iter().position(|&d| d == most);
            let place = joint.map_or_else(String::new, |joint| {
                let effort = pair.closed_loop_effort[joint];
                let unit = loaded.robot.joints()[joint].kind.effort_unit();
                format!("\"{}\", where efforts differ by {} {unit} at most", agreement.joints[joint], number(effort))
            });
            let (first, second) = pair.engines;
            pairs.row([format!("{} – {}", first.name(), second.name()), number(pair.free), number(most), place]);
        }
        let _ = write!(text, "\n  largest distance of a joint, rad (m)\n{}", pairs.render(2));
    }
    for (what, engines) in [("is absent", &agreement.absent), ("broke off", &agreement.failed)] {
        for Absent { engine, reason } in engines {
            let _ = write!(text, "\n  {} {what}: {reason}\n", engine.name());
        }
    }
    if agreement.holds() {
        text.push_str("\n  every tolerance is kept\n");
    }
    for Breach { engine, quantity, found, allowed: (low, high) } in breaches {
        let found = found.map_or_else(|| "not measurable".to_owned(), number);
        let _ = writeln!(
            text,
            "\n  {}: {quantity} is {found}, expected {} to {}",
            engine.name(),
            number(*low),
            number(*high)
        );
    }
    let _ = writeln!(text, "  {}", PathBuf::from(drawn).display());
    text
}

/// Error against step on logarithmic axes, with the slopes 1 and 4 of the methods.
fn figure(agreement: &Agreement, loaded: &LoadedRobot) -> ScatterFigure {
    let revolute = loaded.robot.joints().iter().all(|joint| joint.kind == JointKind::Revolute);
    let unit = if revolute { "rad" } else { "rad or m" };
    let names = agreement.engines.iter().map(|own| own.engine.name());
    let group = |(group, own): (Group, &EngineAgreement)| {
        let label = own.order.map_or(group.label.clone(), |order| format!("{}, order {order:.2}", group.label));
        // An error of zero cannot stand on a logarithmic axis.
        let points = own.errors.iter().filter(|point| point.error > 0.0);
        let points = points.map(|point| ScatterPoint::new(point.step_s, point.error)).collect();
        ScatterGroup { label, style: group.style, points }
    };
    let groups: Vec<ScatterGroup> = Group::assign(names).into_iter().zip(&agreement.engines).map(group).collect();
    let lines = agreement.engines.iter().filter_map(|own| {
        let (order, first) = (own.order?.round(), own.errors.first()?);
        let floor = agreement.reference_error.max(f64::EPSILON);
        let last = own.errors.iter().rev().find(|point| point.error > 10.0 * floor)?;
        let slope = (last.step_s / first.step_s).powf(order);
        let from = (first.step_s, last.error / slope);
        Some(Reference::Segment { from, to: (last.step_s, last.error), label: format!("slope {order}") })
    });
    ScatterFigure {
        heading: Heading::new("convergence", "The engines converge to one motion, each with its own order")
            .subtitle(format!(
                "{}: free motion over {} s from random states, no friction{}",
                agreement.robot,
                stated(agreement.horizon_s),
                hidden(agreement)
            ))
            .caption(
                "Points: largest distance of a joint from a reference by articulated bodies and fine steps. Lines: \
                 the slope that belongs to the order of each method, through its finest error above rounding.",
            ),
        columns: 1,
        panels: vec![ScatterPanel {
            title: String::new(),
            x: Axis::log("step", "s"),
            y: Axis::log("largest error of a joint", unit),
            references: lines.collect(),
            groups,
        }],
    }
}

/// Which engines' points are hidden by those of another, for the caption.
fn hidden(agreement: &Agreement) -> String {
    let near = |a: &EngineAgreement, b: &EngineAgreement| {
        a.errors.iter().zip(&b.errors).all(|(a, b)| (a.error - b.error).abs() <= 0.2 * b.error)
    };
    let mut text = String::new();
    for (i, first) in agreement.engines.iter().enumerate() {
        for second in agreement.engines[i + 1..].iter().filter(|second| near(first, second)) {
            let _ = write!(text, "; {} lies on {}", second.engine.name(), first.engine.name());
        }
    }
    text
}
