//! What one `study.toml` describes: a study on one robot, or the same study on each of several.

use super::own_methods::OwnMethods;
use super::plan::StudyPlan;
use super::plan_error::{StudyPlanError, name, number};
use crate::input::check_file_name;
use crate::input::size::ROBOTS;
use crate::model::format::FormatError;

/// The studies of one text.
#[derive(Clone, Debug, PartialEq)]
pub enum StudyPlans {
    /// On one robot: `robot = "crs-a460"`.
    One(Box<StudyPlan>),
    /// On each robot of `robots = ["crs-a460", "puma-560"]`, in their order. Each plan is the one that a text with that
    /// robot alone, and without the families that other robots have for themselves, gives.
    OnRobots(Vec<StudyPlan>),
}

impl StudyPlans {
    /// Reads a `study.toml`.
    ///
    /// # Errors
    /// [`FormatError`] with line and column where the text is not TOML, has a key too many or too few, or asks for
    /// something that does not exist.
    pub fn from_toml(text: &str) -> Result<Self, FormatError> {
        Self::from_toml_with(text, &OwnMethods::default())
    }

    /// Reads the plans of a text that may also name methods from outside.
    ///
    /// # Errors
    /// As [`StudyPlans::from_toml`].
    pub fn from_toml_with(text: &str, own: &OwnMethods) -> Result<Self, FormatError> {
        let mut plan: StudyPlan = toml::from_str(text).map_err(|fault| FormatError::of_toml(text, &fault))?;
        for grid in std::mem::take(&mut plan.grid) {
            plan.designs.extend(grid.designs());
        }
        plan.check_robots().map_err(|fault| fault.in_text(text))?;
        let robots = std::mem::take(&mut plan.robots);
        if robots.is_empty() {
            let plan = plan.for_robot(&plan.robot);
            plan.check_with(own).map_err(|fault| fault.in_text(text))?;
            return Ok(Self::One(Box::new(plan)));
        }
        let plans: Vec<StudyPlan> = robots.iter().map(|robot| plan.for_robot(robot)).collect();
        let faults: Vec<Option<StudyPlanError>> = plans.iter().map(|plan| plan.check_with(own).err()).collect();
        if let Some((plan, fault)) = plans.iter().zip(&faults).find_map(|(plan, fault)| Some((plan, fault.as_ref()?))) {
            let mut error = fault.in_text(text);
            // What is wrong on one robot alone is so by the families that it has.
            if faults.iter().any(|other| other.as_ref() != Some(fault)) {
                error.message = format!("on {}: {}", plan.robot, error.message);
            }
            return Err(error);
        }
        Ok(Self::OnRobots(plans))
    }

    /// The plan on each robot, in order.
    pub fn plans(&self) -> &[StudyPlan] {
        match self {
            Self::One(plan) => std::slice::from_ref(&**plan),
            Self::OnRobots(plans) => plans,
        }
    }

    /// The plans, to be changed.
    pub fn plans_mut(&mut self) -> &mut [StudyPlan] {
        match self {
            Self::One(plan) => std::slice::from_mut(&mut **plan),
            Self::OnRobots(plans) => plans,
        }
    }
}

impl StudyPlan {
    /// Reads a `study.toml` of a study on one robot.
    ///
    /// # Errors
    /// As [`StudyPlans::from_toml`], and where the text has `robots`.
    pub fn from_toml(text: &str) -> Result<Self, FormatError> {
        match StudyPlans::from_toml(text)? {
            StudyPlans::One(plan) => Ok(*plan),
            StudyPlans::OnRobots(plans) => {
                let found = plans.into_iter().map(|plan| plan.robot).collect();
                Err(StudyPlanError::Robots { found, expected: "one robot here, as robot = \"…\"" }.in_text(text))
            }
        }
    }

    /// What the folder of a study on this robot is called beside those on others: the robot's name, or its path in one word.
    pub fn robot_folder(&self) -> String {
        folder_of(&self.robot)
    }

    /// The plan on one robot, with the families that are made on it.
    fn for_robot(&self, robot: &str) -> Self {
        let mut plan = Self { robot: robot.to_owned(), robots: Vec::new(), ..self.clone() };
        plan.designs.retain(|family| family.robots.is_empty() || family.robots.iter().any(|name| name == robot));
        for family in &mut plan.designs {
            family.robots.clear();
        }
        plan
    }

    /// Checks what a text says of robots, before it becomes a plan for each.
    fn check_robots(&self) -> Result<(), StudyPlanError> {
        if !self.robots.is_empty() && !self.robot.is_empty() {
            let expected = "no robot = \"…\" beside it: one of the two keys";
            return Err(StudyPlanError::Robots { found: self.robots.clone(), expected });
        }
        if self.robots.is_empty() {
            self.check_robot()?;
        }
        ROBOTS.check_count("robots", self.robots.len())?;
        for (i, robot) in self.robots.iter().enumerate() {
            check_file_name("robots", &folder_of(robot))?;
            if self.robots[..i].iter().any(|other| folder_of(other) == folder_of(robot)) {
                return Err(StudyPlanError::Twice { key: "robots", found: robot.clone() });
            }
        }
        let all = if self.robots.is_empty() { std::slice::from_ref(&self.robot) } else { &self.robots[..] };
        let named = self.designs.iter().flat_map(|family| &family.robots);
        match named.into_iter().find(|robot| !all.contains(robot)) {
            Some(found) => Err(name("design.robots", found, all.iter().map(String::as_str))),
            None => Ok(()),
        }
    }

    /// Checks that the plan has its one robot.
    pub(super) fn check_robot(&self) -> Result<(), StudyPlanError> {
        if self.robot.is_empty() {
            return Err(number(
                "robot",
                "absent",
                "a bundled name or a path; robots = [\"…\", \"…\"] where it is several",
            ));
        }
        Ok(())
    }
}

/// A robot's name or path as the name of one folder.
fn folder_of(robot: &str) -> String {
    robot.replace(['/', '\\', ':'], "-").trim_start_matches(['.', '-']).to_owned()
}

#[cfg(test)]
mod tests {
    use super::folder_of;

    #[test]
    fn a_folder_of_a_robot_is_one_name_that_is_not_hidden() {
        assert_eq!(folder_of("crs-a460"), "crs-a460");
        assert_eq!(folder_of("../arms/ur5/robot.toml"), "arms-ur5-robot.toml");
        assert_eq!(folder_of(r"C:\arms\ur5.toml"), "C--arms-ur5.toml");
    }
}
