//! Hands the linker the memory map of the STM32F405, when an image for it is built.

use std::env;
use std::path::PathBuf;

fn main() {
    println!("cargo:rerun-if-changed=memory.x");
    println!("cargo:rerun-if-changed=build.rs");
    // Its macros read it, unseen by Cargo.
    println!("cargo:rerun-if-env-changed=DEFMT_LOG");
    if env::var_os("CARGO_FEATURE_BOARD").is_none() {
        return;
    }
    let Some(folder) = env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from) else {
        panic!("cargo sets CARGO_MANIFEST_DIR");
    };
    println!("cargo:rustc-link-search={}", folder.display());
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    // cortex-m-rt's section starts are 4-byte aligned; a page-aligned image wastes flash.
    println!("cargo:rustc-link-arg-bins=--nmagic");
    println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
}
