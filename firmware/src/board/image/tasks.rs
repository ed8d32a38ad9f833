//! What the tasks of each image do.

use super::{BoardServices, Chip, Lines, Locked, Parts, STOP, Tool, Watchdog};
use crate::board::alive::Tasks;
use crate::board::cycles::CycleMeter;
use crate::board::exchanged::Exchanged;
use crate::board::log::EventLog;
use crate::drives::Drives;
use crate::planner::Planner;
use crate::protocol::{Decoder, HostCommand, HostMessage};
use crate::session::Session;
use crate::{ArmController, Request};
use core::sync::atomic::Ordering;
use cortex_m::peripheral::SYST;
use embedded_hal::digital::{OutputPin, PinState};
use heapless::spsc::{Consumer, Producer};
use rtic_core::Mutex;

/// The brake of an image.
pub type Brake<P> = <<P as Parts>::Chip as Chip>::Brake;
/// What has come over a line, for the session.
pub type Arrived = Producer<'static, HostMessage>;
/// The same, for the idle task.
pub type Commands = Consumer<'static, HostMessage>;

/// The control tick.
#[inline(always)]
pub fn tick<P: Parts>(meter: &mut CycleMeter, brake: &mut Brake<P>, locked: &mut Locked<P>) {
    let Locked {
        controller,
        parts,
        sample,
    } = locked;
    let waited = parts.begin();
    let missed = meter.missed(P::TICK_CYCLES);
    meter.measure(waited, || {
        parts.check_clock();
        let stopped = STOP.swap(false, Ordering::Relaxed);
        *sample = parts.sample(missed, P::Chip::stop_was_pressed() || stopped);
        let command = if P::Chip::clock_has_failed() {
            controller.tick_without_clock(sample)
        } else {
            controller.tick(sample)
        };
        parts.apply(&command);
        // A pin of the chip cannot fail.
        let _ = brake.set_state(PinState::from(!command.brake));
        <P::Chip as Chip>::Tool::set(command.tool);
        let drives = controller.drives();
        P::Chip::recorder().record(drives, sample, &command, controller.ticks());
        parts.finish();
    });
    Tasks::TICK.advanced();
}

/// From bytes to commands: takes a byte of a line. A command for which the queue has no room is dropped; the host sends it again.
#[inline(always)]
pub fn hear(byte: u8, arrived: &mut Arrived, decoder: &mut Decoder<HostMessage>) {
    if let Some(Ok(message)) = decoder.feed(byte) {
        if message.command == HostCommand::Request(Request::EmergencyStop) {
            // This does not wait in the queue behind the planner's work.
            STOP.store(true, Ordering::Relaxed);
        }
        let _ = arrived.enqueue(message);
    }
}

/// What the idle task has.
#[allow(missing_docs, reason = "each is named after what it is")]
pub struct Idle<P: Parts> {
    pub lines: <P::Chip as Chip>::Lines,
    pub spare: &'static mut ArmController<P::Drives>,
    pub planner: &'static mut Planner,
    pub session: &'static mut Session,
    pub services: BoardServices<P>,
    pub log: EventLog,
    pub clock: <P::Chip as Chip>::Clock,
    pub systick: SYST,
}

impl<P: Parts> Idle<P> {
    /// Talks with the host, plans, and feeds the watchdog, with the lock of what the tick has.
    #[inline(always)]
    pub fn run(&mut self, locked: impl Mutex<T = Locked<P>>) -> ! {
        P::start(self.clock, &mut self.systick);
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
