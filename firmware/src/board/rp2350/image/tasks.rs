//! What the tasks of each image do.

use super::{Controller, Locked, Parts, TICK_CYCLES};
use crate::Request;
use crate::board::alive::Tasks;
use crate::board::cycles::CycleMeter;
use crate::board::exchanged::Exchanged;
use crate::board::log::EventLog;
use crate::board::rp2350::lines::Lines;
use crate::board::rp2350::outputs::CommonOutputs;
use crate::board::rp2350::pins;
use crate::board::rp2350::services::{self, BoardServices};
use crate::drives::Drives;
use crate::planner::Planner;
use crate::protocol::{Decoder, HostCommand, HostMessage};
use crate::session::Session;
use core::sync::atomic::{AtomicBool, Ordering};
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use heapless::spsc::Producer;
use rtic_core::Mutex;

/// The host sent an emergency stop. The next tick reads this.
static STOP: AtomicBool = AtomicBool::new(false);

/// The control tick.
#[inline(always)]
pub fn tick<P: Parts>(meter: &mut CycleMeter, outputs: &mut CommonOutputs, locked: &mut Locked<P>) {
    let Locked {
        controller,
        parts,
        sample,
    } = locked;
    let waited = TICK_CYCLES - 1 - SYST::get_current();
    let missed = meter.missed(TICK_CYCLES);
    meter.measure(waited, || {
        let stopped = STOP.swap(false, Ordering::Relaxed);
        *sample = parts.sample(missed, pins::stop_was_pressed() || stopped);
        let command = controller.tick(sample);
        parts.apply(&command);
        outputs.apply(&command);
        let drives = controller.drives();
        services::recorder().record(drives, sample, &command, controller.ticks());
    });
    Tasks::TICK.advanced();
}

/// From bytes to commands, of either line.
pub struct Hearing {
    /// What they say, for the session.
    pub arrived: Producer<'static, HostMessage>,
    /// What has come of a frame.
    pub decoder: Decoder<HostMessage>,
}

impl Hearing {
    /// Takes a byte. A command for which the queue has no room is dropped; the host sends it again.
    #[inline(always)]
    pub fn hear(&mut self, byte: u8) {
        if let Some(Ok(message)) = self.decoder.feed(byte) {
            if message.command == HostCommand::Request(Request::EmergencyStop) {
                // This does not wait in the queue behind the planner's work.
                STOP.store(true, Ordering::Relaxed);
            }
            let _ = self.arrived.enqueue(message);
        }
    }
}

/// What the idle task has.
#[allow(missing_docs, reason = "each is named after what it is")]
pub struct Idle {
    pub lines: Lines,
    pub spare: &'static mut Controller,
    pub planner: &'static mut Planner,
    pub session: &'static mut Session,
    pub services: BoardServices,
    pub log: EventLog,
    pub systick: SYST,
}

impl Idle {
    /// Lets the ticks begin, those of the parts first: in a tick of the core, theirs has begun.
    fn start<P: Parts>(&mut self) {
        self.systick.set_clock_source(SystClkSource::Core);
        self.systick.set_reload(TICK_CYCLES - 1);
        self.systick.enable_interrupt();
        cortex_m::interrupt::free(|_| {
            P::start();
            cortex_m::asm::dsb();
            self.systick.clear_current();
            self.systick.enable_counter();
        });
    }

    /// Talks with the host, plans, and feeds the watchdog, with the lock of what the tick has.
    #[inline(always)]
    pub fn run<P: Parts>(&mut self, locked: impl Mutex<T = Locked<P>>) -> ! {
        self.start::<P>();
        let mut shared = Exchanged {
            lock: locked,
            spare: &mut self.spare,
        };
        let controller = &mut shared;
        loop {
            if let Some(message) = self.lines.next() {
                self.services.sample = controller.lock.lock(|locked| {
                    let sample = &locked.sample;
                    let words = locked.controller.drives().sensed_words(&sample.drives);
                    sample.with_drives(words)
                });
                let (session, services) = (&mut *self.session, &mut self.services);
                if let Some(frame) = session.answer(&message, controller, self.planner, services) {
                    self.lines.send(&frame);
                }
            }
            self.planner.run(controller);
            if let Some(frame) = self.session.telemetry(controller, self.planner) {
                self.lines.send(&frame);
            }
            self.lines.advance();
            self.services.times.count();
            self.log.update(controller, &self.services.times);
            Tasks::SESSION.advanced();
            self.services.watchdog.refresh_if_all_advanced();
        }
    }
}
