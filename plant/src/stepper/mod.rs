//! Arms with stepper motors.

mod motor;
mod plant;
mod windings;

pub use motor::Stepper;
pub use plant::StepperPlant;
pub use windings::Windings;
