//! A robot and its parameters as URDF, the robot description of ROS.
//!
//! ```text
//! robot.toml:  T = before · Rz(q) · after        URDF:  origin = after_(i−1) · before_i,  axis z,  link frame = before · Rz(q)
//! ```
//! URDF's link frame stands on its joint, so inertias are written as seen from there; a last link without inertia,
//! `flange`, stands where the chain ends. URDF has viscous and Coulomb friction, but no rotor inertia and no torque
//! offset: those are left out.

use crate::model::term::{COULOMB, VISCOUS};
use std::fmt::Write;

use nalgebra::{Matrix3, Vector3};

use super::tree::moved;
use crate::model::capsule::Capsule;
use crate::model::joint::{Joint, JointKind};
use crate::model::parameters::StandardParameters;
use crate::model::robot::Robot;
use crate::model::shape::{Cuboid, Solid};
use crate::spatial::{Inertia, Placement};

/// What is written for a limit that is not stated: URDF asks for a number.
const NO_LIMIT: f64 = 1e9;
/// Radius of the rods that stand for links of unknown shape, m.
const ROD: f64 = 0.02;

/// Writes a robot with these parameters as URDF that [`parse_urdf`](super::parse_urdf) reads, and other tools too.
/// `header` stands on top as a comment.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::model::format::{ChainEnds, parse_robot, parse_nominal, parse_urdf, write_urdf};
/// use armid::model::bundled;
/// let robot = parse_robot(bundled()[0].robot).unwrap();
/// let nominal = parse_nominal(bundled()[0].nominal, &robot).unwrap().parameters;
/// let text = write_urdf(&robot, &nominal, "a guess");
/// assert_eq!(parse_urdf(&text, &ChainEnds::default()).unwrap().robot.dof(), 6);
/// ```
pub fn write_urdf(robot: &Robot, parameters: &StandardParameters, header: &str) -> String {
    written(robot, parameters, header, &|_, _| String::new())
}

/// Writes a URDF for viewers, which show the bodies of collision checks, or a rod from joint to joint if there are none.
pub fn write_urdf_to_view(robot: &Robot, parameters: &StandardParameters, header: &str) -> String {
    let joints = robot.joints();
    written(robot, parameters, header, &|link, frame| {
        let bodies = robot.shapes().iter().filter(|shape| shape.link == link);
        let mut drawn: String = bodies.map(|shape| visual(&shape.solid, frame)).collect();
        if robot.shapes().is_empty() {
            let end = joints.get(link).map_or(frame.translation, |next| frame.compose(&next.before).translation);
            drawn += &rod(&Capsule { from: Vector3::zeros(), to: end, radius: ROD }, &Placement::identity());
        }
        drawn
    })
}

/// What a link looks like, by its number and by the pose of its frame in that of the URDF.
type Visuals<'a> = dyn Fn(usize, &Placement) -> String + 'a;

fn written(robot: &Robot, parameters: &StandardParameters, header: &str, visuals: &Visuals<'_>) -> String {
    let mut out = "<?xml version=\"1.0\"?>\n<!--\n".to_owned();
    // Writing to a String cannot fail.
    for line in header.lines() {
        let _ = writeln!(out, "  {}", commented(line));
    }
    let seen = visuals(0, robot.base());
    let base = if seen.is_empty() {
        "<link name=\"base\"/>".to_owned()
    } else {
        format!("<link name=\"base\">\n{seen}  </link>")
    };
    let _ = write!(out, "-->\n<robot name=\"{}\">\n  {base}\n", escaped(robot.name()));
    let (mut parent, mut end) = ("base".to_owned(), *robot.base());
    for (index, joint) in robot.joints().iter().enumerate() {
        let name = format!("link{}", index + 1);
        write_joint(&mut out, joint, &parent, &name, &end.compose(&joint.before), parameters, index);
        let seen = visuals(index + 1, &joint.after);
        write_link(&mut out, &name, &moved(&parameters.links[index], &joint.after), &seen);
        (parent, end) = (name, joint.after);
    }
    let _ = write!(
        out,
        "  <joint name=\"flange\" type=\"fixed\">\n    <parent link=\"{parent}\"/>\n    <child link=\"flange\"/>\n    {}\n  \
         </joint>\n  <link name=\"flange\"/>\n</robot>\n",
        origin(&end)
    );
    out
}

fn write_joint(
    out: &mut String,
    joint: &Joint,
    parent: &str,
    child: &str,
    place: &Placement,
    parameters: &StandardParameters,
    index: usize,
) {
    let limits = &joint.limits;
    let (low, high) = limits.position;
    let is_limited = low.is_finite() && high.is_finite();
    let kind = match (joint.kind, is_limited) {
        (JointKind::Prismatic, _) => "prismatic",
        (JointKind::Revolute, true) => "revolute",
        (JointKind::Revolute, false) => "continuous",
    };
    let ends = match (is_limited, joint.kind) {
        (true, _) => format!("lower=\"{low:?}\" upper=\"{high:?}\" "),
        (false, JointKind::Prismatic) => format!("lower=\"{:?}\" upper=\"{NO_LIMIT:?}\" ", -NO_LIMIT),
        (false, JointKind::Revolute) => String::new(),
    };
    let stated = |limit: f64| if limit.is_finite() { limit } else { NO_LIMIT };
    let drive = &parameters.drives[index];
    let _ = write!(
        out,
        "  <joint name=\"{}\" type=\"{kind}\">\n    <parent link=\"{parent}\"/>\n    <child link=\"{child}\"/>\n    {}\n    \
         <axis xyz=\"0 0 1\"/>\n    <limit {ends}effort=\"{:?}\" velocity=\"{:?}\"/>\n    \
         <dynamics damping=\"{:?}\" friction=\"{:?}\"/>\n  </joint>\n",
        escaped(&joint.name),
        origin(place),
        stated(limits.torque),
        stated(limits.velocity),
        drive[VISCOUS],
        drive[COULOMB]
    );
}

fn write_link(out: &mut String, name: &str, link: &Inertia, visuals: &str) {
    let [x, y, z]: [f64; 3] = link.com().unwrap_or_default().into();
    let (mass, i) = (link.mass, link.about_com());
    let [xx, xy, xz, yy, yz, zz] = [i.m11, i.m12, i.m13, i.m22, i.m23, i.m33];
    let _ = write!(
        out,
        "  <link name=\"{name}\">\n    <inertial>\n      <origin xyz=\"{x:?} {y:?} {z:?}\" rpy=\"0 0 0\"/>\n      \
         <mass value=\"{mass:?}\"/>\n      <inertia ixx=\"{xx:?}\" ixy=\"{xy:?}\" ixz=\"{xz:?}\" iyy=\"{yy:?}\" \
         iyz=\"{yz:?}\" izz=\"{zz:?}\"/>\n    </inertial>\n{visuals}  </link>\n"
    );
}

/// A body as it is seen, in a frame in which that of its link has this pose.
fn visual(solid: &Solid, frame: &Placement) -> String {
    match solid {
        Solid::Cuboid(Cuboid { placement, half }) => {
            let size = 2.0 * half;
            let geometry = format!("<box size=\"{:?} {:?} {:?}\"/>", size.x, size.y, size.z);
            shown(&frame.compose(placement), &geometry)
        }
        Solid::Capsule(_) | Solid::Hull(_) => rod(&solid.enclosing_capsule(), frame),
    }
}

/// A cylinder between two balls.
fn rod(&Capsule { from, to, radius }: &Capsule, frame: &Placement) -> String {
    let ball = |at: Vector3<f64>| {
        shown(
            &frame.compose(&Placement { rotation: Matrix3::identity(), translation: at }),
            &format!("<sphere radius=\"{radius:?}\"/>"),
        )
    };
    let along = to - from;
    let length = along.norm();
    if length == 0.0 {
        return ball(from);
    }
    // A frame whose z axis is that of the cylinder; x is across the coordinate axis that is least along it.
    let z = along / length;
    let x = Vector3::ith(z.iamin(), 1.0).cross(&z).normalize();
    let rotation = Matrix3::from_columns(&[x, z.cross(&x), z]);
    let middle = Placement { rotation, translation: 0.5 * (from + to) };
    let cylinder = shown(&frame.compose(&middle), &format!("<cylinder radius=\"{radius:?}\" length=\"{length:?}\"/>"));
    format!("{}{cylinder}{}", ball(from), ball(to))
}

fn shown(place: &Placement, geometry: &str) -> String {
    format!("    <visual>\n      {}\n      <geometry>{geometry}</geometry>\n    </visual>\n", origin(place))
}

fn escaped(name: &str) -> String {
    let name = name.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
    // A reader makes a space of each unless it is written so.
    name.replace('\n', "&#10;").replace('\t', "&#9;").replace('\r', "&#13;")
}

/// A text inside a comment, which may have no two hyphens in a row.
fn commented(text: &str) -> String {
    let mut text = text.replace("--", "- -");
    if text.contains("--") {
        text = text.replace("--", "- -");
    }
    text
}

fn origin(place: &Placement) -> String {
    let p = place.translation.map(|x| x + 0.0);
    let [roll, pitch, yaw] = roll_pitch_yaw(&place.rotation);
    format!("<origin xyz=\"{:?} {:?} {:?}\" rpy=\"{roll:?} {pitch:?} {yaw:?}\"/>", p.x, p.y, p.z)
}

/// Angles with `R = Rz(yaw) Ry(pitch) Rx(roll)`; where yaw and roll turn about the same axis, roll alone.
fn roll_pitch_yaw(r: &Matrix3<f64>) -> [f64; 3] {
    let across = libm::hypot(r[(0, 0)], r[(1, 0)]);
    let pitch = libm::atan2(-r[(2, 0)], across);
    if across > 1e-12 {
        return [libm::atan2(r[(2, 1)], r[(2, 2)]) + 0.0, pitch + 0.0, libm::atan2(r[(1, 0)], r[(0, 0)]) + 0.0];
    }
    let sign = if r[(2, 0)] < 0.0 { 1.0 } else { -1.0 };
    [libm::atan2(sign * r[(0, 1)], r[(1, 1)]) + 0.0, pitch + 0.0, 0.0]
}

#[cfg(test)]
mod tests {
    use super::super::{ChainEnds, parse_urdf};
    use super::*;
    use crate::chains::random_robot;
    use crate::dynamics::Dynamics;
    use crate::seed::Seed;
    use rand::RngExt;

    #[test]
    fn identity_angles_of_turned_frames() {
        let turn = |[roll, pitch, yaw]: [f64; 3]| {
            let of = |angle: f64| libm::sincos(angle);
            let ((sr, cr), (sp, cp), (sy, cy)) = (of(roll), of(pitch), of(yaw));
            let (x, y) = (Placement::rotation_x(sr, cr), Placement::rotation_y(sp, cp));
            Placement::rotation_z(sy, cy).compose(&y).compose(&x).rotation
        };
        let right = std::f64::consts::FRAC_PI_2;
        for angles in [[0.3, -0.8, 2.0], [0.7, right, 0.4], [-0.7, -right, 1.4], [right, 0.0, -right]] {
            let r = turn(angles);
            assert!((turn(roll_pitch_yaw(&r)) - r).norm() < 1e-12, "{angles:?}");
        }
    }

    #[test]
    fn identity_a_robot_read_back_has_the_same_torque() {
        for run in 0..4 {
            let mut rng = Seed::new(61).stream("written and read", run);
            let (robot, parameters) = random_robot(&mut rng, 5);
            let read = parse_urdf(&write_urdf(&robot, &parameters, "a -- test"), &ChainEnds::default()).unwrap();
            let mut expected = parameters.clone();
            let mut found = read.parameters.clone();
            for (drive, read) in expected.drives.iter_mut().zip(&mut found.drives) {
                assert_eq!((drive[VISCOUS], drive[COULOMB]), (read[VISCOUS], read[COULOMB]));
                // How sharply Coulomb friction turns is the simulator's own affair.
                *drive = drive.only(|term| term == VISCOUS);
                read[COULOMB] = 0.0;
            }
            let (mut ours, mut theirs) = (Dynamics::new(&robot, &expected), Dynamics::new(&read.robot, &found));
            for _ in 0..20 {
                let mut draw = |size: f64| (0..5).map(|_| rng.random_range(-size..size)).collect::<Vec<f64>>();
                let (q, qd, qdd) = (draw(3.0), draw(2.0), draw(10.0));
                let (mut a, mut b) = (vec![0.0; 5], vec![0.0; 5]);
                ours.inverse(&q, &qd, &qdd, &mut a);
                theirs.inverse(&q, &qd, &qdd, &mut b);
                let size = a.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
                for (a, b) in a.iter().zip(&b) {
                    assert!((a - b).abs() < 1e-10 * size, "{a} {b}");
                }
            }
        }
    }
}
