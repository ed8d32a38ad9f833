//! PWM slice 2, channel A: the output for a tool. Until settings name an output the pin floats.

use super::clocks::CORE;
use super::{pins, resets};
use crate::board::image::Tool;
use crate::settings::{ALWAYS, Share, ToolOutputSettings};
use rp235x_pac::{PWM, RESETS};

const SLICE: usize = 2;
/// The least resolution of a servo's frame: counts in one.
const LONGEST_FRAME: f32 = 65_535.0;
/// Frames of a switch [Hz]; each is all low or all high.
const SWITCH_FRAMES: f32 = 20e3;
/// Parts of a clock that the divider counts.
const PARTS: f32 = 16.0;

/// The slice, which is set up anew for each settings.
pub struct ToolTimer {
    pwm: PWM,
}

impl ToolTimer {
    /// The slice. The pin floats.
    pub fn new(pwm: PWM, resets: &RESETS) -> Self {
        resets::reset(resets, resets::PWM);
        Self { pwm }
    }
}

impl Tool for ToolTimer {
    /// Sets the slice up. The pin floats meanwhile, and stays so without an output.
    fn configure(&mut self, output: &ToolOutputSettings) {
        pins::drive_tool(false);
        let slice = self.pwm.ch(SLICE);
        slice.csr().reset();
        let rate = match *output {
            ToolOutputSettings::None => return,
            ToolOutputSettings::Servo { frame_rate, .. } => frame_rate,
            ToolOutputSettings::Switch { .. } => SWITCH_FRAMES,
            ToolOutputSettings::Power { frequency, .. } => frequency,
        };
        let clocks = CORE as f32 / rate;
        // Sixteenths, rounded up: the frame then fits.
        let divider = ((PARTS * clocks / LONGEST_FRAME) as u32 + 1).max(PARTS as u32);
        let top = PARTS * clocks / divider as f32;
        // SAFETY: 12 bits of the divider and 16 of the top: 50 Hz, the least, need 733 sixteenths; 10 Hz need 3663.
        #[allow(unsafe_code)]
        unsafe {
            slice.div().write(|w| w.bits(divider));
            slice.top().write(|w| w.bits(top as u32 - 1));
        }
        Self::set(output.off());
        slice.csr().write(|w| w.en().set_bit());
        pins::drive_tool(true);
    }

    /// From the next frame on: no pulse is cut.
    #[inline]
    fn set(share: Share) {
        // SAFETY: the compare register is written here alone: in the tick, and while the slice is set up, where both write the
        // same output.
        #[allow(unsafe_code)]
        let slice = unsafe { (*PWM::ptr()).ch(SLICE) };
        let frame = slice.top().read().bits() + 1;
        let compare = if share == ALWAYS {
            frame
        } else {
            (u32::from(share) * frame + 0x8000) >> 16
        };
        // SAFETY: at most 16 bits; channel B has no pin.
        #[allow(unsafe_code)]
        slice.cc().write(|w| unsafe { w.bits(compare) });
    }
}
