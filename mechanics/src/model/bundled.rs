//! The robots that are compiled in, as texts.
//!
//! What the simulator takes as true is not among them: only `study` can name that, after every module that identifies.

/// One robot that is compiled in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BundledRobot {
    /// Its name on the command line; a folder of `models/`.
    pub name: &'static str,
    /// Its `robot.toml`.
    pub robot: &'static str,
    /// Its `nominal.toml`.
    pub nominal: &'static str,
}

macro_rules! robot {
    ($name:literal) => {
        BundledRobot {
            name: $name,
            robot: include_str!(concat!("../../models/", $name, "/robot.toml")),
            nominal: include_str!(concat!("../../models/", $name, "/nominal.toml")),
        }
    };
}

static ROBOTS: [BundledRobot; 4] =
    [robot!("crs-a460"), robot!("puma-560"), robot!("staubli-tx40"), robot!("planar-2r")];

/// Every robot that is compiled in.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::model::{bundled, format::parse_robot};
/// for entry in bundled() {
///     assert_eq!(parse_robot(entry.robot).unwrap().name(), entry.name);
/// }
/// ```
pub fn bundled() -> &'static [BundledRobot] {
    &ROBOTS
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::format::{parse_nominal, parse_robot, write_parameters};
    use crate::model::{Drive, Robot};

    fn robot(name: &str) -> Robot {
        let entry = bundled().iter().find(|entry| entry.name == name).expect("a bundled robot");
        parse_robot(entry.robot).unwrap()
    }

    #[test]
    fn identity_every_bundled_robot_obeys_the_laws() {
        for entry in bundled() {
            let robot = parse_robot(entry.robot).unwrap_or_else(|fault| panic!("{}: {fault}", entry.name));
            assert_eq!(robot.name(), entry.name);
            // Reading a nominal file checks the consistency of each link.
            let nominal =
                parse_nominal(entry.nominal, &robot).unwrap_or_else(|fault| panic!("{}: {fault}", entry.name));
            for joint in robot.joints() {
                let (low, high) = joint.limits.position;
                assert!(low.is_finite() && high.is_finite() && low < 0.0 && high > 0.0, "{}", joint.name);
                for limit in [joint.limits.velocity, joint.limits.acceleration, joint.limits.torque] {
                    assert!(limit.is_finite() && limit > 0.0, "{}", joint.name);
                }
                // A drive can give what its joint is rated for.
                if joint.drive != Drive::ideal() {
                    let most = joint.drive.torque_per_ampere() * joint.drive.current_limit;
                    assert!(most >= joint.limits.torque, "{} {}: {most} N·m", entry.name, joint.name);
                    let range = joint.drive.adc_range;
                    assert!(range >= joint.drive.current_limit, "{} {}: ±{range} A", entry.name, joint.name);
                }
            }
            let text = write_parameters(&robot, &nominal.parameters, entry.name);
            let back = crate::model::format::parse_parameters(&text, &robot, true).unwrap();
            assert_eq!(back.parameters, nominal.parameters);
        }
    }

    #[test]
    fn published_a460_stands_straight_up_at_zero() {
        let robot = robot("crs-a460");
        let poses = robot.poses(&[0.0; 6]);
        // The axis of joint i passes through the origin of frame i−1 of standard DH; heights from the DH table.
        let heights: Vec<f64> = poses.iter().map(|pose| pose.translation.z).collect();
        for (found, expected) in heights.iter().zip([0.3302, 0.6350, 0.6350, 0.9652, 0.9652, 1.0414]) {
            assert!((found - expected).abs() < 1e-15, "{heights:?}");
        }
        // Axes +z, −y, −y, +z, −y, +z, all through x = y = 0; a joint's axis is z of the frame before it.
        let axes =
            [[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]];
        for (pose, axis) in poses.iter().zip(&axes[1..]) {
            assert_eq!(pose.rotation.column(2).as_slice(), axis);
        }
        for pose in &poses {
            assert!(pose.translation.x.abs() < 1e-15 && pose.translation.y.abs() < 1e-15);
        }
        assert_eq!(poses[5].rotation, nalgebra::Matrix3::identity());
    }

    #[test]
    fn published_a460_limits_and_drives() {
        let robot = robot("crs-a460");
        let degrees = |f: fn(&crate::model::Joint) -> f64| -> Vec<f64> {
            robot.joints().iter().map(|joint| f(joint).to_degrees().round()).collect()
        };
        assert_eq!(degrees(|j| j.limits.position.1), [175.0, 90.0, 110.0, 180.0, 105.0, 180.0]);
        assert_eq!(degrees(|j| -j.limits.position.0), [175.0, 90.0, 110.0, 180.0, 105.0, 180.0]);
        assert_eq!(degrees(|j| j.limits.velocity), [180.0, 180.0, 180.0, 171.0, 173.0, 171.0]);
        for joint in robot.joints() {
            // 8e5 counts/s² on every axis, to the printed digits.
            let counts = joint.limits.acceleration * joint.drive.counts_per_revolution / std::f64::consts::TAU;
            assert!((counts / 8e5 - 1.0).abs() < 0.01, "{}: {counts}", joint.name);
        }
    }
}
