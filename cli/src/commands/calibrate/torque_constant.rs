//! `armid calibrate torque-constant`

use armid::calibration::{BackEmf, CalibrationError, Resistance, back_emf};
use armid_io::Error;
use armid_reports::{Axis, Heading, Reference, ScatterFigure, ScatterPoint};
use miette::Result;
use serde_json::json;

use super::bench::{Bench, BenchArguments, values};
use crate::terminal::{Answer, Console, Ending};

const AFTER_HELP: &str = "\
The back-EMF (motor voltage minus the drops at resistance, inductance and brushes) is proportional to shaft \
speed with slope Ke = Kt (Corke 1996). The resistance is estimated too if the current varies independently \
of the speed; --resistance-ohm states it.

Without a measured motor voltage use a known payload: `armid calibrate payload`.";

/// Measure a torque constant by the motor's back-EMF
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(super) struct Arguments {
    #[command(flatten)]
    bench: BenchArguments,
    /// Resistance of armature and leads, Ω, where it is known; estimated otherwise
    #[arg(long, value_name = "OHM")]
    resistance_ohm: Option<f64>,
}

pub(super) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    let mut bench = arguments.bench.prepare("torque-constant", true, console)?;
    let Some(recording) = &bench.recording else {
        console.show(&Answer { text: bench.list(), json: json!({ "written": bench.written }) })?;
        return Ok(Ending::Done);
    };
    let resistance = match arguments.resistance_ohm {
        None => Resistance::Estimated,
        Some(ohm) if ohm.is_finite() && ohm > 0.0 => Resistance::Known(ohm),
        Some(ohm) => return Err(Error::new(format!("--resistance-ohm is {ohm}, expected a number above zero")).into()),
    };
    let found = back_emf(recording, &bench.loaded.robot, bench.joint, resistance).map_err(|error| {
        let shown = Error::new(&error);
        match error {
            CalibrationError::NoVoltage => shown.help(
                "the known-payload route: `armid calibrate payload ROBOT --mass-kg M --centre-m X,Y,Z \
                 --unloaded A.mcap --loaded B.mcap`",
            ),
            _ => shown,
        }
    })?;
    let assumed = bench.loaded.robot.joints()[bench.joint].drive.torque_constant;
    let entry = entry(bench.joint_name(), &found);
    let json = json!({
        "robot": bench.loaded.robot.name(),
        "joint": bench.joint_name(),
        "torque_constant_nm_a": found.torque_constant,
        "assumed_nm_a": assumed,
        "resistance_ohm": found.resistance,
        "inductance_h": found.inductance,
        "brush_drop_v": found.brush_drop,
        "residual_rms_v": found.residual_rms,
        "condition": found.condition_scaled,
        "windows": found.points.len(),
        "periods": found.periods,
        "entry": entry,
    });
    bench.write(&json, &figure(&found, &bench))?;
    let text = format!("{}\nentry for robot.toml\n{entry}\n{}", text(&found, &bench, assumed), bench.list());
    console.show(&Answer { text, json })?;
    Ok(Ending::Done)
}

/// What to paste under the joint's `[joint.drive]`.
fn entry(joint: &str, found: &BackEmf) -> String {
    let half = 0.5 * (found.torque_constant.ci95[1] - found.torque_constant.ci95[0]);
    let mut text = format!(
        "torque_constant_nm_a = {:.6}   # {joint}: by back-EMF, ± {half:.6} (95 %)\n",
        found.torque_constant.value
    );
    if let Some(resistance) = &found.resistance {
        text.push_str(&format!("resistance_ohm = {:.4}\n", resistance.value));
    }
    text.push_str(&format!("brush_drop_v = {:.3}\n", found.brush_drop.value.max(0.0)));
    text
}

fn text(found: &BackEmf, bench: &Bench, assumed: f64) -> String {
    let table = values(&[
        ("torque constant", Some(found.torque_constant), 6, "N·m/A"),
        ("resistance", found.resistance, 4, "Ω"),
        ("inductance", Some(found.inductance.scaled(1e3)), 3, "mH"),
        ("brush drop", Some(found.brush_drop), 4, "V"),
    ]);
    format!(
        "{} \"{}\": back-EMF in {} windows of 50 ms, mean of {} periods; robot file: {assumed} N·m/A\n\n{}",
        bench.loaded.robot.name(),
        bench.joint_name(),
        found.points.len(),
        found.periods,
        table.render(2)
    )
}

fn figure(found: &BackEmf, bench: &Bench) -> ScatterFigure {
    let fastest = found.points.iter().fold(0.0_f64, |most, point| most.max(point.speed.abs()));
    let constant = found.torque_constant;
    let end = |side: f64| (side * fastest, side * fastest * constant.value);
    let points = found.points.iter().map(|point| ScatterPoint::new(point.speed, point.voltage));
    let title = format!(
        "By its back-EMF the torque constant is {:.4} ± {:.4} N·m/A",
        constant.value,
        constant.ci95[1] - constant.value
    );
    let heading = Heading::new("back-emf", title)
        .caption("Points: windows of 50 ms; terminal voltage less the shares of resistance, inductance and brushes. Line: the estimate.");
    let line = Reference::Segment {
        from: end(-1.0),
        to: end(1.0),
        label: format!("Kt = {:.5} ± {:.5} N·m/A", constant.value, constant.ci95[1] - constant.value),
    };
    bench.figure(
        heading,
        [Axis::linear("speed of the motor", "rad/s"), Axis::linear("back-EMF", "V")],
        ("windows", points.collect()),
        line,
    )
}
