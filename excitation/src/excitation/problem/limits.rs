//! What a design must hold beside the robot's own limits of motion, and which part of them it may use.

use crate::excitation::effort::{EffortModel, ParameterSpread};
use crate::excitation::error::{ExcitationError, above_zero, same_length};
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

/// The limits of a design problem.
///
/// ```
/// # use armid_excitation as armid;
/// use armid::excitation::{DesignLimits, LimitSettings};
/// use armid::model::{bundled, format::{parse_nominal, parse_robot}};
/// let robot = parse_robot(bundled()[0].robot).unwrap();
/// let nominal = parse_nominal(bundled()[0].nominal, &robot).unwrap();
/// let of = |settings: &LimitSettings| DesignLimits::of(&robot, Some(&nominal.parameters), Some(&nominal.relative_uncertainty), settings);
/// let limits = of(&LimitSettings::default()).unwrap();
/// assert_eq!((limits.ramp_s(), limits.clearance_m()), (Some(2.0), Some(0.0)));
/// assert!(limits.nominal().is_some() && limits.spread().is_some());
/// assert!(of(&LimitSettings { ramp_s: Some(-1.0), ..LimitSettings::default() }).is_err());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct DesignLimits {
    nominal: Option<StandardParameters>,
    spread: Option<ParameterSpread>,
    payload: Option<Inertia>,
    ramp_s: Option<f64>,
    clearance_m: Option<f64>,
    margins: Margins,
    rms_speed: Option<f64>,
    /// Of each joint; empty where there is none.
    position_margin: Vec<f64>,
}

impl DesignLimits {
    /// The limits of a robot. Torque and current are computed by the `nominal` parameters and not held without them. With their
    /// `uncertainty` they keep the probability of the settings, else nine tenths of the limits.
    ///
    /// # Errors
    /// [`ExcitationError`] where a setting is no number or outside its range.
    pub fn of(
        robot: &Robot,
        nominal: Option<&StandardParameters>,
        uncertainty: Option<&RelativeUncertainty>,
        settings: &LimitSettings,
    ) -> Result<Self, ExcitationError> {
        let LimitSettings { margin_deg, confidence, ramp_s, clearance_m } = *settings;
        if !(margin_deg.is_finite() && margin_deg >= 0.0) {
            let quantity = "distance to the position limits";
            return Err(ExcitationError::Negative { quantity, found: margin_deg, unit: "deg" });
        }
        let margin =
            |kind| if kind == JointKind::Revolute { margin_deg.to_radians() } else { SLIDING_M_PER_DEG * margin_deg };
        let mut limits =
            Self::of_motion().with_position_margin(robot.joints().iter().map(|joint| margin(joint.kind)).collect())?;
        if let Some(ramp_s) = ramp_s {
            limits = limits.with_ramps(ramp_s)?;
        }
        if let Some(clearance_m) = clearance_m {
            limits = limits.with_clearance(clearance_m)?;
        }
        let Some(confidence) = confidence else { return Ok(limits) };
        if !CONFIDENCE.contains(&confidence) {
            return Err(ExcitationError::Confidence { found: confidence });
        }
        let part = |torque: f64| Margins { torque, ..Margins::default() };
        match (nominal, uncertainty) {
            (Some(nominal), Some(shares)) => {
                let spread = ParameterSpread::of(robot, nominal, shares, ParameterSpread::multiple_of(confidence));
                limits.with_uncertain_efforts(nominal.clone(), spread)?.with_margins(part(1.0))
            }
            (Some(nominal), None) => limits.with_efforts(nominal.clone()).with_margins(part(WITHOUT_UNCERTAINTY)),
            (None, _) => limits.with_margins(part(WITHOUT_UNCERTAINTY)),
        }
    }

    /// Position, velocity, acceleration and jerk alone, on the period and not on ramps: neither torque, current nor clearance.
    pub fn of_motion() -> Self {
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

    /// Holds torque and current too, computed by the `nominal` parameters.
    #[must_use]
    pub fn with_efforts(self, nominal: StandardParameters) -> Self {
        Self { nominal: Some(nominal), spread: None, ..self }
    }

    /// Holds torque and current for parameters that may be as far from the `nominal` ones as `spread` says.
    ///
    /// # Errors
    /// [`ExcitationError::Negative`] if a deviation or their multiple is below zero or no number.
    pub fn with_uncertain_efforts(
        self,
        nominal: StandardParameters,
        spread: ParameterSpread,
    ) -> Result<Self, ExcitationError> {
        let not_below_zero = |quantity, found: f64| {
            let holds = found.is_finite() && found >= 0.0;
            if holds { Ok(()) } else { Err(ExcitationError::Negative { quantity, found, unit: "" }) }
        };
        not_below_zero("multiple of the standard deviations", spread.multiple)?;
        for &deviation in &spread.deviations {
            not_below_zero("standard deviation of a nominal parameter", deviation)?;
        }
        Ok(Self { nominal: Some(nominal), spread: Some(spread), ..self })
    }

    /// Holds torque and current with this body on the last link (in its frame) as well as without it. Efforts are linear in
    /// its ten parameters, and their peaks and root mean squares convex: any part of it is held, too.
    #[must_use]
    pub fn with_payload(self, payload: Inertia) -> Self {
        Self { payload: Some(payload), ..self }
    }

    /// Holds all limits on ramps of this length (s) around the motion too.
    ///
    /// # Errors
    /// [`ExcitationError::NotPositive`] if it is no finite number above zero.
    pub fn with_ramps(self, ramp_s: f64) -> Result<Self, ExcitationError> {
        above_zero("length of the ramps", ramp_s, "s")?;
        Ok(Self { ramp_s: Some(ramp_s), ..self })
    }

    /// Keeps this distance (m) between the robot's bodies and from what stands around it.
    ///
    /// # Errors
    /// [`ExcitationError::NotFinite`] if it is no number.
    pub fn with_clearance(self, clearance_m: f64) -> Result<Self, ExcitationError> {
        if !clearance_m.is_finite() {
            return Err(ExcitationError::NotFinite { quantity: "clearance", found: clearance_m, unit: "m" });
        }
        Ok(Self { clearance_m: Some(clearance_m), ..self })
    }

    /// Uses these parts of the limits.
    ///
    /// # Errors
    /// [`ExcitationError::NotPositive`] if one of them is no finite number above zero.
    pub fn with_margins(self, margins: Margins) -> Result<Self, ExcitationError> {
        above_zero("part of the position range", margins.position, "")?;
        above_zero("part of the speed limit", margins.velocity, "")?;
        above_zero("part of the acceleration limit", margins.acceleration, "")?;
        above_zero("part of the torque rating", margins.torque, "")?;
        Ok(Self { margins, ..self })
    }

    /// Keeps the [RMS speed](crate::excitation::rms_speed) of the motion at most at this part of the speed limits.
    ///
    /// # Errors
    /// [`ExcitationError::NotPositive`] if it is no finite number above zero.
    pub fn with_rms_speed(self, most: f64) -> Result<Self, ExcitationError> {
        above_zero("RMS speed", most, "")?;
        Ok(Self { rms_speed: Some(most), ..self })
    }

    /// Keeps this distance from both position limits of each joint, rad (m), n: where a guard stops the arm.
    ///
    /// # Errors
    /// [`ExcitationError::NotFinite`] if one of them is no number. Whether every joint keeps a range is asked by the
    /// problem that takes the limits.
    pub fn with_position_margin(self, position_margin: Vec<f64>) -> Result<Self, ExcitationError> {
        if let Some(&found) = position_margin.iter().find(|margin| !margin.is_finite()) {
            return Err(ExcitationError::NotFinite { quantity: "margin to a position limit", found, unit: "rad" });
        }
        Ok(Self { position_margin, ..self })
    }

    /// Parameters that torque limits are computed with; without them torque is not limited.
    pub const fn nominal(&self) -> Option<&StandardParameters> {
        self.nominal.as_ref()
    }

    /// How far the true parameters may be from the nominal ones, and what the effort limits must leave for that.
    pub const fn spread(&self) -> Option<&ParameterSpread> {
        self.spread.as_ref()
    }

    /// Length of the ramps around the motion, s, in which the limits hold as well; without it only the period counts.
    pub const fn ramp_s(&self) -> Option<f64> {
        self.ramp_s
    }

    /// Distance to keep between the robot's bodies and from what stands around it, m; not held without it.
    pub const fn clearance_m(&self) -> Option<f64> {
        self.clearance_m
    }

    /// Which part of each limit may be used.
    pub const fn margins(&self) -> &Margins {
        &self.margins
    }

    /// Largest RMS speed, as a part of the speed limits; not held without it.
    pub const fn rms_speed(&self) -> Option<f64> {
        self.rms_speed
    }

    /// The efforts of a robot by the nominal parameters; `None` without them.
    pub(super) fn efforts(&self, robot: &Robot) -> Option<EffortModel> {
        self.nominal.as_ref().map(|nominal| EffortModel::new(robot, nominal, self.spread.as_ref()))
    }

    /// The efforts of a robot that carries the payload; `None` without nominal parameters or payload.
    pub(super) fn payload_efforts(&self, robot: &Robot) -> Option<EffortModel> {
        let (mut loaded, payload) = (self.nominal.clone()?, self.payload.as_ref()?);
        let last = loaded.links.last_mut()?;
        let (own, more) = (last.to_array(), payload.to_array());
        *last = Inertia::from_array(&std::array::from_fn(|k| own[k] + more[k]));
        Some(EffortModel::new(robot, &loaded, self.spread.as_ref()))
    }

    /// Checks that these are limits of this robot, and returns it with position limits that keep the margin from its own.
    pub(super) fn inner_robot(&self, robot: &Robot) -> Result<Robot, ExcitationError> {
        let n = robot.dof();
        if let Some(nominal) = &self.nominal {
            same_length("nominal links", nominal.links.len(), n)?;
        }
        if let (Some(nominal), Some(spread)) = (&self.nominal, &self.spread) {
            // As many as the effort model has, which takes in what terms the nominal parameters have.
            let columns = Columns::default().and_those_of(nominal);
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
        let limits = DesignLimits::of_motion().with_position_margin(vec![0.25, 0.0]).unwrap();
        let inner = limits.inner_robot(&robot).unwrap();
        let ranges: Vec<(f64, f64)> = inner.joints().iter().map(|joint| joint.limits.position).collect();
        assert_eq!(ranges, [(-0.75, 1.75), (-0.5, 0.75)]);
        // More than the whole range leaves none.
        let limits = DesignLimits::of_motion().with_position_margin(vec![1.6, 0.0]).unwrap();
        assert!(limits.inner_robot(&robot).is_err());
    }
}
