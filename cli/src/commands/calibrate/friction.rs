//! `armid calibrate friction`

use armid::calibration::{Friction, FrictionPoint, friction};
use armid_io::Error;
use armid_reports::{Axis, Heading, Reference, ScatterFigure, ScatterPoint};
use miette::Result;
use serde_json::json;

use super::bench::{Bench, BenchArguments, values};
use crate::terminal::{Answer, Console, Ending};

const AFTER_HELP: &str = "\
Moving there and back over the same positions cancels gravity in half the difference of the torques. What \
remains is friction: Fc + Fv v. A slowest speed above that line shows Stribeck friction. Recordings of \
`torque-constant` can be used.";

/// Measure a joint's friction at constant speeds
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(super) struct Arguments {
    #[command(flatten)]
    bench: BenchArguments,
}

pub(super) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let mut bench = arguments.bench.prepare("friction", false, console)?;
    let Some(recording) = &bench.recording else {
        console.show(&Answer { text: bench.list(), json: json!({ "written": bench.written }) })?;
        return Ok(Ending::Done);
    };
    let found = friction(recording, &bench.loaded.robot, bench.joint).map_err(Error::new)?;
    let kind = bench.loaded.robot.joints()[bench.joint].kind;
    let json = json!({
        "robot": bench.loaded.robot.name(),
        "joint": bench.joint_name(),
        "viscous": found.viscous,
        "coulomb": found.coulomb,
        "stribeck": found.stribeck,
        "residual_rms": found.residual_rms,
        "points": found.points,
        "effort_unit": kind.effort_unit(),
        "speed_unit": format!("{}/s", kind.unit()),
    });
    bench.write(&json, &figure(&found, &bench))?;
    console.show(&Answer { text: format!("{}\n{}", text(&found, &bench), bench.list()), json })?;
    Ok(Ending::Done)
}

/// Does friction fall as the joint starts to move?
fn falls(found: &Friction) -> bool {
    found.stribeck.is_some_and(|excess| excess.ci95[0] > 0.0)
}

fn text(found: &Friction, bench: &Bench) -> String {
    let kind = bench.loaded.robot.joints()[bench.joint].kind;
    let effort = kind.effort_unit();
    let table = values(&[
        ("viscous Fv", Some(found.viscous), 4, &format!("{effort}·s/{}", kind.unit())),
        ("Coulomb Fc", Some(found.coulomb), 4, effort),
        ("above the line at the slowest speed", found.stribeck, 4, effort),
    ]);
    let word = if falls(found) {
        "\nfriction falls as the joint starts to move: leave slow samples out, or estimate a Stribeck term\n"
    } else {
        ""
    };
    format!(
        "{} \"{}\": friction at {} speeds there and back\n\n{}{word}",
        bench.loaded.robot.name(),
        bench.joint_name(),
        found.points.len(),
        table.render(2)
    )
}

fn figure(found: &Friction, bench: &Bench) -> ScatterFigure {
    let kind = bench.loaded.robot.joints()[bench.joint].kind;
    let fastest = found.points.last().map_or(0.0, |point| point.speed);
    let at = |speed: f64| (speed, found.coulomb.value + found.viscous.value * speed);
    let points = found
        .points
        .iter()
        .map(|p| ScatterPoint::new(p.speed, p.friction.value).interval(p.friction.ci95[0], p.friction.ci95[1]));
    let on_line =
        |point: &&FrictionPoint| (point.friction.ci95[0]..=point.friction.ci95[1]).contains(&at(point.speed).1);
    let title = format!(
        "The line of Coulomb and viscous friction meets {} of {} intervals",
        found.points.iter().filter(on_line).count(),
        found.points.len()
    );
    let heading = Heading::new("friction", title)
        .caption("Points: half the difference of the efforts there and back over the same positions, with 95 % intervals. Line: Fc + Fv v.");
    let line = Reference::Segment {
        from: at(0.0),
        to: at(fastest),
        label: format!("{:.3} + {:.3} v", found.coulomb.value, found.viscous.value),
    };
    bench.figure(
        heading,
        [
            Axis::linear("speed of the joint", format!("{}/s", kind.unit())).including(&[0.0]),
            Axis::linear("friction", kind.effort_unit()),
        ],
        ("speeds", points.collect()),
        line,
    )
}
