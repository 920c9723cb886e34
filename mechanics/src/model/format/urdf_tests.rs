//! URDF against closed forms, against a robot given by a DH table, and against another reader.

use crate::model::term::{COULOMB, OFFSET, ROTOR, VISCOUS};
use std::fmt::Write;

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, Unit, Vector3};

use super::fault_tests::expect_fault;
use super::{ChainEnds, FormatError, ImportedModel, parse_parameters, parse_robot, parse_urdf, parse_urdf_as_written};
use crate::chains::random_state;
use crate::dynamics::Dynamics;
use crate::model::{EffortInterface, JointKind, Robot, StandardParameters, bundled};
use crate::seed::Seed;
use crate::spatial::{Inertia, Placement};

/// A slide that carries a rotated link with a tool fixed to it, a camera fixed to the base, and a two-jaw gripper.
pub(super) const TREE: &str = r#"<?xml version="1.0"?>
<robot name="tree">
  <link name="world"/>
  <joint name="mount" type="fixed"><origin xyz="0 0 1" rpy="0 1.5707963267948966 0"/><parent link="world"/><child link="base"/></joint>
  <link name="base"><inertial><mass value="9"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <joint name="slide" type="prismatic">
    <origin xyz="0.1 0 0"/> <parent link="base"/> <child link="car"/> <axis xyz="0 2 0"/>
    <limit lower="-0.5" upper="0.5" velocity="1.5" effort="0"/>
    <dynamics damping="3" friction="4"/>
  </joint>
  <link name="car"><inertial><origin xyz="0 0 0.5" rpy="0 0 1.5707963267948966"/><mass value="2"/>
    <inertia ixx="0.1" ixy="0.01" ixz="0" iyy="0.2" iyz="0" izz="0.25"/></inertial></link>
  <joint name="turn" type="continuous"><origin xyz="0 0 1" rpy="0 0 3.141592653589793"/><parent link="car"/><child link="arm"/><axis xyz="1 0 0"/></joint>
  <link name="arm"/>
  <joint name="flange" type="fixed"><origin xyz="1 0 0"/><parent link="arm"/><child link="tool"/></joint>
  <link name="tool"><inertial><mass value="3"/><inertia ixx="0.3" ixy="0" ixz="0" iyy="0.4" iyz="0" izz="0.5"/></inertial></link>
  <joint name="bracket" type="fixed"><parent link="car"/><child link="camera"/></joint>
  <link name="camera"><inertial><origin xyz="0 1 0"/><mass value="1"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>
  <gazebo reference="tool"><anything/></gazebo>
</robot>
"#;

fn parse(text: &str) -> Result<ImportedModel, FormatError> {
    parse_urdf(text, &ChainEnds::default())
}

fn assert_near(found: &Inertia, expected: [f64; 10]) {
    for (a, b) in found.to_array().iter().zip(expected) {
        assert!((a - b).abs() < 1e-15, "{:?} against {expected:?}", found.to_array());
    }
}

/// A rounded angle of a URDF.
fn as_written(angle: &str) -> f64 {
    angle.parse().unwrap()
}

#[test]
fn analytic_fixed_links_become_one() {
    let model = parse(TREE).unwrap();
    let [slide, turn] = model.robot.joints() else { panic!("two joints") };
    assert_eq!((slide.name.as_str(), slide.kind), ("slide", JointKind::Prismatic));
    assert_eq!((turn.name.as_str(), turn.kind), ("turn", JointKind::Revolute));
    assert_eq!((slide.limits.position, slide.limits.velocity), ((-0.5, 0.5), 1.5));
    // The root is the world, so gravity needs no turning; the pitched mount stands before the first joint.
    assert_eq!(model.robot.gravity().as_slice(), [0.0, 0.0, -9.81]);
    assert_eq!(model.robot.effort(), EffortInterface::Torque);
    // The axis y of the car is y of the world; 0.1 m along x of the pitched base is 0.1 m down.
    let pose = model.robot.poses(&[0.25, 0.0])[0];
    assert!((pose.translation - Vector3::new(0.0, 0.25, 0.9)).norm() < 1e-16);
    assert_eq!(slide.axis().lin.as_slice(), [0.0, 1.0, 0.0]);
    // Car: 2 kg at (0, 0, 0.5) turned by 90° about z, so Ixx and Iyy change places and Ixy its sign; camera: 1 kg at y = 1.
    assert_near(&model.parameters.links[0], [3.0, 0.0, 1.0, 1.0, 1.7, -0.01, 0.0, 0.6, 0.0, 1.25]);
    // Tool: 3 kg at x = 1.
    assert_near(&model.parameters.links[1], [3.0, 3.0, 0.0, 0.0, 0.3, 0.0, 0.0, 3.4, 0.0, 3.5]);
    assert_eq!((model.parameters.drives[0][VISCOUS], model.parameters.drives[0][COULOMB]), (3.0, 4.0));
    assert_eq!(model.remarks, ["joint \"slide\": the effort limit 0 is read as no limit"]);
    assert!(model.locked.is_empty());
}

#[test]
fn analytic_ends_choose_the_chain() {
    let ends = |base: Option<&str>, tip: Option<&str>| ChainEnds {
        base: base.map(str::to_owned),
        tip: tip.map(str::to_owned),
    };
    // From the base: the same chain, gravity turned into the pitched frame, and the mount in the base's pose.
    let model = parse_urdf(TREE, &ends(Some("base"), None)).unwrap();
    assert_eq!(model.robot.gravity().as_slice(), [9.81, 0.0, 0.0]);
    assert_eq!(model.robot.base().translation.as_slice(), [0.0, 0.0, 1.0]);
    assert_eq!(model.parameters, parse(TREE).unwrap().parameters);
    // To the car: what lies beyond is held at zero and carried. The tool stands at (−1, 0, 1) of the car, turned.
    let model = parse_urdf(TREE, &ends(None, Some("car"))).unwrap();
    assert_eq!((model.robot.dof(), model.locked.as_slice()), (1, ["turn".to_owned()].as_slice()));
    let whole = &model.parameters.links[0];
    assert!((whole.mass - 6.0).abs() < 1e-15);
    assert!((whole.first_moment - Vector3::new(-3.0, 1.0, 4.0)).norm() < 1e-15);
    // A second arm makes a tree with a choice.
    let jaws = r#"<link name="jaw"/><joint name="jaw" type="prismatic"><parent link="car"/><child link="jaw"/>
      <limit lower="0" upper="0.1" velocity="1" effort="1"/></joint></robot>"#;
    let gripper = TREE.replace("</robot>", jaws);
    let fault = parse(&gripper).unwrap_err();
    assert_eq!((fault.line, fault.column), (2, 1));
    assert!(
        fault.message.ends_with("a tip link to choose the chain, one of \"jaw\" (2 joints), \"tool\" (2 joints)"),
        "{fault}"
    );
    let model = parse_urdf(&gripper, &ends(None, Some("tool"))).unwrap();
    assert_eq!(model.locked, ["jaw"]);
    for (base, tip, says) in [
        (None, Some("hand"), "tip \"hand\" is not there"),
        (Some("ground"), None, "base \"ground\" is not there"),
        (Some("arm"), Some("car"), "\"car\" does not hang on \"arm\""),
        (Some("arm"), Some("tool"), "no joint moves between \"arm\" and \"tool\""),
    ] {
        let fault = parse_urdf(TREE, &ends(base, tip)).unwrap_err();
        assert!(fault.message.contains(says), "{fault}");
    }
}

/// An arm of four joints about alternating axes, whose right angles are written as `angle` and `axis`, and what follows.
fn arm(angle: &str, axis: &str, more: &str) -> String {
    let mut text = "<robot name=\"arm\"><link name=\"l0\"/>".to_owned();
    for k in 1..=4 {
        let rpy = if k % 2 == 0 { angle } else { "0 0 0" };
        text.push_str(&format!(
            "<link name=\"l{k}\"><inertial><mass value=\"1\"/><inertia ixx=\"0.1\" ixy=\"0\" ixz=\"0\" iyy=\"0.1\" \
             iyz=\"0\" izz=\"0.1\"/></inertial></link><joint name=\"j{k}\" type=\"continuous\"><origin xyz=\"0.1 0 0.2\" \
             rpy=\"{rpy}\"/><parent link=\"l{}\"/><child link=\"l{k}\"/><axis xyz=\"{axis}\"/></joint>",
            k - 1
        ));
    }
    text + more + "</robot>"
}

#[test]
fn analytic_torque_of_an_axis_that_a_rounded_angle_tilts() {
    use crate::dynamics::TorqueDifference;
    // Upside down, 3.1416 in place of π: the axis leans by δ, and a mass m at the arm l weighs m g l sin δ · sin(q) on it, with all
    // angles equally likely.
    let text = "<robot name=\"arm\"><link name=\"a\"/><link name=\"b\"><inertial><origin xyz=\"0.5 0 0\"/><mass value=\"4\"/>\
        <inertia ixx=\"0.1\" ixy=\"0\" ixz=\"0\" iyy=\"0.1\" iyz=\"0\" izz=\"0.1\"/></inertial></link>\
        <joint name=\"j\" type=\"continuous\"><origin xyz=\"0 0 1\" rpy=\"3.1416 0 0\"/><parent link=\"a\"/><child link=\"b\"/>\
        <axis xyz=\"0 0 1\"/></joint></robot>";
    let read = parse(text).unwrap();
    let written = parse_urdf_as_written(text, &ChainEnds::default()).unwrap();
    let found = TorqueDifference::new((&written.robot, &written.parameters), (&read.robot, &read.parameters), 4000);
    let most = 4.0 * 9.81 * 0.5 * libm::sin(as_written("3.1416") - std::f64::consts::PI);
    assert!((found.largest[0] / most - 1.0).abs() < 1e-3, "{} {most}", found.largest[0]);
    assert!((found.rms[0] / (most / 2.0_f64.sqrt()) - 1.0).abs() < 0.03, "{}", found.rms[0]);
}

#[test]
fn identity_rounded_right_angles_give_the_robot_of_exact_ones() {
    use crate::base::{Method, reduce};
    use crate::model::Columns;
    use crate::seed::Seed;
    let exact = parse(&arm("1.5707963267948966 0 3.141592653589793", "0 0 1", "")).unwrap();
    assert!(exact.remarks.is_empty());
    for (angle, axis) in [("1.5708 0 3.1416", "0 0 1"), ("1.57079632679 0 3.14159", "1e-5 -2e-7 1")] {
        let rounded = parse(&arm(angle, axis, "")).unwrap();
        assert_eq!(rounded.robot.poses(&[0.1, 0.2, 0.3, 0.4]), exact.robot.poses(&[0.1, 0.2, 0.3, 0.4]));
        assert!(
            rounded.remarks[0].contains("within 5e-5 rad") && rounded.remarks[0].contains("\"j2\" by "),
            "{rounded:?}"
        );
        for method in Method::ALL {
            let rank = |model: &ImportedModel| {
                reduce(&model.robot, Columns::RIGID_ROTOR_FRICTION, method, Seed::new(1)).unwrap().names()
            };
            assert_eq!(rank(&rounded), rank(&exact), "{method:?}");
        }
    }
    // The amount is that of the worst angle: 3.1416 is 7.3464e-6 rad too large.
    let rounded = parse(&arm("1.5708 0 3.1416", "0 0 1", "")).unwrap();
    assert!(rounded.remarks[0].ends_with("joint \"j2\" by 7.3e-6, \"j4\" by 7.3e-6 rad"), "{:?}", rounded.remarks);
    let names: Vec<&str> = rounded.snapped.iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["j2", "j4"]);
    assert!((rounded.snapped[0].angle_rad - (as_written("3.1416") - std::f64::consts::PI)).abs() < 1e-15);
    // As it is written it is the angle of the file.
    let written = parse_urdf_as_written(&arm("1.5708 0 3.1416", "0 0 1", ""), &ChainEnds::default()).unwrap();
    assert!(written.snapped.is_empty() && written.remarks.is_empty());
    assert!((written.robot.joints()[1].before.rotation[(2, 2)] - libm::cos(as_written("1.5708"))).abs() < 1e-15);
    // Further away an angle is what it says.
    let tilted = parse(&arm("1.571 0 3.1416", "0 0 1", "")).unwrap();
    assert!((tilted.robot.joints()[1].before.rotation[(2, 2)] - libm::cos(1.571)).abs() < 1e-15);
}

#[test]
fn analytic_a_gripper_is_no_choice_of_chains() {
    let finger = |name: &str, more: &str| {
        format!(
            "<link name=\"{name}\"/><joint name=\"{name}\" type=\"prismatic\"><parent link=\"l4\"/><child link=\"{name}\"/>\
             <limit lower=\"0\" upper=\"0.04\"/>{more}</joint>"
        )
    };
    let mimic = "<mimic joint=\"left\"/>";
    for (more, locked) in [
        (finger("left", "") + &finger("right", ""), ["left", "right"]),
        (finger("left", "") + &finger("right", mimic), ["left", "right (a mimic of left)"]),
    ] {
        let model = parse(&arm("1.5708 0 0", "0 0 1", &more)).unwrap();
        assert_eq!((model.robot.dof(), model.locked.as_slice()), (4, locked.map(str::to_owned).as_slice()));
        assert_eq!(model.remarks.iter().any(|r| r.contains("gripper of 2 branches")), !more.contains("mimic"));
    }
    // A mimic that is fixed moves nothing; many links are not listed one and all.
    let fixed = finger("left", mimic).replace("prismatic", "fixed");
    let model = parse(&arm("0 0 0", "0 0 1", &fixed)).unwrap();
    assert!(model.remarks.contains(&"joint \"left\": the mimic of a fixed joint is passed over".to_owned()));
    let many: String = (0..9).map(|k| format!("<link name=\"p{k}\"/><joint name=\"p{k}\" type=\"continuous\"><parent link=\"l0\"/><child link=\"p{k}\"/></joint>")).collect();
    let fault = parse(&arm("0 0 0", "0 0 1", &many)).unwrap_err();
    assert!(fault.message.contains("one of \"l4\" (4 joints), \"p0\" (1 joint)"), "{fault}");
    assert!(fault.message.ends_with("and 4 more"), "{fault}");
    let macros = "<robot xmlns:xacro=\"http://ros.org/wiki/xacro\"><xacro:macro name=\"arm\"/></robot>";
    assert!(parse(macros).unwrap_err().message.contains("xacro template"));
}

#[test]
fn analytic_every_fault_names_its_place() {
    for (from, to, says) in [
        ("</robot>", "¶</robots>", "malformed XML: expected 'robot' tag, not 'robots'"),
        ("<mass value=\"2\"/>", "<mass value=\"¶two\"/>", "value is \"two\", expected a finite number"),
        ("<mass value=\"2\"/>", "<mass value=\"¶nan\"/>", "expected a finite number"),
        ("<mass value=\"2\"/>", "¶<mass val=\"2\"/>", "<mass> has no attribute value"),
        ("xyz=\"0 0 0.5\"", "xyz=\"¶0 0\"", "xyz is \"0 0\", expected 3 finite numbers"),
        ("iyz=\"0\" izz=\"0.25\"", "iyz=\"0\"", "no attribute izz"),
        ("<axis xyz=\"0 2 0\"/>", "<axis xyz=\"¶0 0 0\"/>", "zero vector"),
        ("lower=\"-0.5\"", "lower=\"1.5\"", "limits are 1.5 to 0.5"),
        ("velocity=\"1.5\"", "velocity=\"¶-1\"", "velocity is -1"),
        ("<child link=\"car\"/>", "<child link=\"¶cart\"/>", "child link \"cart\" is not there"),
        ("type=\"continuous\"", "type=\"¶screw\"", "joint type is \"screw\""),
        ("type=\"continuous\"", "type=\"planar\"", "joint \"turn\" is planar"),
        ("<axis xyz=\"1 0 0\"/>", "<mimic joint=\"slide\"/>", "joint \"turn\" is a mimic of joint \"slide\""),
        ("<link name=\"arm\"/>", "<link name=\"¶car\"/>", "link \"car\" is there twice"),
        (
            "<parent link=\"car\"/><child link=\"camera\"/>",
            "<parent link=\"car\"/><child link=\"tool\"/>",
            "already hangs",
        ),
        ("</robot>", "<link name=\"loose\"/></robot>", "\"world\", \"loose\", expected exactly one"),
        ("<limit lower=\"-0.5\" upper=\"0.5\" velocity=\"1.5\" effort=\"0\"/>", "", "no <limit>"),
    ] {
        let mut text = TREE.replacen(from, to, 1);
        assert_ne!(text, TREE, "{from}");
        if !text.contains('¶') {
            // The element that is named, where the replacement does not show it.
            let place = match says {
                "no attribute izz" => "<inertia ixx=\"0.1\"",
                "limits are 1.5 to 0.5" => "<limit",
                "joint \"turn\" is planar" | "joint \"turn\" is a mimic of joint \"slide\"" => "<joint name=\"turn\"",
                "already hangs" => "<joint name=\"bracket\"",
                "no <limit>" => "<joint name=\"slide\"",
                _ => "<robot",
            };
            text = text.replacen(place, &format!("¶{place}"), 1);
        }
        expect_fault(parse, &text, says);
    }
    expect_fault(parse, "¶<mujoco/>", "root element is <mujoco>, expected <robot>");
    expect_fault(parse, "¶<robot/>", "no links");
    let ring = r#"<robot><link name="r"/><link name="a"/>¶<link name="b"/>
      <joint name="1" type="fixed"><parent link="a"/><child link="b"/></joint>
      <joint name="2" type="fixed"><parent link="b"/><child link="a"/></joint></robot>"#;
    expect_fault(parse, &ring.replacen('¶', "", 1).replacen("<link name=\"a\"", "¶<link name=\"a\"", 1), "in a loop");
}

/// A robot as URDF whose joint frames are turned away from the axes by `turn(i)`.
fn to_urdf(robot: &Robot, parameters: &StandardParameters, turn: impl Fn(usize) -> Matrix3<f64>) -> String {
    let mut text = String::from("<robot name=\"copy\"><link name=\"base\"/>\n");
    let mut to_joint = Placement::identity();
    let mut parent = "base".to_owned();
    for (i, joint) in robot.joints().iter().enumerate() {
        let turned = Placement::new(turn(i), Vector3::zeros());
        let origin = to_joint.compose(&joint.before).compose(&turned);
        to_joint = turned.inverse().compose(&joint.after);
        let axis = turned.rotation.tr_mul(&Vector3::z());
        // The inertial frame of the file is the link's frame of the robot, moved to the centre of mass.
        let com = parameters.links[i].com().unwrap_or_default();
        let inertial = to_joint.compose(&Placement::translation(com.x, com.y, com.z));
        let about = parameters.links[i].about_com();
        let name = &joint.name;
        let kind = if joint.kind == JointKind::Revolute { "revolute" } else { "prismatic" };
        writeln!(
            text,
            "<link name=\"{name}\"><inertial>{}<mass value=\"{:?}\"/><inertia ixx=\"{:?}\" ixy=\"{:?}\" ixz=\"{:?}\" \
             iyy=\"{:?}\" iyz=\"{:?}\" izz=\"{:?}\"/></inertial></link>\n<joint name=\"{name}\" type=\"{kind}\">{}\
             <parent link=\"{parent}\"/><child link=\"{name}\"/><axis xyz=\"{:?} {:?} {:?}\"/>\
             <limit lower=\"{:?}\" upper=\"{:?}\" velocity=\"1\" effort=\"1\"/>\
             <dynamics damping=\"{:?}\" friction=\"{:?}\"/></joint>",
            origin_tag(&inertial),
            parameters.links[i].mass,
            about[(0, 0)],
            about[(0, 1)],
            about[(0, 2)],
            about[(1, 1)],
            about[(1, 2)],
            about[(2, 2)],
            origin_tag(&origin),
            axis.x,
            axis.y,
            axis.z,
            joint.limits.position.0,
            joint.limits.position.1,
            parameters.drives[i][VISCOUS],
            parameters.drives[i][COULOMB],
        )
        .unwrap();
        parent.clone_from(name);
    }
    text + "</robot>\n"
}

fn origin_tag(pose: &Placement) -> String {
    let (t, r) = (pose.translation, pose.rotation);
    let pitch = libm::atan2(-r[(2, 0)], libm::hypot(r[(0, 0)], r[(1, 0)]));
    let (roll, yaw) = if r[(2, 0)].abs() > 1.0 - 1e-12 {
        // Straight up or down only roll − yaw or roll + yaw shows: take yaw as zero.
        (libm::atan2(-r[(1, 2)], r[(1, 1)]), 0.0)
    } else {
        (libm::atan2(r[(2, 1)], r[(2, 2)]), libm::atan2(r[(1, 0)], r[(0, 0)]))
    };
    format!("<origin xyz=\"{:?} {:?} {:?}\" rpy=\"{roll:?} {pitch:?} {yaw:?}\"/>", t.x, t.y, t.z)
}

/// A robot read back from a URDF whose joint frames are turned away from the axes.
pub(super) fn as_urdf(robot: &Robot, parameters: &StandardParameters) -> ImportedModel {
    parse(&to_urdf(robot, parameters, generic_turn)).unwrap()
}

fn generic_turn(i: usize) -> Matrix3<f64> {
    *Rotation3::from_euler_angles(0.4 + i as f64, -0.7 * i as f64, 1.1).matrix()
}

#[test]
fn identity_torques_of_a_dh_robot_and_of_its_urdf_are_equal() {
    let entry = bundled().iter().find(|entry| entry.name == "crs-a460").unwrap();
    let robot = parse_robot(entry.robot).unwrap();
    let mut parameters =
        parse_parameters(&entry.nominal[entry.nominal.find("[[link]]").unwrap()..], &robot, true).unwrap().parameters;
    for (i, drive) in parameters.drives.iter_mut().enumerate() {
        // URDF has no rotor inertia and no offset; products of inertia make the test sharper.
        (drive[ROTOR], drive[OFFSET]) = (0.0, 0.0);
        parameters.links[i].first_moment += Vector3::new(0.02, -0.01, 0.03);
        parameters.links[i].rotational[(0, 1)] = 0.004;
        parameters.links[i].rotational[(1, 0)] = 0.004;
    }
    let mut rng = Seed::new(3).stream("states", 0);
    let mut by_dh = Dynamics::new(&robot, &parameters);
    for turn in [|_| Matrix3::identity(), generic_turn] {
        let model = parse(&to_urdf(&robot, &parameters, turn)).unwrap();
        assert_eq!(model.robot.dof(), 6);
        // An ideal drive has the plain sign; so must the other.
        let mut by_urdf = Dynamics::new(&with_plain_sign(&model.robot, &robot), &model.parameters);
        for _ in 0..20 {
            let (q, qd, qdd) = random_state(&mut rng, 6);
            let (mut a, mut b) = ([0.0; 6], [0.0; 6]);
            by_dh.inverse(&q, &qd, &qdd, &mut a);
            by_urdf.inverse(&q, &qd, &qdd, &mut b);
            for (a, b) in a.iter().zip(b) {
                // Angles go through atan2 and sincos and back, six times one after the other.
                assert!((a - b).abs() < 1e-11 * (1.0 + a.abs()), "{a} against {b}");
            }
        }
    }
}

/// `robot` with the velocity scales of Coulomb friction of another one.
fn with_plain_sign(robot: &Robot, other: &Robot) -> Robot {
    let mut joints = robot.joints().to_vec();
    for (joint, other) in joints.iter_mut().zip(other.joints()) {
        joint.drive.coulomb_velocity = other.drive.coulomb_velocity;
    }
    Robot::new(crate::model::RobotSpec {
        name: robot.name().to_owned(),
        gravity: robot.gravity(),
        base: *robot.base(),
        joints,
        coupling: None,
        ..crate::model::RobotSpec::default()
    })
    .unwrap()
}

#[test]
fn urdf_rs_reads_the_same_chain() {
    let entry = bundled().iter().find(|entry| entry.name == "crs-a460").unwrap();
    let robot = parse_robot(entry.robot).unwrap();
    let parameters = StandardParameters::zero(6);
    let text = to_urdf(&robot, &parameters, generic_turn);
    let model = parse(&text).unwrap();
    let other = urdf_rs::read_from_string(&text).unwrap();
    let q = [0.3, -1.2, 0.8, 2.0, -0.4, 1.5];
    // Quaternions and axis-angle turns of another library, where ours are matrices from right-angled factors.
    let mut pose = Isometry3::identity();
    for ((joint, q), ours) in other.joints.iter().zip(q).zip(model.robot.poses(&q)) {
        let (xyz, rpy, axis) = (joint.origin.xyz.0, joint.origin.rpy.0, joint.axis.xyz.0);
        let origin = Isometry3::from_parts(
            Translation3::new(xyz[0], xyz[1], xyz[2]),
            Rotation3::from_euler_angles(rpy[0], rpy[1], rpy[2]).into(),
        );
        let turn = Rotation3::from_axis_angle(&Unit::new_normalize(Vector3::from(axis)), q);
        pose = pose * origin * Isometry3::from_parts(Translation3::identity(), turn.into());
        assert!((pose.rotation.to_rotation_matrix().matrix() - ours.rotation).amax() < 1e-14);
        assert!((pose.translation.vector - ours.translation).amax() < 1e-14);
    }
}

#[test]
fn collision_shapes_stand_on_the_links_that_carry_them() {
    use super::Geometry;
    use crate::model::{Hull, Solid};

    let shape =
        |origin: &str, geometry: &str| format!("<collision>{origin}<geometry>{geometry}</geometry></collision>");
    let text = format!(
        "<robot name=\"arm\"><link name=\"world\">{}</link><link name=\"a\">{}{}</link><link name=\"tool\">{}{}</link>\
         <joint name=\"j\" type=\"continuous\"><parent link=\"world\"/><child link=\"a\"/><axis xyz=\"0 0 1\"/></joint>\
         <joint name=\"f\" type=\"fixed\"><origin xyz=\"0 0 1\" rpy=\"1.5707963267948966 0 0\"/><parent link=\"a\"/><child \
         link=\"tool\"/></joint></robot>",
        shape("<origin xyz=\"0 0 -1\"/>", "<box size=\"1 2 0\"/>"),
        shape("", "<cylinder radius=\"0.05\" length=\"0.2\"/>"),
        shape("", "<sphere radius=\"-1\"/>"),
        shape("<origin xyz=\"0 0 0.5\"/>", "<capsule radius=\"0.1\" length=\"0.4\"/>"),
        shape("", "<mesh filename=\"package://a/b.stl\" scale=\"0.001 0.001 0.002\"/>"),
    );
    let shapes = parse(&text).unwrap().collisions;
    assert_eq!(
        shapes.iter().map(|s| (s.link, s.body.as_str())).collect::<Vec<_>>(),
        [(0, "world"), (1, "a"), (1, "a"), (1, "tool"), (1, "tool")]
    );
    // A plate has a hull of its corners, a cylinder one of its rims.
    let Some(Solid::Hull(Hull { points, margin })) = shapes[0].solid(&[]) else { panic!("{:?}", shapes[0]) };
    assert_eq!((points.len(), margin), (4, 0.0));
    assert!(matches!(shapes[1].solid(&[]), Some(Solid::Hull(hull)) if hull.margin < 5e-4));
    let fault = shapes[2].geometry.as_ref().unwrap_err();
    assert!(fault.message.contains("radius is -1, expected a number above zero"), "{fault}");
    assert_eq!(shapes[2].solid(&[]), None);
    // A quarter turn about x brings z onto −y, one metre up.
    let Some(Solid::Capsule(capsule)) = shapes[3].solid(&[]) else { panic!("{:?}", shapes[3]) };
    assert!((capsule.from - Vector3::new(0.0, -0.3, 1.0)).norm() < 1e-15, "{capsule:?}");
    assert!((capsule.to - Vector3::new(0.0, -0.7, 1.0)).norm() < 1e-15 && capsule.radius == 0.1);
    assert!(matches!(&shapes[4].geometry, Ok(Geometry::Mesh { file, .. }) if file == "package://a/b.stl"));
    let Some(Solid::Hull(hull)) = shapes[4].solid(&[Vector3::new(1.0, 2.0, 3.0)]) else { panic!() };
    assert!((hull.points[0] - Vector3::new(0.001, -0.006, 1.002)).norm() < 1e-15, "{hull:?}");
    // Where the base is another link, what stands before it stands with it.
    let above = ChainEnds { base: Some("a".to_owned()), tip: None };
    assert!(parse_urdf(&text, &above).is_err());
}
