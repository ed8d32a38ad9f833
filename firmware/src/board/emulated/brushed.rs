//! The image of the emulated board for brushed motors.
#![no_std]
#![no_main]
#![allow(
    unsafe_code,
    missing_docs,
    reason = "the framework's attribute writes code that needs it"
)]

use fivebar_firmware::drives::BrushedDrives as Interface;
use fivebar_firmware::protocol::Board;

mod program;

const BOARD: Board = Board::Emulated;
