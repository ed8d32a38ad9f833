//! The RP2350, as on a Raspberry Pi Pico 2: everything that accesses its registers. The rest of the crate does not depend
//! on it.
//!
//! Each file holds one driver; `docs/use/wiring.md` lists the pins, `link.x` the memory. `image` is what the one program asks for; `servo` and
//! `stepper` hold what is of hobby servos and of steppers. Every wait has a bound. None of this has run on silicon yet;
//! `verify/pico` runs the images against the simulated arm.

pub mod boot;
pub mod clocks;
pub mod end;
pub mod flash;
pub mod image;
pub mod lines;
pub mod pins;
pub mod resets;
pub mod serial;
pub mod servo;
pub mod stepper;
pub mod tool;
pub mod usb;
pub mod watchdog;
