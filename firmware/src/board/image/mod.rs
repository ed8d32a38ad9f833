//! The one body of the production images: its tasks, their order, and what each has.
//!
//! | task | priority | deadline |
//! |---|---|---|
//! | those of the drives alone: the break inputs | 4 | none: the outputs are off before they run |
//! | `tick`: sensor sample in, actuator command out | 3 | the next tick; misses are counted |
//! | `receive`: from bytes to commands | 2 | that of the chip's serial line |
//! | those of the chip alone: another line | 1 | none: the host waits |
//! | `converse`: session, planner, telemetry, log, watchdog | idle | the watchdog's 50 ms |
//!
//! A chip implements [`Chip`] and sets itself up as [`Hardware`]; its macro beside it calls [`image!`](crate::image). A kind of
//! drive implements [`Parts`].

mod app;
mod services;
pub mod start;
pub mod tasks;

pub use services::BoardServices;
pub use start::{Hardware, Image, Places};

use crate::board::end_cause::EndCause;
use crate::board::exchanged::Guarded;
use crate::drives::Drives;
use crate::protocol::{Board, BoardReport, BoardTest, CommandError, Frame, HostMessage};
use crate::recorder::Recorder;
use crate::settings::{BoardLimits, CheckedSettings, Share, ToolOutputSettings};
use crate::{ArmCommand, ArmController, ArmSample};
use core::sync::atomic::AtomicBool;
use cortex_m::peripheral::SYST;
use embedded_hal::digital::OutputPin;
use embedded_storage::nor_flash::NorFlash;
use rtic_core::Mutex;

/// The host sent an emergency stop, or a break input tripped. The next tick reads this.
pub static STOP: AtomicBool = AtomicBool::new(false);

/// A tick's sample with these parts.
pub type Sample<P> = ArmSample<<<P as Parts>::Drives as Drives>::Sample>;
/// A tick's command with these parts.
pub type Command<P> = ArmCommand<<<P as Parts>::Drives as Drives>::Command>;

/// What each image of a chip has.
pub trait Chip: Sized + Send + 'static {
    /// What the core runs from.
    type Clock: Copy + Send;
    /// The brake's transistor; low: engaged.
    type Brake: OutputPin + Send;
    /// The output for a tool.
    type Tool: Tool;
    /// The serial line's receiving half, for its interrupt.
    type Receiver: Send;
    /// What goes to the host and what it has said, for the idle task.
    type Lines: Lines;
    /// Where the lines are put.
    type LinePlaces: 'static;
    /// What tasks of the chip alone have.
    type Locals;
    /// The flash for the settings.
    type Flash: NorFlash;
    /// The watchdog.
    type Watchdog: Watchdog;
    /// What the test of a bare board tells of the start.
    type Facts;

    /// No lines yet.
    const NO_LINES: Self::LinePlaces;

    /// The log at the tick rate.
    fn recorder() -> Recorder<'static>;

    /// Whether the emergency stop was pressed since the last call, and is not any more; for a chip without break inputs.
    #[inline(always)]
    fn stop_was_pressed() -> bool {
        false
    }

    /// Whether the clock has failed. The controller then reports it in each tick.
    #[inline(always)]
    fn clock_has_failed() -> bool {
        false
    }

    /// Does a step of the test of a bare board after the tick of this number.
    ///
    /// # Errors
    /// Why it is not done: a chip without a test of its own does none.
    fn test<P: Parts<Chip = Self>>(
        _services: &mut BoardServices<P>,
        _test: BoardTest,
        _tick: u32,
    ) -> Result<Option<BoardReport>, CommandError> {
        Err(CommandError::Unsupported)
    }
}

/// The output for a tool.
pub trait Tool: Send {
    /// Sets the output up anew, with the tool off. Until settings name an output its pin floats.
    fn configure(&mut self, output: &ToolOutputSettings);

    /// The pin is high for this share of each frame. For the tick.
    fn set(share: Share);
}

/// The lines to hosts.
pub trait Lines: Send {
    /// The next message of the host that leads.
    fn next(&mut self) -> Option<HostMessage>;

    /// Sends a frame to the host that leads.
    fn send(&mut self, frame: &Frame);

    /// Lets what waits go on. Called in each round of the idle task.
    #[inline(always)]
    fn advance(&mut self) {}
}

/// A watchdog, which bites unless it is refreshed. Once started, only a reset stops it.
pub trait Watchdog: Send {
    /// What it is before its start.
    type Stopped;

    /// Starts it.
    fn start(stopped: Self::Stopped) -> Self;

    /// Refreshes it if every task has advanced since the last refresh.
    fn refresh_if_all_advanced(&mut self);

    /// Runs `work` with a timeout that is long enough for erasing flash.
    fn with_erase_timeout<R>(&mut self, work: impl FnOnce() -> R) -> R;
}

/// What an image has for its kind of drive alone: pins, outputs, the timer of the tick, and what a tick reads and writes.
pub trait Parts: Sized + Send + 'static {
    /// The chip.
    type Chip: Chip;
    /// The drives.
    type Drives: Drives + 'static;
    /// What the image is called.
    const BOARD: Board;
    /// What it can do.
    const LIMITS: BoardLimits;
    /// Cycles of the core from one tick to the next.
    const TICK_CYCLES: u32;

    /// Takes from settings what the drives need to know: at the start, and when new ones are put to use.
    fn use_settings(_locked: &mut impl Mutex<T = Locked<Self>>, _settings: &CheckedSettings) {}

    /// Lets the ticks begin. Called once, when interrupts are enabled: the first one then begins in time.
    fn start(clock: <Self::Chip as Chip>::Clock, systick: &mut SYST);

    /// Takes the tick's interrupt. The cycles since it was due.
    fn begin(&mut self) -> u32;

    /// Fails the clock if the ticks come at a wrong time.
    #[inline(always)]
    fn check_clock(&mut self) {}

    /// One sensor sample. `missed` is the number of ticks missed since the last one; `stopped` is an emergency stop that
    /// the button no longer shows.
    fn sample(&mut self, missed: u32, stopped: bool) -> Sample<Self>;

    /// Applies an actuator command, but for the brake and the tool.
    fn apply(&mut self, command: &Command<Self>);

    /// Ends the tick.
    #[inline(always)]
    fn finish(&mut self) {}

    /// Takes the drives' power from any context and in any state, and resets the chip.
    fn end(cause: EndCause) -> !;
}

/// What the tick has, under one lock: each one more would cost it cycles.
pub struct Locked<P: Parts> {
    /// The controller in use.
    pub controller: &'static mut ArmController<P::Drives>,
    /// The parts for its drives.
    pub parts: P,
    /// The sample of the last tick.
    pub sample: Sample<P>,
}

impl<P: Parts> Guarded<P::Drives> for Locked<P> {
    fn controller(&mut self) -> &mut &'static mut ArmController<P::Drives> {
        &mut self.controller
    }

    fn use_settings(lock: &mut impl Mutex<T = Self>, settings: &CheckedSettings) {
        P::use_settings(lock, settings);
    }
}
