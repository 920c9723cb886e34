//! Every file that armid writes at once is written here: whole or absent, and only where a file may be.
//!
//! A file is written beside its place, synchronised with the disk, and takes its name; then its folder is synchronised.
//! A kill or a power cut at any time leaves the old file or the complete new one. Links are
//! followed and stay; what is there and is no regular file (a device, a pipe, a socket, a folder) is refused.
//!
//! Recordings and journals grow for minutes: a recording is written as `R.mcap.part` beside its place and takes its name
//! at the end ([`crate::recording`]), a journal holds whole lines with checksums ([`crate::study::Journal`]).

mod file_system;
mod growing_file;
mod place;
#[cfg(test)]
mod power_cut_tests;
mod whole_file;

pub(crate) use file_system::{name_file, sync_folder_of};
pub(crate) use growing_file::GrowingFile;
pub use place::{folder, regular_file};
pub(crate) use whole_file::make_folder;
pub use whole_file::{pretty, write, write_text};
