//! The image of the emulated board for torque drives on a CAN bus.
#![no_std]
#![no_main]
#![allow(
    unsafe_code,
    missing_docs,
    reason = "the framework's attribute writes code that needs it"
)]

use fivebar_firmware::drives::can::BusDrives as Interface;
use fivebar_firmware::protocol::Board;

mod program;

const BOARD: Board = Board::EmulatedCan;
