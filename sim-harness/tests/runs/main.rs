//! What jobs ask of an arm at home, jobs on steppers, and jobs that are learnt.

mod approach;
mod can_bus;
mod learning;
mod stepper_campaign;
mod stepper_encoders;
mod steppers;
