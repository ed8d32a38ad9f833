//! Files that are written completely or not at all.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file could not be written; no part of it remains.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {source}; choose another folder or free the file", path.display())]
pub struct WriteError {
    path: PathBuf,
    source: std::io::Error,
}

/// Writes a temporary file in the same folder and renames it, so that a reader finds either
/// the old or the new file, complete. Makes the folder if it does not exist.
///
/// # Errors
/// The system's error, with the path.
pub fn write_whole(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), WriteError> {
    written(path, bytes.as_ref())
        .and_then(|file| Ok(file.persist(path).map(drop)?))
        .map_err(|source| refusal(path, source))
}

/// Like [`write_whole`], but does not replace an existing file.
///
/// # Errors
/// As [`write_whole`], or the file exists.
pub fn write_new(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), WriteError> {
    written(path, bytes.as_ref())
        .and_then(|file| Ok(file.persist_noclobber(path).map(drop)?))
        .map_err(|source| refusal(path, source))
}

fn refusal(path: &Path, source: std::io::Error) -> WriteError {
    WriteError {
        path: path.to_owned(),
        source,
    }
}

/// A temporary file beside `path` with its content.
fn written(path: &Path, bytes: &[u8]) -> std::io::Result<NamedTempFile> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    std::fs::create_dir_all(folder)?;
    let mut builder = tempfile::Builder::new();
    // A temporary file is private by default; the final file must obey the umask.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder)?;
    file.write_all(bytes)?;
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::{write_new, write_whole};

    #[test]
    fn replaces_a_file_and_leaves_no_temporary_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/report.html");
        write_whole(&path, "old").unwrap();
        write_whole(&path, "new").unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "new");
        let beside = std::fs::read_dir(path.parent().unwrap()).unwrap().count();
        assert_eq!(beside, 1);
    }

    #[test]
    fn a_new_file_does_not_replace_an_existing_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("arm.toml");
        write_new(&path, "first").unwrap();
        let refusal = write_new(&path, "second").unwrap_err().to_string();
        assert!(refusal.contains("arm.toml"), "{refusal}");
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "first");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn refuses_a_folder_that_is_a_file_and_names_the_path() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("taken");
        std::fs::write(&file, "").unwrap();
        let refusal = write_whole(&file.join("report.html"), "x").unwrap_err();
        assert!(refusal.to_string().contains("taken/report.html"));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_refused_replacement_leaves_no_partial_file() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("report.html");
        std::fs::create_dir(&target).unwrap();
        assert!(write_whole(&target, "x").is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
