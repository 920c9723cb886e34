//! The serial chain of a tree that is meant.

use super::arm::{arm_of, listed, quoted_one};
use super::element::RIGHT_ANGLE;
use super::error::FormatError;
use super::tree::{ChainEnds, ImportedModel, SnappedJoint, Tree};

impl Tree<'_> {
    /// The serial chain between two bodies.
    pub(super) fn chain(mut self, ends: &ChainEnds) -> Result<ImportedModel, FormatError> {
        let (base, moving) = self.select(ends)?;
        self.assemble(base, &moving)
    }

    /// The base of the chain and its bodies that joints move, in order; what the choice had to decide goes to the remarks.
    pub(super) fn select(&mut self, ends: &ChainEnds) -> Result<(usize, Vec<usize>), FormatError> {
        let base = ends.base.as_ref().map_or(Ok(0), |name| self.find("base", name))?;
        let tip = match &ends.tip {
            Some(name) => self.find("tip", name)?,
            None => {
                let arm = arm_of(self, base)?;
                self.remarks.extend(arm.remark);
                arm.tip
            }
        };
        let [from, to] = [base, tip].map(|b| &self.bodies[b].name);
        let fault = |message| self.check.fault(self.at.clone(), message);
        if !self.path(tip).contains(&base) {
            return fault(format!("\"{to}\" does not hang on \"{from}\", expected a tip that does"));
        }
        let moving = self.moving(base, tip);
        if moving.is_empty() {
            return fault(format!("no joint moves between \"{from}\" and \"{to}\", expected at least one"));
        }
        self.remark_right_angles(base, tip);
        Ok((base, moving))
    }

    /// One sentence on every joint from base to tip whose angles are not read as they are written.
    fn remark_right_angles(&mut self, base: usize, tip: usize) {
        let path = self.path(tip).into_iter().skip_while(|&b| b != base).skip(1);
        self.snapped = path.filter_map(|b| self.bodies[b].snapped.clone()).collect();
        let named = |joint: &SnappedJoint| format!("\"{}\" by {:.1e}", joint.name, joint.angle_rad);
        let off: Vec<String> = self.snapped.iter().map(named).collect();
        if !off.is_empty() {
            let joints = off.join(", ");
            self.remarks.push(format!(
                "angles within {RIGHT_ANGLE:.0e} rad of a right angle are right angles: joint {joints} rad"
            ));
        }
    }

    /// A body by its name.
    fn find(&self, end: &str, name: &str) -> Result<usize, FormatError> {
        self.bodies.iter().position(|body| body.name == name).map_or_else(
            || {
                let names: Vec<&str> = self.bodies.iter().map(|body| body.name.as_str()).collect();
                let message = format!("{end} \"{name}\" is not there, expected one of {}", listed(&names, quoted_one));
                self.check.fault(self.at.clone(), message)
            },
            Ok,
        )
    }
}
