//! Makes the functions for `f64` from those for `f32`, so that each is written and described once.

use std::path::PathBuf;
use std::{env, fs};

fn main() {
    println!("cargo:rerun-if-changed=src/single.rs");
    let single = fs::read_to_string("src/single.rs").expect("src/single.rs can be read");
    let out = env::var_os("OUT_DIR").expect("cargo sets OUT_DIR");
    let double = single.replace("f32", "f64");
    fs::write(PathBuf::from(out).join("double.rs"), double).expect("OUT_DIR can be written");
}
