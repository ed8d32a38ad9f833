//! The simulated arm, worn joints and linkages.

mod arm;
mod balance;
mod bench;
mod contact;
mod elastic_drives;
mod electrics;
mod friction_at_rest;
mod holding_brake;
mod linkages;
mod sensing;
mod unchanged;
mod worn_joints;
