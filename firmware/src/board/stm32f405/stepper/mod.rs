//! The drivers of the image for steppers: what it does not share with that for brushed motors.
//!
//! TIM4 counts the ticks. Its update raises the tick's interrupt, and starts TIM1 and TIM8 anew, which make the pulses of joints 1
//! and 4. `docs/use/wiring.md` lists the pins.

pub mod outputs;
pub mod pins;
pub mod sensors;
pub mod timers;
