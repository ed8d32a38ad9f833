//! Arms on belts: random ones against a prediction of their own.

mod arms;
mod backlash;
mod campaign;
mod prediction;
mod pushed;
mod taps;
