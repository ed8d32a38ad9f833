//! The watchdog: it counts microseconds while its tick runs, and keeps its scratch registers over a reset.

const ENABLE: u32 = 1 << 30;
const TRIGGER: u32 = 1 << 31;
const PAUSES: u32 = 7 << 24;
/// Cycles of a microsecond.
const MICROSECOND: u64 = 150;
/// REASON: it ran out, or the program asked for it.
const RAN_OUT: u32 = 1;
const FORCED: u32 = 2;

#[derive(Default)]
pub(crate) struct Watchdog {
    control: u32,
    /// Microseconds left.
    left: u32,
    part: u64,
    pub(crate) reason: u32,
    scratch: [u32; 8],
    /// The tick's registers: control, cycles.
    pub(crate) tick: [u32; 2],
}

impl Watchdog {
    /// As it is after a reset of the chip.
    pub(crate) fn reset(&mut self) {
        let (reason, scratch) = (self.reason, self.scratch);
        *self = Self {
            reason,
            scratch,
            ..Self::default()
        };
    }

    pub(crate) fn read(&self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x00 => self.control | self.left & 0x00ff_ffff,
            0x08 => self.reason,
            0x0c..=0x28 => self.scratch[(offset as usize - 0x0c) / 4],
            _ => return None,
        })
    }

    /// None where there is no such register.
    pub(crate) fn write(&mut self, offset: u32, value: u32) -> Option<()> {
        match offset {
            0x00 => {
                self.control = value & (ENABLE | PAUSES);
                if value & TRIGGER != 0 {
                    self.reason = FORCED;
                    self.left = 0;
                    self.control |= TRIGGER;
                }
            }
            0x04 => self.left = value & 0x00ff_ffff,
            0x0c..=0x28 => self.scratch[(offset as usize - 0x0c) / 4] = value,
            _ => return None,
        }
        Some(())
    }

    /// Lets time pass; true when it resets the chip.
    pub(crate) fn advance(&mut self, cycles: u64) -> bool {
        if self.control & TRIGGER != 0 {
            return true;
        }
        let ticks = self.tick == [1, 12];
        if self.control & ENABLE == 0 || !ticks {
            return false;
        }
        self.part += cycles;
        while self.part >= MICROSECOND {
            self.part -= MICROSECOND;
            self.left = self.left.saturating_sub(1);
            if self.left == 0 {
                self.reason = RAN_OUT;
                return true;
            }
        }
        false
    }
}
