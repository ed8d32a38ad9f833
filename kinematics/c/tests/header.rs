//! `include/fivebar.h` is what cbindgen makes of the sources.
//!
//! After a change of them: `FIVEBAR_UPDATE=1 cargo test --test header`.

use std::{env, fs};

const HEADER: &str = "include/fivebar.h";

#[test]
fn the_header_is_made_from_the_sources() {
    let mut config = cbindgen::Config::from_file("cbindgen.toml").unwrap();
    config.language = cbindgen::Language::C;
    let mut builder = cbindgen::Builder::new().with_config(config);
    for file in ["src/plain.rs", "src/status.rs", "src/single.rs"] {
        builder = builder.with_src(file);
    }
    let made = builder
        .with_src(concat!(env!("OUT_DIR"), "/double.rs"))
        .generate()
        .unwrap();
    let mut header = Vec::new();
    made.write(&mut header);
    if env::var_os("FIVEBAR_UPDATE").is_some() {
        fs::write(HEADER, &header).unwrap();
    }
    let committed = fs::read(HEADER).unwrap();
    assert!(
        committed == header,
        "{HEADER} is not what cbindgen makes: FIVEBAR_UPDATE=1 makes it again"
    );
}
