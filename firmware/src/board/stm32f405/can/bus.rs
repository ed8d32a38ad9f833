//! The bus with its drives, as the tick and the session share it.

use super::bxcan::BxCan;
use super::stop;
use crate::ArmCommand;
use crate::drives::can::{BusSetup, CanController, Link, UNKNOWN, WaitingFrames};
use crate::drives::{TorqueSample, TorqueSetPoint};
use crate::settings::CheckedSettings;
use core::mem::MaybeUninit;

/// The controller of the bus, and the link to the drives.
pub struct Bus {
    can: BxCan,
    waiting: WaitingFrames,
    /// None while the settings name no drives.
    link: Option<Link>,
}

impl Bus {
    /// The bus without drives, in a place where it lasts as long as the program. A call of its own, and once: so the
    /// caller's stack holds no copy.
    #[inline(never)]
    pub fn place(can: BxCan) -> &'static mut Self {
        let place = cortex_m::singleton!(: MaybeUninit<Bus> = MaybeUninit::uninit());
        let Some(place) = place else {
            panic!("there is one bus");
        };
        place.write(Self {
            can,
            waiting: WaitingFrames::default(),
            link: None,
        })
    }

    /// Speaks to these drives from now on.
    pub fn use_link(&mut self, link: Link, setup: &BusSetup) {
        self.can.accept(setup.answers());
        self.link = Some(link);
    }

    /// The drives' counts and what they have answered, once in each tick.
    #[inline]
    pub fn sense(&mut self) -> ([i32; 2], TorqueSample) {
        let is_off = self.can.is_off();
        let Some(link) = &mut self.link else {
            return UNKNOWN;
        };
        self.waiting
            .begin_tick(&mut self.can, |frame| link.receive(frame));
        link.sample(is_off)
    }

    /// Sends the frames of the tick.
    #[inline]
    pub fn send(&mut self, command: &ArmCommand<TorqueSetPoint>) {
        if let Some(link) = &mut self.link {
            let make = |frames: &mut _| link.send(command.enable, &command.drives, frames);
            self.waiting.send(&mut self.can, make);
        }
    }

    /// A mailbox has become free.
    #[inline]
    pub fn fill(&mut self) {
        self.can.take_done();
        self.waiting.fill(&mut self.can);
    }
}

/// Makes the link to the drives of these settings, if they name some, and gives it to the bus.
#[inline(never)]
pub fn use_settings(settings: &CheckedSettings, put: impl FnOnce(Link, &BusSetup)) {
    if let Some(setup) = BusSetup::of(settings) {
        stop::prepare(setup.stops());
        put(Link::new(setup.protocol, setup.nodes, settings), &setup);
    }
}
