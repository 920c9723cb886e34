//! The joints of a message in the order of the robot file.

use super::{LinkError, LinkSettings};
use crate::message::JointState;

/// One joint state in the order of the robot file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointRow {
    /// When it was taken, ns of the robot's clock.
    pub stamp_ns: i64,
    /// Positions, rad (m); n.
    pub q: Vec<f64>,
    /// Velocities, rad/s (m/s); n, or none where the robot does not report them.
    pub qd: Vec<f64>,
    /// Efforts or currents as the robot file says; n.
    pub effort: Vec<f64>,
}

/// Where each joint of the robot stands in a message: by its name, never by its place.
#[derive(Clone, Debug)]
pub struct JointMap {
    names: Vec<String>,
    others: Vec<String>,
    /// Whether joints that nobody named are passed over.
    open: bool,
    /// The names of the message before, and the place of each joint in it.
    last: Option<(Vec<String>, Vec<usize>)>,
}

impl JointMap {
    /// The map for joints called `joints` in the robot file.
    ///
    /// # Errors
    /// [`LinkError::Setting`] where `joint_names` renames a joint that does not exist, or two to the same name.
    pub fn new(joints: &[String], settings: &LinkSettings) -> Result<Self, LinkError> {
        let fault = |found: String, expected| LinkError::Setting { key: "joint_names", found, expected };
        if let Some(stranger) = settings.joint_names.keys().find(|name| !joints.contains(name)) {
            return Err(fault(format!("for \"{stranger}\""), "joints of the robot file"));
        }
        let names: Vec<String> =
            joints.iter().map(|joint| settings.joint_names.get(joint).unwrap_or(joint).clone()).collect();
        if let Some(twice) = duplicate(&names) {
            return Err(fault(format!("\"{twice}\" twice"), "a name for each joint"));
        }
        Ok(Self { names, others: settings.other_joints.clone(), open: false, last: None })
    }

    /// Passes over joints that nobody named from now on: a gripper that starts later is no other robot.
    pub fn pass_over_others(&mut self) {
        self.open = true;
    }

    /// The robot's names of the joints, in the order of the robot file.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The message in the order of the robot file; none where it is about no joint of the arm, as a gripper's own.
    ///
    /// # Errors
    /// [`LinkError::Joints`] where a joint is missing, unknown or named twice; [`LinkError::Length`] where a list has
    /// not one value for each name.
    pub fn row(&mut self, state: &JointState) -> Result<Option<JointRow>, LinkError> {
        if !state.name.is_empty() && !state.name.iter().any(|name| self.names.contains(name)) {
            return Ok(None);
        }
        let places = match self.last.take() {
            Some((names, places)) if names == state.name => places,
            _ => self.places(&state.name)?,
        };
        let expected = state.name.len();
        for (quantity, list, may_be_empty) in [
            ("position", &state.position, false),
            ("velocity", &state.velocity, true),
            ("effort", &state.effort, false),
        ] {
            if list.len() != expected && !(may_be_empty && list.is_empty()) {
                return Err(LinkError::Length { quantity, found: list.len(), expected });
            }
        }
        let take = |list: &[f64]| -> Vec<f64> {
            if list.is_empty() { Vec::new() } else { places.iter().map(|&place| list[place]).collect() }
        };
        let (q, qd, effort) = (take(&state.position), take(&state.velocity), take(&state.effort));
        self.last = Some((state.name.clone(), places));
        Ok(Some(JointRow { stamp_ns: state.header.stamp.ns(), q, qd, effort }))
    }

    /// The positions alone, of a message that need not be right in anything else.
    pub(crate) fn positions(&self, state: &JointState) -> Option<JointRow> {
        let place = |name| state.name.iter().position(|found| found == name);
        let q = self.names.iter().map(|name| state.position.get(place(name)?).copied());
        let q = q.collect::<Option<Vec<f64>>>().filter(|_| duplicate(&state.name).is_none())?;
        Some(JointRow { stamp_ns: state.header.stamp.ns(), q, ..JointRow::default() })
    }

    /// Where each joint stands among `found`.
    ///
    /// # Errors
    /// [`LinkError::Joints`] where one is missing, unknown or there twice.
    pub fn places(&self, found: &[String]) -> Result<Vec<usize>, LinkError> {
        let fault = |fault: String| LinkError::Joints { fault, found: found.to_vec(), expected: self.names.clone() };
        if let Some(twice) = duplicate(found) {
            return Err(fault(format!("joint \"{twice}\" is there twice")));
        }
        let known = |name: &String| self.open || self.names.contains(name) || self.others.contains(name);
        if let Some(stranger) = found.iter().find(|name| !known(name)) {
            return Err(fault(format!(
                "joint \"{stranger}\" is unknown; other_joints in [ros2] names those of no part of the arm"
            )));
        }
        let place = |name: &String| {
            found.iter().position(|other| other == name).ok_or_else(|| fault(format!("joint \"{name}\" is missing")))
        };
        self.names.iter().map(place).collect()
    }
}

fn duplicate(names: &[String]) -> Option<&String> {
    names.iter().enumerate().find(|(i, name)| names[..*i].contains(name)).map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::message::{Header, Time};

    fn strings(names: &[&str]) -> Vec<String> {
        names.iter().map(|&name| name.to_owned()).collect()
    }

    fn state(names: &[&str], position: &[f64]) -> JointState {
        JointState {
            header: Header { stamp: Time { sec: 2, nanosec: 5 }, frame_id: String::new() },
            name: strings(names),
            position: position.to_vec(),
            velocity: Vec::new(),
            effort: position.iter().map(|q| -q).collect(),
        }
    }

    #[test]
    fn joints_are_found_by_name_whatever_their_order() {
        let settings = LinkSettings {
            joint_names: [("elbow".to_owned(), "j2".to_owned())].into(),
            other_joints: strings(&["gripper"]),
            ..Default::default()
        };
        let mut map = JointMap::new(&strings(&["waist", "elbow"]), &settings).unwrap();
        for (names, position) in
            [(vec!["waist", "j2"], vec![1.0, 2.0]), (vec!["j2", "gripper", "waist"], vec![2.0, 9.0, 1.0])]
        {
            let row = map.row(&state(&names, &position)).unwrap().unwrap();
            assert_eq!((row.q, row.effort, row.stamp_ns), (vec![1.0, 2.0], vec![-1.0, -2.0], 2_000_000_005));
            assert!(row.qd.is_empty());
        }
    }

    #[test]
    fn wrong_names_and_lengths_are_told() {
        let joints = strings(&["a", "b"]);
        let mut map = JointMap::new(&joints, &LinkSettings::default()).unwrap();
        for (names, word) in [
            (vec!["a"], "\"b\" is missing"),
            (vec!["a", "b", "c"], "\"c\" is unknown"),
            (vec!["a", "b", "a"], "\"a\" is there twice"),
            (vec![], "\"a\" is missing"),
        ] {
            let message = map.row(&state(&names, &vec![0.0; names.len()])).unwrap_err().to_string();
            assert!(message.contains(word), "{message}");
        }
        // A gripper's own message is not about the arm, and later it may be in the arm's as well.
        assert_eq!(map.row(&state(&["c"], &[0.5])), Ok(None));
        let (both, twice) = (state(&["c", "a", "b"], &[9.0, 1.0, 2.0]), state(&["a", "b", "b"], &[1.0, 2.0, 3.0]));
        assert_eq!(map.positions(&both).unwrap().q, [1.0, 2.0]);
        assert!(map.positions(&twice).is_none() && map.positions(&state(&["a"], &[1.0])).is_none());
        let mut later = map.clone();
        later.pass_over_others();
        assert_eq!(later.row(&both).unwrap().unwrap().q, [1.0, 2.0]);
        assert!(later.row(&twice).is_err() && later.row(&state(&["a", "c"], &[1.0, 9.0])).is_err());
        let mut short = state(&["a", "b"], &[1.0, 2.0]);
        short.effort.pop();
        assert_eq!(map.positions(&short).unwrap().q, [1.0, 2.0]);
        assert_eq!(map.row(&short), Err(LinkError::Length { quantity: "effort", found: 1, expected: 2 }));
        let renamed = |from: &str, to: &str| LinkSettings {
            joint_names: [(from.to_owned(), to.to_owned())].into(),
            ..Default::default()
        };
        assert!(JointMap::new(&joints, &renamed("z", "y")).is_err());
        assert!(JointMap::new(&joints, &renamed("a", "b")).is_err());
    }
}
