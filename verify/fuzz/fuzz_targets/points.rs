//! Points of a stream to the controller of the simulated arm: it stays within its limits and comes to rest.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Err(broken) = fivebar_stress::run_points(bytes) {
        panic!("{broken}");
    }
});
