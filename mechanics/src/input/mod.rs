//! What an input may ask for: how large, and by which names.
//!
//! A file or an argument of a few bytes can ask for work without end, for more memory than there is, or for a path outside
//! of its folder. What is allowed stands here, in one list ([`size::ALL`]) and one rule ([`check_file_name`]), and is looked
//! at before work begins; each error states the limit and its reason.

mod file_name;
mod named;
pub mod size;

pub use file_name::{FileNameError, check_file_name};
pub use size::{SizeError, SizeLimit};

#[doc(inline)]
pub use crate::named_variants as named;
