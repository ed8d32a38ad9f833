//! Torque drives on a CAN bus: frames against the encoders of others, and the time that they take on the bus.

mod bits;
mod frames;
mod margins;
