//! Sessions of a host with the controller and the simulated arm: the rules of every tick hold.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Err(violation) = fivebar_stress::run(bytes) {
        panic!("{violation}");
    }
});
