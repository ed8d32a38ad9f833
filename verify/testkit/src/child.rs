//! Programs that tests start, of which none outlives its test.

use std::ops::{Deref, DerefMut};
use std::path::PathBuf;
use std::process::{Child, Command};

/// This program, to be started by the thread of a test. On Linux the system kills it when that thread ends, however it
/// ends: also if the test fails, or if the process of the tests is killed.
pub fn program(path: &str) -> Command {
    // Of util-linux. It becomes the program, so the process and its signals are the program's.
    let Some(setpriv) = find("setpriv").filter(|_| cfg!(target_os = "linux")) else {
        return Command::new(path);
    };
    let mut command = Command::new(setpriv);
    command.args(["--pdeathsig", "KILL", "--", path]);
    command
}

/// A program of this machine. The one that a test starts may be given another path to search.
fn find(name: &str) -> Option<PathBuf> {
    let folders = std::env::var_os("PATH")?;
    let mut paths = std::env::split_paths(&folders).map(|folder| folder.join(name));
    paths.find(|path| path.is_file())
}

/// A program that is killed, and waited for, when this value is dropped.
#[derive(Debug)]
pub struct Running(Option<Child>);

impl Running {
    /// Starts it.
    ///
    /// # Panics
    /// If it cannot be started.
    pub fn start(command: &mut Command) -> Self {
        Self(Some(command.spawn().expect("the program starts")))
    }

    /// The process, for whoever waits for its end.
    ///
    /// # Panics
    /// Never: the process is there until this value is gone.
    pub fn into_child(mut self) -> Child {
        self.0.take().expect("a process")
    }
}

impl Deref for Running {
    type Target = Child;

    fn deref(&self) -> &Child {
        self.0.as_ref().expect("a process")
    }
}

impl DerefMut for Running {
    fn deref_mut(&mut self) -> &mut Child {
        self.0.as_mut().expect("a process")
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        if let Some(child) = &mut self.0 {
            // It may have ended by itself.
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}
