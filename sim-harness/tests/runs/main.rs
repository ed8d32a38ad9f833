//! What jobs ask of an arm at home, and jobs on steppers.

mod approach;
mod can_bus;
mod steppers;
