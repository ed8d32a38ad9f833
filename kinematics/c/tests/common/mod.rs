//! The system's compilers, and the static library that scripts/c.sh builds and names in FIVEBAR_LIBRARY.

use std::env;
use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Compiles `sources` with the header and the library to a program of this name.
pub(crate) fn compile(
    compiler: &str,
    arguments: &[&str],
    sources: &[&Path],
    name: &str,
) -> PathBuf {
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let output = Command::new(compiler)
        .args(["-Wall", "-Wextra", "-Werror", "-pedantic", "-O1"])
        .args(["-Wl,--gc-sections", "-Iinclude", "-o"])
        .arg(&program)
        .args(arguments)
        .args(sources)
        .args(["-x", "none"])
        .arg(library())
        .output()
        .unwrap_or_else(|error| panic!("{compiler}: {error}"));
    assert!(
        output.status.success(),
        "{name}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    program
}

fn library() -> OsString {
    env::var_os("FIVEBAR_LIBRARY").expect("FIVEBAR_LIBRARY names the static library")
}

/// What a program prints, given this input; its status must be 0.
pub(crate) fn printed(program: &Path, input: String) -> String {
    let mut child = Command::new(program)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut pipe = child.stdin.take().unwrap();
    let writer = std::thread::spawn(move || pipe.write_all(input.as_bytes()));
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{}: {text}", program.display());
    text
}
