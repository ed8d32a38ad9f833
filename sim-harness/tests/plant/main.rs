//! The simulated arm, worn joints and linkages.

mod arm;
mod contact;
mod elastic_drives;
mod linkages;
mod sensing;
mod unchanged;
mod worn_joints;
mod worn_joints_document;
