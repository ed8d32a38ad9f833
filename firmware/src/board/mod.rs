//! The STM32F405RG: all that touches registers. Nothing above knows which board it is on.
//!
//! One driver a file; `docs/wiring.md` has the pins. No driver waits without a bound, and
//! none has run on silicon yet: `docs/bring-up.md` says what an emulator could show.

pub mod analog;
pub mod clocks;
pub mod cycles;
pub mod encoders;
pub mod instructions;
pub mod log;
pub mod outputs;
pub mod pins;
pub mod post_mortem;
pub mod pwm;
pub mod sensors;
pub mod serial;
pub mod services;
pub mod stack;
pub mod storage;
pub mod watchdog;
