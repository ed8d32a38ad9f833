//! The simulated arm, worn joints and linkages.

mod arm;
mod contact;
mod linkages;
mod worn_joints;
mod worn_joints_document;
