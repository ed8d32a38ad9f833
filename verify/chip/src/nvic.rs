//! NVIC and SCB: which exceptions wait, which are active, and which one is next.

use crate::violation::{Access, refuse, refuse_read};

/// Numbers of the system exceptions.
pub(crate) const NMI: u32 = 2;
pub(crate) const HARD_FAULT: u32 = 3;
pub(crate) const PEND_SV: u32 = 14;
pub(crate) const SYS_TICK: u32 = 15;
/// Number of the first interrupt.
pub(crate) const FIRST: u32 = 16;

const INTERRUPTS: usize = 96;
/// Priority of a thread: below all exceptions.
pub(crate) const THREAD: i32 = 256;

/// The controller of the exceptions.
#[derive(Clone, Debug)]
pub(crate) struct Nvic {
    enabled: u128,
    pending: u128,
    /// Levels of the interrupts' lines.
    lines: u128,
    priority: [u8; INTERRUPTS],
    /// Priorities of exceptions 4 to 15.
    system_priority: [u8; 12],
    /// Pending system exceptions, a bit each.
    system_pending: u32,
    /// Active exceptions, the latest last.
    pub(crate) active: Vec<u32>,
    pub(crate) vector_table: u32,
    shcsr: u32,
    ccr: u32,
    scr: u32,
    cpacr: u32,
    fpccr: u32,
    pub(crate) cfsr: u32,
    pub(crate) hfsr: u32,
    pub(crate) bfar: u32,
    pub(crate) demcr: u32,
    pub(crate) reset_requested: bool,
}

impl Nvic {
    pub(crate) fn new() -> Self {
        Self {
            enabled: 0,
            pending: 0,
            lines: 0,
            priority: [0; INTERRUPTS],
            system_priority: [0; 12],
            system_pending: 0,
            active: Vec::new(),
            vector_table: 0,
            shcsr: 0,
            ccr: 0x200,
            scr: 0,
            cpacr: 0,
            fpccr: 0xc000_0000,
            cfsr: 0,
            hfsr: 0,
            bfar: 0,
            demcr: 0,
            reset_requested: false,
        }
    }

    /// The levels of all interrupt lines; one that rises makes its interrupt pending.
    pub(crate) fn set_lines(&mut self, lines: u128) {
        self.pending |= lines & !self.lines;
        self.lines = lines;
    }

    pub(crate) fn pend(&mut self, exception: u32) {
        if exception >= FIRST {
            self.pending |= 1 << (exception - FIRST);
        } else {
            self.system_pending |= 1 << exception;
        }
    }

    /// Enables an interrupt and makes it pending.
    pub(crate) fn raise(&mut self, interrupt: u32) {
        self.enabled |= 1 << interrupt;
        self.pending |= 1 << interrupt;
    }

    pub(crate) fn disable(&mut self, interrupt: u32) {
        self.enabled &= !(1 << interrupt);
    }

    fn priority_of(&self, exception: u32) -> i32 {
        match exception {
            NMI => -2,
            HARD_FAULT => -1,
            4..16 => self.system_priority[exception as usize - 4].into(),
            _ => self.priority[(exception - FIRST) as usize].into(),
        }
    }

    /// The priority of what runs, without the masks.
    pub(crate) fn active_priority(&self) -> i32 {
        let priorities = self
            .active
            .iter()
            .map(|&exception| self.priority_of(exception));
        priorities.min().unwrap_or(THREAD)
    }

    /// The pending exception of the highest priority, and its priority.
    pub(crate) fn next(&self) -> Option<(u32, i32)> {
        let mut waiting = self.pending & self.enabled;
        if waiting == 0 && self.system_pending == 0 {
            return None;
        }
        let mut best: Option<(u32, i32)> = None;
        let mut consider = |exception: u32| {
            let priority = self.priority_of(exception);
            if best.is_none_or(|(_, least)| priority < least) {
                best = Some((exception, priority));
            }
        };
        (0..16)
            .filter(|bit| self.system_pending >> bit & 1 != 0)
            .for_each(&mut consider);
        while waiting != 0 {
            let interrupt = waiting.trailing_zeros();
            waiting &= waiting - 1;
            consider(interrupt + FIRST);
        }
        best
    }

    pub(crate) fn enter(&mut self, exception: u32) {
        if exception >= FIRST {
            self.pending &= !(1 << (exception - FIRST));
        } else {
            self.system_pending &= !(1 << exception);
        }
        self.active.push(exception);
    }

    /// The latest exception returns. An interrupt whose line is still high is pending again.
    pub(crate) fn leave(&mut self) {
        let left = self.active.pop();
        if let Some(interrupt) = left.and_then(|exception| exception.checked_sub(FIRST)) {
            self.pending |= self.lines & 1 << interrupt;
        }
    }

    pub(crate) fn read(&self, offset: u32) -> Access<u32> {
        let word = |bits: u128, at: u32| (bits >> (8 * at)) as u32;
        Ok(match offset {
            0x004 => 2,
            0x100..0x110 => word(self.enabled, offset - 0x100),
            0x180..0x190 => word(self.enabled, offset - 0x180),
            0x200..0x210 => word(self.pending, offset - 0x200),
            0x280..0x290 => word(self.pending, offset - 0x280),
            0x300..0x310 => {
                let interrupts = self.active.iter().filter(|&&active| active >= FIRST);
                word(
                    interrupts.fold(0, |bits, active| bits | 1 << (active - FIRST)),
                    offset - 0x300,
                )
            }
            0x400..0x460 => {
                let at = (offset - 0x400) as usize;
                u32::from_le_bytes(std::array::from_fn(|i| {
                    self.priority.get(at + i).copied().unwrap_or(0)
                }))
            }
            0xd00 => 0x410f_c241,
            0xd04 => {
                let pending = self.next().map_or(0, |(exception, _)| exception << 12);
                self.active.last().copied().unwrap_or(0) | pending
            }
            0xd08 => self.vector_table,
            0xd0c => 0xfa05_0000,
            0xd10 => self.scr,
            0xd14 => self.ccr,
            0xd18..0xd24 => {
                let at = (offset - 0xd18) as usize;
                u32::from_le_bytes(std::array::from_fn(|i| self.system_priority[at + i]))
            }
            0xd24 => self.shcsr,
            0xd28 => self.cfsr,
            0xd2c => self.hfsr,
            0xd34 | 0xd38 => self.bfar,
            0xd88 => self.cpacr,
            0xd90 => 0x800,
            0xdf0 => 0,
            0xdfc => self.demcr,
            0xf34 => self.fpccr,
            _ => return refuse_read("SCS", format!("offset {offset:#x} is not simulated")),
        })
    }

    pub(crate) fn write(&mut self, offset: u32, size: u32, value: u32) -> Access<()> {
        let bits = |at: u32| u128::from(value) << (8 * at);
        match offset {
            0x100..0x110 => self.enabled |= bits(offset - 0x100),
            0x180..0x190 => self.enabled &= !bits(offset - 0x180),
            0x200..0x210 => self.pending |= bits(offset - 0x200),
            0x280..0x290 => self.pending = self.pending & !bits(offset - 0x280) | self.lines,
            0x400..0x460 => {
                for (i, byte) in value
                    .to_le_bytes()
                    .into_iter()
                    .take(size as usize)
                    .enumerate()
                {
                    if let Some(priority) = self.priority.get_mut(offset as usize - 0x400 + i) {
                        *priority = byte & 0xf0;
                    }
                }
            }
            0xd04 => self.write_icsr(value),
            0xd08 => self.vector_table = value & !0x1ff,
            0xd0c => {
                if value >> 16 != 0x05fa {
                    return refuse("SCB_AIRCR", value, "without its key");
                }
                if value & 0x700 != 0 {
                    return refuse("SCB_AIRCR", value, "priority groups are not simulated");
                }
                self.reset_requested = value & 4 != 0;
            }
            0xd10 => self.scr = value,
            0xd14 => self.ccr = value,
            0xd18..0xd24 => {
                for (i, byte) in value
                    .to_le_bytes()
                    .into_iter()
                    .take(size as usize)
                    .enumerate()
                {
                    self.system_priority[offset as usize - 0xd18 + i] = byte & 0xf0;
                }
            }
            0xd24 => self.shcsr = value,
            0xd28 => self.cfsr &= !value,
            0xd2c => self.hfsr &= !value,
            0xd88 => self.cpacr = value,
            0xdfc => self.demcr = value,
            0xf34 => self.fpccr = value,
            _ => return refuse("SCS", value, format!("offset {offset:#x} is not simulated")),
        }
        Ok(())
    }

    fn write_icsr(&mut self, value: u32) {
        for (bit, exception, pend) in [
            (31, NMI, true),
            (28, PEND_SV, true),
            (27, PEND_SV, false),
            (26, SYS_TICK, true),
            (25, SYS_TICK, false),
        ] {
            if value >> bit & 1 != 0 {
                if pend {
                    self.pend(exception);
                } else {
                    self.system_pending &= !(1 << exception);
                }
            }
        }
    }
}
