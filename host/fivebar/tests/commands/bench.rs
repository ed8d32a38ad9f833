//! The program, run in a folder of its own.

use fivebar_testkit::program;
use std::path::PathBuf;
use std::process::Output;

/// A temporary folder in which `fivebar` is run.
pub(crate) struct Bench(tempfile::TempDir);

impl Bench {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Writes a file and returns its path.
    pub(crate) fn file(&self, name: &str, text: &str) -> String {
        let path = self.path(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().into()
    }

    /// Runs `fivebar sim` in the folder.
    pub(crate) fn sim(&self, arguments: &[&str]) -> Output {
        self.run(&[&["sim"], arguments].concat())
    }

    /// Runs `fivebar` in the folder.
    pub(crate) fn run(&self, arguments: &[&str]) -> Output {
        program(env!("CARGO_BIN_EXE_fivebar"))
            .args(arguments)
            .current_dir(self.0.path())
            .output()
            .unwrap()
    }
}
