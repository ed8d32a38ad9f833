//! The production image for hobby servos: an RP2350 that makes the pulses of two.
#![no_std]
#![no_main]
#![allow(
    unsafe_code,
    missing_docs,
    reason = "the framework's attribute writes code that needs it"
)]

use defmt_rtt as _;

fivebar_firmware::rp2350_image!(fivebar_firmware::board::rp2350::servo::Servos);
