//! A trajectory file with its certificate: the table `[certificate]` behind the motion.

use serde::{Deserialize, Serialize};

use super::certificate::Certificate;
use super::error::ExcitationError;
use crate::trajectory::PeriodicTrajectory;

#[derive(Serialize)]
struct Out<'a> {
    certificate: &'a Certificate,
}

#[derive(Deserialize)]
struct In {
    certificate: Option<toml::Value>,
}

impl Certificate {
    /// The file of a trajectory with this certificate. [`PeriodicTrajectory::from_toml`] reads the motion, [`Self::from_toml`]
    /// the certificate.
    pub fn to_toml_with(&self, trajectory: &PeriodicTrajectory) -> String {
        let table =
            toml::to_string(&Out { certificate: self }).expect("names, numbers and lists of them have a TOML form");
        format!(
            "# Units: s, rad, rad/s (m, m/s for a prismatic joint).\n# {}\n{}\n# Value of the criteria and use of the limits; a run verifies it again.\n{table}",
            trajectory.formula(),
            trajectory.to_toml()
        )
    }

    /// The certificate of a trajectory file; `None` where it has none.
    ///
    /// # Errors
    /// [`ExcitationError::Certificate`] if the table is there and is not a certificate.
    pub fn from_toml(text: &str) -> Result<Option<Self>, ExcitationError> {
        let fault =
            |error: toml::de::Error| ExcitationError::Certificate { message: error.message().trim_end().to_owned() };
        let file: In = toml::from_str(text).map_err(fault)?;
        file.certificate.map(|table| table.try_into().map_err(fault)).transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains;
    use crate::excitation::effort::EffortModel;
    use crate::excitation::{
        CriterionKind, DesignBudget, DesignLimits, DesignProblem, LimitKind, VerificationError, verify_certificate,
    };
    use crate::model::{Columns, Obstacle};
    use crate::spatial::Inertia;
    use crate::trajectory::table_one;

    fn certified() -> (DesignProblem, PeriodicTrajectory, Certificate) {
        let mut problem =
            DesignProblem::new(chains::crs_a460(), Columns::RIGID, CriterionKind::Condition, DesignLimits::motion())
                .unwrap();
        let nominal = Some(chains::crs_a460_nominal());
        problem.set_limits(DesignLimits { nominal, ramp_s: Some(2.0), ..DesignLimits::motion() }).unwrap();
        problem.set_budget(DesignBudget { certificate_samples: 500, ..DesignBudget::default() }).unwrap();
        let mut series = table_one::corrected();
        for (moved, joint) in series.joints.iter_mut().zip(problem.robot().joints()) {
            moved.name.clone_from(&joint.name);
        }
        let motion: PeriodicTrajectory = series.into();
        let certificate = Certificate::new(&problem, &motion).unwrap();
        (problem, motion, certificate)
    }

    #[test]
    fn identity_a_certified_file_reads_back() {
        let (_, motion, certificate) = certified();
        let text = certificate.to_toml_with(&motion);
        assert_eq!(PeriodicTrajectory::from_toml(&text).unwrap(), motion);
        assert_eq!(Certificate::from_toml(&text).unwrap().unwrap(), certificate);
        assert_eq!(Certificate::from_toml(&motion.to_toml()).unwrap(), None);
        let broken = text.replace("trajectory_sha256", "trajectory_sha");
        assert!(Certificate::from_toml(&broken).unwrap_err().to_string().contains("trajectory_sha256"));
    }

    #[test]
    fn verification_refuses_what_does_not_fit() {
        let (problem, motion, certificate) = certified();
        let robot = problem.robot();
        assert_eq!(verify_certificate(robot, &motion, &certificate, None), Ok(()));
        let mut other = motion.clone();
        other.adjust(2, 0.9, 0.0);
        assert!(matches!(
            verify_certificate(robot, &other, &certificate, None),
            Err(VerificationError::OtherTrajectory { .. })
        ));
        let elsewhere = robot.clone().with_source("another file");
        assert!(matches!(
            verify_certificate(&elsewhere, &motion, &certificate, None),
            Err(VerificationError::OtherRobot { .. })
        ));
        let slow = robot.clone().with_joints(|joint| joint.limits.velocity = 1.0).unwrap();
        let fault = verify_certificate(&slow, &motion, &certificate, None).unwrap_err();
        assert!(matches!(fault, VerificationError::Limit { limit: LimitKind::Velocity, .. }), "{fault}");
        assert!(fault.to_string().contains("exceeds its limit") && fault.to_string().contains("rad/s"), "{fault}");
        let smooth = robot.clone().with_joints(|joint| joint.limits.jerk = 1.0).unwrap();
        assert!(matches!(
            verify_certificate(&smooth, &motion, &certificate, None),
            Err(VerificationError::Limit { limit: LimitKind::Jerk, .. })
        ));
        let low = robot.clone().with_obstacle(Obstacle::everything_below("table", 0.8));
        let fault = verify_certificate(&low, &motion, &certificate, None).unwrap_err();
        assert!(matches!(fault, VerificationError::Contact(_)) && fault.to_string().contains("\"table\""), "{fault}");
        let mut strained = certificate.clone();
        strained.worst.torque.as_mut().unwrap().ratio = 1.2;
        // A changed figure breaks the checksum; a certificate that was made that way says what it asks.
        assert_eq!(verify_certificate(robot, &motion, &strained, None), Err(VerificationError::Changed));
        let strained = strained.with_checksum();
        let fault = verify_certificate(robot, &motion, &strained, None).unwrap_err();
        assert!(matches!(fault, VerificationError::Limit { limit: LimitKind::Torque, .. }), "{fault}");
    }

    #[test]
    fn verification_computes_torque_anew_by_the_parameters_at_hand() {
        let (problem, motion, certificate) = certified();
        let mut model = problem.efforts().unwrap();
        assert_eq!(verify_certificate(problem.robot(), &motion, &certificate, Some(&mut model)), Ok(()));
        // A certificate with a valid checksum that states less than the parameters ask is refused all the same.
        let mut flattering = certificate.clone();
        flattering.worst_limit_use.torque = Some(0.1);
        let fault =
            verify_certificate(problem.robot(), &motion, &flattering.with_checksum(), Some(&mut model)).unwrap_err();
        assert!(matches!(fault, VerificationError::Stale { limit: LimitKind::Torque, .. }), "{fault}");
        // So is one that was made for lighter links.
        let heavier = |factor: f64| {
            let mut nominal = problem.limits().nominal.as_ref().unwrap().clone();
            for link in &mut nominal.links {
                *link = Inertia::from_array(&link.to_array().map(|x| factor * x));
            }
            EffortModel::new(problem.robot(), &nominal, None)
        };
        let fault = verify_certificate(problem.robot(), &motion, &certificate, Some(&mut heavier(1.01))).unwrap_err();
        assert!(matches!(fault, VerificationError::OtherParameters { .. }), "{fault}");
        let fault = verify_certificate(problem.robot(), &motion, &certificate, Some(&mut heavier(3.0))).unwrap_err();
        assert!(matches!(fault, VerificationError::Limit { limit: LimitKind::Torque, .. }), "{fault}");
    }
}
