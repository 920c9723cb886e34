//! A robot's links and rotors as MJCF, MuJoCo's own format.
//!
//! Body i is link i with its frame as in `robot.toml`, so that inertias are written as they are, about the centre of
//! mass in the order `xx yy zz xy xz yz`; the joint's axis and anchor are what is expressed in it. A rotor is armature
//! of its joint. A coupled rotor turns with several joints, `q_motor = Σ_j c_j q_j`, and adds `Ia c cᵀ` to the mass
//! matrix: a fixed tendon of that length with armature `Ia` does exactly that.
//!
//! MuJoCo can correct a physically inconsistent inertia (`balanceinertia`); here it is refused, since a
//! corrected one is another robot. Friction is not written: the plant applies it.

use armid::model::term::{COULOMB, ROTOR, VISCOUS};
use std::fmt::Write;

use armid::model::{DriveParameters, Joint, JointKind, Robot, StandardParameters};
use armid::spatial::{Inertia, Placement};
use nalgebra::Vector3;

use super::MujocoError;

/// The least mass and principal moment, kg and kg·m², that MuJoCo takes (`mjMINVAL`).
const LEAST: f64 = 1e-15;

/// Links, joints and rotors of a robot, with these parameters, as MJCF.
///
/// ```
/// # let (robot, parameters) = armid::conformance::chains::random_robot(&mut armid::seed::Seed::new(1).stream("doc", 0), 3);
/// let text = armid_sim::mjcf(&robot, &parameters).unwrap();
/// assert_eq!(text.matches("<joint ").count(), 3);
/// assert!(text.contains("fullinertia=") && !text.contains("balanceinertia=\"true\""));
/// ```
///
/// # Errors
/// [`MujocoError`] where the parameters are not the robot's, or MuJoCo would refuse them: a number that is not finite,
/// a mass, principal moment or rotor that is not positive, principal moments `A + B < C`.
pub fn mjcf(robot: &Robot, parameters: &StandardParameters) -> Result<String, MujocoError> {
    write(robot, parameters, None)
}

/// The model for other users of MuJoCo: with friction, limits and MuJoCo's usual flags, and `header` as a comment on top.
///
/// Offsets of the torque, other laws of friction, and friction of coupled motors have no place in MJCF: they are left out.
///
/// # Errors
/// As [`mjcf`].
pub fn mjcf_for_exchange(robot: &Robot, parameters: &StandardParameters, header: &str) -> Result<String, MujocoError> {
    write(robot, parameters, Some(header))
}

/// `header` where the file is for others.
fn write(robot: &Robot, parameters: &StandardParameters, header: Option<&str>) -> Result<String, MujocoError> {
    let n = robot.dof();
    let found = parameters.links.len().min(parameters.drives.len());
    if found != n || parameters.links.len() != parameters.drives.len() {
        return Err(MujocoError::Parameters { found, expected: n });
    }
    for (index, (joint, link)) in robot.joints().iter().zip(&parameters.links).enumerate() {
        check_link(index + 1, joint, link)?;
    }
    let mut text = String::new();
    if let Some(header) = header {
        write_comment(&mut text, header);
    }
    write_head(&mut text, robot, header.is_some());
    text += "  <worldbody>\n";
    open_body(&mut text, 2, "base", robot.base());
    for (index, (joint, link)) in robot.joints().iter().zip(&parameters.links).enumerate() {
        open_body(&mut text, 3 + index, &format!("link{}", index + 1), &joint.before.compose(&joint.after));
        let rotor = rotor_of_joint(robot, parameters, index)?;
        let more = header.map_or_else(String::new, |_| friction_and_limits(joint, &parameters.drives[index]));
        write_link(&mut text, 4 + index, joint, link, rotor, &more);
    }
    for depth in (2..n + 3).rev() {
        line(&mut text, depth, "</body>");
    }
    text += "  </worldbody>\n";
    write_coupled_rotors(&mut text, robot, parameters);
    text += "</mujoco>\n";
    Ok(text)
}

fn line(text: &mut String, depth: usize, content: &str) {
    for _ in 0..depth {
        text.push_str("  ");
    }
    text.push_str(content);
    text.push('\n');
}

/// Numbers that read back as the same bits; no minus before a zero.
fn numbers(values: &[f64]) -> String {
    let mut out = String::new();
    for value in values {
        let gap = if out.is_empty() { "" } else { " " };
        write!(out, "{gap}{:?}", value + 0.0).expect("a string takes all that is written");
    }
    out
}

fn escaped(name: &str) -> String {
    name.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

/// What the file is.
fn write_comment(text: &mut String, header: &str) {
    line(text, 0, "<!--");
    for words in header.lines() {
        line(text, 1, &words.replace("--", "- -"));
    }
    line(text, 0, "-->");
}

/// Attributes of a joint that another user of the file expects.
fn friction_and_limits(joint: &Joint, drive: &DriveParameters) -> String {
    let mut more =
        format!(" damping=\"{}\" frictionloss=\"{}\"", numbers(&[drive[VISCOUS]]), numbers(&[drive[COULOMB]]));
    let (low, high) = joint.limits.position;
    if low.is_finite() && high.is_finite() {
        more += &format!(" limited=\"true\" range=\"{}\"", numbers(&[low, high]));
    }
    if joint.limits.torque.is_finite() {
        let torque = joint.limits.torque;
        more += &format!(" actuatorfrclimited=\"true\" actuatorfrcrange=\"{}\"", numbers(&[-torque, torque]));
    }
    more
}

fn write_head(text: &mut String, robot: &Robot, for_others: bool) {
    let gravity = robot.base().rotation * robot.gravity();
    line(text, 0, &format!("<mujoco model=\"{}\">", escaped(robot.name())));
    let exact = "inertiafromgeom=\"false\" balanceinertia=\"false\" boundmass=\"0\" boundinertia=\"0\"";
    line(text, 1, &format!("<compiler angle=\"radian\" autolimits=\"false\" {exact}/>"));
    let gravity = numbers(gravity.as_slice());
    if for_others {
        line(text, 1, &format!("<option timestep=\"0.001\" gravity=\"{gravity}\"/>"));
        return;
    }
    line(text, 1, &format!("<option timestep=\"0.001\" integrator=\"RK4\" gravity=\"{gravity}\">"));
    // A state that is no longer a number must be seen, not be put back to zero.
    line(text, 2, "<flag contact=\"disable\" constraint=\"disable\" autoreset=\"disable\"/>");
    line(text, 1, "</option>");
}

fn open_body(text: &mut String, depth: usize, name: &str, placement: &Placement) {
    let r = &placement.rotation;
    let axes = numbers(&[r[(0, 0)], r[(1, 0)], r[(2, 0)], r[(0, 1)], r[(1, 1)], r[(2, 1)]]);
    let position = numbers(placement.translation.as_slice());
    line(text, depth, &format!("<body name=\"{name}\" pos=\"{position}\" xyaxes=\"{axes}\">"));
}

fn write_link(text: &mut String, depth: usize, joint: &Joint, link: &Inertia, rotor: f64, more: &str) {
    let c = link.com().unwrap_or_else(Vector3::zeros);
    let i = link.about_com();
    let six = [i[(0, 0)], i[(1, 1)], i[(2, 2)], i[(0, 1)], i[(0, 2)], i[(1, 2)]];
    let (position, mass, inertia) = (numbers(c.as_slice()), numbers(&[link.mass]), numbers(&six));
    line(text, depth, &format!("<inertial pos=\"{position}\" mass=\"{mass}\" fullinertia=\"{inertia}\"/>"));
    // The joint as its link sees it.
    let seen = joint.after.inverse();
    let kind = match joint.kind {
        JointKind::Revolute => "hinge",
        JointKind::Prismatic => "slide",
    };
    let (anchor, axis) = (numbers(seen.translation.as_slice()), numbers(seen.rotation.column(2).as_slice()));
    let (name, armature) = (escaped(&joint.name), numbers(&[rotor]));
    let place = format!("pos=\"{anchor}\" axis=\"{axis}\"");
    line(text, depth, &format!("<joint name=\"{name}\" type=\"{kind}\" {place} armature=\"{armature}\"{more}/>"));
}

/// What the rotor of motor `index` adds to its own joint alone; 0 where a tendon carries it.
fn rotor_of_joint(robot: &Robot, parameters: &StandardParameters, index: usize) -> Result<f64, MujocoError> {
    let rotor = parameters.drives[index][ROTOR];
    let joint = || robot.joints()[index].name.clone();
    if !rotor.is_finite() {
        return Err(MujocoError::NotFinite { joint: joint(), quantity: "inertia of its rotor", value: rotor });
    }
    if rotor < 0.0 {
        return Err(MujocoError::Rotor { joint: joint(), rotor });
    }
    let own = robot.coupling().map_or(1.0, |c| c[(index, index)]);
    Ok(if robot.is_coupled(index) { 0.0 } else { rotor * own * own })
}

fn write_coupled_rotors(text: &mut String, robot: &Robot, parameters: &StandardParameters) {
    let Some(coupling) = robot.coupling() else { return };
    let coupled: Vec<usize> =
        (0..robot.dof()).filter(|&i| robot.is_coupled(i) && parameters.drives[i][ROTOR] > 0.0).collect();
    if coupled.is_empty() {
        return;
    }
    line(text, 1, "<tendon>");
    for motor in coupled {
        let armature = numbers(&[parameters.drives[motor][ROTOR]]);
        line(text, 2, &format!("<fixed name=\"motor{}\" armature=\"{armature}\">", motor + 1));
        for (joint, coefficient) in robot.joints().iter().zip(&coupling.row(motor)) {
            if *coefficient != 0.0 {
                let (name, coefficient) = (escaped(&joint.name), numbers(&[*coefficient]));
                line(text, 3, &format!("<joint joint=\"{name}\" coef=\"{coefficient}\"/>"));
            }
        }
        line(text, 2, "</fixed>");
    }
    line(text, 1, "</tendon>");
}

/// Whether MuJoCo takes the inertia of a link.
fn check_link(number: usize, joint: &Joint, link: &Inertia) -> Result<(), MujocoError> {
    let name = || joint.name.clone();
    if let Some(value) = link.to_array().into_iter().find(|value| !value.is_finite()) {
        return Err(MujocoError::NotFinite { joint: name(), quantity: "a parameter of its link", value });
    }
    if link.mass < LEAST {
        return Err(MujocoError::Mass { link: number, joint: name(), mass: link.mass });
    }
    let mut moments = nalgebra::SymmetricEigen::new(link.about_com()).eigenvalues;
    moments.as_mut_slice().sort_by(f64::total_cmp);
    let (a, b, c) = (moments[0], moments[1], moments[2]);
    if a < LEAST {
        return Err(MujocoError::PrincipalMoment { link: number, joint: name(), eigenvalue: a });
    }
    if a + b < c {
        return Err(MujocoError::Triangle { link: number, joint: name(), eigenvalue: c, sum: a + b });
    }
    Ok(())
}
