//! What the tasks of each image do.

use super::shared::Locked;
use super::{CLOCK_FAILED, Parts, STOP};
use crate::board::alive::Tasks;
use crate::board::cycles::CycleMeter;
use crate::board::exchanged::Exchanged;
use crate::board::log::EventLog;
use crate::board::stm32f405::clocks::Source;
use crate::board::stm32f405::outputs::CommonOutputs;
use crate::board::stm32f405::serial::{Receiver, Sender};
use crate::board::stm32f405::services::{self, BoardServices};
use crate::drives::Drives;
use crate::planner::Planner;
use crate::protocol::{Decoder, HostCommand, HostMessage};
use crate::session::Session;
use crate::{ArmController, Request};
use core::sync::atomic::Ordering;
use cortex_m::peripheral::{NVIC, SYST};
use heapless::spsc::{Consumer, Producer};
use rtic_core::Mutex;
use stm32f4xx_hal::pac::Interrupt;

/// The control tick.
#[inline(always)]
pub fn tick<P: Parts>(meter: &mut CycleMeter, outputs: &mut CommonOutputs, locked: &mut Locked<P>) {
    let Locked {
        controller,
        parts,
        sample,
    } = locked;
    let waited = parts.begin();
    let missed = meter.missed(P::TICK_CYCLES);
    meter.measure(waited, || {
        if parts.clock_is_wrong() {
            CLOCK_FAILED.store(true, Ordering::Relaxed);
        }
        let stopped = STOP.swap(false, Ordering::Relaxed);
        *sample = parts.sample(missed, stopped);
        let command = if CLOCK_FAILED.load(Ordering::Relaxed) {
            controller.tick_without_clock(sample)
        } else {
            controller.tick(sample)
        };
        parts.apply(&command);
        outputs.apply(&command);
        let drives = controller.drives();
        services::recorder().record(drives, sample, &command, controller.ticks());
        parts.finish();
    });
    Tasks::TICK.advanced();
}

/// From bytes to commands. A command for which the queue has no room is dropped; the host sends it again.
#[inline(always)]
pub fn receive(
    receiver: &mut Receiver,
    arrived: &mut Producer<'static, HostMessage>,
    decoder: &mut Decoder<HostMessage>,
) {
    receiver.drain(|byte| {
        if let Some(Ok(message)) = decoder.feed(byte) {
            if message.command == HostCommand::Request(Request::EmergencyStop) {
                // This does not wait in the queue behind the planner's work.
                STOP.store(true, Ordering::Relaxed);
            }
            let _ = arrived.enqueue(message);
        }
    });
}

/// What the idle task has.
#[allow(missing_docs, reason = "each is named after what it is")]
pub struct Idle<P: Parts> {
    pub commands: Consumer<'static, HostMessage>,
    pub sender: Sender,
    pub spare: &'static mut ArmController<P::Drives>,
    pub planner: &'static mut Planner,
    pub session: &'static mut Session,
    pub services: BoardServices,
    pub log: EventLog,
    pub source: Source,
    pub systick: SYST,
}

impl<P: Parts> Idle<P> {
    /// Talks with the host, plans, and feeds the watchdog, with the lock of what the tick has.
    #[inline(always)]
    pub fn run(&mut self, locked: impl Mutex<T = Locked<P>>) -> ! {
        P::start(self.source, &mut self.systick);
        let mut shared = Exchanged {
            lock: locked,
            spare: &mut self.spare,
        };
        let controller = &mut shared;
        loop {
            // The line's interrupt comes when the line is idle. This one looks also while bytes come without a pause.
            NVIC::pend(Interrupt::USART1);
            if let Some(message) = self.commands.dequeue() {
                self.services.sample = controller.lock.lock(|locked| {
                    let sample = &locked.sample;
                    let words = locked.controller.drives().sensed_words(&sample.drives);
                    sample.with_drives(words)
                });
                let (session, services) = (&mut *self.session, &mut self.services);
                if let Some(frame) = session.answer(&message, controller, self.planner, services) {
                    self.sender.send(&frame);
                }
            }
            self.planner.run(controller);
            if let Some(frame) = self.session.telemetry(controller, self.planner) {
                self.sender.send(&frame);
            }
            self.services.times.count();
            self.log.update(controller, &self.services.times);
            Tasks::SESSION.advanced();
            self.services.watchdog.refresh_if_all_advanced();
        }
    }
}
