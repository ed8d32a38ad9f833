//! DMA2: eight streams between peripherals and memory, byte by byte.

use crate::register::Register;
use crate::violation::{Access, refuse};

/// The memory that DMA2 reaches: not the core-coupled one.
const REACHED: std::ops::Range<u32> = 0x2000_0000..0x2002_0000;

/// One stream.
#[derive(Clone, Debug)]
struct Stream {
    cr: Register,
    /// Items left, and what a circular stream starts again with.
    ndtr: u32,
    length: u32,
    par: u32,
    m0ar: u32,
    m1ar: u32,
    fcr: Register,
    /// Items moved since the start.
    moved: u32,
}

/// The controller.
#[derive(Clone, Debug)]
pub(crate) struct Dma {
    streams: [Stream; 8],
    /// LISR and HISR.
    flags: [u32; 2],
}

/// A transfer of one item that a peripheral asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Transfer {
    /// The address in memory.
    pub(crate) memory: u32,
    /// The address of the peripheral's register.
    pub(crate) peripheral: u32,
    /// Whether it goes to memory.
    pub(crate) to_memory: bool,
}

impl Stream {
    fn new() -> Self {
        Self {
            cr: Register::new("DMA2_SxCR", 0, 0x0fef_ffff, 0),
            ndtr: 0,
            length: 0,
            par: 0,
            m0ar: 0,
            m1ar: 0,
            fcr: Register::new("DMA2_SxFCR", 0x21, 0x87, 0x38),
            moved: 0,
        }
    }
}

/// Where a stream's flags are in its register.
fn flag_shift(stream: usize) -> (usize, u32) {
    (stream / 4, [0, 6, 16, 22][stream % 4])
}

impl Dma {
    pub(crate) fn new() -> Self {
        Self {
            streams: std::array::from_fn(|_| Stream::new()),
            flags: [0; 2],
        }
    }

    /// The stream that serves this channel's request in this direction, if one is enabled.
    pub(crate) fn request(&mut self, streams: &[usize], channel: u32) -> Option<Transfer> {
        let &number = streams.iter().find(|&&number| {
            let stream = &self.streams[number];
            stream.cr.bit(0) && stream.cr.field(25, 3) == channel
        })?;
        let stream = &mut self.streams[number];
        let step = u32::from(stream.cr.bit(10));
        let transfer = Transfer {
            memory: stream.m0ar + step * stream.moved,
            peripheral: stream.par,
            to_memory: stream.cr.field(6, 2) == 0,
        };
        stream.moved += 1;
        stream.ndtr -= 1;
        let (register, shift) = flag_shift(number);
        if stream.ndtr == stream.length / 2 {
            self.flags[register] |= 1 << (shift + 4);
        }
        if stream.ndtr == 0 {
            self.flags[register] |= 1 << (shift + 5);
            if stream.cr.bit(8) {
                stream.ndtr = stream.length;
                stream.moved = 0;
            } else {
                stream.cr.set(0, false);
            }
        }
        Some(transfer)
    }

    /// Whether a stream's interrupt is asserted.
    pub(crate) fn interrupt(&self, stream: usize) -> bool {
        let (register, shift) = flag_shift(stream);
        let flags = self.flags[register] >> shift;
        let enabled = self.streams[stream].cr.value;
        enabled & 1 << 4 != 0 && flags & 1 << 5 != 0
            || enabled & 1 << 3 != 0 && flags & 1 << 4 != 0
            || enabled & 1 << 2 != 0 && flags & 1 << 3 != 0
    }

    pub(crate) fn read(&self, offset: u32) -> u32 {
        match offset {
            0x00 => self.flags[0],
            0x04 => self.flags[1],
            0x10..0xd0 => {
                let stream = &self.streams[(offset as usize - 0x10) / 0x18];
                match (offset - 0x10) % 0x18 {
                    0x00 => stream.cr.value,
                    0x04 => stream.ndtr,
                    0x08 => stream.par,
                    0x0c => stream.m0ar,
                    0x10 => stream.m1ar,
                    _ => stream.fcr.value,
                }
            }
            _ => 0,
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        match offset {
            0x08 | 0x0c => {
                if value & !0x0f7d_0f7d != 0 {
                    return refuse("DMA2_xIFCR", value, "reserved bits");
                }
                self.flags[(offset as usize - 8) / 4] &= !value;
                Ok(())
            }
            0x10..0xd0 => self.write_stream(offset, value),
            _ => refuse(
                "DMA2",
                value,
                format!("no writable register at {offset:#x}"),
            ),
        }
    }

    fn write_stream(&mut self, offset: u32, value: u32) -> Access<()> {
        let number = (offset as usize - 0x10) / 0x18;
        let (register, shift) = flag_shift(number);
        let flags = self.flags[register] >> shift & 0x3d;
        let stream = &mut self.streams[number];
        let place = (offset - 0x10) % 0x18;
        if stream.cr.bit(0) && place != 0 {
            return refuse("DMA2_Sx", value, format!("stream {number} is enabled"));
        }
        match place {
            0x00 => {
                let starts = value & 1 != 0 && !stream.cr.bit(0);
                if stream.cr.bit(0) && (value ^ stream.cr.value) & !0x1f != 0 {
                    return refuse("DMA2_SxCR", value, format!("stream {number} is enabled"));
                }
                stream.cr.write(value)?;
                if starts {
                    return stream.start(value, flags);
                }
            }
            0x04 => {
                if value > 0xffff {
                    return refuse("DMA2_SxNDTR", value, "reserved bits");
                }
                stream.ndtr = value;
            }
            0x08 => stream.par = value,
            0x0c => stream.m0ar = value,
            0x10 => stream.m1ar = value,
            _ => stream.fcr.write(value)?,
        }
        Ok(())
    }
}

impl Stream {
    fn start(&mut self, value: u32, flags: u32) -> Access<()> {
        let rule = if flags != 0 {
            "the stream starts with flags of the transfer before"
        } else if self.ndtr == 0 {
            "the stream starts with nothing to do"
        } else if self.cr.field(11, 4) != 0 || self.cr.bit(18) || self.fcr.bit(2) {
            "only bytes in direct mode with one buffer are simulated"
        } else if self.cr.bit(9) || self.cr.bit(5) || self.cr.field(6, 2) > 1 {
            "this kind of transfer is not simulated"
        } else if !REACHED.contains(&self.m0ar) {
            "DMA2 does not reach this memory"
        } else {
            self.length = self.ndtr;
            self.moved = 0;
            return Ok(());
        };
        refuse("DMA2_SxCR", value, rule)
    }
}

#[cfg(test)]
mod tests {
    use super::Dma;

    #[test]
    fn a_stream_reaches_the_ram_and_not_the_core_coupled_memory() {
        for (memory, reached) in [
            (0x2000_0000, true),
            (0x2001_ffff, true),
            (0x1000_0000, false),
            (0x2002_0000, false),
        ] {
            let mut dma = Dma::new();
            for (offset, value) in [(0x14, 1), (0x18, 0x4001_1004), (0x1c, memory)] {
                dma.write(offset, value).expect("legal");
            }
            assert_eq!(dma.write(0x10, 1).is_ok(), reached, "{memory:#x}");
        }
    }
}
