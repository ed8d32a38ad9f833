//! Steppers with step/dir drivers: what this image has of its own.

pub mod machines;
pub mod pins;

use super::end;
use super::image::{OnChip, Rp2350, TICK_CYCLES, since_tick, start_ticks};
use super::pins::Pins;
use crate::board::end_cause::EndCause;
use crate::board::image::Parts;
use crate::drivers::steps::StepAxis;
use crate::drives::{BlindStepDrives, StepCommand, StepSample};
use crate::protocol::Board;
use crate::settings::BoardLimits;
use crate::{ArmCommand, ArmSample};
use cortex_m::peripheral::SYST;
use machines::StepMachines;
use pins::{OutputPins, Switches};
use rp235x_pac::{PIO0, RESETS};

/// The drivers and the switches.
pub struct Stepper {
    switches: Switches,
    pins: OutputPins,
    machines: StepMachines,
    axes: [StepAxis; 2],
    /// Whether each machine had taken its number when the tick began.
    taken: [bool; 2],
}

impl OnChip for Stepper {
    const NAME: &'static str = "rp2350_stepper";

    fn new(pio: PIO0, pins: &Pins<'_>, resets: &RESETS) -> Self {
        let (pins, switches) = pins::set_up(pins);
        Self {
            switches,
            pins,
            machines: StepMachines::new(pio, resets),
            axes: Default::default(),
            taken: [false; 2],
        }
    }
}

impl Parts for Stepper {
    type Chip = Rp2350;
    type Drives = BlindStepDrives;
    const BOARD: Board = Board::Rp2350Stepper;
    const LIMITS: BoardLimits = BoardLimits::RP2350_STEPPER;
    const TICK_CYCLES: u32 = TICK_CYCLES;

    fn start((): (), systick: &mut SYST) {
        start_ticks(systick, StepMachines::start);
    }

    #[inline(always)]
    fn begin(&mut self) -> u32 {
        since_tick()
    }

    #[inline(always)]
    fn end(cause: EndCause) -> ! {
        end::end(cause)
    }

    /// The micro-steps that are made at the end of the tick that has begun are the counts, too.
    #[inline(always)]
    fn sample(&mut self, missed: u32, stopped: bool) -> ArmSample<StepSample> {
        let stopped = stopped || self.machines.is_stopped();
        self.taken = self.machines.taken();
        let ([axis1, axis4], [taken1, taken4]) = (&mut self.axes, self.taken);
        let steps = [axis1.begin_once(taken1), axis4.begin_once(taken4)];
        let drives = StepSample {
            steps,
            ..StepSample::default()
        };
        self.switches.sample(steps, drives, missed, stopped)
    }

    /// Pulses from the next tick on, the rest at once. A machine that waits with its last number gets no other one, and the
    /// direction stays: the next tick finds what is missing.
    #[inline(always)]
    fn apply(&mut self, command: &ArmCommand<StepCommand>) {
        let (steps, enable) = (command.drives.steps, command.enable);
        let mut pulses = [None; 2];
        for joint in 0..2 {
            if self.taken[joint] {
                let steps = if enable[joint] { steps[joint] } else { 0 };
                pulses[joint] = Some(self.axes[joint].prepare(steps));
            }
        }
        let OutputPins {
            direction,
            enable: enables,
        } = &mut self.pins;
        let [axis1, axis4] = &self.axes;
        direction.0.write(axis1.forwards());
        direction.1.write(axis4.forwards());
        enables.0.write(!enable[0]);
        enables.1.write(!enable[1]);
        self.machines.power(enable[0] || enable[1]);
        for (machine, pulses) in pulses.into_iter().enumerate() {
            if let Some(pulses) = pulses {
                self.machines.prepare(machine, pulses);
            }
        }
    }
}
