//! The one body of the production images for the RP2350.
//!
//! | task | priority | deadline |
//! |---|---|---|
//! | `tick`: sensor sample in, actuator command out | 4 | the next tick; misses are counted |
//! | `receive`: from bytes to commands | 2 | 16 bytes of 10 µs: 160 µs |
//! | `serve_usb`: the same over USB, and what is sent there | 1 | none: the host waits |
//! | `converse`: session, planner, telemetry, log, watchdog | idle | the watchdog's 50 ms |
//!
//! A kind of drive is a folder beside this one. It implements [`Parts`]; both kinds take steps from the controller.
//!
//! Without its crystal the program ends before it has set a pin up: no clock of the chip is exact enough for the serial line.

mod app;
pub mod start;
pub mod tasks;

use super::clocks;
use super::pins::Pins;
use crate::board::exchanged::Guarded;
use crate::drives::{BlindStepDrives, StepCommand, StepSample};
use crate::protocol::Board;
use crate::settings::{BoardLimits, CheckedSettings};
use crate::{ArmCommand, ArmController, ArmSample};
use rp235x_pac::{PIO0, RESETS};
use rtic_core::Mutex;

/// The controller of both kinds of drive.
pub type Controller = ArmController<BlindStepDrives>;

/// Cycles of the core, and clocks of the state machines, from one tick to the next: 10 kHz.
pub const TICK_CYCLES: u32 = clocks::CORE / 10_000;

/// What an image has for its kind of drive alone: pins, state machines, and what a tick reads and writes.
pub trait Parts: Sized + Send + 'static {
    /// What the image is called.
    const BOARD: Board;
    /// What USB calls it.
    const NAME: &'static str;
    /// What it can do.
    const LIMITS: BoardLimits;

    /// Sets its pins and state machines up, the drives without power first.
    fn new(pio: PIO0, pins: &Pins<'_>, resets: &RESETS) -> Self;

    /// Takes from settings what the drives need to know: at the start, and when new ones are put to use.
    fn use_settings(&mut self, _settings: &CheckedSettings) {}

    /// Called once, some cycles before the ticks of the core begin.
    fn start() {}

    /// One sensor sample. `missed` is the number of ticks missed since the last one; `stopped` is an emergency stop that
    /// the button no longer shows.
    fn sample(&mut self, missed: u32, stopped: bool) -> ArmSample<StepSample>;

    /// Applies an actuator command, but for the brake and the tool.
    fn apply(&mut self, command: &ArmCommand<StepCommand>);
}

/// What the tick has, under one lock.
pub struct Locked<P> {
    /// The controller in use.
    pub controller: &'static mut Controller,
    /// The parts for its drives.
    pub parts: P,
    /// The sample of the last tick.
    pub sample: ArmSample<StepSample>,
}

impl<P: Parts> Guarded<BlindStepDrives> for Locked<P> {
    fn controller(&mut self) -> &mut &'static mut Controller {
        &mut self.controller
    }

    fn use_settings(lock: &mut impl Mutex<T = Self>, settings: &CheckedSettings) {
        lock.lock(|locked| locked.parts.use_settings(settings));
    }
}
