//! Hands the linker the memory map of the chip, when an image for it is built.

use std::env;
use std::path::PathBuf;

fn main() {
    println!("cargo:rerun-if-changed=src/board/stm32f405/memory.x");
    println!("cargo:rerun-if-changed=src/board/rp2350/link.x");
    println!("cargo:rerun-if-changed=build.rs");
    // Its macros read it, unseen by Cargo.
    println!("cargo:rerun-if-env-changed=DEFMT_LOG");
    let has = |feature| env::var_os(feature).is_some();
    let (board, rp2350) = (has("CARGO_FEATURE_BOARD"), has("CARGO_FEATURE_RP2350"));
    if !board && !rp2350 {
        return;
    }
    let Some(folder) = env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from) else {
        panic!("cargo sets CARGO_MANIFEST_DIR");
    };
    let boards = folder.join("src/board");
    if rp2350 {
        // It replaces the script of cortex-m-rt, which leaves the program in the flash.
        let script = boards.join("rp2350/link.x");
        println!("cargo:rustc-link-arg-bins=-T{}", script.display());
    } else {
        println!(
            "cargo:rustc-link-search={}",
            boards.join("stm32f405").display()
        );
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
    }
    // cortex-m-rt's section starts are 4-byte aligned; a page-aligned image wastes flash.
    println!("cargo:rustc-link-arg-bins=--nmagic");
    println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    if rp2350 {
        return;
    }
    // These two make their controllers and planners on the stack. They run on the emulator only, whose
    // RAM is theirs.
    for image in ["instructions", "replay"] {
        println!("cargo:rustc-link-arg-bin={image}=--defsym=_stack_start=0x20020000");
        println!("cargo:rustc-link-arg-bin={image}=--defsym=_stack_end=__euninit");
    }
}
