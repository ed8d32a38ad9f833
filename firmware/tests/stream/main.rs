//! Streams of set-points, in virtual time.

#[path = "../shared/rig.rs"]
mod rig;

mod host;

mod cases;
mod following;
mod forces;
mod free;
mod impedance;
mod limits;
mod stiffening;
mod walls;
