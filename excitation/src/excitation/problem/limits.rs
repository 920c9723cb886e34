//! What a design must hold beside the robot's own limits of motion, and which part of them it may use.

use crate::excitation::effort::{EffortModel, ParameterSpread};
use crate::excitation::error::{ExcitationError, above_zero, same_length};
use crate::excitation::margins::Margins;
use crate::model::{Columns, Robot, StandardParameters};
use crate::spatial::Inertia;

/// The limits of a design problem. The default is the robot's own of position, velocity and acceleration, on the period
/// alone.
///
/// ```
/// # use armid_excitation as armid;
/// use armid::excitation::DesignLimits;
/// let limits = DesignLimits::default().with_ramps(2.0).unwrap().with_clearance(0.02).unwrap();
/// assert_eq!((limits.ramp_s(), limits.clearance_m()), (Some(2.0), Some(0.02)));
/// assert!(limits.with_ramps(-1.0).is_err());
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DesignLimits {
    nominal: Option<StandardParameters>,
    spread: Option<ParameterSpread>,
    payload: Option<Inertia>,
    ramp_s: Option<f64>,
    clearance_m: Option<f64>,
    margins: Margins,
    /// Of each joint; empty where there is none.
    position_margin: Vec<f64>,
}

impl DesignLimits {
    /// Holds torque and current too, computed by the `nominal` parameters.
    #[must_use]
    pub fn with_efforts(self, nominal: StandardParameters) -> Self {
        Self { nominal: Some(nominal), spread: None, ..self }
    }

    /// The same for parameters that may be as far from the `nominal` ones as `spread` says.
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
    #[must_use]
    pub const fn nominal(&self) -> Option<&StandardParameters> {
        self.nominal.as_ref()
    }

    /// How far the true parameters may be from the nominal ones, and what the effort limits must leave for that.
    #[must_use]
    pub const fn spread(&self) -> Option<&ParameterSpread> {
        self.spread.as_ref()
    }

    /// Length of the ramps around the motion, s, in which the limits hold as well; without it only the period counts.
    #[must_use]
    pub const fn ramp_s(&self) -> Option<f64> {
        self.ramp_s
    }

    /// Distance to keep between the robot's bodies and from what stands around it, m; not held without it.
    #[must_use]
    pub const fn clearance_m(&self) -> Option<f64> {
        self.clearance_m
    }

    /// Which part of each limit may be used.
    #[must_use]
    pub const fn margins(&self) -> &Margins {
        &self.margins
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
