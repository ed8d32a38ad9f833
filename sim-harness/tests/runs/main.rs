//! What jobs ask of an arm at home, jobs on steppers and hobby servos, and jobs that are learnt.

mod approach;
mod bench;
mod can_bus;
mod can_requests;
mod hobby_servos;
mod learning;
mod limits;
mod stepper_campaign;
mod stepper_encoders;
mod steppers;
