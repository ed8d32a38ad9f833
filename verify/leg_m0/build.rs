//! Hands the linker the memory map of the emulated Cortex-M0, when the image is built.

use std::env;

fn main() {
    println!("cargo:rerun-if-changed=memory.x");
    if env::var_os("CARGO_FEATURE_IMAGE").is_none() {
        return;
    }
    let Some(folder) = env::var_os("CARGO_MANIFEST_DIR") else {
        panic!("cargo sets CARGO_MANIFEST_DIR");
    };
    println!("cargo:rustc-link-search={}", folder.to_string_lossy());
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    println!("cargo:rustc-link-arg-bins=--nmagic");
}
