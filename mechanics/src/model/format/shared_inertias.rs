//! The inertia of a chain's link, shared among the bodies of the file that it is made of.
//!
//! ```text
//! φ_moved = φ_link − s Σ_b φ_b seen from the link's frame        s = 1, ½, ¼, ⅛, 0: the first that real bodies can have
//! ```
//! Bodies that are fixed to the one which the joint moves keep their inertia, and that one gets the rest.

use super::error::FormatError;
use super::tree::{Tree, moved};
use crate::spatial::Inertia;

/// Shares of their inertia that bodies keep which are fixed to another.
const SHARES: [f64; 5] = [1.0, 0.5, 0.25, 0.125, 0.0];

/// What is to be written.
pub(super) struct SharedInertias {
    /// Bodies of the tree whose inertia changes, with the new one in their own frame.
    pub(super) bodies: Vec<(usize, Inertia)>,
    /// What else the reader must know.
    pub(super) remarks: Vec<String>,
}

impl SharedInertias {
    /// For a chain from `base` whose links, each moved by one body, get these inertias.
    pub(super) fn of(tree: &Tree<'_>, base: usize, moving: &[usize], links: &[Inertia]) -> Result<Self, FormatError> {
        let carried = tree.carried(base, moving);
        let mut shared = Self { bodies: Vec::new(), remarks: Vec::new() };
        for (index, (&main, target)) in moving.iter().zip(links).enumerate() {
            let mut attached = Vec::new();
            for (b, place) in carried.iter().enumerate() {
                if let Some((link, pose)) = place
                    && *link == index + 1
                    && b != main
                {
                    let inertia = tree.bodies[b].inertia.as_ref().map_err(Clone::clone)?;
                    if inertia.to_array() != [0.0; 10] {
                        attached.push((b, *inertia, moved(inertia, pose)));
                    }
                }
            }
            let own = tree.bodies[main].inertia.as_ref().map_err(Clone::clone)?;
            if attached.iter().fold(*own, |sum, (_, _, inertia)| less(&sum, inertia, -1.0)) == *target {
                continue;
            }
            let rest = |share: f64| attached.iter().fold(*target, |rest, (_, _, inertia)| less(&rest, inertia, share));
            let share = SHARES.into_iter().find(|&share| share == 0.0 || rest(share).check().is_ok()).unwrap_or(0.0);
            shared.bodies.push((main, rest(share)));
            for (b, inertia, _) in attached.iter().filter(|_| share < 1.0) {
                shared.bodies.push((*b, less(&Inertia::zero(), inertia, -share)));
                shared.remarks.push(format!(
                    "link \"{}\" keeps {share} of its inertia: with all of it \"{}\" could be no body",
                    tree.bodies[*b].name, tree.bodies[main].name
                ));
            }
        }
        Ok(shared)
    }
}

/// `a − share · b`.
fn less(a: &Inertia, b: &Inertia, share: f64) -> Inertia {
    Inertia {
        mass: a.mass - share * b.mass,
        first_moment: a.first_moment - b.first_moment * share,
        rotational: a.rotational - b.rotational * share,
    }
}
