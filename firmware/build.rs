//! Hands the linker the memory map of the STM32F405, when an image for it is built.

use std::env;
use std::path::PathBuf;

fn main() {
    println!("cargo:rerun-if-changed=src/board/stm32f405/memory.x");
    println!("cargo:rerun-if-changed=build.rs");
    // Its macros read it, unseen by Cargo.
    println!("cargo:rerun-if-env-changed=DEFMT_LOG");
    if env::var_os("CARGO_FEATURE_BOARD").is_none() {
        return;
    }
    let Some(folder) = env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from) else {
        panic!("cargo sets CARGO_MANIFEST_DIR");
    };
    let map = folder.join("src/board/stm32f405");
    println!("cargo:rustc-link-search={}", map.display());
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    // cortex-m-rt's section starts are 4-byte aligned; a page-aligned image wastes flash.
    println!("cargo:rustc-link-arg-bins=--nmagic");
    println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    // These two make their controllers and planners on the stack. They run on the emulator only, whose
    // RAM is theirs.
    for image in ["instructions", "replay"] {
        println!("cargo:rustc-link-arg-bin={image}=--defsym=_stack_start=0x20020000");
        println!("cargo:rustc-link-arg-bin={image}=--defsym=_stack_end=__euninit");
    }
}
