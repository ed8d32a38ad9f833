//! A child process that ends with this process, even if this process is killed.

use std::ffi::OsString;
use std::io::{self, Read, Write};
use std::process::{Child, Command, ExitStatus, Stdio};

/// The shell starts a watcher on the pipe from this process, then becomes the program. A
/// line in the pipe ends the watcher. If the pipe breaks without a line, this process has
/// died, and the watcher kills the program.
const SUPERVISED: &str = r#"exec 3<&0
(read -r line <&3 || kill -9 $$) >/dev/null 2>&1 &
exec "$@" </dev/null 3<&-"#;
/// The shell's exit status for a program that does not exist.
const NOT_FOUND: i32 = 127;

/// A running program. It ends when this value is dropped, and when this process ends, even
/// if this process is killed.
#[derive(Debug)]
pub(super) struct SupervisedChild {
    child: Child,
}

impl SupervisedChild {
    /// Starts a program with these arguments.
    pub(super) fn start(program: &str, arguments: &[OsString]) -> io::Result<Self> {
        let mut command = if cfg!(unix) {
            let mut command = Command::new("sh");
            command.args(["-c", SUPERVISED, "sh", program]);
            command
        } else {
            // Without such a shell the program ends only when this value is dropped.
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

    /// The program's exit status and its stderr; none while it runs.
    ///
    /// # Errors
    /// [`io::ErrorKind::NotFound`] if the program does not exist.
    pub(super) fn end(&mut self) -> io::Result<Option<(ExitStatus, String)>> {
        let Some(status) = self.child.try_wait()? else {
            return Ok(None);
        };
        let mut text = String::new();
        if let Some(stderr) = &mut self.child.stderr {
            stderr.read_to_string(&mut text)?;
        }
        if cfg!(unix) && status.code() == Some(NOT_FOUND) {
            return Err(io::Error::new(io::ErrorKind::NotFound, text));
        }
        Ok(Some((status, text)))
    }
}

impl Drop for SupervisedChild {
    fn drop(&mut self) {
        // These calls fail only if the watcher or the program has already ended.
        if let Some(mut pipe) = self.child.stdin.take() {
            let _ = pipe.write_all(b"\n");
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::SupervisedChild;
    use std::io::ErrorKind;
    use std::time::Duration;

    /// The program's exit status and its stderr, if it ends within 5 s.
    fn end(child: &mut SupervisedChild) -> Option<(std::process::ExitStatus, String)> {
        (0..500).find_map(|_| {
            std::thread::sleep(Duration::from_millis(10));
            child.end().expect("the program exists")
        })
    }

    #[test]
    fn a_program_is_killed_when_the_pipe_to_its_watcher_breaks() {
        let mut child = SupervisedChild::start("sleep", &["1000".into()]).expect("a shell");
        std::thread::sleep(Duration::from_millis(50));
        assert!(child.end().expect("sleep exists").is_none());
        // The same happens when this process dies.
        drop(child.child.stdin.take());
        let (status, _) = end(&mut child).expect("the watcher kills it");
        assert!(!status.success());
    }

    #[test]
    fn the_end_of_a_program_comes_with_its_error_messages() {
        let missing = "/nowhere/at/all";
        let mut child = SupervisedChild::start("ls", &[missing.into()]).expect("a shell");
        let (status, text) = end(&mut child).expect("it ends by itself");
        assert!(!status.success());
        assert!(text.contains(missing), "{text}");
    }

    #[test]
    fn a_program_that_does_not_exist_is_reported_as_not_found() {
        let mut child = SupervisedChild::start("no-such-program", &[]).expect("a shell");
        let error = (0..500).find_map(|_| {
            std::thread::sleep(Duration::from_millis(10));
            child.end().err()
        });
        assert_eq!(error.expect("an error").kind(), ErrorKind::NotFound);
    }
}
