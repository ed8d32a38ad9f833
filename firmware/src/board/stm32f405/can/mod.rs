//! Torque drives on a CAN bus: what this image has of its own.
//!
//! TIM5 counts the ticks, CAN1 sends the commands and takes the answers. `docs/use/wiring.md` lists the pins.

pub mod bus;
pub mod bxcan;
pub mod pins;
pub mod stop;
pub mod timer;

use super::clocks::Source;
use super::image::{OnChip, Stm32f405};
use crate::board::end_cause::EndCause;
use crate::board::image::{Locked, Parts};
use crate::drives::{TorqueDrives, TorqueSample, TorqueSetPoint};
use crate::protocol::Board;
use crate::settings::{BoardLimits, CheckedSettings};
use crate::{ArmCommand, ArmSample};
use bus::Bus;
use bxcan::BxCan;
use cortex_m::peripheral::SYST;
use pins::Switches;
use rtic_core::Mutex;
use stm32f4xx_hal::pac::{CAN1, TIM5};
use stm32f4xx_hal::rcc::Rcc;

/// The bus and the switches.
pub struct Can {
    switches: Switches,
    /// The bus with its drives.
    pub bus: &'static mut Bus,
}

impl OnChip for Can {
    type Peripherals = (TIM5, CAN1);

    fn new((ticks, can): Self::Peripherals, source: Source, rcc: &mut Rcc) -> Self {
        let switches = pins::set_up();
        timer::set_up(&ticks, rcc);
        let can = BxCan::new(can, source == Source::Crystal, rcc);
        Self {
            switches,
            bus: Bus::place(can),
        }
    }

    /// Without the bus the drives' own watchdogs take their power.
    fn unpower_until_reset() {
        bxcan::leave();
    }
}

impl Parts for Can {
    type Chip = Stm32f405;
    type Drives = TorqueDrives;
    const BOARD: Board = Board::Stm32f405Can;
    const LIMITS: BoardLimits = BoardLimits::STM32F405_CAN;
    const TICK_CYCLES: u32 = timer::TICK_CYCLES;

    fn use_settings(locked: &mut impl Mutex<T = Locked<Self>>, settings: &CheckedSettings) {
        bus::use_settings(settings, |link, setup| {
            locked.lock(|locked| locked.parts.bus.use_link(link, setup));
        });
    }

    fn start(_: Source, _: &mut SYST) {
        timer::start();
    }

    #[inline(always)]
    fn begin(&mut self) -> u32 {
        timer::take_tick();
        timer::since_tick()
    }

    #[inline(always)]
    fn sample(&mut self, missed: u32, stopped: bool) -> ArmSample<TorqueSample> {
        let (counts, drives) = self.bus.sense();
        self.switches.sample(counts, drives, missed, stopped)
    }

    #[inline(always)]
    fn apply(&mut self, command: &ArmCommand<TorqueSetPoint>) {
        self.bus.send(command);
    }

    #[inline(always)]
    fn end(cause: EndCause) -> ! {
        stop::end(cause)
    }
}
