//! `robot.toml` over a URDF.

use super::{ChainEnds, embed_urdf, parse_robot, parse_robot_model, parse_urdf, write_robot};
use crate::model::term::{COULOMB, ROTOR, VISCOUS};
use crate::model::{EffortInterface, Obstacle};

/// Two joints, a fork behind them; the second link has no inertia.
const URDF: &str = r#"<robot name="pair"><link name="world"/>
  <link name="arm"><inertial><origin xyz="0 0 0.2"/><mass value="2"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.01"/></inertial></link>
  <link name="slider"/>
  <joint name="turn" type="revolute"><parent link="world"/><child link="arm"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="2" velocity="3" effort="40"/><dynamics damping="0.5"/></joint>
  <joint name="slide" type="prismatic"><parent link="arm"/><child link="slider"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="0.5" velocity="0" effort="0"/></joint></robot>
"#;

fn robot(text: &str) -> String {
    embed_urdf(&format!("urdf = \"arm.urdf\"\n{text}"), URDF)
}

#[test]
fn identity_a_bare_reference_is_the_urdf() {
    let model = parse_robot_model(&robot("")).unwrap();
    let urdf = parse_urdf(URDF, &ChainEnds::default()).unwrap();
    assert_eq!(model.parameters.unwrap(), urdf.parameters);
    assert_eq!(model.remarks, urdf.remarks);
    assert_eq!(model.robot.clone().with_source(URDF), urdf.robot);
    // The whole text names it: a change of either file is a change of the robot.
    assert_ne!(model.robot.source_sha256(), urdf.robot.source_sha256());
}

#[test]
fn what_the_file_says_is_added_or_takes_the_place_of_the_urdfs() {
    let text = "name = \"mine\"\neffort = \"current\"\ngravity_m_s2 = [0, 0, -9.8]\n[base]\nroll_pitch_yaw_deg = [180, 0, 0]\n\
         [coupling]\nmotor_from_joint = [[1, 0], [0.5, 1]]\n[floor]\nz_m = -0.1\n[servo]\nrate_hz = 500\nbandwidth_hz = 9\n\
         damping = 0.7\nintegral_hz = 1\n[[shape]]\nlink = \"turn\"\nfrom_m = [0, 0, 0]\nto_m = [0, 0, 1]\nradius_m = 0.1\n\
         [[point]]\nname = \"tip\"\nlink = \"slide\"\nposition_m = [0, 0, 1]\n\
         [[joint]]\nname = \"slide\"\n[joint.limits]\nvelocity_m_s = 0.2\n[joint.drive]\ngear_rad_m = 300\n\
         torque_constant_nm_a = 0.1\n[joint.terms]\nrotor_kg = 7\nviscous_n_s_m = 3\n\
         [[joint]]\nname = \"turn\"\n[joint.limits]\nacceleration_rad_s2 = 5\n\
         [joint.drive]\ngear = 100\ntorque_constant_nm_a = 0.2\ncoulomb_velocity_rad_s = 0.01\n[joint.terms]\ncoulomb_nm = 4\n";
    let model = parse_robot_model(&robot(text)).unwrap();
    let (robot, parameters) = (model.robot, model.parameters.unwrap());
    assert_eq!((robot.name(), robot.effort()), ("mine", EffortInterface::Current));
    assert!((robot.gravity().z - 9.8).abs() < 1e-15, "{}", robot.gravity());
    let [turn, slide] = robot.joints() else { panic!("two joints") };
    // Stated here beside what the URDF states.
    assert_eq!((turn.limits.acceleration, turn.limits.velocity, turn.limits.torque), (5.0, 3.0, 40.0));
    assert_eq!((slide.limits.velocity, slide.limits.position), (0.2, (0.0, 0.5)));
    assert_eq!((turn.drive.gear, turn.drive.torque_constant, slide.drive.gear), (100.0, 0.2, 300.0));
    assert_eq!((parameters.drives[0][VISCOUS], parameters.drives[0][COULOMB]), (0.5, 4.0));
    assert_eq!((parameters.drives[1][ROTOR], parameters.drives[1][VISCOUS]), (7.0, 3.0));
    assert_eq!(parameters.links[0].mass, 2.0);
    assert!(robot.is_coupled(1) && robot.obstacles() == [Obstacle::Floor { z: -0.1 }]);
    assert_eq!((robot.shapes().len(), robot.points().len(), robot.servo().rate_hz), (1, 1, 500.0));
}

#[test]
fn faults_name_their_place() {
    for (text, line, wanted) in [
        ("[[joint]]\nname = \"bend\"\n", 3, "joint \"bend\" is not there, expected one of \"turn\", \"slide\""),
        ("[[joint]]\nname = \"turn\"\n[[joint]]\nname = \"turn\"\n", 5, "is there twice"),
        ("[[joint]]\nname = \"turn\"\nkind = \"revolute\"\n", 4, "unknown field `kind`"),
        ("convention = \"standard\"\n", 2, "unknown field `convention`"),
        ("effort = \"current\"\n", 1, "joint \"turn\" has no [joint.drive], expected one with gear"),
        ("effort = \"current\"\n[[joint]]\nname = \"turn\"\n", 4, "joint \"turn\" has no [joint.drive]"),
        ("effort = \"current\"\n[[joint]]\nname = \"turn\"\n[joint.drive]\n", 3, "has no gear, expected one"),
        ("[[joint]]\nname = \"turn\"\n[joint.drive]\ntorque_constant_nm_a = 1\n", 2, "has no gear, expected one"),
        (
            "[[joint]]\nname = \"turn\"\n[joint.terms]\nrotor = 1\n",
            5,
            "unknown field `rotor`, expected one of `rotor_kg_m2`",
        ),
        ("[[joint]]\nname = \"turn\"\n[joint.terms]\nrotor_kg = 1\n", 5, "expected rotor_kg_m2"),
        ("[[joint]]\nname = \"turn\"\n[joint.terms]\nrotor_kg_m2 = -1\n", 5, "expected a number not below zero"),
        ("[[joint]]\nname = \"slide\"\n[joint.limits]\nposition_deg = [0, 1]\n", 5, "expected position_m"),
        ("tip_link = \"hand\"\n", 1, "arm.urdf, line 1, column 1: "),
    ] {
        let fault = parse_robot(&robot(text)).unwrap_err();
        assert!(fault.message.contains(wanted), "{text}: {fault}");
        assert_eq!(fault.line, line, "{text}: {fault}");
    }
    let fault = parse_robot("urdf = \"arm.urdf\"\n").unwrap_err();
    assert!(fault.message.contains("is not with this text"), "{fault}");
    assert_eq!((fault.line, fault.column), (1, 8));
    assert!(parse_robot("urdf = 3\n").unwrap_err().message.contains("expected the path of a file"));
}

#[test]
fn identity_a_file_with_its_gaps_reads_as_the_urdf_and_every_gap_is_a_key() {
    let ends = ChainEnds { base: None, tip: Some("slider".to_owned()) };
    let model = parse_urdf(URDF, &ends).unwrap();
    let text = write_robot(&model, "arm.urdf", &ends);
    assert!(text.lines().all(|line| line.chars().count() <= 120), "{text}");
    let read = parse_robot_model(&embed_urdf(&text, URDF)).unwrap();
    assert_eq!(read.parameters.as_ref(), Some(&model.parameters));
    // The file states the servo that is assumed of a robot that states none.
    let servo = *model.robot.servo();
    let with_servo = |robot: &crate::model::Robot| robot.clone().with_spec(|spec| spec.servo = Some(servo)).unwrap();
    assert_eq!(with_servo(&read.robot.clone().with_source(URDF)), with_servo(&model.robot));
    // What a joint states is no gap.
    let turn = text.split("[[joint]]").nth(1).unwrap();
    for stated in ["position_deg", "velocity_deg_s", "torque_nm ", "viscous"] {
        assert!(!turn.contains(&format!("# {stated}")), "{stated} in {turn}");
    }
    assert!(text.split("[[joint]]").nth(2).unwrap().contains("has no <inertial>"), "{text}");
    // Filled in one by one, headings with them, each gap is read; all together too.
    let value = |key: &str| match key {
        "drives" => "\"belt\"",
        "gravity_m_s2" => "[0, 0, -9.8]",
        "roll_pitch_yaw_deg" => "[0, 90, 0]",
        "motor_from_joint" => "[[1, 0], [0.5, 1]]",
        "position_m" | "position_deg" => "[0, 0.4]",
        _ => "1.5",
    };
    let gaps: Vec<&str> = text.lines().filter(|line| line.contains(" = ?")).collect();
    assert!(gaps.len() > 20, "{text}");
    let mut all = text.clone();
    for gap in gaps {
        let key = gap.trim_start_matches("# ").split(' ').next().unwrap();
        let filled = gap.trim_start_matches("# ").replacen('?', value(key), 1);
        all = all.replacen(gap, &filled, 1);
    }
    for heading in ["[base]", "[coupling]", "[floor]"] {
        all = all.replace(&format!("# {heading}"), heading);
    }
    let filled = parse_robot_model(&embed_urdf(&all, URDF)).unwrap_or_else(|fault| panic!("{fault}\n{all}"));
    assert!(filled.robot.is_coupled(1) && filled.robot.joints()[1].drive.gear == 1.5, "{all}");
    assert_eq!(filled.parameters.unwrap().drives[0][ROTOR], 1.5);
}
