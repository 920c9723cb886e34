//! `armid robot`

use std::fmt::Write;
use std::path::Path;

use armid::model::format::{Geometry, parse_robot};
use armid::model::term::Term;
use armid::model::{
    Columns, DhConvention, Drive, EffortInterface, Joint, JointKind, Obstacle, Robot, Shape, Solid, bundled,
};
use armid::provenance::Provenance;
use armid_io::{Error, LoadedRobot, output, robot};
use miette::Result;
use serde_json::{Value, json};

use crate::answers::findings::paragraph;
use crate::arguments::ChainArguments;
use crate::terminal::{Answer, Console, Ending, Table, stated};

const AFTER_HELP: &str = "\
Examples:
  armid robot                                    the bundled robots
  armid robot crs-a460                           one of them
  armid robot arm.urdf --tip-link tool0 --json   a chain of a URDF, for a program
  armid robot arm.urdf -o robot.toml             begins a robot file, the gaps of the URDF marked
  armid robot crs-a460 -o robot.toml             a copy of a bundled one to begin from";

/// Show a robot, or list the bundled ones
///
/// Links, limits, drives, nominal parameters and where they come from. With -o NAME.toml a URDF becomes a robot
/// file.
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Arguments {
    /// A bundled name, a robot.toml, a .urdf or an MJCF .xml file
    robot: Option<String>,
    #[command(flatten)]
    chain: ChainArguments,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Ending> {
    if let (Some(name), Some(place)) = (&arguments.robot, console.output())
        && place.extension().is_some_and(|extension| extension == "toml")
    {
        return write(arguments, name, place, console);
    }
    let answer = match &arguments.robot {
        Some(name) => {
            let loaded = arguments.chain.load(name)?;
            let is_bare_urdf = loaded.urdf.as_ref().is_some_and(|urdf| urdf.text == loaded.text);
            let mut answer = describe(&loaded);
            let _ = write!(answer.text, "\n{}", next_commands(&arguments.chain.on_command_line(name), is_bare_urdf));
            answer
        }
        None => list(),
    };
    console.answer(&answer)?;
    Ok(Ending::Done)
}

/// Writes a robot file: over a URDF with its gaps marked, or a copy of a bundled one.
fn write(arguments: &Arguments, name: &str, place: &Path, console: &Console) -> Result<Ending> {
    let loaded = arguments.chain.load(name)?;
    if place.exists() {
        let message = format!("{} is there already, expected a new file: its gaps may be filled in", place.display());
        return Err(Error::new(message).help("-o chooses another name").into());
    }
    let text = match (&loaded.urdf, bundled().iter().find(|entry| entry.name == name)) {
        (_, Some(entry)) => entry.robot.to_owned(),
        (Some(urdf), None) if urdf.text == loaded.text => robot::begin(Path::new(name), &urdf.ends, place)?,
        _ => {
            let message = format!("{name} is no URDF, expected one or a bundled robot to begin a robot file from");
            return Err(Error::new(message).help("`armid robot` lists the bundled robots").into());
        }
    };
    output::write_text(place, &text)?;
    let gaps = text.matches(" = ?").count();
    let mut told = format!("{}\n", place.display());
    if gaps > 0 {
        let _ = writeln!(told, "{gaps} gaps of the URDF, each a line \"# key = ?\" that says what it is used for");
    }
    let file = place.display().to_string();
    console.show(&Answer { text: told, json: json!({ "file": file, "gaps": gaps }) })?;
    Ok(Ending::Done)
}

fn list() -> Answer {
    let robots: Vec<Robot> = bundled().iter().filter_map(|entry| parse_robot(entry.robot).ok()).collect();
    let mut table = Table::of("robot | #joints | kinds | effort | #parameters");
    for robot in &robots {
        let kinds: String =
            robot.joints().iter().map(|joint| if joint.kind == JointKind::Revolute { 'R' } else { 'P' }).collect();
        let parameters = Columns::RIGID_ROTOR_FRICTION.parameters(robot).len();
        let cells = [robot.name(), &robot.dof().to_string(), &kinds, robot.effort().name(), &parameters.to_string()];
        table.row(cells);
    }
    let json = robots
        .iter()
        .map(|robot| json!({ "name": robot.name(), "dof": robot.dof(), "effort": robot.effort().name() }))
        .collect();
    let text = format!("{}\nR revolute, P prismatic; `armid robot NAME` shows one.\n", table.render(0));
    Answer { text, json }
}

fn describe(loaded: &LoadedRobot) -> Answer {
    let robot = &loaded.robot;
    let provenance = Provenance::new(robot.name(), &loaded.text.content, None);
    let mut text = format!("{}: {} joints, from {}\n", robot.name(), robot.dof(), loaded.text.name);
    let gravity = robot.gravity();
    let _ = writeln!(
        text,
        "gravity in the base frame  ({}) m/s²",
        gravity.iter().map(|&g| stated(g)).collect::<Vec<_>>().join(", ")
    );
    let _ = writeln!(text, "effort                     {}", effort(robot.effort()));
    let _ = write!(text, "\nChain\n{}", chain(robot).render(2));
    let _ = write!(text, "\nLimits\n{}", limits(robot).render(2));
    if robot.joints().iter().any(|joint| states_a_drive(&joint.drive)) {
        let _ = write!(text, "\nDrives\n{}", drives(robot).render(2));
    } else {
        text.push_str("\nDrives: none stated, motor and joint are the same\n");
    }
    if let Some(coupling) = robot.coupling() {
        let _ = write!(text, "\nCoupling, motor coordinates from joint coordinates\n");
        for row in coupling.row_iter() {
            let cells: Vec<String> = row.iter().map(|&c| format!("{:>6}", stated(c))).collect();
            let _ = writeln!(text, "  {}", cells.join(" "));
        }
    }
    for (heading, parameters) in [("Nominal parameters", &loaded.nominal), ("Parameters of the file", &loaded.own)] {
        if let Some(parameters) = parameters {
            // Every torque term of which some joint has a coefficient, in the units of a revolute joint.
            let terms: Vec<Term> = Columns::RIGID.with_terms_of(parameters).terms().collect();
            let unit = |term: &Term| term.unit(JointKind::Revolute);
            let headings = terms.iter().map(|term| format!(" | #{} {}", term.entry().name, unit(term)));
            let headings: String = headings.collect();
            let mut table = Table::of(&format!("link | #m kg | centre of mass m{headings}"));
            for ((joint, link), drive) in robot.joints().iter().zip(&parameters.links).zip(&parameters.drives) {
                let com = if link.mass > 0.0 { link.first_moment / link.mass } else { link.first_moment };
                let com: Vec<String> = com.iter().map(|&c| format!("{c:>8.4}")).collect();
                let own = [joint.name.clone(), stated(link.mass), com.join("")];
                table.row(own.into_iter().chain(terms.iter().map(|&term| stated(drive[term]))));
            }
            let _ = write!(text, "\n{heading}\n{}", table.render(2));
        }
    }
    if !loaded.collisions.is_empty() {
        let shapes = loaded.collisions.iter().map(|shape| match &shape.geometry {
            Ok(Geometry::Mesh { file, .. }) => {
                let name = file.rsplit(['/', '\\']).next().unwrap_or(file);
                format!("{}: mesh {name}", shape.body)
            }
            Ok(geometry) => format!("{}: {}", shape.body, geometry.kind()),
            Err(fault) => format!("{} cannot be read: {fault}", shape.body),
        });
        let shapes: Vec<String> = shapes.collect();
        let _ = writeln!(text, "\nCollision shapes, which `armid design` holds clearances against");
        text += &paragraph(&shapes.join(", "), 2);
    }
    if !loaded.remarks.is_empty() {
        let mut remarks = Table::of("Remarks");
        for remark in &loaded.remarks {
            remarks.row([remark.as_str()]);
        }
        let _ = write!(text, "\n{}", remarks.render(0));
    }
    Answer { text, json: as_json(loaded, &provenance) }
}

const fn effort(interface: EffortInterface) -> &'static str {
    match interface {
        EffortInterface::Current => "motor current, A",
        EffortInterface::Torque => "effort at the joint, N·m or N",
    }
}

fn chain(robot: &Robot) -> Table {
    let mut table = Table::of("joint | kind | frame | #offset ° | #d m | #a m | #alpha °");
    for joint in robot.joints() {
        let (frame, row) = match &joint.dh {
            Some((DhConvention::Standard, row)) => ("standard DH", Some(row)),
            Some((DhConvention::Modified, row)) => ("modified DH", Some(row)),
            None => ("placed", None),
        };
        let cells =
            row.map_or([const { String::new() }; 4], |row| [row.offset_deg, row.d, row.a, row.alpha_deg].map(stated));
        let kind = match joint.kind {
            JointKind::Revolute => "revolute",
            JointKind::Prismatic => "prismatic",
        };
        table.row([joint.name.clone(), kind.to_owned(), frame.to_owned()].into_iter().chain(cells));
    }
    table
}

fn limits(robot: &Robot) -> Table {
    let mut table = Table::of("joint | #position |  | #velocity | #acceleration | #effort");
    for joint in robot.joints() {
        let (low, high) = joint.limits.position;
        let revolute = joint.kind == JointKind::Revolute;
        let angle = |value: f64| if revolute { value.to_degrees() } else { value };
        let unit = joint.kind.unit();
        table.row([
            joint.name.clone(),
            format!("{} … {}", stated(angle(low)), stated(angle(high))),
            if revolute { "°" } else { "m" }.to_owned(),
            format!("{} {unit}/s", stated(joint.limits.velocity)),
            format!("{} {unit}/s²", stated(joint.limits.acceleration)),
            format!("{} {}", stated(joint.limits.torque), joint.kind.effort_unit()),
        ]);
    }
    table
}

/// Whether the file says anything of a drive; torque at the joint needs none.
fn states_a_drive(drive: &Drive) -> bool {
    let ratios = [drive.gear, drive.torque_constant, drive.encoder_sign];
    ratios.iter().any(|&ratio| ratio != 1.0)
        || drive.current_limit.is_finite()
        || drive.counts_per_revolution > 0.0
        || drive.coulomb_velocity > 0.0
}

fn drives(robot: &Robot) -> Table {
    let mut table = Table::of(
        "joint | #gear | #Kt N·m/A | #limit A | #counts/turn | #sign | #noise A | #range A | #bits | #Coulomb rad/s",
    );
    for joint in robot.joints() {
        let drive = &joint.drive;
        table.row([
            joint.name.clone(),
            stated(drive.gear),
            stated(drive.torque_constant),
            stated(drive.current_limit),
            stated(drive.counts_per_revolution),
            stated(drive.encoder_sign),
            stated(drive.current_noise),
            stated(drive.adc_range),
            drive.adc_bits.to_string(),
            stated(drive.coulomb_velocity),
        ]);
    }
    table
}

fn solid_json(solid: &Solid) -> Value {
    match solid {
        Solid::Capsule(capsule) => json!({
            "from_m": capsule.from.as_slice(),
            "to_m": capsule.to.as_slice(),
            "radius_m": capsule.radius,
        }),
        Solid::Cuboid(cuboid) => json!({
            "centre_m": cuboid.placement.translation.as_slice(),
            "axes": cuboid.placement.rotation.column_iter().map(|axis| axis.as_slice().to_vec()).collect::<Vec<_>>(),
            "size_m": (2.0 * cuboid.half).as_slice(),
        }),
        Solid::Hull(hull) => json!({
            "points_m": hull.points.iter().map(|point| point.as_slice().to_vec()).collect::<Vec<_>>(),
            "margin_m": hull.margin,
        }),
    }
}

fn as_json(loaded: &LoadedRobot, provenance: &Provenance) -> Value {
    let robot = &loaded.robot;
    let shape = |shape: &Shape| {
        let mut value = solid_json(&shape.solid);
        value["link"] = json!(shape.link);
        value
    };
    let obstacle = |obstacle: &Obstacle| match obstacle {
        Obstacle::Floor { z } => json!({ "kind": "floor", "z_m": z }),
        Obstacle::Plane { name, normal, offset } => {
            json!({ "kind": "plane", "name": name, "normal": normal.as_slice(), "offset_m": offset })
        }
        Obstacle::Body { name, solid } => {
            let mut value = solid_json(solid);
            value["kind"] = json!("body");
            value["name"] = json!(name);
            value
        }
    };
    let parameters = |set: &Option<armid::model::StandardParameters>| {
        set.as_ref().map(|set| {
            let ids = Columns::RIGID_ROTOR_FRICTION.parameters(robot);
            ids.into_iter().map(|id| (id.to_string(), json!(set.get(id)))).collect::<serde_json::Map<_, _>>()
        })
    };
    json!({
        "name": robot.name(),
        "dof": robot.dof(),
        "source": loaded.text.name,
        "gravity_m_s2": robot.gravity().as_slice(),
        "effort": robot.effort().name(),
        "joints": robot.joints().iter().map(joint_json).collect::<Vec<_>>(),
        "coupling": robot.coupling().map(|c| c.row_iter().map(|row| row.iter().copied().collect()).collect::<Vec<Vec<f64>>>()),
        "shapes": robot.shapes().iter().map(shape).collect::<Value>(),
        "collision_shapes": loaded.collisions.iter().map(|shape| json!({
            "link": robot.link_name(shape.link),
            "body": shape.body,
            "kind": shape.geometry.as_ref().map_or("shape", Geometry::kind),
            "fault": shape.geometry.as_ref().err().map(ToString::to_string),
        })).collect::<Vec<_>>(),
        "obstacles": robot.obstacles().iter().map(obstacle).collect::<Value>(),
        "servo": robot.servo(),
        "nominal": parameters(&loaded.nominal),
        "parameters": parameters(&loaded.own),
        "remarks": loaded.remarks,
        "provenance": provenance,
    })
}

fn joint_json(joint: &Joint) -> Value {
    let finite = |value: f64| value.is_finite().then_some(value);
    json!({
        "name": joint.name,
        "kind": joint.kind,
        "unit": joint.kind.unit(),
        "effort_unit": joint.kind.effort_unit(),
        "dh": joint.dh.map(|(convention, row)| json!({
            "convention": convention,
            "offset_deg": row.offset_deg,
            "d_m": row.d,
            "a_m": row.a,
            "alpha_deg": row.alpha_deg,
        })),
        "limits": {
            "position": [finite(joint.limits.position.0), finite(joint.limits.position.1)],
            "velocity": finite(joint.limits.velocity),
            "acceleration": finite(joint.limits.acceleration),
            "jerk": finite(joint.limits.jerk),
            "effort": finite(joint.limits.torque),
            "continuous_effort": finite(joint.limits.continuous_torque),
        },
        "drive": {
            "gear": joint.drive.gear,
            "torque_constant_nm_a": joint.drive.torque_constant,
            "current_limit_a": finite(joint.drive.current_limit),
            "continuous_current_a": finite(joint.drive.continuous_current),
            "counts_per_revolution": joint.drive.counts_per_revolution,
            "encoder_sign": joint.drive.encoder_sign,
            "current_noise_a": joint.drive.current_noise,
            "adc_range_a": finite(joint.drive.adc_range),
            "adc_bits": joint.drive.adc_bits,
            "coulomb_velocity_rad_s": joint.drive.coulomb_velocity,
        },
    })
}

/// What comes after a look at a robot that is so called on a command line: a robot file over a bare URDF, else a motion, else its log.
fn next_commands(robot: &str, is_bare_urdf: bool) -> String {
    if is_bare_urdf {
        return format!("next: armid init {robot}\n");
    }
    format!(
        "next, without a log: armid advise {robot}\nwith a log:          armid identify LOG --robot {robot} -o E.json\n"
    )
}
