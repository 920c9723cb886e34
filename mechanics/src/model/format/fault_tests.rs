//! Every fault of `robot.toml` and of the parameter files, each with the line and the column that it must name.

use super::{FormatError, parse_nominal, parse_parameters, parse_robot, write_parameters};
use crate::model::term::{MOTOR_COULOMB, MOTOR_VISCOUS, OFFSET, ROTOR};
use crate::model::{EffortInterface, JointKind, Obstacle, ServoTuning};
use crate::spatial::Inertia;

/// A revolute and a prismatic joint with everything that a robot file can say.
pub(super) const TWO_JOINTS: &str = r#"name = "pair"
convention = "modified"
gravity_m_s2 = [0.0, 0.0, -9.8]
effort = "torque"

[base]
position_m = [0.0, 0.0, 0.32]
roll_pitch_yaw_deg = [0, 90, 0]

[servo]
rate_hz = 5000
bandwidth_hz = 10
damping = 0.7
integral_hz = 0.2

[[joint]]
name = "turn"
kind = "revolute"
dh = { offset_deg = 90, d_m = 0.1, a_m = 0.0, alpha_deg = 0 }
[joint.limits]
position_deg = [-90, 180]
velocity_deg_s = 180
acceleration_rad_s2 = 12
torque_nm = 40
[joint.drive]
gear = 50
counts_per_revolution = 4096
encoder_sign = -1
current_noise_a = 0.01
adc_range_a = 10
adc_bits = 12
coulomb_velocity_rad_s = 0.01

[[joint]]
name = "slide"
kind = "prismatic"
dh = { offset_deg = 0, d_m = 0.2, a_m = 0.1, alpha_deg = 90 }
[joint.limits]
position_m = [0, 0.5]
velocity_m_s = 1.5
acceleration_m_s2 = 4
force_n = 300
[joint.drive]
gear_rad_m = 200
torque_constant_nm_a = 0.1
counts_per_m = 1e6

[coupling]
motor_from_joint = [[1, 0], [0.5, 1]]

[[shape]]
link = "slide"
from_m = [0, 0, 0]
to_m = [0, 0, 0.3]
radius_m = 0.05

[floor]
z_m = -0.32
"#;

const PARAMETERS: &str = r#"[[link]]
name = "turn"
source = "weighed"
mass_kg = 2.0
com_m = [0.0, 0.0, 0.5]
inertia_about_com_kg_m2 = { xx = 0.02, yy = 0.02, zz = 0.01, xy = 0.0, xz = 0.001, yz = 0.0 }

[[link]]
name = "slide"
mass_kg = 1.0
first_moment_kg_m = [0.1, 0.0, 0.0]
inertia_kg_m2 = { xx = 0.02, yy = 0.03, zz = 0.03, xy = 0.0, xz = 0.0, yz = 0.0 }

[[drive]]
joint = "turn"
rotor_kg_m2 = 0.1
viscous_nm_s_rad = 1.5
coulomb_nm = 2.5
offset_nm = -0.5

[[drive]]
joint = "slide"
source = "guessed"
rotor_kg = 3
motor_viscous_n_s_m = 0.7
"#;

const UNCERTAINTY: &str = "[relative_uncertainty]\nmass = 0.3\nfirst_moment = 0.3\ninertia = 0.3\nrotor = 0.2\nviscous = 0.5\ncoulomb = 0.5\noffset_nm = 1\n";

/// Parses a text in which `¶` stands before the place that the fault must name.
pub(super) fn expect_fault<T>(parse: impl Fn(&str) -> Result<T, FormatError>, marked: &str, says: &str) {
    let lines: Vec<&str> = marked.split('\n').collect();
    let line = lines.iter().position(|line| line.contains('¶')).expect("a mark");
    let column = lines[line].chars().position(|c| c == '¶').expect("a mark");
    match parse(&marked.replace('¶', "")) {
        Ok(_) => panic!("accepted: {}", lines[line]),
        Err(fault) => {
            assert_eq!((fault.line, fault.column), (line + 1, column + 1), "{fault} in: {}", lines[line]);
            assert!(fault.message.contains(says), "{fault} does not say {says}");
        }
    }
}

fn replaced(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1)
}

#[test]
fn analytic_a_robot_file_is_read_with_its_units() {
    let robot = parse_robot(TWO_JOINTS).unwrap();
    assert_eq!(robot.effort(), EffortInterface::Torque);
    assert_eq!(
        *robot.servo(),
        ServoTuning { rate_hz: 5000.0, bandwidth_hz: 10.0, damping: 0.7, integral_hz: 0.2, friction: false }
    );
    let [turn, slide] = robot.joints() else { panic!("two joints") };
    assert_eq!(turn.limits.position, (-std::f64::consts::FRAC_PI_2, std::f64::consts::PI));
    assert_eq!(turn.limits.velocity, std::f64::consts::PI);
    assert_eq!((turn.limits.acceleration, turn.limits.torque), (12.0, 40.0));
    // The effort is the joint's own, so the drive passes it through.
    assert!((turn.drive.torque_per_ampere() - 1.0).abs() < 1e-15);
    assert_eq!(slide.kind, JointKind::Prismatic);
    assert_eq!((slide.limits.position, slide.limits.velocity), ((0.0, 0.5), 1.5));
    assert_eq!(slide.drive.encoder_step(false), 1e-6);
    assert_eq!(robot.obstacles(), [Obstacle::Floor { z: -0.32 }]);
    assert_eq!(robot.shapes()[0].link, 2);
    assert!(robot.is_coupled(1) && !robot.is_coupled(0));
    // The base is pitched by 90°: gravity, down in the world, points along +x of the base.
    assert_eq!(robot.gravity().as_slice(), [9.8, 0.0, 0.0]);
}

#[test]
fn analytic_every_fault_of_a_robot_file_names_its_place() {
    for (from, to, says) in [
        ("name = \"pair\"", "¶nam = \"pair\"", "unknown field `nam`"),
        ("name = \"pair\"", "name = ¶3", "expected a string"),
        ("\"modified\"", "¶\"khalil\"", "expected `standard` or `modified`"),
        ("\"torque\"", "¶\"volts\"", "expected `current` or `torque`"),
        ("[0.0, 0.0, -9.8]", "¶[0.0, -9.8]", "gravity_m_s2 has 2 numbers, expected 3"),
        ("-9.8]", "¶nan]", "gravity_m_s2 is NaN, expected a finite number"),
        ("rate_hz = 5000", "rate_hz = ¶0", "rate_hz is 0, expected a number above zero"),
        ("integral_hz = 0.2", "integral_hz = ¶-1", "expected a number not below zero"),
        ("damping = 0.7", "damping = 0.7\n¶gain = 3", "unknown field `gain`"),
        ("\"revolute\"", "¶\"helical\"", "expected `revolute` or `prismatic`"),
        ("d_m = 0.1, ", "d = 0.1, ", "unknown field `d`"),
        ("gear = 50", "¶gaer = 50", "unknown field `gaer`"),
        ("gear = 50", "gear = ¶-50", "gear is -50, expected a number above zero"),
        ("gear = 50", "gear = ¶0", "gear is 0, expected a number above zero"),
        ("gear = 50", "gear_rad_m = ¶50", "gear_rad_m is given for a revolute joint, expected gear"),
        ("gear_rad_m = 200", "gear_rad_m = ¶nan", "gear_rad_m is NaN"),
        ("position_deg = [-90, 180]", "position_deg = ¶[180, -90]", "position_deg is [180, -90], expected the lower"),
        ("position_deg = [-90, 180]", "position_deg = ¶[-90]", "position_deg has 1 numbers, expected 2"),
        ("position_m = [0, 0.5]", "position_deg = ¶[0, 90]", "given for a prismatic joint, expected position_m"),
        ("velocity_deg_s = 180", "velocity_deg_s = ¶0.0", "velocity_deg_s is 0"),
        ("torque_nm = 40", "torque_nm = ¶-40", "torque_nm is -40"),
        ("acceleration_rad_s2 = 12", "acceleration_rad_s2 = ¶inf", "acceleration_rad_s2 is inf"),
        ("encoder_sign = -1", "encoder_sign = ¶2", "encoder_sign is 2, expected 1 or -1"),
        ("adc_bits = 12", "adc_bits = ¶40", "adc_bits is 40"),
        ("adc_bits = 12", "adc_bits = ¶-1", "expected u32"),
        ("adc_range_a = 10\nadc_bits = 12", "adc_bits = ¶12", "without adc_range_a"),
        ("name = \"slide\"", "name = ¶\"turn\"", "\"turn\" is taken"),
        ("name = \"slide\"", "name = ¶\"base\"", "\"base\" is taken"),
        (
            "link = \"slide\"",
            "link = ¶\"slid\"",
            "link \"slid\" is not there, expected \"base\" or one of \"turn\", \"slide\"",
        ),
        ("to_m = [0, 0, 0.3]", "to_m = ¶[0, 0.3]", "to_m has 2 numbers, expected 3"),
        ("radius_m = 0.05", "radius_m = ¶0", "radius_m is 0"),
        ("z_m = -0.32", "z_m = ¶nan", "z_m is NaN"),
        ("[[1, 0], [0.5, 1]]", "¶[[1, 0]]", "1 rows, expected 2"),
        ("[[1, 0], [0.5, 1]]", "[[1, 0], ¶[0.5]]", "row 2 of motor_from_joint has 1 numbers, expected 2"),
        ("[[1, 0], [0.5, 1]]", "¶[[1, 0], [1, 0]]", "singular"),
        ("[servo]", "[servo¶", "expected `]`"),
        (
            "[servo]",
            "[uncertainty]\n¶gravity = 0.1\n[servo]",
            "unknown field `gravity`, expected one of `torque_constant`",
        ),
        (
            "[servo]",
            "[uncertainty]\n¶viscous = -0.1\n[servo]",
            "viscous is -0.1, expected a finite number not below zero",
        ),
        ("name = \"pair\"\n", "¶", "missing field `name`"),
        ("[base]", "drives = ¶\"rubber\"\n[base]", "unknown variant `rubber`, expected one of `harmonic`"),
        ("rate_hz = 5000\n", "", "missing field `rate_hz`"),
    ] {
        let mut text = replaced(TWO_JOINTS, from, to);
        // A missing key is a fault of its table, whose header is named.
        if says == "missing field `rate_hz`" {
            text = replaced(&text, "[servo]", "¶[servo]");
        }
        if says == "unknown field `d`" {
            text = replaced(&text, "d = 0.1", "¶d = 0.1");
        }
        expect_fault(parse_robot, &text, says);
    }
    let current = replaced(TWO_JOINTS, "\"torque\"", "\"current\"");
    expect_fault(parse_robot, &replaced(&current, "[[joint]]", "¶[[joint]]"), "no torque_constant_nm_a");
    let no_gear = replaced(TWO_JOINTS, "gear = 50\n", "");
    expect_fault(parse_robot, &replaced(&no_gear, "[[joint]]", "¶[[joint]]"), "\"turn\" has no gear");
    let no_dh = replaced(TWO_JOINTS, "a_m = 0.0, ", "");
    expect_fault(parse_robot, &replaced(&no_dh, "{ offset_deg = 90", "¶{ offset_deg = 90"), "missing field `a_m`");
    expect_fault(parse_robot, "name = \"none\"\nconvention = \"standard\"\njoint = ¶[]\n", "at least one");
    // Counted by hand once: line 26 is `gear = 50`, and its value starts in column 8.
    let fault = parse_robot(&replaced(TWO_JOINTS, "gear = 50", "gear = -5")).unwrap_err();
    assert_eq!((fault.line, fault.column), (26, 8));
    assert_eq!(fault.to_string(), "line 26, column 8: gear is -5, expected a number above zero");
    assert_eq!(fault.span.map(|span| span.len()), Some(2));
}

#[test]
fn analytic_both_forms_of_a_link_are_read() {
    let robot = parse_robot(TWO_JOINTS).unwrap();
    let file = parse_parameters(PARAMETERS, &robot, true).unwrap();
    // Steiner on the first: 0.02 + 2 · 0.5² about x and y; the second form is as written.
    assert_eq!(file.parameters.links[0].to_array(), [2.0, 0.0, 0.0, 1.0, 0.52, 0.0, 0.001, 0.52, 0.0, 0.01]);
    assert_eq!(file.parameters.links[1], Inertia::from_array(&[1.0, 0.1, 0.0, 0.0, 0.02, 0.0, 0.0, 0.03, 0.0, 0.03]));
    assert_eq!(file.parameters.drives[0][OFFSET], -0.5);
    assert_eq!((file.parameters.drives[1][ROTOR], file.parameters.drives[1][MOTOR_VISCOUS]), (3.0, 0.7));
    let subjects: Vec<&str> = file.notes.iter().map(|note| note.subject.as_str()).collect();
    assert_eq!(subjects, ["link turn", "drive slide"]);
    let nominal = parse_nominal(&format!("{UNCERTAINTY}{PARAMETERS}"), &robot).unwrap();
    assert_eq!(nominal.parameters, file.parameters);
    assert_eq!((nominal.relative_uncertainty.of_term(ROTOR), nominal.relative_uncertainty.of_term(OFFSET)), (0.2, 1.0));
}

#[test]
fn analytic_every_fault_of_a_parameter_file_names_its_place() {
    let robot = parse_robot(TWO_JOINTS).unwrap();
    let parse = |text: &str| parse_parameters(text, &robot, true);
    for (from, to, says) in [
        ("mass_kg = 2.0", "¶mass = 2.0", "unknown field `mass`"),
        ("mass_kg = 2.0", "mass_kg = ¶nan", "mass_kg is NaN"),
        ("[0.0, 0.0, 0.5]", "¶[0.0, 0.5]", "com_m has 2 numbers, expected 3"),
        ("yy = 0.02", "yy = ¶inf", "yy is inf"),
        ("name = \"slide\"", "name = ¶\"slid\"", "link \"slid\" is not there, expected one of \"turn\", \"slide\""),
        ("name = \"slide\"", "name = ¶\"turn\"", "link \"turn\" is there twice"),
        ("joint = \"slide\"", "joint = ¶\"turn\"", "joint \"turn\" is there twice"),
        ("joint = \"slide\"", "joint = ¶\"arm\"", "joint \"arm\" is not there"),
        ("coulomb_nm = 2.5", "coulomb_nm = ¶-2.5", "coulomb_nm is -2.5, expected a number not below zero"),
        ("rotor_kg = 3", "rotor_kg_m2 = ¶3", "expected rotor_kg"),
        ("offset_nm = -0.5", "motor_coulomb_nm = ¶0.1", "only where the robot's coupling"),
        // A mass that is too small for its first moment, and principal moments against the triangle inequality.
        (
            "mass_kg = 1.0",
            "mass_kg = ¶0.1",
            "link \"slide\" is physically inconsistent: its pseudo-inertia has the eigenvalue -",
        ),
        ("mass_kg = 2.0", "mass_kg = ¶-2.0", "link \"turn\" is physically inconsistent"),
    ] {
        expect_fault(parse, &replaced(PARAMETERS, from, to), says);
    }
    let flat = replaced(PARAMETERS, "zz = 0.01", "zz = 0.10");
    expect_fault(parse, &replaced(&flat, "mass_kg = 2.0", "mass_kg = ¶2.0"), "physically inconsistent");
    assert!(parse_parameters(&flat, &robot, false).is_ok());
    let mixed = replaced(PARAMETERS, "com_m = [0.0, 0.0, 0.5]\n", "first_moment_kg_m = [0, 0, 1]\n");
    expect_fault(parse, &replaced(&mixed, "name = \"turn\"", "name = ¶\"turn\""), "the two forms");
    let (_, one_link) = PARAMETERS.split_at(PARAMETERS.rfind("[[link]]").unwrap());
    expect_fault(parse, &format!("¶{one_link}"), "link \"turn\" is missing");
    let product = replaced(PARAMETERS, "xy = 0.0, xz = 0.001", "xz = 0.001");
    expect_fault(parse, &replaced(&product, "{ xx = 0.02", "¶{ xx = 0.02"), "missing field `xy`");

    let parse = |text: &str| parse_nominal(text, &robot);
    let nominal = format!("{UNCERTAINTY}{PARAMETERS}");
    for (from, to, says) in [
        ("inertia = 0.3", "inertia = ¶-0.3", "inertia is -0.3"),
        ("rotor = 0.2\n", "", "missing field `rotor`"),
        ("mass_kg = 2.0", "mass_kg = ¶-2.0", "physically inconsistent"),
    ] {
        let mut text = replaced(&nominal, from, to);
        if to.is_empty() {
            text = format!("¶{text}");
        }
        expect_fault(parse, &text, says);
    }
}

#[test]
fn identity_what_is_written_is_read_back_to_the_last_bit() {
    let robot = parse_robot(TWO_JOINTS).unwrap();
    let mut parameters = parse_parameters(PARAMETERS, &robot, true).unwrap().parameters;
    // Numbers whose shortest decimal form is long.
    parameters.links[0].first_moment.x = 1.0 / 3.0;
    parameters.links[0].rotational[(2, 2)] = 1e-17;
    parameters.drives[1][MOTOR_COULOMB] = 2.0_f64.sqrt();
    parameters.drives[0][OFFSET] = -1e-300;
    let text = write_parameters(&robot, &parameters, "two lines\nof header");
    assert!(text.starts_with("# two lines\n# of header\n"));
    assert_eq!(parse_parameters(&text, &robot, false).unwrap().parameters, parameters);
}

/// What stands around the robot of two joints: a box on a link, a capsule, a wall, and a pair that may touch.
const SURROUNDINGS: &str = r#"
[[shape]]
link = "base"
centre_m = [0, 0, 0.1]
size_m = [0.2, 0.4, 0.6]
roll_pitch_yaw_deg = [0, 0, 90]

[[obstacle]]
name = "post"
from_m = [1, 0, 0]
to_m = [1, 0, 2]
radius_m = 0.05

[[obstacle]]
name = "wall"
normal = [0, -2, 0]
offset_m = -0.6

[[may_touch]]
links = ["slide", "base"]
"#;

#[test]
fn analytic_surroundings_are_read_and_their_faults_named() {
    use crate::model::Solid;
    let text = format!("{TWO_JOINTS}{SURROUNDINGS}");
    let robot = parse_robot(&text).unwrap();
    let Solid::Cuboid(cuboid) = robot.shapes().last().unwrap().solid else { panic!("a box") };
    assert_eq!(cuboid.half.as_slice(), [0.1, 0.2, 0.3]);
    assert_eq!(cuboid.placement.rotation.column(0).as_slice(), [0.0, 1.0, 0.0]);
    let [_, Obstacle::Body { name, solid: Solid::Capsule(post) }, Obstacle::Plane { normal, offset, .. }] =
        robot.obstacles()
    else {
        panic!("{:?}", robot.obstacles())
    };
    assert!(name == "post" && post.radius == 0.05);
    assert_eq!((normal.as_slice(), *offset), ([0.0, -1.0, 0.0].as_slice(), -0.6));
    assert_eq!(robot.may_touch(), [(0, 2)]);
    assert_eq!(robot.source_sha256(), crate::provenance::sha256(&text));
    for (from, to, says) in [
        ("to_m = [1, 0, 2]\n", "", "the body of \"post\" is neither a capsule nor a box"),
        ("normal = [0, -2, 0]", "normal = [0, 0, 0]", "normal has no direction"),
        ("offset_m = -0.6", "offset_m = -0.6\nradius_m = 1", "obstacle \"wall\" mixes kinds"),
        ("size_m = [0.2, 0.4, 0.6]", "size_m = [0.2, 0, 0.6]", "size_m has a length that is not above zero"),
        ("\"slide\", \"base\"", "\"slide\"", "links has 1 names, expected 2"),
        ("[\"slide\", \"base\"]", "[\"slide\", \"hand\"]", "link \"hand\" is not there"),
    ] {
        let fault = parse_robot(&replaced(&text, from, to)).unwrap_err().to_string();
        assert!(fault.contains(says), "{fault}");
    }
}
