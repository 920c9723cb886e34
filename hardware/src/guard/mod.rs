//! The guard: what every command to a real arm passes, and what ends a motion before it does damage.
//!
//! | part | the question it answers |
//! |---|---|
//! | [`Preflight`] | may the arm move at all? |
//! | [`Approach`] | how does it come to the start pose? |
//! | [`Trip`], [`Check`], [`Watch`] | is something wrong, what is done about it, and how soon? |
//! | [`Guarded`] | any arm, guarded |
//!
//! It has no clock and does no input or output: time is that of the samples, silence is reported by the arm. So the same
//! guard is tested on a virtual clock and works in real time.

mod approach;
mod bounds;
mod check;
mod confirmation;
mod guarded;
mod machine;
mod mode;
mod points;
mod preflight;
mod record;
mod settings;
mod state;
mod table;
mod trip;
mod watch;
#[cfg(test)]
mod tests;

pub use approach::Approach;
pub use bounds::JointBounds;
pub use check::Check;
pub use confirmation::Confirmation;
pub use guarded::Guarded;
pub use machine::{Approached, Machine};
pub use mode::Mode;
pub use points::{Fastest, fastest_point};
pub use preflight::{Preflight, Survey};
pub use record::{ApproachRecord, GuardRecord, Passed};
pub use settings::{GuardSettings, SettingError};
pub use state::{Activity, GuardState, Observer};
pub use table::table;
pub(crate) use trip::{ARRIVAL_WINDOW_S, OVERSPEED_WINDOW_S};
pub use trip::{LOOK_MS, REACTION_MS, Trip};
pub use watch::Watch;
