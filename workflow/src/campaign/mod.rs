//! Design, perform, identify, and again, until what the model is for is known well enough.
//!
//! ```text
//! motion of round k ← argmin tr(A M⁻¹)      M = information of rounds 1 … k − 1, and of the motion      A: the targets not met yet
//! interval at look k of at most K: confidence 1 − 0.05 / K
//! ```
//! Every round is a look at the intervals, and the campaign ends where they are narrow enough. By Bonferroni's inequality all K
//! intervals hold together with 95 % at least, whatever their dependence. So the last one does, however the end was chosen.
//!
//! An interval has a part by noise, which motion averages out, and one by errors of the model, which it does not
//! ([`pool`](armid::estimation::pool)). Where the second alone is wider than a target, and a further round did not make it a tenth
//! narrower, the target is out of reach.
//!
//! Before that is said, terms are selected by the logs of all rounds. The columns grow by those that are new, all rounds are estimated
//! again, and the campaign goes on.
//!
//! A campaign performs nothing: [`Campaign::next`] says which experiment comes, and [`Campaign::take`] takes its log. All of its state is in
//! its folder, in files that are whole or absent. So it goes on after any end, to the same bits.

mod aim;
mod answer;
mod figure;
mod folder;
mod logs;
mod motion;
mod settings;
mod standing;
mod state;
mod stopping;
mod target;
mod terms;

pub use answer::{CampaignAnswer, RoundAnswer};
pub use folder::Round;
pub use settings::{CampaignSettings, experiment_table};
pub use state::{Campaign, Step};
pub use stopping::{Obstacle, Outcome, Width};
pub use target::{Quantity, Target};
