//! Which torque a design may expect of an effect, before the arm has moved.

use nalgebra::DMatrix;

use super::actual_arm::{ActualArm, Coupling};
use super::kind::EffectKind as Kind;
use super::selection::Effects;
use super::warming::Warming;
use crate::excitation::{Criterion, EffectLaw, ExpectedEffect, ExpectedEffects, WarmGears};
use crate::model::term::{COULOMB, MOTOR_COULOMB, MOTOR_VISCOUS, VISCOUS};
use crate::model::{DriveParameters, Robot, StandardParameters};

/// Why effects cannot be expected.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "each text says what its fields are")]
pub enum ExpectedEffectError {
    /// No law of the motion gives its torque: it has a memory, phases that nobody knows, or is one of the sensors.
    #[error("{} cannot be expected of a design, expected one of {}", found.name(), names())]
    NoLaw { found: Kind },
}

fn names() -> String {
    Effects::EXPECTABLE.map(Kind::name).join(", ")
}

impl Effects {
    /// Effects whose torque along a motion follows from the nominal parameters.
    pub const EXPECTABLE: [Kind; 7] = [
        Kind::Stribeck,
        Kind::LoadFriction,
        Kind::Elasticity,
        Kind::TorqueConstant,
        Kind::CurrentLag,
        Kind::CurrentDelay,
        Kind::Warming,
    ];

    /// What a criterion expects where nothing else is declared, each at its realistic level: load-dependent friction and
    /// elasticity, and for measured torque also what a drive reports wrongly or late, Stribeck friction and gears that warm up.
    pub fn expected_by(criterion: &dyn Criterion) -> Self {
        use Kind::{CurrentLag, Elasticity, LoadFriction, Stribeck, TorqueConstant, Warming};
        let kinds = [LoadFriction, Elasticity, CurrentLag, TorqueConstant, Stribeck, Warming];
        let count = if criterion.predicts_measured_torque() { kinds.len() } else { 2 };
        kinds[..count].iter().fold(Self::none(), |effects, &kind| effects.with_effect(kind, kind.entry().realistic))
    }

    /// These effects one by one, as a design expects them of `robot` with its `nominal` parameters: each magnitude is the
    /// standard deviation of what is expected.
    ///
    /// ```
    /// # use armid_measurement as armid;
    /// use armid::chains::planar_2r;
    /// use armid::experiment::{EffectKind, Effects, Level};
    /// use armid::model::StandardParameters;
    /// let effects = Effects::only(EffectKind::CurrentLag, Level::Realistic);
    /// let expected = effects.expected(&planar_2r(), &StandardParameters::zero(2)).unwrap();
    /// assert_eq!(expected.effects[0].name, "current-lag");
    /// let tilted = Effects::only(EffectKind::BaseTilt, Level::Realistic);
    /// assert!(tilted.expected(&planar_2r(), &StandardParameters::zero(2)).is_err());
    /// ```
    ///
    /// # Errors
    /// [`ExpectedEffectError`] if one has no law of the motion.
    pub fn expected(
        &self,
        robot: &Robot,
        nominal: &StandardParameters,
    ) -> Result<ExpectedEffects, ExpectedEffectError> {
        let effect = |(kind, magnitude): (Kind, f64)| {
            let law = match kind {
                Kind::CurrentLag => EffectLaw::Late(1e-3 * magnitude),
                Kind::CurrentDelay => EffectLaw::Late(magnitude / robot.servo().rate_hz),
                Kind::TorqueConstant => EffectLaw::Scaled(magnitude),
                Kind::Stribeck | Kind::LoadFriction => {
                    let arm = ActualArm::new(&Self::none().with_effect(kind, magnitude), robot, nominal);
                    EffectLaw::Terms(added(&arm.drives, &nominal.drives))
                }
                Kind::Elasticity => {
                    ActualArm::new(&Self::none().with_effect(kind, magnitude), robot, nominal).elastic_law(robot)
                }
                Kind::Warming => EffectLaw::Warming(warm_gears(robot, nominal, magnitude)),
                _ => return Err(ExpectedEffectError::NoLaw { found: kind }),
            };
            Ok(ExpectedEffect { name: kind.name().to_owned(), law })
        };
        let effects = self.iter().map(effect).collect::<Result<_, _>>()?;
        Ok(ExpectedEffects { nominal: nominal.clone(), effects, are_carried: false })
    }
}

/// The gears whose viscous friction falls by this share as they warm up: at the joints, and at the motors that turn them.
fn warm_gears(robot: &Robot, nominal: &StandardParameters, share: f64) -> WarmGears {
    let n = robot.dof();
    let motors = robot.coupling().cloned().unwrap_or_else(|| DMatrix::identity(n, n));
    let (mut rows, mut gears) = (Vec::new(), Vec::new());
    for (speeds, viscous, coulomb) in
        [(DMatrix::identity(n, n), VISCOUS, COULOMB), (motors, MOTOR_VISCOUS, MOTOR_COULOMB)]
    {
        for (i, (joint, drive)) in robot.joints().iter().zip(&nominal.drives).enumerate() {
            let (limit, lost) = (joint.limits.velocity, share * drive[viscous]);
            if lost > 0.0 {
                let gear = Warming::new(drive[viscous], drive[coulomb], limit);
                gears.push(gear.expected(lost, limit, joint.drive.coulomb_velocity));
                rows.push(speeds.row(i).into_owned());
            }
        }
    }
    let speeds = if rows.is_empty() { DMatrix::zeros(0, n) } else { DMatrix::from_rows(&rows) };
    WarmGears { speeds, gears }
}

/// What drives have beside those that they were made from.
fn added(with: &[DriveParameters], without: &[DriveParameters]) -> Vec<DriveParameters> {
    let difference = |(with, without): (&DriveParameters, &DriveParameters)| {
        let terms = with.iter().map(|(term, value)| (term, value - without[term]));
        terms.filter(|(_, value)| *value != 0.0).collect()
    };
    with.iter().zip(without).map(difference).collect()
}

impl ActualArm {
    /// The springs of its drives as a law of the torque that they add: `B = C⁻¹ diag(1/k) C⁻ᵀ`.
    fn elastic_law(&self, robot: &Robot) -> EffectLaw {
        let give = |coupling: &Coupling| match coupling {
            Coupling::Rigid => 0.0,
            Coupling::TwoMasses(spring) | Coupling::QuasiStatic(spring) => 1.0 / spring.stiffness,
        };
        let of_motors = DMatrix::from_diagonal(&nalgebra::DVector::from_iterator(
            self.couplings.len(),
            self.couplings.iter().map(give),
        ));
        let compliance = match robot.coupling().and_then(|c| c.clone().try_inverse()) {
            Some(inverse) => &inverse * of_motors * inverse.transpose(),
            None => of_motors,
        };
        let with_link = self.couplings.iter().map(|coupling| !matches!(coupling, Coupling::TwoMasses(_))).collect();
        EffectLaw::Elastic { compliance, with_link }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::CriterionKind;
    use crate::experiment::Level;
    use crate::model::bundled;
    use crate::model::format::{parse_nominal, parse_robot};
    use crate::model::term::LOAD_FRICTION;

    #[test]
    fn every_effect_that_can_be_expected_is_and_others_say_so() {
        let robot = parse_robot(bundled()[0].robot).unwrap();
        let nominal = parse_nominal(bundled()[0].nominal, &robot).unwrap().parameters;
        for &kind in Kind::ALL {
            let expected = Effects::only(kind, Level::Realistic).expected(&robot, &nominal);
            assert_eq!(expected.is_ok(), Effects::EXPECTABLE.contains(&kind), "{kind:?}");
            if let Err(error) = expected {
                assert!(error.to_string().contains("expected one of stribeck, load-friction"), "{error}");
            }
        }
        for (kind, count) in [(CriterionKind::ModelError, 2), (CriterionKind::MeasuredTorque, 6)] {
            let effects = Effects::expected_by(&*kind.criterion());
            assert_eq!(effects.expected(&robot, &nominal).unwrap().effects.len(), count);
        }
    }

    #[test]
    fn analytic_laws_have_the_sizes_of_the_effects() {
        let robot = parse_robot(bundled()[0].robot).unwrap();
        let nominal = parse_nominal(bundled()[0].nominal, &robot).unwrap().parameters;
        let law = |kind, magnitude| {
            let expected = Effects::none().with_effect(kind, magnitude).expected(&robot, &nominal).unwrap();
            expected.effects[0].law.clone()
        };
        let EffectLaw::Elastic { compliance, with_link } = law(Kind::Elasticity, 3.0) else { panic!() };
        for (j, joint) in robot.joints().iter().enumerate() {
            // Rated torque winds a drive up by 3 mrad.
            assert!((compliance[(j, j)] * joint.limits.torque - 3e-3).abs() < 1e-15);
        }
        // Joints of the wrist are so light that they move with their motors.
        assert_eq!((with_link[0], with_link[5]), (false, true));
        let EffectLaw::Terms(drives) = law(Kind::LoadFriction, 0.07) else { panic!() };
        assert!(drives.iter().all(|drive| drive.iter().count() == 1 && (drive[LOAD_FRICTION] - 0.07).abs() < 1e-15));
        assert_eq!(law(Kind::CurrentDelay, 2.0), EffectLaw::Late(2e-3));
    }
}
