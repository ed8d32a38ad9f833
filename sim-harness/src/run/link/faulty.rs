//! A bad line: frames get lost, doubled, overtaken and damaged, as a seed will have it.

use super::frames::Frames;
use oorandom::Rand32;
use std::collections::VecDeque;
use std::io::{self, Read, Write};

/// How often each mishap befalls a frame, 0…1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mishaps {
    /// It does not arrive.
    pub dropped: f32,
    /// It arrives twice.
    pub repeated: f32,
    /// The next one overtakes it.
    pub overtaken: f32,
    /// One of its bytes arrives changed.
    pub corrupt: f32,
    /// Garbage arrives before it.
    pub garbage: f32,
}

/// A line `L` on which frames meet mishaps, both ways. The same seed and the same traffic
/// give the same mishaps.
pub struct Faulty<L> {
    line: L,
    to_line: Direction,
    from_line: Direction,
    /// Bytes for the reader.
    arrived: VecDeque<u8>,
    /// Frames the host may still send before it falls silent.
    frames_left: Option<u32>,
}

/// One direction.
struct Direction {
    mishaps: Mishaps,
    random: Rand32,
    frames: Frames,
    /// A frame that waits to be overtaken.
    held: Option<Vec<u8>>,
    /// Mishaps so far.
    count: u32,
}

impl<L> Faulty<L> {
    /// A bad line.
    pub fn new(line: L, mishaps: Mishaps, seed: u64) -> Self {
        Self {
            line,
            to_line: Direction::new(mishaps, seed),
            from_line: Direction::new(mishaps, seed ^ u64::MAX),
            arrived: VecDeque::new(),
            frames_left: None,
        }
    }

    /// Nothing the host sends arrives after so many more frames.
    pub fn fall_silent_after(&mut self, frames: u32) {
        self.frames_left = Some(frames);
    }

    /// Mishaps so far, both ways.
    pub fn mishaps(&self) -> u32 {
        self.to_line.count + self.from_line.count
    }

    /// The line itself.
    pub fn line(&mut self) -> &mut L {
        &mut self.line
    }
}

impl Direction {
    fn new(mishaps: Mishaps, seed: u64) -> Self {
        Self {
            mishaps,
            random: Rand32::new(seed),
            frames: Frames::default(),
            held: None,
            count: 0,
        }
    }

    fn strikes(&mut self, chance: f32) -> bool {
        let strikes = self.random.rand_float() < chance;
        self.count += u32::from(strikes);
        strikes
    }

    /// What arrives when this byte is sent.
    fn pass(&mut self, byte: u8) -> Vec<u8> {
        let Some(mut frame) = self.frames.feed(byte) else {
            return Vec::new();
        };
        let mishaps = self.mishaps;
        let mut arriving = Vec::new();
        if self.strikes(mishaps.garbage) {
            let length = self.random.rand_range(1..40);
            arriving.extend((0..length).map(|_| self.random.rand_u32() as u8));
        }
        if self.strikes(mishaps.dropped) {
            return arriving;
        }
        if self.strikes(mishaps.corrupt) {
            let at = self.random.rand_range(0..frame.len() as u32) as usize;
            frame[at] ^= self.random.rand_range(1..256) as u8;
        }
        if self.held.is_none() && self.strikes(mishaps.overtaken) {
            self.held = Some(frame);
            return arriving;
        }
        let twice = self.strikes(mishaps.repeated);
        arriving.extend(&frame);
        if twice {
            arriving.extend(&frame);
        }
        arriving.extend(self.held.take().into_iter().flatten());
        arriving
    }
}

impl<L: Read> Read for Faulty<L> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        // A frame may come in many parts; only a silent line is silence.
        while self.arrived.is_empty() {
            let count = self.line.read(bytes)?;
            for &byte in bytes.iter().take(count) {
                self.arrived.extend(self.from_line.pass(byte));
            }
        }
        self.arrived.read(bytes)
    }
}

impl<L: Write> Write for Faulty<L> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        for &byte in bytes {
            let arriving = self.to_line.pass(byte);
            if arriving.is_empty() {
                continue;
            }
            match &mut self.frames_left {
                Some(0) => {}
                left => {
                    *left = left.map(|left| left - 1);
                    self.line.write_all(&arriving)?;
                }
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.line.flush()
    }
}
