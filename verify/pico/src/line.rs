//! The host's end of the serial line, or of that over USB. Time passes in the chip while the host waits.

use crate::chip::{Chip, HZ};
use fivebar_sim::link::READ;
use std::cell::{RefCell, RefMut};
use std::io::{self, ErrorKind, Read, Write};
use std::rc::Rc;
use std::time::Duration;

/// The host looks for bytes so often [cycles].
const SLICE: u64 = HZ / 20_000;
/// A line over USB on which nothing comes for so long, while the host waits, has failed: half a second [cycles].
const MOST_SILENCE: u64 = HZ / 2;

/// A serial line to a chip. Clones are ends of the same line.
#[derive(Clone)]
pub struct HostLine {
    chip: Rc<RefCell<Chip>>,
    over_usb: bool,
    /// How long the host has waited since the last byte [cycles].
    silence: u64,
}

impl HostLine {
    /// The host's end of this chip's line.
    pub fn new(chip: Chip) -> Self {
        Self::to(Rc::new(RefCell::new(chip)), false)
    }

    fn to(chip: Rc<RefCell<Chip>>, over_usb: bool) -> Self {
        Self {
            chip,
            over_usb,
            silence: 0,
        }
    }

    /// The host's end of the line over USB to the same chip.
    pub fn over_usb(&self) -> Self {
        Self::to(Rc::clone(&self.chip), true)
    }

    /// The serial line of the same chip.
    pub fn serial(&self) -> Self {
        Self::to(Rc::clone(&self.chip), false)
    }

    fn taken(&self, chip: &mut Chip, most: usize) -> Vec<u8> {
        if !self.over_usb {
            return chip.receive(most);
        }
        chip.usb().receive(most)
    }

    /// The chip, while the host does not wait.
    pub fn chip(&self) -> RefMut<'_, Chip> {
        self.chip.borrow_mut()
    }

    /// The chip's time.
    pub fn time(&self) -> Duration {
        Duration::from_nanos(self.chip().now() * 20 / 3)
    }
}

impl Read for HostLine {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let mut chip = self.chip.borrow_mut();
        let end = chip.now() + READ.as_nanos() as u64 * 3 / 20;
        let mut received = self.taken(&mut chip, bytes.len());
        while received.is_empty() {
            if self.over_usb && self.silence >= MOST_SILENCE {
                return Err(io::Error::other("nothing comes over USB for 0.5 s"));
            }
            if chip.now() >= end {
                return Err(ErrorKind::TimedOut.into());
            }
            chip.run(SLICE).map_err(io::Error::other)?;
            self.silence += SLICE;
            received = self.taken(&mut chip, bytes.len());
        }
        self.silence = 0;
        bytes[..received.len()].copy_from_slice(&received);
        Ok(received.len())
    }
}

impl Write for HostLine {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut chip = self.chip();
        if self.over_usb {
            chip.usb().send(bytes);
        } else {
            chip.send(bytes);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
