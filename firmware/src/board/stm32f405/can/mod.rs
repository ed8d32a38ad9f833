//! The drivers of the image for torque drives on a CAN bus: what it does not share with that for brushed motors.
//!
//! TIM5 counts the ticks, CAN1 sends the commands and takes the answers. `docs/use/wiring.md` lists the pins.

pub mod bus;
pub mod bxcan;
pub mod outputs;
pub mod pins;
pub mod sensors;
pub mod shared;
pub mod stop;
pub mod timer;
