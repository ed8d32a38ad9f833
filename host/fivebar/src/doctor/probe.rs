//! Calls of other programs.

use std::path::Path;
use std::process::{Command, Stdio};

/// The library's source in Debian's package rust-web-src.
const DEBIAN_SOURCE: &str = "/usr/lib/rustlib/src/rust/library/core/src/lib.rs";

/// The first line that a program prints; none if the program does not exist or fails.
pub(super) fn first_line(program: &str, arguments: &[&str]) -> Option<String> {
    let mut command = Command::new(program);
    let output = command.args(arguments).stdin(Stdio::null()).output().ok()?;
    let text = String::from_utf8_lossy(&output.stdout);
    let line = text.lines().find(|line| !line.trim().is_empty())?;
    output.status.success().then(|| line.trim().to_owned())
}

/// The path of the library for a target, compiled or as Debian's source.
pub(super) fn has_rust_target(target: &str) -> Option<String> {
    let compiled = first_line("rustc", &["--print", "sysroot"])
        .map(|sysroot| Path::new(&sysroot).join("lib/rustlib").join(target));
    let debian = || Some(Path::new(DEBIAN_SOURCE).to_owned());
    let found = compiled.filter(|path| path.is_dir()).or_else(debian)?;
    found.exists().then(|| found.display().to_string())
}

/// The path of a C library's header.
pub(super) fn has_header(name: &str) -> Option<String> {
    const FOLDERS: [&str; 3] = [
        "/usr/include",
        "/usr/local/include",
        "/opt/homebrew/include",
    ];
    let mut paths = FOLDERS.iter().map(|folder| Path::new(folder).join(name));
    let found = paths.find(|path| path.is_file())?;
    Some(found.display().to_string())
}
