//! The protocol, and the session with a host.

#[path = "../shared/nor.rs"]
mod nor;
#[path = "../shared/rig.rs"]
mod rig;

mod desk;
mod log;
mod messages;
mod moves;
mod sections;

mod boards_document;
mod frames;
mod garbage;
mod handing_over;
mod protocol_document;
mod refusals_in_words;
mod session;
