//! Output files, written completely or not at all, and their folders.

mod folder;
mod write;

pub use folder::{FolderError, OutputFolder};
pub use write::{STANDARD_OUTPUT, WriteError, write_in, write_new, write_report, write_whole};
