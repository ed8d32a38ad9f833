//! The C interface of `fivebar-kinematics`: a static library; `include/fivebar.h` is made from these sources.
//!
//! Each function checks its pointers, calls one function of the kinematics, and writes through its last pointer.
//! References that may be null are `Option`s, so that safe Rust checks them.
// Cargo builds tests so that a panic unwinds, which needs std; the library itself aborts.
#![cfg_attr(panic = "abort", no_std)]

mod answer;
mod opaque;
pub mod plain;
pub mod status;

/// The functions for `f32`.
pub mod single {
    include!("single.rs");
}

/// The functions for `f64`, which `build.rs` makes from those for `f32`.
pub mod double {
    include!(concat!(env!("OUT_DIR"), "/double.rs"));
}

/// No function comes here: a test looks for panics in programs that call them all.
#[cfg(panic = "abort")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
