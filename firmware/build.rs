//! Hands the linker the memory map of the STM32F405, when an image for it is built.

use std::env;
use std::path::PathBuf;

fn main() {
    println!("cargo:rerun-if-changed=memory.x");
    println!("cargo:rerun-if-changed=build.rs");
    let production = env::var_os("CARGO_FEATURE_STM32F405").is_some();
    let emulated = env::var_os("CARGO_FEATURE_QEMU").is_some();
    if !production && !emulated {
        return;
    }
    let Some(folder) = env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from) else {
        panic!("cargo sets CARGO_MANIFEST_DIR");
    };
    println!("cargo:rustc-link-search={}", folder.display());
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    // cortex-m-rt's section starts are 4-byte aligned; a page-aligned image wastes flash.
    println!("cargo:rustc-link-arg-bins=--nmagic");
    if production {
        println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    }
}
