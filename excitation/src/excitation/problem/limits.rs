//! What a design must hold beside the robot's own limits of motion, and which part of them it may use.

use crate::excitation::effort::ParameterSpread;
use crate::excitation::error::{ExcitationError, above_zero, finite, not_below_zero, same_length};
use crate::excitation::margins::Margins;
use crate::model::format::RelativeUncertainty;
use crate::model::{Columns, JointKind, Robot, StandardParameters};
use crate::spatial::Inertia;

/// The part of the torque and current limits that may be used where the nominal parameters state no uncertainty.
const WITHOUT_UNCERTAINTY: f64 = 0.9;
/// Smallest and largest probability of [`LimitSettings::confidence`].
const CONFIDENCE: std::ops::Range<f64> = 0.5..1.0;
/// Margin of a prismatic joint for each degree of a revolute one, m/deg, as that of a guard.
const SLIDING_M_PER_DEG: f64 = 0.0025;

/// Which limits a design of a robot holds; the default holds all. A limit that is not held is `None`.
///
/// Position, velocity, acceleration and jerk are always held, as far as the robot states them.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LimitSettings {
    /// Distance to both position limits, deg. The default keeps off the soft limits of the guard, 4 deg, by a degree for the
    /// servo. Prismatic joints keep 2.5 mm for each degree.
    pub margin_deg: f64,
    /// Probability with which torque and current keep their limits at any one instant, by the uncertainty of the nominal
    /// parameters; from 0.5, the nominal parameters alone, to less than 1.
    pub confidence: Option<f64>,
    /// Length of the ramps around the period on which limits hold too, s.
    pub ramp_s: Option<f64>,
    /// Distance to keep between the robot's shapes and from obstacles, m.
    pub clearance_m: Option<f64>,
}

impl Default for LimitSettings {
    fn default() -> Self {
        Self { margin_deg: 5.0, confidence: Some(0.95), ramp_s: Some(2.0), clearance_m: Some(0.0) }
    }
}

/// The limits of a design problem, which checks them when it takes them.
///
/// ```
/// # use armid_excitation as armid;
/// use armid::excitation::{DesignLimits, LimitSettings};
/// use armid::model::{bundled, format::{parse_nominal, parse_robot}};
/// let robot = parse_robot(bundled()[0].robot).unwrap();
/// let nominal = parse_nominal(bundled()[0].nominal, &robot).unwrap();
/// let of = |settings: &LimitSettings| DesignLimits::for_robot(&robot, Some(&nominal.parameters), Some(&nominal.relative_uncertainty), settings);
/// let limits = of(&LimitSettings::default()).unwrap();
/// assert_eq!((limits.ramp_s, limits.clearance_m), (Some(2.0), Some(0.0)));
/// assert!(limits.nominal.is_some() && limits.spread.is_some());
/// assert!(of(&LimitSettings { ramp_s: Some(-1.0), ..LimitSettings::default() }).is_err());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct DesignLimits {
    /// Parameters by which torque and current are held; not held without them.
    pub nominal: Option<StandardParameters>,
    /// How far the true parameters may be from the nominal ones, and what the effort limits must leave for that.
    pub spread: Option<ParameterSpread>,
    /// A body on the last link (in its frame), with which torque and current are held as well as without it. Efforts are
    /// linear in its ten parameters, and their peaks and root mean squares convex: any part of it is held, too.
    pub payload: Option<Inertia>,
    /// Length of the ramps around the motion, s, in which the limits hold as well; without it only the period counts.
    pub ramp_s: Option<f64>,
    /// Distance to keep between the robot's bodies and from what stands around it, m; not held without it.
    pub clearance_m: Option<f64>,
    /// Which part of each limit may be used.
    pub margins: Margins,
    /// Largest [RMS speed](crate::excitation::rms_speed) of the motion, as a part of the speed limits; not held without it.
    pub rms_speed: Option<f64>,
    /// Distance from both position limits of each joint, rad (m), n: where a guard stops the arm. Empty where there is none.
    pub position_margin: Vec<f64>,
}

impl DesignLimits {
    /// The limits of a robot. Torque and current are computed by the `nominal` parameters and not held without them. With their
    /// `uncertainty` they keep the probability of the settings, else nine tenths of the limits.
    ///
    /// # Errors
    /// [`ExcitationError`] where a setting is no number or outside its range.
    pub fn for_robot(
        robot: &Robot,
        nominal: Option<&StandardParameters>,
        uncertainty: Option<&RelativeUncertainty>,
        settings: &LimitSettings,
    ) -> Result<Self, ExcitationError> {
        let LimitSettings { margin_deg, confidence, ramp_s, clearance_m } = *settings;
        not_below_zero("distance to the position limits", margin_deg, "deg")?;
        let margin =
            |kind| if kind == JointKind::Revolute { margin_deg.to_radians() } else { SLIDING_M_PER_DEG * margin_deg };
        let position_margin = robot.joints().iter().map(|joint| margin(joint.kind)).collect();
        let mut limits = Self { ramp_s, clearance_m, position_margin, ..Self::motion() };
        if let Some(confidence) = confidence {
            if !CONFIDENCE.contains(&confidence) {
                return Err(ExcitationError::Confidence { found: confidence });
            }
            let multiple = ParameterSpread::multiple_for(confidence);
            let spread = |(nominal, shares)| ParameterSpread::new(robot, nominal, shares, multiple);
            limits.spread = nominal.zip(uncertainty).map(spread);
            limits.nominal = nominal.cloned();
            limits.margins.torque = if limits.spread.is_some() { 1.0 } else { WITHOUT_UNCERTAINTY };
        }
        limits.check()?;
        Ok(limits)
    }

    /// Position, velocity, acceleration and jerk alone, on the period and not on ramps: neither torque, current nor clearance.
    pub fn motion() -> Self {
        Self {
            nominal: None,
            spread: None,
            payload: None,
            ramp_s: None,
            clearance_m: None,
            margins: Margins::default(),
            rms_speed: None,
            position_margin: Vec::new(),
        }
    }

    fn check(&self) -> Result<(), ExcitationError> {
        if let Some(spread) = &self.spread {
            not_below_zero("multiple of the standard deviations", spread.multiple, "")?;
            for &deviation in &spread.deviations {
                not_below_zero("standard deviation of a nominal parameter", deviation, "")?;
            }
        }
        self.ramp_s.map_or(Ok(()), |ramp_s| above_zero("length of the ramps", ramp_s, "s"))?;
        self.clearance_m.map_or(Ok(()), |clearance_m| finite("clearance", clearance_m, "m"))?;
        above_zero("part of the position range", self.margins.position, "")?;
        above_zero("part of the speed limit", self.margins.velocity, "")?;
        above_zero("part of the acceleration limit", self.margins.acceleration, "")?;
        above_zero("part of the torque rating", self.margins.torque, "")?;
        self.rms_speed.map_or(Ok(()), |most| above_zero("RMS speed", most, ""))?;
        self.position_margin.iter().try_for_each(|&margin| finite("margin to a position limit", margin, "rad"))
    }

    /// Checks that these are limits of this robot, and returns it with position limits that keep the margin from its own.
    pub(super) fn inner_robot(&self, robot: &Robot) -> Result<Robot, ExcitationError> {
        self.check()?;
        let n = robot.dof();
        if let Some(nominal) = &self.nominal {
            same_length("nominal links", nominal.links.len(), n)?;
        }
        if let (Some(nominal), Some(spread)) = (&self.nominal, &self.spread) {
            // As many as the effort model has, which takes in what terms the nominal parameters have.
            let columns = Columns::default().with_terms_of(nominal);
            same_length("uncertain parameters", spread.deviations.len(), columns.parameters(robot).len())?;
        }
        if !self.position_margin.is_empty() {
            same_length("position margins", self.position_margin.len(), n)?;
        }
        let mut margins = self.position_margin.iter();
        let inner = robot.clone().with_joints(|joint| {
            if let Some(margin) = margins.next().filter(|margin| **margin != 0.0) {
                let (low, high) = joint.limits.position;
                joint.limits.position = (low + margin, high - margin);
            }
        });
        inner.map_err(ExcitationError::PositionMargin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains;

    #[test]
    fn analytic_a_margin_narrows_the_range_from_both_ends() {
        let mut robot = chains::planar_2r();
        for (at, range) in [(-1.0, 2.0), (-0.5, 0.75)].into_iter().enumerate() {
            let mut joint = 0..;
            robot = robot
                .with_joints(|one| {
                    if joint.next() == Some(at) {
                        one.limits.position = range;
                    }
                })
                .unwrap();
        }
        let limits = DesignLimits { position_margin: vec![0.25, 0.0], ..DesignLimits::motion() };
        let inner = limits.inner_robot(&robot).unwrap();
        let ranges: Vec<(f64, f64)> = inner.joints().iter().map(|joint| joint.limits.position).collect();
        assert_eq!(ranges, [(-0.75, 1.75), (-0.5, 0.75)]);
        // More than the whole range leaves none.
        let limits = DesignLimits { position_margin: vec![1.6, 0.0], ..DesignLimits::motion() };
        assert!(limits.inner_robot(&robot).is_err());
    }
}
