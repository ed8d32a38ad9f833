//! The emulated board over a file of commands, for long comparisons: the controller, the planner
//! and the session of the production image answer the frames of the file `commands`, and their
//! replies go to the file `replies`, both in the emulator's folder.
//!
//! The image `qemu` answers the same commands one at a time over a serial line, where the emulator
//! takes most of the time for the bytes. Here they come and go in blocks by semihosting.
#![no_std]
#![no_main]
#![allow(
    unsafe_code,
    reason = "the entry point's attribute exports a symbol, and files are opened by semihosting"
)]

use core::panic::PanicInfo;
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln, nr, syscall};
use fivebar_firmware::board::emulated::instructions::InstructionCounter;
use fivebar_firmware::planner::Planner;
use fivebar_firmware::protocol::{Board, Decoder, HostMessage, Identity, MAX_FRAME, Reset};
use fivebar_firmware::session::Session;
use fivebar_firmware::storage::StorageError;
use fivebar_firmware::{ActuatorCommand, Controller, SensorSample, Settings};
use heapless::Vec;

/// Bytes that are read or written at once.
const BLOCK: usize = 4096;

/// A file of the machine that runs the emulator.
struct File(usize);

impl File {
    /// Opens a file; its name ends with a zero.
    fn open(name: &'static [u8], mode: usize) -> Option<Self> {
        // SAFETY: the name is readable memory of this length.
        let handle = unsafe { syscall!(OPEN, name.as_ptr(), mode, name.len() - 1) };
        (handle != usize::MAX).then_some(Self(handle))
    }

    /// The number of bytes read; 0 at the end.
    fn read(&self, bytes: &mut [u8; BLOCK]) -> usize {
        // SAFETY: the bytes are writable memory of this length.
        let missing = unsafe { syscall!(READ, self.0, bytes.as_mut_ptr(), BLOCK) };
        BLOCK.saturating_sub(missing)
    }

    /// Whether all bytes were written.
    fn write(&self, bytes: &[u8]) -> bool {
        // SAFETY: the bytes are readable memory of this length.
        unsafe { syscall!(WRITE, self.0, bytes.as_ptr(), bytes.len()) == 0 }
    }
}

/// This board: it stores nothing, and its ticks come from the file.
struct Replay {
    counter: InstructionCounter,
}

impl fivebar_firmware::session::Board for Replay {
    fn save(&mut self, _: &Settings) -> Result<(), StorageError> {
        Err(StorageError::Flash)
    }

    fn tick(
        &mut self,
        controller: &mut Controller,
        sample: &SensorSample,
    ) -> Option<(ActuatorCommand, u32)> {
        let start = self.counter.now();
        let command = controller.tick(sample);
        Some((command, self.counter.since(start)))
    }
}

/// Answers all commands; what went wrong otherwise.
fn replay(mut board: Replay) -> Result<(), &'static str> {
    let commands = File::open(b"commands\0", nr::open::R_BINARY).ok_or("no commands")?;
    let replies = File::open(b"replies\0", nr::open::W_TRUNC_BINARY).ok_or("no replies")?;
    let settings = Settings::BENCHTOP.check().map_err(|_| "settings")?;
    let mut controller = Controller::new(&settings);
    let mut planner = Planner::new(&settings);
    let identity = Identity::new(Board::Emulated, Reset::Power);
    let mut session = Session::new(identity, &settings, false);
    let mut decoder = Decoder::<HostMessage>::new();
    let mut input = [0; BLOCK];
    let mut output = Vec::<u8, BLOCK>::new();
    loop {
        let count = commands.read(&mut input);
        if count == 0 {
            break;
        }
        for &byte in input.iter().take(count) {
            let Some(message) = decoder.feed(byte) else {
                continue;
            };
            let message = message.map_err(|_| "a damaged command")?;
            let answer = session.answer(&message, &mut controller, &mut planner, &mut board);
            let frame = answer.ok_or("a command without a reply")?;
            if output.len() + MAX_FRAME > BLOCK {
                replies.write(&output).then_some(()).ok_or("a full disk")?;
                output.clear();
            }
            output
                .extend_from_slice(&frame)
                .map_err(|_| "a long reply")?;
        }
    }
    replies.write(&output).then_some(()).ok_or("a full disk")
}

#[entry]
fn main() -> ! {
    let core = cortex_m::Peripherals::take();
    let done = core.ok_or("no core").and_then(|core| {
        replay(Replay {
            counter: InstructionCounter::new(core.SYST),
        })
    });
    match done {
        Ok(()) => debug::exit(debug::EXIT_SUCCESS),
        Err(reason) => fail(reason),
    }
    loop {
        cortex_m::asm::wfi();
    }
}

fn fail(reason: &str) {
    hprintln!("{}", reason);
    debug::exit(debug::EXIT_FAILURE);
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    fail("panicked");
    loop {
        cortex_m::asm::wfi();
    }
}
