//! A line with injected faults: it drops, repeats, reorders and corrupts frames, and
//! inserts garbage. A seed decides where.

use super::frames::Frames;
use oorandom::Rand32;
use std::collections::VecDeque;
use std::io::{self, Read, Write};

/// The probability of each fault for one frame, 0…1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FaultRates {
    /// The frame does not arrive.
    pub dropped: f32,
    /// The frame arrives twice.
    pub repeated: f32,
    /// The frame arrives after the next one.
    pub reordered: f32,
    /// One byte of the frame arrives changed.
    pub corrupt: f32,
    /// Random bytes arrive before the frame.
    pub garbage: f32,
}

/// A line `L` whose frames suffer faults in both directions. The same seed and the same
/// traffic give the same faults.
pub struct FaultInjector<L> {
    line: L,
    to_line: Direction,
    from_line: Direction,
    /// Bytes that wait for the reader.
    arrived: VecDeque<u8>,
    /// Frames of the host that still arrive; none: all of them do.
    frames_left: Option<u32>,
}

/// One direction of the line.
struct Direction {
    rates: FaultRates,
    random: Rand32,
    frames: Frames,
    /// A frame that is sent after the next one.
    delayed: Option<Vec<u8>>,
    /// Faults injected so far.
    count: u32,
}

impl<L> FaultInjector<L> {
    /// Injects faults at these rates; `seed` starts the pseudo-random numbers.
    pub fn new(line: L, rates: FaultRates, seed: u64) -> Self {
        Self {
            line,
            to_line: Direction::new(rates, seed),
            from_line: Direction::new(rates, seed ^ u64::MAX),
            arrived: VecDeque::new(),
            frames_left: None,
        }
    }

    /// Lets this many more frames of the host arrive, and none after them.
    pub fn cut_after(&mut self, frames: u32) {
        self.frames_left = Some(frames);
    }

    /// Faults injected so far, in both directions.
    pub fn injected(&self) -> u32 {
        self.to_line.count + self.from_line.count
    }

    /// The line behind the injector.
    pub fn line(&mut self) -> &mut L {
        &mut self.line
    }
}

impl Direction {
    fn new(rates: FaultRates, seed: u64) -> Self {
        Self {
            rates,
            random: Rand32::new(seed),
            frames: Frames::default(),
            delayed: None,
            count: 0,
        }
    }

    /// Whether a fault of this probability happens now; counts it.
    fn happens(&mut self, probability: f32) -> bool {
        let happens = self.random.rand_float() < probability;
        self.count += u32::from(happens);
        happens
    }

    /// The bytes that arrive when this byte is sent.
    fn pass(&mut self, byte: u8) -> Vec<u8> {
        let Some(mut frame) = self.frames.feed(byte) else {
            return Vec::new();
        };
        let rates = self.rates;
        let mut arriving = Vec::new();
        if self.happens(rates.garbage) {
            let length = self.random.rand_range(1..40);
            arriving.extend((0..length).map(|_| self.random.rand_u32() as u8));
        }
        if self.happens(rates.dropped) {
            return arriving;
        }
        if self.happens(rates.corrupt) {
            let at = self.random.rand_range(0..frame.len() as u32) as usize;
            frame[at] ^= self.random.rand_range(1..256) as u8;
        }
        if self.delayed.is_none() && self.happens(rates.reordered) {
            self.delayed = Some(frame);
            return arriving;
        }
        let twice = self.happens(rates.repeated);
        arriving.extend(&frame);
        if twice {
            arriving.extend(&frame);
        }
        arriving.extend(self.delayed.take().into_iter().flatten());
        arriving
    }
}

impl<L: Read> Read for FaultInjector<L> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        // A frame may come in several reads: read on until one is complete or the line
        // times out.
        while self.arrived.is_empty() {
            let count = self.line.read(bytes)?;
            for &byte in bytes.iter().take(count) {
                self.arrived.extend(self.from_line.pass(byte));
            }
        }
        self.arrived.read(bytes)
    }
}

impl<L: Write> Write for FaultInjector<L> {
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
