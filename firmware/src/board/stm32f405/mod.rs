//! The STM32F405RG: everything that accesses registers. The rest of the crate does not depend on
//! it.
//!
//! Each file holds one driver; `docs/use/wiring.md` lists the pins, `memory.x` the memory. [`image`] is what the one program asks for, and
//! [`brushed`], [`stepper`] and [`can`] are what it has for one kind of drive alone. Every wait has a bound. None of this has run on silicon yet: `docs/use/bring-up.md` says what the
//! emulator has shown.

pub mod brown_out;
pub mod brushed;
pub mod can;
pub mod clocks;
pub mod crystal;
pub mod gpio;
pub mod halt;
pub mod image;
pub mod pins;
pub mod post_mortem;
pub mod self_test;
pub mod serial;
pub mod stepper;
pub mod storage;
pub mod tool;
pub mod watchdog;
