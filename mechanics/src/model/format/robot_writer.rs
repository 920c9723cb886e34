//! A `robot.toml` over a URDF, with every gap of the URDF marked.
//!
//! A gap is a line `# key = ?`: without the `#`, and with a value, it is a key of the file. What stands behind it says what
//! the number is used for.

use std::fmt::Write;

use super::tree::{ChainEnds, ImportedModel};
use crate::model::joint::{Joint, JointKind};
use crate::model::parameters::DriveParameters;
use crate::model::term::{COULOMB, OFFSET, ROTOR, Term, VISCOUS};
use crate::spatial::Inertia;

/// Column at which comments begin.
const COMMENT: usize = 36;

/// Velocity scale of Coulomb friction where the URDF states friction, rad/s (m/s).
const COULOMB_VELOCITY: &str = "0.01";

/// Torque terms that arms have and URDFs often lack, and what their nominal coefficients are used for.
const TERMS: [(Term, &str); 4] = [
    (ROTOR, "inertia of motor and gear, seen at the joint"),
    (VISCOUS, "friction that grows with speed; the URDF has no damping"),
    (COULOMB, "friction that does not; the URDF has no friction"),
    (OFFSET, "constant torque of drive or sensor"),
];

/// Begins a `robot.toml` over a URDF: `path` is that file's, relative to the robot file; `ends` are those it was read with.
///
/// Reading it gives the robot and the parameters of the URDF. What a simulation needs beside them is assumed, and marked: the
/// rate of the servo, and that friction of a joint is smooth about rest.
pub fn write_robot(model: &ImportedModel, path: &str, ends: &ChainEnds) -> String {
    let mut out = Lines::default();
    out.comment(
        "Kinematics, limits, inertias, damping and friction are those of the URDF. A line that begins with # and has a",
    );
    out.comment("question mark for its value is a gap: what the URDF does not say. Without the # and with a value it counts; left");
    out.comment("alone, nothing is assumed but what stands behind it.");
    for remark in &model.remarks {
        out.comment(&format!("remark: {remark}"));
    }
    if !model.locked.is_empty() {
        out.comment(&format!("held at zero, since they are off the chain: {}", model.locked.join(", ")));
    }
    out.blank();
    out.key("name", &quoted(model.robot.name()), "");
    out.key("urdf", &quoted(path), "relative to this file");
    for (key, end) in [("base_link", &ends.base), ("tip_link", &ends.tip)] {
        if let Some(end) = end {
            out.key(key, &quoted(end), "");
        }
    }
    out.key("effort", "\"torque\"", "what logs hold: \"torque\" (N m at the joint) or \"current\" (A), which");
    out.comment_at_column("needs gears and torque constants below");
    out.gap("drives", "\"harmonic\", \"planetary\", \"belt\", \"direct\" or \"servo\": effects that advice expects");
    out.gap("gravity_m_s2", "in the world; [0, 0, -9.81] is taken, the root of the URDF standing upright");
    out.blank();
    out.line("# [base]", "where the root stands, if not upright at the origin");
    out.gap("roll_pitch_yaw_deg", "a list: a wall or a ceiling changes the weight at every joint");
    out.blank();
    out.line("# [coupling]", "where a motor turns with more than its own joint (wrists with belts)");
    out.gap("motor_from_joint", "q_motor = C q, row by row; each motor for itself is taken");
    out.blank();
    out.line("[servo]", "of the simulated arm, assumed: without rotor inertias wrists are light,");
    out.key("rate_hz", "5000", "and at a lower rate a simulation can diverge");
    out.key("bandwidth_hz", "8", "");
    out.key("damping", "0.8", "");
    out.key("integral_hz", "0.5", "");
    out.key("friction", "true", "gains overcome the friction of the URDF, too");
    out.blank();
    out.line("# [floor]", "a design with a clearance keeps above it");
    out.gap("z_m", "in the base frame");
    for ((joint, link), drive) in model.robot.joints().iter().zip(&model.parameters.links).zip(&model.parameters.drives)
    {
        write_joint(&mut out, joint, link, drive);
    }
    out.text
}

fn write_joint(out: &mut Lines, joint: &Joint, link: &Inertia, drive: &DriveParameters) {
    let revolute = joint.kind == JointKind::Revolute;
    let by = |revolute_key, prismatic_key| if revolute { revolute_key } else { prismatic_key };
    out.blank();
    out.line("[[joint]]", "");
    out.key("name", &quoted(&joint.name), &said(joint));
    if link.mass <= 0.0 {
        out.comment("gap: its link has no <inertial> in the URDF; there is nothing to simulate, and nothing to");
        out.comment("choose by where torque does not decide");
    }
    out.line("[joint.limits]", "");
    let limits = &joint.limits;
    if limits.position.0.is_infinite() {
        out.gap(by("position_deg", "position_m"), "[low, high]: designs and the guard keep inside");
    }
    if limits.velocity.is_infinite() {
        out.gap(by("velocity_deg_s", "velocity_m_s"), "designs and the guard keep below");
    }
    out.gap(by("acceleration_rad_s2", "acceleration_m_s2"), "designs keep below; a design can have one for all joints");
    if limits.torque.is_infinite() {
        out.gap(by("torque_nm", "force_n"), "peak: designs keep below");
    }
    out.line("[joint.drive]", "");
    out.gap(by("gear", "gear_rad_m"), "motor turns per joint turn: logs of motors' angles, currents");
    out.gap("torque_constant_nm_a", "at the motor: logs of currents");
    out.gap("current_limit_a", "peak: designs keep below");
    out.gap(by("counts_per_revolution", "counts_per_m"), "of the encoder, at the joint: noise of a simulated arm");
    let scale = by("coulomb_velocity_rad_s", "coulomb_velocity_m_s");
    if drive[COULOMB] == 0.0 {
        out.gap(scale, "Coulomb friction is Fc tanh(velocity / this); a simulation needs it");
    } else {
        out.key(scale, COULOMB_VELOCITY, "assumed: friction of the URDF is Fc tanh(velocity / this),");
        out.comment_at_column("since no engine simulates a jump");
    }
    out.line("[joint.terms]", "nominal, before measuring: limits of a design, start of an export");
    for (term, use_of) in TERMS {
        if drive[term] == 0.0 {
            out.gap(term.entry().key.for_kind(joint.kind), use_of);
        }
    }
}

/// What the URDF says of a joint.
fn said(joint: &Joint) -> String {
    let revolute = joint.kind == JointKind::Revolute;
    let shown = |x: f64| {
        let rounded = (x * 100.0).round() / 100.0;
        format!("{rounded}")
    };
    let angle = |x: f64| shown(if revolute { x.to_degrees() } else { x });
    let (kind, unit, effort) = if revolute { ("revolute", "deg", "N m") } else { ("prismatic", "m", "N") };
    let limits = &joint.limits;
    let mut text = kind.to_owned();
    if limits.position.0.is_finite() {
        let _ = write!(text, ", {} to {} {unit}", angle(limits.position.0), angle(limits.position.1));
    }
    if limits.velocity.is_finite() {
        let _ = write!(text, ", {} {unit}/s", angle(limits.velocity));
    }
    if limits.torque.is_finite() {
        let _ = write!(text, ", {} {effort}", shown(limits.torque));
    }
    text
}

/// A text as TOML writes it.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// Lines of a file, comments in a column.
#[derive(Default)]
struct Lines {
    text: String,
}

impl Lines {
    fn comment(&mut self, text: &str) {
        // Names of a URDF may hold what no comment of a TOML can. Writing to a String cannot fail.
        let plain: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        let _ = writeln!(self.text, "# {plain}");
    }

    fn comment_at_column(&mut self, text: &str) {
        let _ = writeln!(self.text, "{:COMMENT$}# {text}", "");
    }

    fn blank(&mut self) {
        self.text.push('\n');
    }

    fn key(&mut self, key: &str, value: &str, meaning: &str) {
        self.line(&format!("{key} = {value}"), meaning);
    }

    fn gap(&mut self, key: &str, meaning: &str) {
        self.line(&format!("# {key} = ?"), meaning);
    }

    fn line(&mut self, begin: &str, meaning: &str) {
        let _ = if meaning.is_empty() {
            writeln!(self.text, "{begin}")
        } else {
            writeln!(self.text, "{begin:COMMENT$}# {meaning}")
        };
    }
}
