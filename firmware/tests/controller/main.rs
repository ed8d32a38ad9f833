//! The controller and its tick, on a bench of its own.

#[path = "../shared/rig.rs"]
mod rig;

mod can_link;
mod crossing;
#[path = "../../../verify/stress/src/crossing_arm.rs"]
mod crossing_arm;
mod crossing_limits;
mod crossing_rig;
mod crossing_torques;
mod current_zeros;
mod drives;
mod either_joint;
mod excitation;
mod faults;
mod heat;
mod holding;
mod holding_brake;
mod homing;
mod homing_again;
mod homing_index;
mod homing_methods;
mod independent_joints;
mod left_behind;
mod lost_counts;
mod motor_check;
mod moving;
mod place_without_power;
mod step_drives;
mod stopping;
mod tool;
mod torque_drives;
mod unlike_joints;
mod waking;
