//! A child process that does not outlive this one, however this one ends.

use std::ffi::OsString;
use std::io::{self, Read, Write};
use std::process::{Child, Command, ExitStatus, Stdio};

/// What the shell does before it becomes the program: it leaves behind a watcher on the
/// pipe from this process. A line tells the watcher that all is well; when the pipe breaks
/// without one, this process is gone, and the watcher kills the program.
const WATCHED: &str = r#"exec 3<&0
(read -r line <&3 || kill -9 $$) >/dev/null 2>&1 &
exec "$@" </dev/null 3<&-"#;
/// What a shell says of a program that is not there.
const NOT_FOUND: i32 = 127;

/// A running program; it ends with this value, and with this process even if that is
/// killed.
#[derive(Debug)]
pub(super) struct KeptChild {
    child: Child,
}

impl KeptChild {
    /// Starts a program with these arguments.
    pub(super) fn start(program: &str, arguments: &[OsString]) -> io::Result<Self> {
        let mut command = if cfg!(unix) {
            let mut command = Command::new("sh");
            command.args(["-c", WATCHED, "sh", program]);
            command
        } else {
            // No such shell: the program ends with this value at least.
            Command::new(program)
        };
        let child = command
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()?;
        Ok(Self { child })
    }

    /// How the program ended and what it complained of, if it has ended.
    ///
    /// # Errors
    /// [`io::ErrorKind::NotFound`] if there is no such program.
    pub(super) fn end(&mut self) -> io::Result<Option<(ExitStatus, String)>> {
        let Some(status) = self.child.try_wait()? else {
            return Ok(None);
        };
        let mut words = String::new();
        if let Some(stderr) = &mut self.child.stderr {
            stderr.read_to_string(&mut words)?;
        }
        if cfg!(unix) && status.code() == Some(NOT_FOUND) {
            return Err(io::Error::new(io::ErrorKind::NotFound, words));
        }
        Ok(Some((status, words)))
    }
}

impl Drop for KeptChild {
    fn drop(&mut self) {
        // These fail only if watcher or program are gone already, which is what is wanted.
        if let Some(mut pipe) = self.child.stdin.take() {
            let _ = pipe.write_all(b"\n");
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::KeptChild;
    use std::io::ErrorKind;
    use std::time::Duration;

    /// The end of a program within 5 s.
    fn end(child: &mut KeptChild) -> Option<(std::process::ExitStatus, String)> {
        (0..500).find_map(|_| {
            std::thread::sleep(Duration::from_millis(10));
            child.end().expect("a program that is there")
        })
    }

    #[test]
    fn a_program_is_killed_when_the_pipe_to_its_watcher_breaks() {
        let mut child = KeptChild::start("sleep", &["1000".into()]).expect("a shell");
        std::thread::sleep(Duration::from_millis(50));
        assert!(child.end().expect("sleep is there").is_none());
        // As when this process dies.
        drop(child.child.stdin.take());
        let (status, _) = end(&mut child).expect("killed");
        assert!(!status.success());
    }

    #[test]
    fn a_program_that_ends_is_told_with_its_complaint() {
        let missing = "/nowhere/at/all";
        let mut child = KeptChild::start("ls", &[missing.into()]).expect("a shell");
        let (status, words) = end(&mut child).expect("it ends by itself");
        assert!(!status.success());
        assert!(words.contains(missing), "{words}");
    }

    #[test]
    fn a_program_that_is_not_there_is_told() {
        let mut child = KeptChild::start("no-such-program", &[]).expect("a shell");
        let error = (0..500).find_map(|_| {
            std::thread::sleep(Duration::from_millis(10));
            child.end().err()
        });
        assert_eq!(error.expect("an end").kind(), ErrorKind::NotFound);
    }
}
