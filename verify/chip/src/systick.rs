//! SysTick, and the DWT's cycle counter: both count the core's cycles.

use crate::time::NEVER;
use crate::violation::{Access, refuse, refuse_read};

/// The timer of the core.
#[derive(Clone, Debug)]
pub(crate) struct SysTick {
    control: u32,
    reload: u32,
    /// The counter at `since`, in the core's cycles.
    count: u32,
    since: u64,
}

impl SysTick {
    pub(crate) fn new() -> Self {
        Self {
            control: 0,
            reload: 0,
            count: 0,
            since: 0,
        }
    }

    fn step(&self) -> u64 {
        if self.control & 4 != 0 { 1 } else { 8 }
    }

    fn left(&self) -> u64 {
        u64::from(if self.count == 0 {
            self.reload
        } else {
            self.count
        })
    }

    /// The cycle in which the counter reaches zero.
    pub(crate) fn due(&self) -> u64 {
        if self.control & 1 == 0 || self.reload == 0 {
            return NEVER;
        }
        self.since + self.left() * self.step()
    }

    /// Passes the zeros that are due; true if they raise the exception.
    pub(crate) fn advance(&mut self, cycle: u64) -> bool {
        let mut reached = false;
        while self.due() <= cycle {
            self.since = self.due();
            // The reload takes a count of its own.
            self.since += self.step();
            self.count = self.reload;
            self.control |= 1 << 16;
            reached = true;
        }
        reached && self.control & 2 != 0
    }

    fn now(&self, cycle: u64) -> u32 {
        if self.control & 1 == 0 {
            return self.count;
        }
        let counted = cycle.saturating_sub(self.since) / self.step();
        self.left().saturating_sub(counted) as u32
    }

    pub(crate) fn read(&mut self, offset: u32, cycle: u64) -> Access<u32> {
        match offset {
            0x10 => {
                let value = self.control;
                self.control &= !(1 << 16);
                Ok(value)
            }
            0x14 => Ok(self.reload),
            0x18 => Ok(self.now(cycle)),
            0x1c => Ok(0x4000_0000),
            _ => refuse_read("SYST", format!("no register at {offset:#x}")),
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, cycle: u64) -> Access<()> {
        self.count = self.now(cycle);
        self.since = cycle;
        match offset {
            0x10 => self.control = value & 7,
            0x14 if value >> 24 == 0 => self.reload = value,
            0x18 => self.count = 0,
            _ => return refuse("SYST", value, format!("not possible at {offset:#x}")),
        }
        Ok(())
    }
}

/// The cycle counter.
#[derive(Clone, Debug)]
pub(crate) struct Dwt {
    control: u32,
    /// The count at the cycle `since`, if it runs.
    count: u32,
    since: u64,
}

impl Dwt {
    pub(crate) fn new() -> Self {
        Self {
            control: 0x4000_0000,
            count: 0,
            since: 0,
        }
    }

    fn now(&self, cycle: u64, trace: bool) -> u32 {
        if self.control & 1 == 0 || !trace {
            return self.count;
        }
        self.count.wrapping_add((cycle - self.since) as u32)
    }

    /// Reads a register; `trace` is DEMCR's TRCENA.
    pub(crate) fn read(&self, offset: u32, cycle: u64, trace: bool) -> Access<u32> {
        match offset {
            0 => Ok(self.control),
            4 => Ok(self.now(cycle, trace)),
            _ => refuse_read("DWT", format!("offset {offset:#x} is not simulated")),
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, cycle: u64, trace: bool) -> Access<()> {
        self.count = self.now(cycle, trace);
        self.since = cycle;
        match offset {
            0 => self.control = value,
            4 => self.count = value,
            0xfb0 => {}
            _ => return refuse("DWT", value, format!("offset {offset:#x} is not simulated")),
        }
        Ok(())
    }
}
