//! What the simulated arms are made of, as texts. Nothing above this module can name it.

/// The `truth.toml` of a robot that is compiled in, by the name that [`bundled`](crate::model::bundled) gives it.
///
/// ```
/// use armid::{model::bundled, study::truth_text};
/// assert!(bundled().iter().all(|robot| truth_text(robot.name).is_some()));
/// assert!(truth_text("no such robot").is_none());
/// ```
#[must_use]
pub fn truth_text(robot: &str) -> Option<&'static str> {
    match robot {
        "crs-a460" => Some(include_str!("../../models/crs-a460/truth.toml")),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::bundled;
    use crate::model::format::{parse_nominal, parse_parameters, parse_robot};

    #[test]
    fn identity_every_truth_is_physically_consistent_and_another_than_the_guess() {
        for entry in bundled() {
            let robot = parse_robot(entry.robot).unwrap();
            let text = truth_text(entry.name).expect("a truth for every bundled robot");
            let truth = parse_parameters(text, &robot, true).unwrap_or_else(|fault| panic!("{}: {fault}", entry.name));
            let nominal = parse_nominal(entry.nominal, &robot).unwrap();
            for (i, (a, b)) in truth.parameters.links.iter().zip(&nominal.parameters.links).enumerate() {
                assert!((a.mass - b.mass).abs() <= 0.4 * a.mass, "{} link {}", entry.name, i + 1);
                assert_ne!(a, b, "{} link {}", entry.name, i + 1);
            }
            // A source for every link and drive.
            assert_eq!(truth.notes.len(), 2 * robot.dof(), "{}", entry.name);
        }
    }

    #[test]
    fn published_a460_weighs_what_a_crs_arm_weighs() {
        let entry = bundled().iter().find(|entry| entry.name == "crs-a460").unwrap();
        let robot = parse_robot(entry.robot).unwrap();
        let truth = parse_parameters(truth_text("crs-a460").unwrap(), &robot, true).unwrap().parameters;
        // The CAD's 16.0 kg of structure, and 5 to 10 kg of motors and gears.
        let mass: f64 = truth.links.iter().map(|link| link.mass).sum();
        assert!((mass - 25.03).abs() < 1e-12, "{mass} kg");
    }
}
