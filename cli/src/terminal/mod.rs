//! Standard output, standard error, and who is looking.

mod answer;
mod console;
mod destination;
mod flags;
mod global_arguments;
pub(crate) mod real_time;
mod reporter;
mod table;
mod watch;

pub(crate) use answer::{Answer, Ending};
pub(crate) use armid_workflow::numbers::{number, stated};
pub(crate) use console::Console;
pub(crate) use destination::{Destination, Writes, report_folder};
pub(crate) use flags::Flags;
pub(crate) use global_arguments::GlobalArguments;
pub(crate) use reporter::install_reporter;
pub(crate) use table::Table;
pub(crate) use watch::{Watch, bar};
