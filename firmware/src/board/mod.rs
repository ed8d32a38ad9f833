//! The boards: all that touches registers. Nothing above knows which one it runs on.

#[cfg(feature = "qemu")]
pub mod emulated;
