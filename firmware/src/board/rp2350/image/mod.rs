//! What the production images for the RP2350 give [the one body](crate::board::image).
//!
//! A kind of drive is a folder beside this one. It implements [`OnChip`]; both kinds take steps from the controller. The serial
//! line holds 32 bytes and raises its interrupt at 16: its deadline is 160 µs.
//!
//! Without its crystal the program ends before it has set a pin up: no clock of the chip is exact enough for the serial line.

mod app;
mod start;

pub use start::set_up;

use super::flash::SettingsFlash;
use super::lines::BothLines;
use super::pins::{self, Brake, Pins};
use super::serial::{self, Receiver};
use super::tool::ToolTimer;
use super::watchdog::Watchdog;
use super::{clocks, usb};
use crate::board::image::tasks::Arrived;
use crate::board::image::{Chip, Parts};
use crate::drives::BlindStepDrives;
use crate::protocol::HostMessage;
use crate::recorder::{Log, Recorder};
use crate::session::WAITING;
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use heapless::spsc::Queue;
use rp235x_pac::{PIO0, RESETS};

/// Cycles of the core, and clocks of the state machines, from one tick to the next: 10 kHz.
pub const TICK_CYCLES: u32 = clocks::CORE / 10_000;

static LOG: Log = Log::new();

/// What an image has for its kind of drive and this chip alone.
pub trait OnChip: Parts<Chip = Rp2350, Drives = BlindStepDrives> {
    /// What USB calls it.
    const NAME: &'static str;

    /// Sets its pins and state machines up, the drives without power first.
    fn new(pio: PIO0, pins: &Pins<'_>, resets: &RESETS) -> Self;
}

/// The chip.
pub struct Rp2350;

/// Where both lines are put.
pub struct LinePlaces {
    waiting: serial::Waiting,
    usb: usb::Places,
    usb_queue: Queue<HostMessage, WAITING>,
}

impl Chip for Rp2350 {
    type Clock = ();
    type Brake = Brake;
    type Tool = ToolTimer;
    type Receiver = Receiver;
    type Lines = BothLines;
    type LinePlaces = LinePlaces;
    type Locals = (Option<&'static mut usb::Device>, Arrived);
    type Flash = SettingsFlash;
    type Watchdog = Watchdog;
    type Facts = ();

    const NO_LINES: LinePlaces = LinePlaces {
        waiting: serial::Waiting::new(),
        usb: usb::Places::NONE,
        usb_queue: Queue::new(),
    };

    #[inline(always)]
    fn recorder() -> Recorder<'static> {
        LOG.recorder()
    }

    #[inline(always)]
    fn stop_was_pressed() -> bool {
        pins::stop_was_pressed()
    }
}

/// Cycles since the tick was due.
#[inline(always)]
pub fn since_tick() -> u32 {
    TICK_CYCLES - 1 - SYST::get_current()
}

/// Lets the ticks begin, those of the parts first: in a tick of the core, theirs has begun.
pub fn start_ticks(systick: &mut SYST, start_parts: impl FnOnce()) {
    systick.set_clock_source(SystClkSource::Core);
    systick.set_reload(TICK_CYCLES - 1);
    systick.enable_interrupt();
    cortex_m::interrupt::free(|_| {
        start_parts();
        cortex_m::asm::dsb();
        systick.clear_current();
        systick.enable_counter();
    });
}
