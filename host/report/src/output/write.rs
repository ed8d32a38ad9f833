//! Files that are written completely or not at all.
//!
//! A regular file is written under another name in its folder, made durable, and renamed, so
//! that a reader finds either the old or the new file, complete, also after a power cut.
//! A symbolic link that the user names stays and its file is replaced. One that lies in a report's folder under the name
//! of one of its files is replaced itself, because the user has not named it and its file may be foreign. A device, a
//! FIFO or a socket stays, too, and the bytes are written into it. The path `-` stands for the standard output.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Error, ErrorKind, Write as _};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file could not be written; no part of it remains.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {source}; choose another folder or free the file", path.display())]
pub struct WriteError {
    path: PathBuf,
    source: io::Error,
}

/// The path that stands for the standard output.
pub const STANDARD_OUTPUT: &str = "-";

/// Writes a file. Makes its folder if it does not exist.
///
/// # Errors
/// The system's error, with the path.
pub fn write_whole(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), WriteError> {
    Draft::new(path, bytes.as_ref())
        .and_then(Draft::finish)
        .map_err(|source| refusal(path, source))
}

/// Like [`write_whole`], but does not replace an existing file.
///
/// # Errors
/// As [`write_whole`], or the file exists.
pub fn write_new(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), WriteError> {
    if path == Path::new(STANDARD_OUTPUT) {
        return write_whole(path, bytes);
    }
    written(path, bytes.as_ref())
        .and_then(|file| Ok(file.persist_noclobber(path).map(drop)?))
        .map_err(|source| refusal(path, source))
}

/// Writes one file, whose name the program has chosen, into a folder that the user has named. It replaces a symbolic
/// link.
///
/// # Errors
/// As [`write_whole`].
pub fn write_in(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) -> Result<(), WriteError> {
    write_report(folder, &[(name, &bytes)])
}

/// The names of the files that belong to a report.html.
const REPORT_FILES: [&str; 7] = [
    "picture.svg",
    "summary.json",
    "table.csv",
    "trace.csv",
    "workspace.csv",
    "workspace.png",
    "workspace.svg",
];

/// Writes the files of one report into a folder. The first is the one that a reader opens. It is
/// there only while all files are of the same report: an old one is removed before the others are
/// replaced, and the new one follows them. An interruption therefore leaves all the old files, all
/// the new ones, or no first file. Files that belong to the old first file and that the new report does
/// not have are removed with it.
///
/// # Errors
/// The first that could not be written. If it could not even be prepared, nothing has changed.
pub fn write_report(folder: &Path, files: &[(&str, &dyn AsRef<[u8]>)]) -> Result<(), WriteError> {
    let mut drafts = Vec::new();
    for (name, bytes) in files {
        let path = folder.join(name);
        let draft = Draft::of_report(&path, bytes.as_ref());
        drafts.push((draft.map_err(|source| refusal(&path, source))?, path));
    }
    if let [(first, path), _, ..] = drafts.as_slice() {
        let had_report = fs::symlink_metadata(path).is_ok_and(|data| data.is_file());
        first.remove_old().map_err(|source| refusal(path, source))?;
        let replaced = |name: &&str| files.iter().any(|(written, _)| written == name);
        for name in REPORT_FILES
            .iter()
            .filter(|name| had_report && !replaced(name))
        {
            let path = folder.join(name);
            // A folder or a link of that name is none of a report's files.
            if fs::symlink_metadata(&path).is_ok_and(|data| data.is_file()) {
                fs::remove_file(&path).map_err(|source| refusal(&path, source))?;
            }
        }
    }
    // The first file comes last.
    let first = usize::from(!drafts.is_empty());
    drafts.rotate_left(first);
    for (draft, path) in drafts {
        draft.finish().map_err(|source| refusal(&path, source))?;
    }
    Ok(())
}

/// Whether `path` leads to the standard output, a device, a FIFO or a socket, into which bytes are written.
pub(super) fn is_stream(path: &Path) -> bool {
    if path == Path::new(STANDARD_OUTPUT) {
        return true;
    }
    let open = ["/dev/fd", "/dev/std", "/proc"];
    let text = path.to_string_lossy();
    let named = open.iter().any(|prefix| text.starts_with(prefix));
    // An open file of a process, by its number, is not to be replaced either.
    fs::metadata(path).is_ok_and(|data| named || !(data.is_file() || data.is_dir()))
}

/// A file that is ready to be put in its place.
enum Draft<'a> {
    /// It replaces the file at this path.
    File(NamedTempFile, PathBuf),
    /// Its bytes go into what is at this path.
    Stream(&'a [u8], PathBuf),
}

impl<'a> Draft<'a> {
    fn new(path: &Path, bytes: &'a [u8]) -> io::Result<Self> {
        if is_stream(path) {
            return Ok(Self::Stream(bytes, path.to_owned()));
        }
        let target = behind_links(path)?;
        Ok(Self::File(written(&target, bytes)?, target))
    }

    /// As [`Draft::new`], for a path whose last part the user has not named: it replaces a symbolic link.
    fn of_report(path: &Path, bytes: &'a [u8]) -> io::Result<Self> {
        if is_link(path) {
            return Ok(Self::File(written(path, bytes)?, path.to_owned()));
        }
        Self::new(path, bytes)
    }

    /// Removes the file that this one will replace.
    fn remove_old(&self) -> io::Result<()> {
        match self {
            Self::File(_, path) => match fs::remove_file(path) {
                Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
                removed => removed.and_then(|()| sync_folder(path)),
            },
            Self::Stream(..) => Ok(()),
        }
    }

    fn finish(self) -> io::Result<()> {
        match self {
            Self::File(file, path) => {
                file.persist(&path)?;
                sync_folder(&path)
            }
            Self::Stream(bytes, path) if path == Path::new(STANDARD_OUTPUT) => {
                let mut out = io::stdout().lock();
                match out.write_all(bytes).and_then(|()| out.flush()) {
                    // The reader has read what it wanted, as `head` does.
                    Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
                    written => written,
                }
            }
            Self::Stream(bytes, path) => {
                let mut stream = OpenOptions::new().append(true).open(path)?;
                stream.write_all(bytes)?;
                stream.flush()
            }
        }
    }
}

fn is_link(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|data| data.is_symlink())
}

/// The file to which symbolic links lead.
fn behind_links(path: &Path) -> io::Result<PathBuf> {
    if !is_link(path) {
        return Ok(path.to_owned());
    }
    fs::canonicalize(path).map_err(|error| {
        Error::new(
            error.kind(),
            format!("the symbolic link leads to no file ({error})"),
        )
    })
}

fn refusal(path: &Path, source: io::Error) -> WriteError {
    WriteError {
        path: path.to_owned(),
        source,
    }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// A temporary file beside `path` with its content, which is on the disk.
fn written(path: &Path, bytes: &[u8]) -> io::Result<NamedTempFile> {
    let folder = folder_of(path);
    fs::create_dir_all(folder)?;
    #[cfg_attr(not(unix), expect(unused_mut))]
    let mut builder = tempfile::Builder::new();
    // A temporary file is private by default; the final file must obey the umask.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    Ok(file)
}

/// Makes a change of names durable. Some file systems cannot: then nothing more can be done.
fn sync_folder(path: &Path) -> io::Result<()> {
    if cfg!(unix) {
        let _ = File::open(folder_of(path))?.sync_all();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{write_new, write_report, write_whole};

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

    #[test]
    fn a_report_is_whole_or_has_no_first_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let read = |name: &str| std::fs::read_to_string(path(name)).ok();
        let write = |text: &str| {
            write_report(
                folder.path(),
                &[("report.html", &text), ("trace.csv", &text)],
            )
        };
        write("old").unwrap();
        write("new").unwrap();
        assert_eq!(read("report.html").as_deref(), Some("new"));
        assert_eq!(read("trace.csv").as_deref(), Some("new"));
        // The trace cannot be replaced. The old report would stand beside files of a new run.
        std::fs::remove_file(path("trace.csv")).unwrap();
        std::fs::create_dir(path("trace.csv")).unwrap();
        assert!(write("newer").is_err());
        assert_eq!(read("report.html"), None);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn nothing_changes_if_one_file_of_a_report_cannot_be_prepared() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("report.html");
        std::fs::write(&path, "old").unwrap();
        let refused = write_report(
            folder.path(),
            &[("report.html", &"new"), ("report.html/trace.csv", &"new")],
        );
        assert!(refused.is_err());
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
    }

    #[cfg(unix)]
    #[test]
    fn a_symbolic_link_stays_and_its_file_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let [target, link] = ["target", "link"].map(|name| folder.path().join(name));
        std::os::unix::fs::symlink("target", &link).unwrap();
        let refusal = write_whole(&link, "x").unwrap_err().to_string();
        assert!(refusal.contains("leads to no file"), "{refusal}");
        std::fs::write(&target, "old").unwrap();
        write_whole(&link, "new").unwrap();
        assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(std::fs::read_to_string(&target).unwrap(), "new");
    }

    /// The user has named the folder, which may be a link, and not the files in it.
    #[cfg(unix)]
    #[test]
    fn a_report_replaces_symbolic_links_of_its_names_and_leaves_their_files() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::create_dir(path("reports")).unwrap();
        symlink("reports", path("out")).unwrap();
        std::fs::write(path("foreign"), "old").unwrap();
        symlink("../foreign", path("reports/report.html")).unwrap();
        symlink("nowhere", path("reports/trace.csv")).unwrap();
        let files: [(&str, &dyn AsRef<[u8]>); 2] = [("report.html", &"new"), ("trace.csv", &"new")];
        write_report(&path("out"), &files).unwrap();
        assert_eq!(std::fs::read_to_string(path("foreign")).unwrap(), "old");
        for (name, _) in files {
            let written = path("reports").join(name);
            assert!(std::fs::symlink_metadata(&written).unwrap().is_file());
            assert_eq!(std::fs::read_to_string(written).unwrap(), "new");
        }
        assert!(std::fs::symlink_metadata(path("out")).unwrap().is_symlink());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_device_and_a_fifo_are_written_into_and_stay() {
        use std::os::unix::fs::FileTypeExt as _;
        let folder = tempfile::tempdir().unwrap();
        let fifo = folder.path().join("fifo");
        let made = std::process::Command::new("mkfifo").arg(&fifo).status();
        assert!(made.unwrap().success());
        let reader = {
            let fifo = fifo.clone();
            std::thread::spawn(move || std::fs::read_to_string(fifo).unwrap())
        };
        write_whole(&fifo, "through").unwrap();
        assert_eq!(reader.join().unwrap(), "through");
        let kind = |path: &std::path::Path| std::fs::symlink_metadata(path).unwrap().file_type();
        assert!(kind(&fifo).is_fifo());
        write_whole("/dev/null".as_ref(), "x").unwrap();
        let refusal = write_whole("/dev/full".as_ref(), "x").unwrap_err();
        assert!(refusal.to_string().contains("/dev/full"), "{refusal}");
        for device in ["/dev/null", "/dev/full"] {
            assert!(kind(device.as_ref()).is_char_device(), "{device}");
        }
        let entries = std::fs::read_dir(folder.path()).unwrap().count();
        assert_eq!(entries, 1, "no temporary file remains");
    }
}
