//! MJCF against MuJoCo, against closed forms, and against the same robot as URDF and as a DH table.

use crate::model::term::{COULOMB, ROTOR, VISCOUS};
use std::fmt::Write;

use nalgebra::{Rotation3, UnitQuaternion, Vector3};

use super::fault_tests::expect_fault;
use super::{ChainEnds, FormatError, ImportedModel, parse_mjcf, parse_parameters, parse_robot};
use crate::chains::random_state;
use crate::dynamics::Dynamics;
use crate::model::{JointKind, Robot, StandardParameters, bundled};
use crate::seed::Seed;
use crate::spatial::Placement;

/// Every way to state an orientation and an inertia, nested defaults, a fixed body, a slide, joints off the origin.
pub(super) const MIXED: &str = r#"<mujoco model="mixed">
  <compiler angle="degree" eulerseq="zyx"/>
  <option gravity="0.5 -1 -9.5"/>
  <default>
    <joint damping="0.3" armature="0.02"/>
    <default class="heavy"><joint armature="0.5" axis="0 1 0"/></default>
  </default>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="column" pos="0 0 0.3" euler="30 0 90">
      <inertial pos="0.1 0.2 0.3" mass="4" diaginertia="0.3 0.2 0.1"/>
      <body name="upper" pos="0.1 0 0.2" quat="2 0 1 0.5" childclass="heavy">
        <joint name="first" pos="0.05 -0.1 0.02" range="-120 100"/>
        <inertial pos="0.1 -0.05 0.2" mass="3" fullinertia="0.05 0.06 0.04 0.002 -0.003 0.004"/>
        <body name="plate" pos="0.2 0.1 0" axisangle="0 1 1 40">
          <inertial pos="0 0.1 0" euler="10 20 30" mass="1.5" diaginertia="0.01 0.02 0.015"/>
        </body>
        <body name="lower" pos="0 0.1 0.5" xyaxes="1 0.2 0 0 1 0.3">
          <joint name="second" type="slide" axis="1 0 2" range="-0.3 0.4" damping="7"/>
          <inertial pos="0.02 0.03 -0.1" quat="1 0.2 0.3 -0.1" mass="2" diaginertia="0.02 0.015 0.012"/>
          <body name="hand" pos="0 0 0.3" zaxis="0.3 -0.2 -1">
            <joint name="third" axis="-1 2 0.5" class="main" actuatorfrcrange="-12 15"/>
            <inertial pos="0.05 0 0.02" mass="0.7" diaginertia="0.004 0.003 0.002"/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"#;

fn parse(text: &str) -> Result<ImportedModel, FormatError> {
    parse_mjcf(text, &ChainEnds::default())
}

#[test]
fn mujoco_inverse_dynamics_and_kinematics_of_the_same_text() {
    let model = parse(MIXED).unwrap();
    assert_eq!(model.robot.dof(), 3);
    let mut dynamics = Dynamics::new(&model.robot, &model.parameters);
    // MuJoCo 3.3.7, mj_inverse with constraints disabled: qfrc_inverse, and xpos of the hand.
    #[rustfmt::skip]
    let cases = [
        ([0.4, -0.1, 1.2], [0.7, -0.5, 2.0], [-1.5, 0.8, 3.0],
         [4.293371963654509, 5.158447721088093, 0.5429723586120149],
         [0.8553944922033789, -0.018350695960640886, 0.5487331725552659]),
        ([-1.1, 0.25, -2.0], [1.5, 0.9, -1.0], [2.0, -1.0, 0.5],
         [17.822798481175543, -7.016582423195435, 0.12345642069535251],
         [0.6643712695073515, -0.9196976623943037, 0.07976298230105283]),
        ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0],
         [8.057507657115117, 4.847953559217481, 0.1315299799647094],
         [0.947341657656042, -0.23438400697533246, 0.4690482411076084]),
    ];
    for (q, qd, qdd, effort, hand) in cases {
        let mut tau = [0.0; 3];
        dynamics.inverse(&q, &qd, &qdd, &mut tau);
        // MuJoCo diagonalises a fullinertia iteratively, to about 1e-10; only the first joint carries one.
        for ((found, expected), bound) in tau.iter().zip(effort).zip([1e-8, 1e-12, 1e-12]) {
            assert!((found - expected).abs() < bound * (1.0 + expected.abs()), "{found} against {expected}");
        }
        let at = model.robot.poses(&q)[2].translation;
        assert!((at - Vector3::from(hand)).amax() < 1e-14, "{at}");
    }
    let [first, second, third] = model.robot.joints() else { panic!("three joints") };
    assert_eq!(first.limits.position, (-120_f64.to_radians(), 100_f64.to_radians()));
    assert_eq!((second.kind, second.limits.position), (JointKind::Prismatic, (-0.3, 0.4)));
    assert_eq!((third.limits.torque, third.limits.position.1), (12.0, f64::INFINITY));
    // Classes: the first joint is heavy by its body, the third is called back to the main class.
    let rotors: Vec<f64> = model.parameters.drives.iter().map(|drive| drive[ROTOR]).collect();
    assert_eq!(rotors, [0.5, 0.5, 0.02]);
    let damping: Vec<f64> = model.parameters.drives.iter().map(|drive| drive[VISCOUS]).collect();
    assert_eq!(damping, [0.3, 7.0, 0.3]);
}

#[test]
fn analytic_every_fault_names_its_place() {
    for (from, to, says) in [
        ("angle=\"degree\"", "angle=\"¶degrees\"", "angle is \"degrees\", expected degree or radian"),
        ("eulerseq=\"zyx\"", "eulerseq=\"¶zy\"", "three letters"),
        ("angle=\"degree\"", "balanceinertia=\"¶true\"", "changes the inertias"),
        ("angle=\"degree\"", "boundmass=\"¶0.1\"", "changes the inertias"),
        ("angle=\"degree\"", "coordinate=\"¶global\"", "expected local"),
        ("<option ", "<option density=\"¶1.2\" ", "vacuum"),
        ("<option gravity=\"0.5 -1 -9.5\"/>", "<option><flag gravity=\"¶disable\"/></option>", "flag gravity"),
        ("<default class=\"heavy\">", "¶<default>", "<default> has no class"),
        ("class=\"main\"", "class=\"¶light\"", "class \"light\" is not there"),
        ("<option ", "¶<include file=\"x\"/><option ", "<include> is not supported"),
        ("<option ", "<tendon>¶<spatial/></tendon><option ", "<spatial> in <tendon> is not supported"),
        ("<option ", "<tendon><fixed damping=\"¶1\"/></tendon><option ", "damping of a tendon is 1, expected 0"),
        (
            "<option ",
            "<tendon>¶<fixed armature=\"1\"><joint joint=\"first\" coef=\"1\"/></fixed></tendon><option ",
            "has a rotor of its own",
        ),
        ("<option ", "¶<equality/><option ", "<equality> is not supported"),
        ("<geom type=\"plane\" size=\"1 1 1\"/>", "¶<frame/>", "<frame> in <worldbody> is not supported"),
        ("quat=\"2 0 1 0.5\"", "quat=\"¶0 0 0 0\"", "quat is zero"),
        ("quat=\"2 0 1 0.5\"", "quat=\"¶1 0 0\"", "4 finite numbers"),
        ("quat=\"2 0 1 0.5\"", "quat=\"1 0 0 0\" ¶euler=\"0 0 0\"", "a second orientation, euler"),
        ("xyaxes=\"1 0.2 0 0 1 0.3\"", "xyaxes=\"¶1 0 0 2 0 0\"", "parallel"),
        ("childclass=\"heavy\"", "¶mocap=\"true\"", "mocap"),
        ("mass=\"3\" fullinertia", "mass=\"3\" diaginertia=\"1 1 1\" fullinertia", "both diaginertia and fullinertia"),
        (
            "pos=\"0.1 -0.05 0.2\" mass=\"3\"",
            "pos=\"0 0 0\" euler=\"1 2 3\" mass=\"3\"",
            "fullinertia and an orientation",
        ),
        ("mass=\"3\" ", "", "<inertial> has no attribute mass"),
        ("type=\"slide\"", "type=\"¶screw\"", "type is \"screw\", expected hinge"),
        ("type=\"slide\"", "type=\"ball\"", "joint \"second\" is ball"),
        ("type=\"slide\"", "stiffness=\"¶2\"", "joint \"second\" has a spring, stiffness = 2"),
        ("type=\"slide\"", "ref=\"¶0.1\"", "joint \"second\" has a reference"),
        ("range=\"-0.3 0.4\"", "range=\"¶0.4 -0.3\"", "range is 0.4 -0.3, expected the lower below"),
        ("range=\"-0.3 0.4\"", "limited=\"¶maybe\" range=\"-0.3 0.4\"", "limited is \"maybe\""),
        ("damping=\"7\"", "damping=\"¶-7\"", "damping is -7"),
        ("axis=\"1 0 2\"", "axis=\"¶0 0 0\"", "zero vector"),
        ("<joint name=\"third\"", "<joint/>¶<joint name=\"third\"", "a second joint of body \"hand\""),
        ("armature=\"0.5\"", "armature=\"¶heavy\"", "armature is \"heavy\""),
    ] {
        let mut text = MIXED.replacen(from, to, 1);
        assert_ne!(text, MIXED, "{from}");
        if !text.contains('¶') {
            let place = if says.contains("ball") { "<body name=\"lower\"" } else { "<inertial pos=\"0.1 -0.05 0.2\"" };
            let place = if text.contains(place) { place } else { "<inertial pos=\"0 0 0\"" };
            text = text.replacen(place, &format!("¶{place}"), 1);
        }
        expect_fault(parse, &text, says);
    }
    expect_fault(parse, "¶<robot/>", "root element is <robot>, expected <mujoco>");
    // Shapes count only where a body moves and says nothing else.
    let shaped = MIXED.replacen(
        "<inertial pos=\"0.1 0.2 0.3\" mass=\"4\" diaginertia=\"0.3 0.2 0.1\"/>",
        "<geom size=\"1\"/>",
        1,
    );
    assert!(parse(&shaped).is_ok());
    let shaped = MIXED.replacen(
        "<inertial pos=\"0.05 0 0.02\" mass=\"0.7\" diaginertia=\"0.004 0.003 0.002\"/>",
        "<geom size=\"1\"/>",
        1,
    );
    expect_fault(parse, &shaped.replacen("<body name=\"hand\"", "¶<body name=\"hand\"", 1), "from its shapes");
    let massless = shaped.replacen("<geom size=\"1\"/>", "<geom size=\"1\" mass=\"0\"/>", 1);
    assert_eq!(parse(&massless).unwrap().parameters.links[2].mass, 0.0);
}

#[test]
fn analytic_the_armature_of_a_tendon_is_the_rotor_of_a_coupled_motor() {
    let tendon = "<tendon><fixed name=\"motor3\" armature=\"0.4\"><joint joint=\"second\" coef=\"-0.5\"/><joint joint=\"third\" \
                  coef=\"2\"/></fixed><fixed name=\"seen\"><joint joint=\"first\" coef=\"1\"/></fixed></tendon>";
    let text = MIXED
        .replace("class=\"main\"", "class=\"main\" armature=\"0\"")
        .replace("</mujoco>", &format!("{tendon}</mujoco>"));
    let (plain, model) =
        (parse(&MIXED.replace("class=\"main\"", "class=\"main\" armature=\"0\"")).unwrap(), parse(&text).unwrap());
    let coupling = model.robot.coupling().unwrap();
    assert_eq!(coupling.row(2).iter().copied().collect::<Vec<f64>>(), [0.0, -0.5, 2.0]);
    assert_eq!(model.parameters.drives[2][ROTOR], 0.4);
    // The rotor adds Ia cᵀ q̈ c.
    let (q, qd, qdd) = ([0.4, -0.1, 1.2], [0.0; 3], [-1.5, 0.8, 3.0]);
    let torque = |model: &ImportedModel| {
        let mut tau = [0.0; 3];
        Dynamics::new(&model.robot, &model.parameters).inverse(&q, &qd, &qdd, &mut tau);
        tau
    };
    let turned = 0.4 * (-0.5 * 0.8 + 2.0 * 3.0);
    for ((found, expected), c) in torque(&model).iter().zip(torque(&plain)).zip([0.0, -0.5, 2.0]) {
        assert!((found - expected - c * turned).abs() < 1e-13, "{found} {expected}");
    }
}

/// A robot as MJCF whose bodies stand in the link frames.
fn to_mjcf(robot: &Robot, parameters: &StandardParameters) -> String {
    let mut text = String::from("<mujoco model=\"copy\"><compiler angle=\"radian\"/><worldbody>\n");
    for (i, joint) in robot.joints().iter().enumerate() {
        let pose = joint.before.compose(&joint.after);
        let quat = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(pose.rotation));
        let at = joint.after.inverse();
        let (link, drive, limits) = (&parameters.links[i], &parameters.drives[i], &joint.limits);
        let com = link.com().unwrap_or_default();
        let about = link.about_com();
        let kind = if joint.kind == JointKind::Revolute { "hinge" } else { "slide" };
        let axis = at.rotation.column(2);
        let t = pose.translation;
        writeln!(
            text,
            "<body name=\"{name}\" pos=\"{:?} {:?} {:?}\" quat=\"{:?} {:?} {:?} {:?}\"><joint name=\"{name}\" \
             type=\"{kind}\" pos=\"{:?} {:?} {:?}\" axis=\"{:?} {:?} {:?}\" range=\"{:?} {:?}\" armature=\"{:?}\" \
             damping=\"{:?}\" frictionloss=\"{:?}\"/><inertial pos=\"{:?} {:?} {:?}\" mass=\"{:?}\" \
             fullinertia=\"{:?} {:?} {:?} {:?} {:?} {:?}\"/>",
            t.x,
            t.y,
            t.z,
            quat.w,
            quat.i,
            quat.j,
            quat.k,
            at.translation.x,
            at.translation.y,
            at.translation.z,
            axis[0],
            axis[1],
            axis[2],
            limits.position.0,
            limits.position.1,
            drive[ROTOR],
            drive[VISCOUS],
            drive[COULOMB],
            com.x,
            com.y,
            com.z,
            link.mass,
            about[(0, 0)],
            about[(1, 1)],
            about[(2, 2)],
            about[(0, 1)],
            about[(0, 2)],
            about[(1, 2)],
            name = joint.name,
        )
        .unwrap();
    }
    text + &"</body>".repeat(robot.dof()) + "</worldbody></mujoco>\n"
}

#[test]
fn identity_a_dh_robot_comes_back_from_mjcf_and_agrees_with_its_urdf() {
    let entry = bundled().iter().find(|entry| entry.name == "crs-a460").unwrap();
    let robot = parse_robot(entry.robot).unwrap();
    let nominal = &entry.nominal[entry.nominal.find("[[link]]").unwrap()..];
    let mut parameters = parse_parameters(nominal, &robot, true).unwrap().parameters;
    for link in &mut parameters.links {
        link.first_moment += Vector3::new(0.02, -0.01, 0.03);
        link.rotational[(0, 2)] = -0.003;
        link.rotational[(2, 0)] = -0.003;
    }
    let model = parse(&to_mjcf(&robot, &parameters)).unwrap();
    // The body frames are the link frames, so the parameters come back as they were.
    for (a, b) in model.parameters.links.iter().zip(&parameters.links) {
        for (a, b) in a.to_array().iter().zip(b.to_array()) {
            assert!((a - b).abs() < 1e-14, "{a} against {b}");
        }
    }
    assert_eq!(model.parameters.drives, parameters.drives);
    let zero_pose: Placement = model.robot.poses(&[0.0; 6])[5];
    assert!((zero_pose.translation - Vector3::new(0.0, 0.0, 1.0414)).norm() < 1e-14);

    // URDF has no rotors; its link frames are turned at random, so only torques can be compared.
    for drive in &mut parameters.drives {
        (drive[ROTOR], drive[COULOMB]) = (0.0, 0.0);
    }
    let by_mjcf = parse(&to_mjcf(&robot, &parameters)).unwrap();
    let by_urdf = super::urdf_tests::as_urdf(&robot, &parameters);
    let mut rng = Seed::new(5).stream("states", 0);
    let mut from_mjcf = Dynamics::new(&by_mjcf.robot, &by_mjcf.parameters);
    let mut from_urdf = Dynamics::new(&by_urdf.robot, &by_urdf.parameters);
    for _ in 0..20 {
        let (q, qd, qdd) = random_state(&mut rng, 6);
        let (mut a, mut b) = ([0.0; 6], [0.0; 6]);
        from_mjcf.inverse(&q, &qd, &qdd, &mut a);
        from_urdf.inverse(&q, &qd, &qdd, &mut b);
        for (a, b) in a.iter().zip(b) {
            assert!((a - b).abs() < 1e-11 * (1.0 + a.abs()), "{a} against {b}");
        }
    }
}
