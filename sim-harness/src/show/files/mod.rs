//! Files and folders that are left behind: whole or not at all.

mod folder;
mod write;

pub use folder::{OutputFolder, Unwritable};
pub use write::{WriteError, write_new, write_whole};
