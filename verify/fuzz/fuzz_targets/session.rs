//! Sessions of a host with the controller and the simulated arm: the rules of every tick hold.
#![no_main]

use libfuzzer_sys::fuzz_target;

/// Ticks of a session: short ones, so that there are many.
const LONGEST: u32 = 3000;

fuzz_target!(|bytes: &[u8]| {
    if let Err(violation) = fivebar_stress::run_for(LONGEST, bytes) {
        panic!("{violation}");
    }
});
