//! Printing on standard output and standard error.

use super::failure::{Failure, refused};
use fivebar_files::robot::Robot;
use fivebar_report::output::STANDARD_OUTPUT;
use std::fmt::Display;
use std::io::{self, ErrorKind, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether a file goes to the standard output, so that lines go to the standard error.
static OUTPUT_IS_A_FILE: AtomicBool = AtomicBool::new(false);

/// Leaves the standard output to `file` if that is `-`: lines are then printed to the standard error.
pub(super) fn leave_output_to(file: &Path) {
    if file == Path::new(STANDARD_OUTPUT) {
        OUTPUT_IS_A_FILE.store(true, Ordering::Relaxed);
    }
}

/// Prints a line to the standard output.
pub(super) fn say(line: impl Display) -> Result<(), Failure> {
    print(format_args!("{line}\n"))
}

/// Prints a text without adding anything. A closed output, as in `fivebar robots | head -1`,
/// is no failure: the command finishes its work, and its exit status shows the result.
pub(super) fn print(text: impl Display) -> Result<(), Failure> {
    if OUTPUT_IS_A_FILE.load(Ordering::Relaxed) {
        return print_to(&mut io::stderr().lock(), text);
    }
    print_to(&mut io::stdout().lock(), text)
}

fn print_to(out: &mut impl Write, text: impl Display) -> Result<(), Failure> {
    match write!(out, "{text}").and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(refused(format_args!("cannot print: {error}")))
        }
        _ => Ok(()),
    }
}

/// Prints a line to the standard error.
pub(super) fn warn(line: impl Display) {
    hint(format_args!("{line}\n"));
}

/// Warns of drives that lose their way by themselves, before an arm with them moves.
pub(super) fn warn_of_drivers(robot: &Robot) {
    if let Some(warning) = robot.voltage_driver_warning() {
        warn(format_args!("{}: {warning}", robot.name));
    }
}

/// Prints a text to the standard error without adding anything.
pub(super) fn hint(text: impl Display) {
    // If this fails, there is no place to report it.
    let _ = write!(io::stderr().lock(), "{text}");
}

#[cfg(test)]
mod tests {
    use super::print_to;
    use std::io::{self, ErrorKind, Write};

    /// An output that fails in one way.
    struct Failing(ErrorKind);

    impl Write for Failing {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(self.0.into())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_closed_output_is_no_failure_but_a_full_disk_is() {
        assert!(print_to(&mut Failing(ErrorKind::BrokenPipe), "text").is_ok());
        let failure = print_to(&mut Failing(ErrorKind::StorageFull), "text").unwrap_err();
        assert!(failure.to_string().contains("cannot print"), "{failure}");
    }
}
