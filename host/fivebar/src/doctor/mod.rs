//! Checks of what some commands need besides this program, and how to get it.
//!
//! Simulation, analyses and reports need only the program itself. The checks are grouped by
//! [`Task`].

mod image;
mod ports;
mod probe;

use fivebar_files::robot::BuiltIn;
use fivebar_firmware::drives::can::BusDrives;
use fivebar_firmware::drives::{BrushedDrives, StepDrives};
use fivebar_sim::boards::IMAGES;
use fivebar_sim::machine::Machine;
pub use image::compare_outputs;
use probe::{first_line, has_header, has_rust_target};
use serde::Serialize;
use std::borrow::Cow;

/// The compiler's name for the Cortex-M4F, as scripts/toolchain.sh has it.
const TARGET: &str = "thumbv7em-none-eabihf";

/// A task that needs more than this program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Task {
    /// Build the images for the microcontroller and the emulated board.
    Firmware,
    /// Run the firmware on the emulated board: `fivebar pil`.
    Pil,
    /// Run the image for the microcontroller on the simulated STM32F405 of the folder chip.
    Chip,
    /// Flash an image to a board.
    Flash,
    /// Connect to a board: `fivebar drive`, `hil`, `monitor`, `serve --port`.
    Port,
    /// Test the live page in a browser, as ci.sh does.
    Browser,
    /// Install the Python package.
    Python,
}

/// The check of one tool or device.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Check {
    /// Its name.
    pub what: Cow<'static, str>,
    /// Its purpose.
    pub purpose: Cow<'static, str>,
    /// The tasks that need it.
    pub needed_for: &'static [Task],
    /// The result.
    #[serde(flatten)]
    pub state: State,
}

/// The result of a check.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum State {
    /// It exists: its version or its path.
    Found(String),
    /// It does not exist: how to get it.
    Missing(String),
    /// It exists, but does not fit this program: the reason, and what to do.
    Outdated(String),
}

impl Check {
    /// Whether it is missing or outdated and one of these tasks needs it.
    pub fn blocks(&self, tasks: &[Task]) -> bool {
        let needed = self.needed_for.iter().any(|task| tasks.contains(task));
        needed && !matches!(self.state, State::Found(_))
    }
}

/// Makes all checks.
pub fn examine() -> Vec<Check> {
    let mut checks = Vec::from(of_boards());
    checks.extend(of_images());
    checks.extend(of_browser_and_python());
    checks
}

/// What boards need, emulated, simulated and real ones.
fn of_boards() -> [Check; 6] {
    [
        Check {
            what: "rustc".into(),
            purpose: "compiles the firmware".into(),
            needed_for: &[Task::Firmware, Task::Chip],
            state: program("rustc", "install Rust with rustup, see https://rustup.rs"),
        },
        Check {
            what: TARGET.into(),
            purpose: "Rust's library for the Cortex-M4F".into(),
            needed_for: &[Task::Firmware, Task::Chip],
            state: match has_rust_target(TARGET) {
                Some(place) => State::Found(place),
                None => State::Missing(format!(
                    "`rustup target add {TARGET}`, or Debian's packages rustc-web and \
                     rust-web-src; scripts/toolchain.sh does either"
                )),
            },
        },
        Check {
            what: "qemu-system-arm".into(),
            purpose: "emulates the Cortex-M4F".into(),
            needed_for: &[Task::Pil],
            state: program(
                "qemu-system-arm",
                "install your system's package of that name; on Debian scripts/toolchain.sh does so",
            ),
        },
        Check {
            what: "unicorn".into(),
            purpose: "emulates the core of the simulated STM32F405".into(),
            needed_for: &[Task::Chip],
            state: match has_header("unicorn/unicorn.h") {
                Some(place) => State::Found(place),
                None => State::Missing(
                    "Unicorn 2 with its header: Debian's package libunicorn-dev; scripts/chip.sh \
                     installs it"
                        .into(),
                ),
            },
        },
        Check {
            what: "probe-rs".into(),
            purpose: "flashes an image to a board with a debug probe".into(),
            needed_for: &[Task::Flash],
            state: program("probe-rs", "`cargo install probe-rs-tools`"),
        },
        Check {
            what: "serial port".into(),
            purpose: "connects to a board".into(),
            needed_for: &[Task::Port],
            state: ports::state(),
        },
    ]
}

/// The firmware for each kind of drives, emulated and for the microcontroller.
fn of_images() -> impl Iterator<Item = Check> {
    let emulated = [
        Check {
            what: "image qemu".into(),
            purpose: "the firmware for the emulated board".into(),
            needed_for: &[Task::Pil],
            state: image::of_emulated_board::<BrushedDrives>(BuiltIn::DEFAULT),
        },
        Check {
            what: "image qemu_stepper".into(),
            purpose: "the same for steppers".into(),
            needed_for: &[Task::Pil],
            state: image::of_emulated_board::<StepDrives>("benchtop_stepper"),
        },
        Check {
            what: "image qemu_can".into(),
            purpose: "the same for drives on a CAN bus".into(),
            needed_for: &[Task::Pil],
            state: image::of_emulated_board::<BusDrives>("leg"),
        },
    ];
    let with_motors = IMAGES.map(|image| Check {
        what: format!("image {}", image.name).into(),
        purpose: format!(
            "the firmware for {} with {}",
            image.chip.called,
            Machine::of(image.drives).motors
        )
        .into(),
        needed_for: &[Task::Flash],
        state: image::state(&image),
    });
    emulated.into_iter().chain(with_motors)
}

/// What the browser's test and the Python package need.
fn of_browser_and_python() -> [Check; 4] {
    [
        Check {
            what: "chromium".into(),
            purpose: "shows the live page in its test".into(),
            needed_for: &[Task::Browser],
            state: program(
                "chromium",
                "Debian's package chromium; scripts/browser.sh installs it",
            ),
        },
        Check {
            what: "chromedriver".into(),
            purpose: "controls the browser in that test".into(),
            needed_for: &[Task::Browser],
            state: program(
                "chromedriver",
                "Debian's package chromium-driver; scripts/browser.sh installs it",
            ),
        },
        Check {
            what: "python3".into(),
            purpose: "runs the Python package and some of the tests".into(),
            needed_for: &[Task::Browser, Task::Python],
            state: program(
                "python3",
                "your system's package python3, with python3-venv",
            ),
        },
        Check {
            what: "maturin".into(),
            purpose: "builds the Python package by hand; pip installs its own".into(),
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
    fn a_check_blocks_a_task_that_needs_what_is_missing_or_outdated() {
        let check = |state| Check {
            what: "".into(),
            purpose: "".into(),
            needed_for: &[Task::Pil, Task::Flash],
            state,
        };
        let missing = check(State::Missing(String::new()));
        assert!(missing.blocks(&[Task::Port, Task::Pil]));
        assert!(!missing.blocks(&[Task::Port]));
        assert!(!missing.blocks(&[]));
        assert!(check(State::Outdated(String::new())).blocks(&[Task::Pil]));
        assert!(!check(State::Found(String::new())).blocks(&[Task::Pil]));
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
