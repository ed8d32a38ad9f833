//! The folder that a run leaves behind: report, trace and figures.

use super::write::{WriteError, write_whole};
use std::path::{Path, PathBuf};

/// A folder that can be written to. If nothing is, those folders that were made for it are
/// taken away again.
#[derive(Debug)]
pub struct OutputFolder {
    path: PathBuf,
    /// Outermost first.
    made: Vec<PathBuf>,
}

/// The folder cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("cannot write to folder {}: {source}; choose another with {option}", path.display())]
pub struct Unwritable {
    path: PathBuf,
    option: &'static str,
    source: std::io::Error,
}

impl OutputFolder {
    /// Makes sure, before anything is run, that files can be written to `path`, which the
    /// command line's `option` names.
    ///
    /// # Errors
    /// What the system says.
    pub fn prepare(path: &Path, option: &'static str) -> Result<Self, Unwritable> {
        let refused = |source| Unwritable {
            path: path.to_owned(),
            option,
            source,
        };
        let missing = path.ancestors().filter(|p| !p.as_os_str().is_empty());
        let mut made: Vec<_> = missing
            .take_while(|p| !p.exists())
            .map(Path::to_owned)
            .collect();
        made.reverse();
        let folder = Self {
            path: path.to_owned(),
            made,
        };
        std::fs::create_dir_all(path).map_err(refused)?;
        tempfile::tempfile_in(path).map_err(refused)?;
        Ok(folder)
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes files by name, each whole or not at all.
    ///
    /// # Errors
    /// The first that could not be written.
    pub fn write(&self, files: &[(&str, &dyn AsRef<[u8]>)]) -> Result<(), WriteError> {
        for (name, bytes) in files {
            write_whole(&self.path.join(name), bytes.as_ref())?;
        }
        Ok(())
    }
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        // Only empty folders can be removed so: what was written stays.
        for made in self.made.iter().rev() {
            if std::fs::remove_dir(made).is_err() {
                return;
            }
        }
    }
}
