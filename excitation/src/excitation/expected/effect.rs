//! An effect that is expected of the arm.

use nalgebra::DMatrix;

use super::warm_gears::WarmGears;
use crate::excitation::error::{ExcitationError, not_below_zero, same_length};
use crate::model::{DriveParameters, StandardParameters};

/// How an effect changes the torque of a motion.
#[derive(Clone, Debug, PartialEq)]
pub enum EffectLaw {
    /// Torque terms with these coefficients, joint by joint (n); none that depends on temperature.
    Terms(Vec<DriveParameters>),
    /// Springs between motors and links; the encoders are on the motors.
    ///
    /// ```text
    /// δ = B τ_l(θ, θ̇, θ̈)      d = τ(θ − δ, θ̇ − δ̇, θ̈ − δ̈) − τ(θ, θ̇, θ̈)
    /// ```
    /// `τ_l` is what the links take, `τ` that and, where rotor and friction are beyond the spring, theirs. Without damping
    /// and oscillation: to first order in δ, whose derivatives are those of one period.
    Elastic {
        /// B, rad/(N·m), n × n.
        compliance: DMatrix<f64>,
        /// Whether rotor and friction of a joint move with its link, n.
        with_link: Vec<bool>,
    },
    /// Torque that follows its set point late by this time (s), where the set point is what is reported: `d = T dτ/dt`.
    Late(f64),
    /// Torque that is off by this share, up or down, each joint by itself: n discrepancies, `d_j = share τ_j`.
    Scaled(f64),
    /// Friction that falls as gears warm up.
    Warming(WarmGears),
}

impl EffectLaw {
    /// Number of discrepancies of an arm of so many joints.
    pub(super) const fn discrepancies(&self, joints: usize) -> usize {
        match self {
            Self::Scaled(_) => joints,
            Self::Terms(_) | Self::Elastic { .. } | Self::Late(_) | Self::Warming(_) => 1,
        }
    }

    /// Checks that it is one of an arm of so many joints.
    fn check(&self, joints: usize) -> Result<(), ExcitationError> {
        match self {
            Self::Terms(drives) => same_length("drives of an expected effect", drives.len(), joints),
            Self::Elastic { compliance, with_link } => {
                same_length("rows of a compliance", compliance.nrows(), joints)?;
                same_length("columns of a compliance", compliance.ncols(), joints)?;
                same_length("drives of an expected effect", with_link.len(), joints)
            }
            Self::Warming(WarmGears { speeds, gears }) => {
                same_length("columns of the speeds of gears", speeds.ncols(), joints)?;
                same_length("gears that warm up", gears.len(), speeds.nrows())
            }
            Self::Late(time) => not_below_zero("lag of an expected effect", *time, "s"),
            Self::Scaled(share) => not_below_zero("share of an expected effect", *share, ""),
        }
    }
}

/// One effect with the magnitude that is expected of it: the standard deviation of what it may be.
#[derive(Clone, Debug, PartialEq)]
pub struct ExpectedEffect {
    /// Name, as in the list of effects.
    pub name: String,
    /// How it changes torque.
    pub law: EffectLaw,
}

/// The effects that are expected of an arm, and the parameters by which their torque is found. A design problem checks
/// them when it takes them.
#[derive(Clone, Debug, PartialEq)]
pub struct ExpectedEffects {
    /// The parameters.
    pub nominal: StandardParameters,
    /// The effects.
    pub effects: Vec<ExpectedEffect>,
    /// Whether the estimate is to predict the torque of the arm with its effects, as far as it can, or that without them.
    pub are_carried: bool,
}

impl ExpectedEffects {
    /// Checks that they are those of an arm of so many joints.
    pub(in crate::excitation) fn check(&self, joints: usize) -> Result<(), ExcitationError> {
        same_length("nominal links of the expected effects", self.nominal.links.len(), joints)?;
        self.effects.iter().try_for_each(|effect| effect.law.check(joints))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_size_or_of_another_arm_is_refused() {
        for size in [0.0, 0.3] {
            assert!(EffectLaw::Late(size).check(2).is_ok() && EffectLaw::Scaled(size).check(2).is_ok());
        }
        for size in [-0.1, f64::INFINITY, f64::NAN] {
            let refused = [EffectLaw::Late(size), EffectLaw::Scaled(size)].map(|law| law.check(2));
            assert!(refused.iter().all(|answer| matches!(answer, Err(ExcitationError::Negative { .. }))), "{size}");
        }
        assert!(matches!(
            EffectLaw::Terms(Vec::new()).check(2),
            Err(ExcitationError::Length { found: 0, expected: 2, .. })
        ));
    }
}
