//! What a board is.
//!
//! A board is a folder here. It holds the drivers of its registers and its program, of which those with a chip of their own share
//! the folder `image`. The program
//!
//! - gives the controller an [`ArmSample`](crate::ArmSample) at each tick, and its [`ArmCommand`](crate::ArmCommand) to the drives or, where
//!   the host steps the ticks, to the host;
//! - carries bytes to and from the [session](crate::session), and implements [`Board`](crate::session::Board) for it;
//! - keeps the controller behind a lock, as [`SharedController`](crate::session::SharedController); on a core with RTIC that is `Exchanged`;
//! - switches the bridges off in a panic, a fault of the processor and a hang, and stores the reason over the reset.
//!
//! | folder | a tick comes from | samples and commands | settings |
//! |---|---|---|---|
//! | `stm32f405/brushed` | the PWM timer, 10 kHz | timers, converters, bridges | in flash |
//! | `stm32f405/stepper` | a timer, 10 kHz | the steps made, step/dir drivers | in flash |
//! | `stm32f405/can` | a timer, 1 kHz | frames of a CAN bus | in flash |
//! | `rp2350/servo` | SysTick, 10 kHz | pulses of hobby servos by PIO | in QSPI flash |
//! | `rp2350/stepper` | SysTick, 10 kHz | the steps made, step/dir drivers by PIO | in QSPI flash |
//! | `emulated` | the host | frames | none |
//!
//! What a host has to know of a board stands where the host reads it: its name in
//! [`Identity`](crate::protocol::Identity), its bounds in [`BoardLimits`](crate::settings::BoardLimits).

#[cfg(feature = "image")]
pub mod alive;
#[cfg(feature = "image")]
pub mod cycles;
#[cfg(feature = "board")]
pub mod emulated;
#[cfg(feature = "image")]
pub mod end_cause;
#[cfg(feature = "image")]
pub mod exchanged;
#[cfg(feature = "image")]
pub mod image;
#[cfg(feature = "image")]
pub mod log;
#[cfg(feature = "rp2350")]
pub mod rp2350;
#[cfg(feature = "image")]
pub mod stack;
#[cfg(feature = "board")]
pub mod stm32f405;
#[cfg(feature = "image")]
pub mod stored;
