//! The torque as a linear function of the dynamic parameters.
//!
//! ```text
//! τ = Y(q, q̇, q̈) φ        I a + v ×* I v = K(v, a) φ_body        Y_ik = S_iᵀ X_kiᵀ K(v_k, a_k)  for i ≤ k, else 0
//! ```
//! `radkhah2007` eq. 1 with `Γ_k = K_k θ_k`: row i, block k is the part of link k in the effort of joint i, where `X_ki`
//! takes motions from frame i to frame k. It is computed with the axis `S_i` carried outwards, `X_ki S_i`, which
//! costs six numbers per pair where carrying `K_k` inwards would cost sixty. After the links' columns come those of
//! the drives, from the same [`TorqueTerms`](crate::dynamics::TorqueTerms) that inverse and forward dynamics use.
//!
//! The recursion is written once, for as many samples as the processor has lanes: one at a time, or many into the columns that
//! are wanted, with the same bits.
//!
//! Columns are in the order of [`Columns::parameters`](crate::model::Columns::parameters), in link frames, and none is
//! dropped: finding out which the torque reveals is the next module's.

mod adjoint;
mod body;
mod cells;
mod gram;
mod joint_torque;
mod moving_base;
mod part_weights;
mod stack;
mod straight_axis;

pub use body::BodyRegressor;
pub use joint_torque::JointTorqueRegressor;
pub use moving_base::BaseState;
pub use part_weights::PartWeights;
pub use stack::{BLOCKS_OF_PART, StackPart};
