//! The checks, one file each.

mod command_age;
mod command_step;
mod current_clamp;
mod definition;
mod following_error;
mod not_finite;
mod overspeed;
mod past;
mod position_jump;
mod reduced_speed;
mod soft_limit;
mod stale_state;
mod unexpected_stop;

pub use definition::Check;
pub(crate) use definition::all;

use command_age::CommandAge;
use command_step::CommandStep;
use current_clamp::CurrentClamp;
use following_error::FollowingError;
use not_finite::NotFinite;
use overspeed::Overspeed;
use past::Past;
use position_jump::PositionJump;
use reduced_speed::ReducedSpeed;
use soft_limit::SoftLimit;
use stale_state::StaleState;
use unexpected_stop::UnexpectedStop;
