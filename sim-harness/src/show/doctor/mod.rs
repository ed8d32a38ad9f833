//! What this machine has of what some commands need, and how to get the rest.
//!
//! Simulating, analysing and reporting need nothing but the program itself; the rest is
//! grouped by what one may want to do, a [`Task`].

mod image;
mod ports;
mod probe;

pub use image::answers_alike;
use probe::{first_line, has_rust_target};
use serde::Serialize;

/// The compiler's name for the Cortex-M4F, as scripts/toolchain.sh has it.
const TARGET: &str = "thumbv7em-none-eabihf";

/// What one may want to do that needs more than this program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Task {
    /// Build the images for the microcontroller and the emulated board.
    Firmware,
    /// Run the firmware on the emulated board: `fivebar pil`.
    Pil,
    /// Put an image on a board.
    Flash,
    /// Talk to a board: `fivebar drive`, `hil`, `monitor`, `serve --port`.
    Port,
    /// Test the live page in a browser, as ci.sh does.
    Browser,
    /// Install the Python package.
    Python,
}

/// One thing that was looked for.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Check {
    /// What was looked for.
    pub what: &'static str,
    /// What it is for.
    pub purpose: &'static str,
    /// The tasks that cannot be done without it.
    pub needed_for: &'static [Task],
    /// What was found.
    #[serde(flatten)]
    pub state: State,
}

/// Whether a thing is there.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum State {
    /// It is: its version, or where it is.
    Found(String),
    /// It is not: how to get it.
    Missing(String),
    /// It is, but not as this program needs it: why, and what to do.
    Outdated(String),
}

impl Check {
    /// Whether it is missing or outdated and one of these tasks needs it.
    pub fn is_in_the_way_of(&self, tasks: &[Task]) -> bool {
        let needed = self.needed_for.iter().any(|task| tasks.contains(task));
        needed && !matches!(self.state, State::Found(_))
    }
}

/// Looks for everything.
pub fn examine() -> Vec<Check> {
    vec![
        Check {
            what: "rustc",
            purpose: "compiles the firmware",
            needed_for: &[Task::Firmware],
            state: program("rustc", "install Rust with rustup, see https://rustup.rs"),
        },
        Check {
            what: TARGET,
            purpose: "Rust's library for the Cortex-M4F",
            needed_for: &[Task::Firmware],
            state: match has_rust_target(TARGET) {
                Some(place) => State::Found(place),
                None => State::Missing(format!(
                    "`rustup target add {TARGET}`, or Debian's packages rustc-web and \
                     rust-web-src; scripts/toolchain.sh does either"
                )),
            },
        },
        Check {
            what: "qemu-system-arm",
            purpose: "emulates the Cortex-M4F",
            needed_for: &[Task::Pil],
            state: program(
                "qemu-system-arm",
                "install your system's package of that name; scripts/toolchain.sh does on Debian",
            ),
        },
        Check {
            what: "image qemu",
            purpose: "the firmware for the emulated board",
            needed_for: &[Task::Pil],
            state: image::of_emulated_board(),
        },
        Check {
            what: "image stm32f405",
            purpose: "the firmware for the microcontroller",
            needed_for: &[Task::Flash],
            state: image::state("stm32f405"),
        },
        Check {
            what: "probe-rs",
            purpose: "puts an image on a board by a debug probe",
            needed_for: &[Task::Flash],
            state: program("probe-rs", "`cargo install probe-rs-tools`"),
        },
        Check {
            what: "serial port",
            purpose: "the way to a board",
            needed_for: &[Task::Port],
            state: ports::state(),
        },
        Check {
            what: "chromium",
            purpose: "shows the live page to its test",
            needed_for: &[Task::Browser],
            state: program(
                "chromium",
                "Debian's package chromium; scripts/browser.sh installs it",
            ),
        },
        Check {
            what: "chromedriver",
            purpose: "drives the browser in that test",
            needed_for: &[Task::Browser],
            state: program(
                "chromedriver",
                "Debian's package chromium-driver; scripts/browser.sh installs it",
            ),
        },
        Check {
            what: "python3",
            purpose: "runs the Python package and some of the tests",
            needed_for: &[Task::Browser, Task::Python],
            state: program(
                "python3",
                "your system's package python3, with python3-venv",
            ),
        },
        Check {
            what: "maturin",
            purpose: "builds the Python package by hand; pip fetches its own",
            needed_for: &[],
            state: program("maturin", "`pip install maturin`"),
        },
    ]
}

fn program(name: &str, get: &str) -> State {
    match first_line(name, &["--version"]) {
        Some(version) => State::Found(version),
        None => State::Missing(get.into()),
    }
}

#[cfg(test)]
mod tests {
    use super::{Check, State, Task, examine};

    #[test]
    fn only_what_is_needed_and_missing_or_outdated_is_in_the_way() {
        let check = |state| Check {
            what: "",
            purpose: "",
            needed_for: &[Task::Pil, Task::Flash],
            state,
        };
        let missing = check(State::Missing(String::new()));
        assert!(missing.is_in_the_way_of(&[Task::Port, Task::Pil]));
        assert!(!missing.is_in_the_way_of(&[Task::Port]));
        assert!(!missing.is_in_the_way_of(&[]));
        assert!(check(State::Outdated(String::new())).is_in_the_way_of(&[Task::Pil]));
        assert!(!check(State::Found(String::new())).is_in_the_way_of(&[Task::Pil]));
    }

    #[test]
    fn every_task_needs_something() {
        let checks = examine();
        for task in <Task as clap::ValueEnum>::value_variants() {
            assert!(
                checks.iter().any(|check| check.needed_for.contains(task)),
                "{task:?}"
            );
        }
    }
}
