//! A robot and its relatives: the same arm with other lengths and angles.

use rand::RngExt;

use super::symbol::{Symbol, Variable};
use crate::base::geometry::Geometry;
use crate::base::reduction::BaseReduction;
use crate::base::structural;
use crate::base::structural::BaseMotion;
use crate::model::{DhRow, ParameterId};
use crate::seed::Seed;
use crate::spatial::Placement;

/// Relatives with everything changed at random, on which a formula must hold.
pub(super) const WITNESSES: usize = 6;

/// A changed length is this multiple of the old one; a power of it gives an exponent, and it is exact in binary.
pub(super) const STRETCH: f64 = 1.25;

/// A changed angle is this much larger, degrees: a number that makes no angle special.
const TURN_DEG: f64 = 7.3;

/// One arm and its K.
#[derive(Clone, Debug)]
pub(super) struct Relative {
    geometry: Geometry,
    /// Its reduction.
    pub(super) reduction: BaseReduction,
}

impl Relative {
    fn new(geometry: Geometry, parameters: &[ParameterId], motion: BaseMotion) -> Self {
        let reduction = structural::reduce(&geometry, parameters, motion);
        Self { geometry, reduction }
    }

    /// Value of a letter on this arm.
    pub(super) fn letter(&self, symbol: Symbol) -> f64 {
        self.geometry.dh[symbol.joint].map_or(f64::NAN, |(_, row)| symbol.value_in_row(&row))
    }
}

/// The arm itself, one relative for each variable, and the witnesses; all with the same kept columns.
pub(super) struct Family {
    pub(super) original: Relative,
    pub(super) variables: Vec<(Variable, Relative)>,
    pub(super) witnesses: Vec<Relative>,
}

impl Family {
    /// The family of a geometry; `None` where a relative keeps other columns, so that the arm is a special case of its
    /// own shape and no formula of the shape can be trusted.
    pub(super) fn of(geometry: &Geometry, parameters: &[ParameterId], motion: BaseMotion) -> Option<Self> {
        let make = |geometry| Relative::new(geometry, parameters, motion);
        let original = make(geometry.clone());
        let variables: Vec<_> = Variable::of(geometry)
            .into_iter()
            .map(|variable| {
                let relative = geometry.changed(|candidate| if candidate == Some(variable) { Some(1.0) } else { None });
                (variable, make(relative))
            })
            .collect();
        // The witnesses are part of the method, not of a study: their seed is fixed.
        let mut rng = Seed::new(0).stream("formula witnesses", 0);
        let witnesses: Vec<_> =
            (0..WITNESSES).map(|_| make(geometry.changed(|_| Some(rng.random_range(-2.0..2.0))))).collect();
        let family = Self { original, variables, witnesses };
        let kept = &family.original.reduction.kept;
        let alike = family.relatives().all(|relative| relative.reduction.kept == *kept);
        alike.then_some(family)
    }

    /// All arms, the original first.
    pub(super) fn relatives(&self) -> impl Iterator<Item = &Relative> {
        std::iter::once(&self.original).chain(self.variables.iter().map(|(_, r)| r)).chain(&self.witnesses)
    }
}

impl Geometry {
    /// The arm with its variables changed: `steps` says by how many steps, `None` leaves a variable alone. A step is
    /// a factor for a length and an addition for an angle. It is asked for `None` where an offset has no name, which is
    /// where a joint is not given by a DH row.
    fn changed(&self, mut steps: impl FnMut(Option<Variable>) -> Option<f64>) -> Self {
        let mut changed = self.clone();
        let scaled = |x: f64, step: Option<f64>| x * step.map_or(1.0, factor);
        for variable in Variable::of(self) {
            let joint = match variable {
                Variable::Length(symbol) => symbol.joint,
                Variable::Alpha(joint) | Variable::Theta(joint) => joint,
            };
            let Some((_, row)) = &mut changed.dh[joint] else { continue };
            let step = steps(Some(variable));
            match variable {
                Variable::Length(symbol) => {
                    let length = match symbol.quantity {
                        super::Quantity::A => &mut row.a,
                        _ => &mut row.d,
                    };
                    *length = scaled(*length, step);
                }
                Variable::Alpha(_) => row.alpha_deg += TURN_DEG * step.unwrap_or(0.0),
                Variable::Theta(_) => row.offset_deg += TURN_DEG * step.unwrap_or(0.0),
            }
        }
        for joint in 0..self.dof() {
            match changed.dh[joint] {
                Some((convention, row)) => {
                    let in_units = DhRow { d: row.d / self.length, a: row.a / self.length, ..row };
                    (changed.before[joint], changed.after[joint]) = in_units.placements(convention);
                }
                None => {
                    for placement in [&mut changed.before[joint], &mut changed.after[joint]] {
                        let moved = placement.translation.map(|x| scaled(x, steps(None)));
                        *placement = Placement::new(placement.rotation, moved);
                    }
                }
            }
        }
        changed
    }
}

/// The factor of `steps` steps: `STRETCH` for one.
fn factor(steps: f64) -> f64 {
    if steps == 1.0 { STRETCH } else { libm::exp(steps * libm::log(STRETCH)) }
}
