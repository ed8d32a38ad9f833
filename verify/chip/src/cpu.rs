//! The core between emulator and peripherals: what it runs, and when it has to stop.

use crate::accesses::Accesses;
use crate::figures::Figures;
use crate::image::{CODE, Image};
use crate::locate::access_in;
use crate::mcu::Mcu;
use crate::nvic::Nvic;
use crate::peripherals::reset_cause::ResetCause;
use crate::report::Report;
use crate::time::{Time, seconds};
use crate::trace::{Step, Trace};
use crate::unicorn::{Engine, Reg};
use crate::violation::Violation;
use std::sync::Arc;

/// Why the core stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stop {
    /// Something is due: an exception, a reset, the end.
    Due,
    /// The program returns from an exception.
    Return,
    /// A fault of the processor.
    Fault,
}

/// What the callbacks reach.
pub(crate) struct Cpu {
    pub(crate) engine: Engine,
    pub(crate) mcu: Mcu,
    pub(crate) image: Arc<Image>,
    pub(crate) code: Box<[u8]>,
    pub(crate) ccm: Box<[u8]>,
    pub(crate) system: Box<[u8]>,
    /// The block that runs.
    pub(crate) block: u32,
    pub(crate) block_size: u32,
    pub(crate) stop: Option<Stop>,
    pub(crate) limit: Time,
    /// When the block hook has to look.
    pub(crate) deadline: Time,
    /// An exception waits that may be masked.
    pub(crate) waiting: bool,
    pub(crate) locked_up: bool,
    pub(crate) resets: Vec<(Time, ResetCause)>,
    pub(crate) figures: Figures,
    /// Bytes of the stack that the next exception finds, if a test says so; the stack's figure
    /// then means nothing.
    pub(crate) stack_left: Option<u32>,
    pub(crate) idle: IdleLoop,
    /// What the program does, if a test asks.
    pub(crate) trace: Option<Trace>,
    /// Accesses to registers in the ticks, and the exception of these.
    pub(crate) accesses: Accesses,
    pub(crate) tick: u32,
}

/// The idle loop's turns. One that runs the same blocks as the turn before, without an
/// exception and without touching a register, changes nothing; those that would follow are
/// skipped up to the next event.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct IdleLoop {
    /// A block that each turn runs once; none: nothing is skipped.
    pub(crate) anchor: Option<u32>,
    /// Hash of the blocks of this turn, and of the turn before.
    pub(crate) path: u64,
    pub(crate) last_path: u64,
    pub(crate) began: Time,
    pub(crate) last_length: Time,
    pub(crate) disturbed: bool,
}

impl Cpu {
    pub(crate) fn report(&self, violation: Violation) -> Report {
        Report {
            violation,
            pc: self.block,
            function: self.image.function(self.block).unwrap_or("?").to_owned(),
            line: self
                .image
                .line(self.block)
                .unwrap_or_else(|| "?".to_owned()),
            time: seconds(self.mcu.now),
        }
    }

    /// An access to this address broke a rule: the run ends, and the report names the
    /// instruction.
    pub(crate) fn refuse(&mut self, violation: Violation, address: u32, writes: bool) {
        let first = self.mcu.violation.is_none();
        self.mcu.violation.get_or_insert(violation);
        self.touched();
        let start = self.block.wrapping_sub(CODE) as usize;
        let code = self.code.get(start..start + self.block_size as usize);
        let register = |number| match number {
            13 => self.engine.get(Reg::SP),
            14 => self.engine.get(Reg::LR),
            15 => self.engine.get(Reg::PC),
            _ => self.engine.get(Reg::r(number)),
        };
        let found = code.and_then(|code| access_in(code, self.block, address, writes, register));
        if first {
            self.block = found.unwrap_or(self.block);
        }
    }

    /// Starts the core after a reset.
    pub(crate) fn start(&mut self, cause: ResetCause) {
        self.resets.push((self.mcu.now, cause));
        self.mcu.make_reset(cause);
        self.locked_up = false;
        self.figures.restart();
        if cause == ResetCause::Power {
            self.mcu.ram.fill(0xa5);
            self.ccm.fill(0x5a);
        }
        let stack = self.vector(0);
        let entry = self.vector(1);
        self.engine.set(Reg::XPSR, 1 << 24);
        self.engine.set(Reg::CONTROL, 0);
        self.engine.set(Reg::PRIMASK, 0);
        self.engine.set(Reg::BASEPRI, 0);
        self.engine.set(Reg::FAULTMASK, 0);
        self.engine.set(Reg::SP, stack);
        self.engine.set(Reg::LR, !0);
        self.engine.set(Reg::PC, entry & !1);
    }

    /// An entry of the vector table; the flash is at address 0, too.
    pub(crate) fn vector(&self, number: u32) -> u32 {
        let at = (self.mcu.nvic.vector_table & 0x7_ffff) as usize + 4 * number as usize;
        let bytes = &self.code[at..at + 4];
        u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])
    }

    /// Notes whether an exception waits whose priority is above that of what runs.
    pub(crate) fn look_for_exceptions(&mut self) {
        let nvic: &Nvic = &self.mcu.nvic;
        self.waiting = nvic
            .next()
            .is_some_and(|(_, priority)| priority < nvic.active_priority());
    }

    /// The exception to take now, the masks considered.
    pub(crate) fn takeable(&self) -> Option<u32> {
        if !self.waiting {
            return None;
        }
        let (exception, priority) = self.mcu.nvic.next()?;
        let masked = self.engine.get(Reg::FAULTMASK) & 1 != 0 && priority >= -1
            || self.engine.get(Reg::PRIMASK) & 1 != 0 && priority >= 0
            || matches!(self.engine.get(Reg::BASEPRI) as i32 & 0xf0, base if base != 0 && priority >= base);
        (!masked).then_some(exception)
    }

    /// Something is due in the block hook: true if the core has to stop.
    pub(crate) fn look(&mut self) -> bool {
        self.mcu.run_events();
        self.look_for_exceptions();
        self.deadline = self.mcu.due.min(self.limit);
        self.mcu.violation.is_some()
            || self.mcu.reset.is_some()
            || self.mcu.bus_error
            || self.mcu.stalled_until > self.mcu.now
            || self.mcu.now >= self.limit
    }

    /// The program reads or writes a register.
    pub(crate) fn count_access(&mut self, address: u32) {
        let active = self.mcu.nvic.active.last().copied();
        self.accesses.count(address, active, self.tick);
    }

    /// A register was written or read: the hook looks before the next block.
    pub(crate) fn touched(&mut self) {
        self.deadline = 0;
        self.idle.disturbed = true;
    }

    /// A turn of the idle loop begins: skips those that change nothing.
    pub(crate) fn turn(&mut self) {
        if let Some(trace) = &mut self.trace {
            trace.note(Step::Planned);
        }
        let (now, idle) = (self.mcu.now, &mut self.idle);
        let length = now - idle.began;
        let repeats = idle.path == idle.last_path && length == idle.last_length;
        if repeats && !idle.disturbed && self.deadline > now && length > 0 {
            self.mcu.now += (self.deadline - now) / length * length;
        }
        idle.last_path = if idle.disturbed { 0 } else { idle.path };
        idle.last_length = length;
        idle.path = 0;
        idle.disturbed = false;
        idle.began = self.mcu.now;
    }
}
