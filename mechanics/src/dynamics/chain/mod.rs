//! A robot's links in frames that stand on the joints, and sweeps along them: what the fast recursions are made of.
//!
//! ```text
//! x_{i-1} = Rx(α) Rz(θ + q) x_i + p                (revolute)
//! x_{i-1} = Rx(α) (Rz(θ) x_i + q z) + p            (prismatic)
//! ```
//! Every chain of revolute and prismatic joints can be written so: the constant rotation between two joint axes is
//! `Rz(γ) Rx(α) Rz(β)`; `Rz(β)` turns about the next axis and joins its angle, `Rz(γ)` turns about the axis before and
//! joins that one's. A change of frame then costs 8 products instead of 18, and 4 at right angles. Links' inertias are given in
//! these frames, as mass, first moment and second moments `Σ = ∫ x xᵀ dm` (upper left of the pseudo-inertia), which shift by sums
//! of products and rotate in planes.
//!
//! Masses on the axis of a revolute joint move alike on both of its links. So a link's mass and its moments along the axis go to
//! the link before, and those of the first link to the base: no joint's effort changes, and less is left to compute
//! (W. Khalil, J.-F. Kleinfinger, IEEE J. Robotics and Automation 3, 1987, group parameters so). Frames slide along their axes so
//! that shifts between them have few components.
//!
//! Out: velocities, accelerations, and the forces they need, with `U = [ω̇]× + [ω]×²` so that a point `x` of
//! a link accelerates by `a + U x`; a link needs `f = m a + U m c` and `n = m c × a + vee(U Σ − Σ Uᵀ)` ([`Outward`]). In: forces and
//! composite inertias go to the frame before; the force that accelerates joint k alone travels inwards and leaves
//! `H_jk` at every joint j ([`Inward`]).
//!
//! Reference: R. Featherstone, *Rigid Body Dynamics Algorithms*, Springer 2008, tables 5.1 and 6.2.

mod inward;
mod link;
mod outward;
mod pose;

pub use inward::{Inward, Moments};
pub(super) use link::Twist;
pub use link::{Link, Links};
pub use outward::Outward;
pub(super) use pose::{ANY, PARALLEL, RIGHT};
pub use pose::{Pose, Wrench};
