//! Settings: their bounds, and their storage in flash.

#[path = "../shared/nor.rs"]
mod nor;
#[path = "../shared/rig.rs"]
mod rig;

mod bounds;
mod faults;
mod storage;
mod tool_output;
mod values;
