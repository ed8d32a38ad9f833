//! What the production images for the STM32F405RG give [the one body](crate::board::image).
//!
//! A kind of drive is a folder beside this one. It implements [`OnChip`], and its `image.rs` names what
//! [`stm32f405_image!`](crate::stm32f405_image) cannot know: the peripherals, the tick's interrupt, tasks of its own. The serial
//! line's ring buffer holds 5 ms.
//!
//! Without a crystal the ticks come more slowly, and the controller reports its clock fault, which cannot be cleared.

mod app;
mod start;
mod test;

pub use start::{CommonPeripherals, set_up, started};

use super::clocks::{self, Source};
use super::pins::Brake;
use super::self_test::Started;
use super::serial::{self, Buffers, Receiver, Sender};
use super::storage::SettingsFlash;
use super::tool::{self, ToolTimer};
use super::watchdog::Watchdog;
use crate::board::image::tasks::Commands;
use crate::board::image::{BoardServices, Chip, Lines, Parts};
use crate::protocol::{BoardReport, BoardTest, CommandError, Frame, HostMessage};
use crate::recorder::{LogControl, LogWords, Recorder};
use core::sync::atomic::{AtomicBool, Ordering};
use cortex_m::peripheral::NVIC;
use stm32f4xx_hal::pac::Interrupt;
use stm32f4xx_hal::rcc::Rcc;

/// The crystal did not start, or failed later.
pub static CLOCK_FAILED: AtomicBool = AtomicBool::new(false);

static LOG: LogControl = LogControl::new();
/// In the core-coupled memory, which nothing clears at the start.
#[allow(unsafe_code)]
// SAFETY: the linker script reserves the section for such data, and no word is read before it was written.
#[unsafe(link_section = ".ccm.log")]
static LOG_WORDS: LogWords = LogWords::new();

/// What an image has for its kind of drive and this chip alone.
pub trait OnChip: Parts<Chip = Stm32f405> {
    /// What it takes of the chip.
    type Peripherals;

    /// Sets its pins and peripherals up, the drives without power first. `source` is what the core runs from.
    fn new(own: Self::Peripherals, source: Source, rcc: &mut Rcc) -> Self;

    /// Takes the drives' power until the next reset, from any context, for a handler that returns.
    fn unpower_until_reset();
}

/// The chip.
pub struct Stm32f405;

/// The serial line, for the idle task.
pub struct Line {
    commands: Commands,
    sender: Sender,
}

impl Chip for Stm32f405 {
    type Clock = Source;
    type Brake = Brake;
    type Tool = ToolTimer;
    type Receiver = Receiver;
    type Lines = Line;
    type LinePlaces = Buffers;
    type Locals = ();
    type Flash = SettingsFlash;
    type Watchdog = Watchdog;
    type Facts = Started;

    const NO_LINES: Buffers = Buffers::new();

    #[inline(always)]
    fn recorder() -> Recorder<'static> {
        Recorder::new(&LOG, &LOG_WORDS)
    }

    #[inline(always)]
    fn clock_has_failed() -> bool {
        CLOCK_FAILED.load(Ordering::Relaxed)
    }

    fn test<P: Parts<Chip = Self>>(
        services: &mut BoardServices<P>,
        test: BoardTest,
        tick: u32,
    ) -> Result<Option<BoardReport>, CommandError> {
        test::measure(services, test, tick)
    }
}

impl Lines for Line {
    #[inline(always)]
    fn next(&mut self) -> Option<HostMessage> {
        // The line's interrupt comes when the line is idle. This one looks also while bytes come without a pause.
        NVIC::pend(Interrupt::USART1);
        self.commands.dequeue()
    }

    #[inline(always)]
    fn send(&mut self, frame: &Frame) {
        self.sender.send(frame);
    }
}

/// The crystal has failed, and the core runs from the internal oscillator. Whatever this interrupts: the power goes first,
/// and no code that goes on gives it back.
pub fn crystal_failed<P: OnChip>() {
    P::unpower_until_reset();
    CLOCK_FAILED.store(true, Ordering::Relaxed);
    clocks::acknowledge_failure();
    serial::follow_internal_oscillator();
    tool::follow_internal_oscillator();
}
