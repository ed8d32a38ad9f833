//! The emulated board at the far end of a serial port: what `fivebar hil` does, by the
//! same code, with the real firmware.
#![cfg(unix)]

mod bench;

use bench::{Bench, stated};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::FaultKind;
use fivebar_sim::link::{Emulator, SerialLine};
use serialport::{SerialPort, TTYPort};
use std::io::{Read, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Ends the thread that carries bytes when the test ends, also by a panic.
struct End<'a>(&'a AtomicBool);

impl Drop for End<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Carries bytes between a pseudo-terminal and the board until `ends` is true.
fn carry(far: &mut TTYPort, board: &mut Emulator, ends: &AtomicBool) {
    let mut bytes = [0; 512];
    while !ends.load(Ordering::Relaxed) {
        if let Ok(count) = far.read(&mut bytes) {
            board.write_all(&bytes[..count]).expect("the board lives");
        }
        if let Ok(count) = board.read(&mut bytes) {
            far.write_all(&bytes[..count]).expect("the port lives");
        }
    }
}

#[test]
fn an_emulated_board_behind_a_serial_port_moves_and_faults_bit_by_bit() {
    let (mut far, near) = TTYPort::pair().expect("a pseudo-terminal");
    far.set_timeout(Duration::from_millis(1))
        .expect("a timeout");
    let port = near.name().expect("a name");
    let image = Emulator::built_image("qemu");
    let mut board = Emulator::start(&image).expect("an emulated board");
    let ends = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| carry(&mut far, &mut board, &ends));
        let _end = End(&ends);
        let line = SerialLine::open(&port).expect("the port");
        let mut bench = Bench::moving(line);
        bench.inject(FaultKind::DriverFault {
            joint: Joint::Joint4,
        });
        bench.powers_off(stated("a_bridge_that_gives_up"));
    });
}
