//! The sources of a sensor sample with stepper drivers: the micro-steps made, and the switches.

use super::pins::Switches;
use crate::ArmSample;
use crate::drives::StepSample;

/// The switches.
pub struct Sensors {
    /// Home switches, emergency stop and fault outputs.
    pub switches: Switches,
}

impl Sensors {
    /// One sensor sample, with the micro-steps that are made at the end of the tick that has begun. They are the counts, too.
    /// `missed_ticks` is the number of ticks missed since the last one; `stopped` is an emergency stop that the button no
    /// longer shows.
    #[inline]
    pub fn sample(
        &mut self,
        steps: [i32; 2],
        missed_ticks: u32,
        stopped: bool,
    ) -> ArmSample<StepSample> {
        ArmSample {
            counts: steps,
            drives: StepSample {
                steps,
                ..StepSample::default()
            },
            home: self.switches.home(),
            index: self.switches.index(),
            emergency_stop: self.switches.emergency_stop() || stopped,
            driver_fault: self.switches.driver_fault(),
            missed_ticks,
        }
    }
}
