#![doc = include_str!("../README.md")]

mod acquire;
mod arm;
mod board;
mod bus;
mod chip;
mod flags;
mod flash;
mod fpu;
mod image;
mod line;
mod masks;
mod pins;
mod rom;
mod uart;
mod usb;
mod usb_host;
mod watchdog;

pub use arm::{Arm, ServoArm, StepperArm};
pub use bus::Violation;
pub use chip::{Chip, HZ};
pub use flash::{FlashEvent, Share};
pub use image::{Image, ImageError};
pub use line::HostLine;
pub use pins::{PULSES, Pulse, Wires};
pub use usb_host::UsbHost;
