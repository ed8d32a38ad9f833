//! The servos of both joints: from units of their pulses to pulses in frames.

pub mod pulses;

use super::clocks::CORE;
use super::end;
use super::image::{OnChip, Rp2350, TICK_CYCLES, since_tick, start_ticks};
use super::pins::{Pins, Stop};
use crate::board::end_cause::EndCause;
use crate::board::image::{Locked, Parts};
use crate::drivers::{Inputs, Level};
use crate::drives::{BlindStepDrives, StepCommand, StepSample};
use crate::protocol::Board;
use crate::settings::{BoardLimits, CheckedSettings, ServoPulse};
use crate::{ArmCommand, ArmSample};
use cortex_m::peripheral::SYST;
use pulses::Pulses;
use rp235x_pac::{PIO0, RESETS};
use rtic_core::Mutex;

/// Clocks of a microsecond.
const MICROSECOND: u32 = CORE / 1_000_000;
/// Clocks of a unit: half a microsecond.
const UNIT: i32 = MICROSECOND.cast_signed() / 2;
/// Ticks in a second.
const TICK_RATE: f32 = 1e4;

/// A servo knows its angle and tells no fault; only the emergency stop is read.
type Switches =
    Inputs<Level<false>, Level<false>, Level<false>, Level<false>, Stop, Level<true>, Level<true>>;

/// Both servos.
pub struct Servos {
    switches: Switches,
    pulses: Pulses,
    axes: [Axis; 2],
}

/// One servo.
#[derive(Clone, Copy, Default)]
struct Axis {
    /// Clocks of the pulse at home.
    home: i32,
    /// Units by which the pulse is longer.
    units: i32,
    /// Ticks from one pulse to the next.
    frame: u32,
    /// Ticks until the next pulse.
    until_pulse: u32,
}

impl OnChip for Servos {
    const NAME: &'static str = "rp2350_servo";

    fn new(pio: PIO0, pins: &Pins<'_>, resets: &RESETS) -> Self {
        let switches = Inputs {
            home1: Level,
            home4: Level,
            index1: Level,
            index4: Level,
            emergency_stop: pins.input(),
            fault1: Level,
            fault4: Level,
        };
        Self {
            switches,
            pulses: Pulses::new(pio, resets),
            axes: Default::default(),
        }
    }
}

impl Parts for Servos {
    type Chip = Rp2350;
    type Drives = BlindStepDrives;
    const BOARD: Board = Board::Rp2350Servo;
    const LIMITS: BoardLimits = BoardLimits::RP2350_SERVO;
    const TICK_CYCLES: u32 = TICK_CYCLES;

    fn start((): (), systick: &mut SYST) {
        start_ticks(systick, || {});
    }

    #[inline(always)]
    fn begin(&mut self) -> u32 {
        since_tick()
    }

    #[inline(always)]
    fn end(cause: EndCause) -> ! {
        end::end(cause)
    }

    /// Takes the pulses from settings. The arm has no power, and a new controller counts from 0. Without pulses of servos in the
    /// settings, as on a board that has none yet, none is made.
    fn use_settings(locked: &mut impl Mutex<T = Locked<Self>>, settings: &CheckedSettings) {
        let axes = settings
            .servo_pulses()
            .map_or_else(Default::default, |pulses| {
                pulses.map(|pulse| Axis {
                    home: (pulse.home_width * CORE as f32 + 0.5) as i32,
                    frame: (TICK_RATE / pulse.frame_rate + 0.5) as u32,
                    ..Axis::default()
                })
            });
        locked.lock(|locked| locked.parts.axes = axes);
    }

    /// The units made are the counts of the joints, too.
    #[inline(always)]
    fn sample(&mut self, missed: u32, stopped: bool) -> ArmSample<StepSample> {
        let [axis1, axis4] = &self.axes;
        let units = [axis1.units, axis4.units];
        let drives = StepSample {
            steps: units,
            ..StepSample::default()
        };
        self.switches.sample(units, drives, missed, stopped)
    }

    /// The units are in the pulses that begin after this tick.
    #[inline(always)]
    fn apply(&mut self, command: &ArmCommand<StepCommand>) {
        let (steps, enable) = (command.drives.steps, command.enable);
        for (machine, (axis, (steps, powered))) in self
            .axes
            .iter_mut()
            .zip(steps.into_iter().zip(enable))
            .enumerate()
        {
            if let Some(clocks) = axis.pulse(powered) {
                self.pulses.make(machine, clocks);
            }
            axis.units = axis.units.wrapping_add(steps);
        }
    }
}

impl Axis {
    /// The clocks of the pulse that begins in this tick. Two begin at least a frame apart, also where the power was off.
    #[inline]
    fn pulse(&mut self, powered: bool) -> Option<u32> {
        let begins = powered && self.frame > 0 && self.until_pulse == 0;
        if begins {
            self.until_pulse = self.frame;
        }
        self.until_pulse = self.until_pulse.saturating_sub(1);
        let clocks = self.home.wrapping_add(self.units.wrapping_mul(UNIT));
        let [least, greatest] = ServoPulse::WIDTHS.map(|width| width * MICROSECOND);
        begins.then_some((clocks.max(0) as u32).clamp(least, greatest))
    }
}
