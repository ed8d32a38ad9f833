//! The folder for the files of a run.

use super::write::{WriteError, is_stream, write_report};
use std::path::{Path, PathBuf};

/// A folder that can be written to. It is made with its files, so that an interrupted run leaves
/// no empty folder.
#[derive(Debug)]
pub struct OutputFolder {
    path: PathBuf,
}

/// The folder cannot be written to.
#[derive(Debug, thiserror::Error)]
#[error("cannot write to folder {}: {source}; choose another with {option}", path.display())]
pub struct FolderError {
    path: PathBuf,
    option: &'static str,
    source: std::io::Error,
}

impl OutputFolder {
    /// Like [`OutputFolder::prepare`], for the folder of a file. None if `file` is a device, a
    /// FIFO or a socket: nothing is written beside it.
    ///
    /// # Errors
    /// The system's error.
    pub fn prepare_for(file: &Path, option: &'static str) -> Result<Option<Self>, FolderError> {
        if is_stream(file) {
            return Ok(None);
        }
        let folder = file.parent().filter(|path| !path.as_os_str().is_empty());
        Self::prepare(folder.unwrap_or(Path::new(".")), option).map(Some)
    }

    /// Makes sure, before a run, that files can be written to `path`. `option` is the option
    /// of the command line that names it.
    ///
    /// # Errors
    /// The system's error.
    pub fn prepare(path: &Path, option: &'static str) -> Result<Self, FolderError> {
        let refused = |source| FolderError {
            path: path.to_owned(),
            option,
            source,
        };
        let missing = path.ancestors().filter(|p| !p.as_os_str().is_empty());
        let mut made: Vec<_> = missing
            .take_while(|p| !p.exists())
            .map(Path::to_owned)
            .collect();
        let tried = std::fs::create_dir_all(path).and_then(|()| tempfile::tempfile_in(path));
        // The innermost first; this removes empty folders only.
        made.retain(|made| std::fs::remove_dir(made).is_err());
        tried.map_err(refused)?;
        Ok(Self {
            path: path.to_owned(),
        })
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the files of one report by name; the first is the one that a reader opens
    /// ([`write_report`]).
    ///
    /// # Errors
    /// The first that could not be written.
    pub fn write(&self, files: &[(&str, &dyn AsRef<[u8]>)]) -> Result<(), WriteError> {
        write_report(&self.path, files)
    }
}
