//! TIM3's channel 2 on PC7: the output for a tool.
//!
//! PC7 is free in every start mode of the chip, also in its ROM loader, and TIM3 has no other task
//! here. Until settings name an output the pin floats, and a resistor holds the tool off
//! (`docs/use/wiring.md`).
//!
//! | output | counter | compare value |
//! |---|---|---|
//! | servo | 1 MHz, from the crystal and from the internal oscillator | preloaded: no pulse is cut |
//! | switch | 20 kHz frames | 0, or beyond the top |
//! | power | as fine as 16 bits allow | at once: off within the tick |

use super::gpio::{self, Resistor};
use super::pins::PINS;
use crate::board::image::Tool;
use crate::drivers::boards::Peripheral;
use crate::settings::{ALWAYS, Share, ToolOutputSettings};
use stm32f4xx_hal::pac::{RCC, TIM3};
use stm32f4xx_hal::rcc::{Enable, Reset};

/// The counter's clock for a servo [Hz].
const SERVO_CLOCK: f32 = 1e6;
/// Frames of a switch [Hz]; each is all low or all high.
const SWITCH_FRAMES: f32 = 20e3;
/// The greatest count of a frame: a compare value one above it must fit the register.
const LONGEST_FRAME: f32 = 65_535.0;
/// The timer, which is set up anew for each settings.
pub struct ToolTimer {
    timer: TIM3,
    /// The timer's clock [Hz].
    clock: f32,
}

impl ToolTimer {
    /// The timer, with its clock of `clock` [Hz]. The pin floats.
    pub fn new(timer: TIM3, clock: u32, rcc: &mut RCC) -> Self {
        TIM3::enable(rcc);
        TIM3::reset(rcc);
        gpio::connect(PINS.tool, Peripheral::Tim3, Resistor::None);
        gpio::drive(PINS.tool, false);
        Self {
            timer,
            clock: clock as f32,
        }
    }
}

impl Tool for ToolTimer {
    /// Sets the timer up. The pin floats meanwhile, and stays so without an output.
    fn configure(&mut self, output: &ToolOutputSettings) {
        gpio::drive(PINS.tool, false);
        self.timer.cr1().reset();
        let (divider, frame) = match *output {
            ToolOutputSettings::None => return,
            ToolOutputSettings::Servo { frame_rate, .. } => {
                (self.clock / SERVO_CLOCK, SERVO_CLOCK / frame_rate)
            }
            ToolOutputSettings::Switch { .. } => (1.0, self.clock / SWITCH_FRAMES),
            ToolOutputSettings::Power { frequency, .. } => {
                let cycles = self.clock / frequency;
                let divider = (cycles / LONGEST_FRAME) as u16 + 1;
                (f32::from(divider), cycles / f32::from(divider))
            }
        };
        let is_servo = matches!(output, ToolOutputSettings::Servo { .. });
        let timer = &self.timer;
        timer.psc().write(|w| w.psc().set(divider as u16 - 1));
        timer.arr().write(|w| w.arr().set(frame as u16 - 1));
        timer
            .ccmr1_output()
            .write(|w| w.oc2m().pwm_mode1().oc2pe().bit(is_servo));
        Self::set(output.off());
        timer.ccer().write(|w| w.cc2e().set_bit());
        // Loads the preloaded values.
        timer.egr().write(|w| w.ug().update());
        timer.cr1().write(|w| w.cen().enabled());
        gpio::drive(PINS.tool, true);
    }

    #[inline]
    fn set(share: Share) {
        // SAFETY: the compare register is written here alone: in the tick, and while the timer is
        // set up, where both write the same output.
        #[allow(unsafe_code)]
        let timer = unsafe { &*TIM3::ptr() };
        let frame = u32::from(timer.arr().read().arr().bits()) + 1;
        let compare = if share == ALWAYS {
            frame
        } else {
            (u32::from(share) * frame + 0x8000) >> 16
        };
        timer.ccr(1).write(|w| w.ccr().set(compare as u16));
    }
}

/// Keeps the width of a servo's pulse when the timers run from the internal oscillator instead:
/// for the NMI, which owns nothing. The tick then switches every other output off.
pub fn follow_internal_oscillator() {
    // SAFETY: any 16 bits are a divider; a new frame begins, as after each.
    #[allow(unsafe_code)]
    let timer = unsafe { &*TIM3::ptr() };
    let [crystal, internal] = [
        super::clocks::Source::Crystal,
        super::clocks::Source::Internal,
    ]
    .map(|source| source.tool_timer() / SERVO_CLOCK as u32 - 1);
    if timer.psc().read().bits() == crystal {
        timer.psc().write(|w| w.psc().set(internal as u16));
        timer.egr().write(|w| w.ug().update());
    }
}
