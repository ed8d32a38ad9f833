//! Links the CPU emulator: Debian's package `libunicorn-dev`.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rustc-link-lib=unicorn");
}
