//! The one body of the production images for the STM32F405RG.
//!
//! | task | priority | deadline |
//! |---|---|---|
//! | those of the drives alone: the break inputs | 4 | none: the outputs are off before they run |
//! | `tick`: sensor sample in, actuator command out | 3 | the next tick; misses are counted |
//! | `receive`: from bytes to commands, where the line is idle and when `converse` asks | 2 | the ring buffer's 5 ms |
//! | `converse`: session, planner, telemetry, log, watchdog | idle | the watchdog's 50 ms |
//!
//! A kind of drive is a folder beside this one. It implements [`Parts`], and its `image.rs` names what
//! [`image!`](crate::image) cannot know: the peripherals, the tick's interrupt, tasks of its own.
//!
//! Without a crystal the ticks come more slowly, and the controller reports its clock fault, which cannot be cleared.

mod app;
pub mod shared;
pub mod start;
pub mod tasks;

use self::shared::Locked;
use super::clocks::{self, Source};
use super::services::OnBoard;
use super::{serial, tool};
use crate::board::end_cause::EndCause;
use crate::drives::Drives;
use crate::protocol::Board;
use crate::settings::CheckedSettings;
use crate::{ArmCommand, ArmSample};
use core::sync::atomic::{AtomicBool, Ordering};
use cortex_m::peripheral::SYST;
use rtic_core::Mutex;
use stm32f4xx_hal::rcc::Rcc;

/// A break input tripped, or the host sent an emergency stop. The next tick reads this.
pub static STOP: AtomicBool = AtomicBool::new(false);
/// The crystal did not start, or failed later.
pub static CLOCK_FAILED: AtomicBool = AtomicBool::new(false);

/// A tick's sample with these parts.
pub type Sample<P> = ArmSample<<<P as Parts>::Drives as Drives>::Sample>;
/// A tick's command with these parts.
pub type Command<P> = ArmCommand<<<P as Parts>::Drives as Drives>::Command>;

/// What an image has for its kind of drive alone: pins, outputs, the timer of the tick, and what a tick reads and writes.
pub trait Parts: Sized + Send + 'static {
    /// The drives.
    type Drives: OnBoard + 'static;
    /// What it takes of the chip.
    type Peripherals;
    /// What the image is called.
    const BOARD: Board;
    /// Cycles of the core from one tick to the next.
    const TICK_CYCLES: u32;

    /// Sets its pins and peripherals up, the drives without power first. `source` is what the core runs from.
    fn new(own: Self::Peripherals, source: Source, rcc: &mut Rcc) -> Self;

    /// Takes from settings what the drives need to know: at the start, and when new ones are put to use.
    fn use_settings(_locked: &mut impl Mutex<T = Locked<Self>>, _settings: &CheckedSettings) {}

    /// Lets the ticks begin. Called once, when interrupts are enabled: the first one then begins in time.
    fn start(source: Source, systick: &mut SYST);

    /// Takes the tick's interrupt. The cycles since it was due.
    fn begin(&mut self) -> u32;

    /// Whether the ticks come at a wrong time, which is a failure of the clock.
    #[inline(always)]
    fn clock_is_wrong(&mut self) -> bool {
        false
    }

    /// One sensor sample. `missed` is the number of ticks missed since the last one; `stopped` is an emergency stop that
    /// the button no longer shows.
    fn sample(&mut self, missed: u32, stopped: bool) -> Sample<Self>;

    /// Applies an actuator command, but for the brake and the tool.
    fn apply(&mut self, command: &Command<Self>);

    /// Ends the tick.
    #[inline(always)]
    fn finish(&mut self) {}

    /// Takes the drives' power until the next reset, from any context, for a handler that returns.
    fn unpower_until_reset();

    /// Takes the drives' power from any context and in any state, and resets the chip.
    fn end(cause: EndCause) -> !;
}

/// The crystal has failed, and the core runs from the internal oscillator. Whatever this interrupts: the power goes first,
/// and no code that goes on gives it back.
pub fn crystal_failed<P: Parts>() {
    P::unpower_until_reset();
    CLOCK_FAILED.store(true, Ordering::Relaxed);
    clocks::acknowledge_failure();
    serial::follow_internal_oscillator();
    tool::follow_internal_oscillator();
}
