//! A line with a delay and a queue of bounded length in each direction.

use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};

/// A line `L` whose frames arrive later, and are dropped when too many are on their way. Time
/// counts in reads of 10 ms.
pub(crate) struct SlowLine<L> {
    line: L,
    /// The delay in each direction [reads].
    delay: u64,
    /// Most writes that are on their way in each direction.
    queue: usize,
    now: u64,
    there: VecDeque<(u64, Vec<u8>)>,
    back: VecDeque<(u64, Vec<u8>)>,
    arrived: VecDeque<u8>,
}

impl<L> SlowLine<L> {
    pub(crate) fn new(line: L, delay: u64, queue: usize) -> Self {
        Self {
            line,
            delay,
            queue,
            now: 0,
            there: VecDeque::new(),
            back: VecDeque::new(),
            arrived: VecDeque::new(),
        }
    }
}

impl<L: Read + Write> SlowLine<L> {
    fn send_what_is_due(&mut self) -> io::Result<()> {
        while let Some((_, bytes)) = due(&mut self.there, self.now) {
            self.line.write_all(&bytes)?;
        }
        Ok(())
    }
}

impl<L: Read + Write> Read for SlowLine<L> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        if self.arrived.is_empty() {
            self.send_what_is_due()?;
            // What waits at the other end is read at once; then 10 ms pass.
            let mut part = [0; 512];
            loop {
                match self.line.read(&mut part) {
                    Ok(count) if self.back.len() < self.queue => {
                        let due = self.now + self.delay;
                        self.back.push_back((due, part[..count].to_vec()));
                    }
                    Ok(_) => {}
                    Err(error) if error.kind() == ErrorKind::TimedOut => break,
                    Err(error) => return Err(error),
                }
            }
            self.now += 1;
            while let Some((_, bytes)) = due(&mut self.back, self.now - 1) {
                self.arrived.extend(bytes);
            }
        }
        if self.arrived.is_empty() {
            return Err(ErrorKind::TimedOut.into());
        }
        self.arrived.read(bytes)
    }
}

impl<L: Read + Write> Write for SlowLine<L> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.there.len() < self.queue {
            self.there
                .push_back((self.now + self.delay, bytes.to_vec()));
        }
        self.send_what_is_due()?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.line.flush()
    }
}

/// The first entry, if it is due.
fn due(queue: &mut VecDeque<(u64, Vec<u8>)>, now: u64) -> Option<(u64, Vec<u8>)> {
    let is_due = queue.front().is_some_and(|(at, _)| *at <= now);
    if is_due { queue.pop_front() } else { None }
}
