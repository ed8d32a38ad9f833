//! The emulated board: QEMU's `netduinoplus2`, an STM32F405 without working timers.

mod instructions;

pub use instructions::InstructionCounter;
