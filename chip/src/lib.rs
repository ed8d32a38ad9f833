#![doc = include_str!("../README.md")]

mod access;
mod arm;
mod bus;
mod callbacks;
mod chip;
mod cpu;
mod events;
mod exceptions;
mod figures;
mod host;
mod image;
mod locate;
mod mcu;
mod nvic;
mod peripherals;
mod pwr;
mod register;
mod systick;
pub mod time;
mod unicorn;
mod violation;
mod wiring;

pub use arm::{Arm, SharedArm, Tick};
pub use chip::{Chip, Report};
pub use figures::{Figures, Summary};
pub use host::HostLine;
pub use image::{Image, ImageError};
pub use mcu::Options;
pub use peripherals::adc::SampleWindow;
pub use peripherals::flash::FlashEvent;
pub use peripherals::gpio::Pin;
pub use peripherals::rcc::ResetCause;
pub use peripherals::tim1::{Output, RepetitionReading};
pub use unicorn::EmulatorError;
pub use violation::{Access, Violation};
pub use wiring::{Outputs, Unwired, Wiring};
