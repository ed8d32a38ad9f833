//! Entry to exceptions and return from them, with the frames on the stack, and faults.

use crate::cpu::Cpu;
use crate::mcu::{RAM, RAM_SIZE};
use crate::nvic::{HARD_FAULT, NMI};
use crate::unicorn::Reg;

/// Cycles of an exception's entry and return.
const EXCEPTION: u64 = 12;

impl Cpu {
    pub(crate) fn push(&mut self, at: u32, word: u32) -> bool {
        let place = at.wrapping_sub(RAM) as usize;
        match self.mcu.ram.get_mut(place..place.wrapping_add(4)) {
            Some(slot) if place < RAM_SIZE => {
                slot.copy_from_slice(&word.to_le_bytes());
                true
            }
            _ => false,
        }
    }

    pub(crate) fn enter(&mut self, exception: u32) {
        let engine = &self.engine;
        let (sp, control, xpsr) = (
            engine.get(Reg::SP),
            engine.get(Reg::CONTROL),
            engine.get(Reg::XPSR),
        );
        let left = self.stack_left.take();
        let sp = left.map_or(sp, |bytes| RAM + bytes);
        let float = control & 4 != 0;
        let mut frame: Vec<u32> = [0, 1, 2, 3, 12].map(|n| engine.get(Reg::r(n))).to_vec();
        frame.push(engine.get(Reg::LR));
        frame.push(engine.get(Reg::PC) & !1);
        frame.push(xpsr & !(1 << 9) | (sp >> 2 & 1) << 9);
        if float {
            frame.extend((0..16).map(|n| engine.get(Reg::s(n))));
            frame.extend([engine.get(Reg::FPSCR), 0]);
        }
        let new = sp.wrapping_sub(4 * frame.len() as u32) & !7;
        let mut stacked = true;
        for (at, word) in (new..).step_by(4).zip(frame) {
            stacked &= self.push(at, word);
        }
        // The stack is no memory: a bus fault, which the HardFault handles. It is taken in place
        // of the exception, which stays pending. The stack pointer has moved all the same, and
        // nothing is pushed again (Armv7-M manual, derived exceptions).
        let exception = if !stacked && exception > HARD_FAULT {
            self.mcu.nvic.cfsr |= 1 << 12;
            self.mcu.nvic.hfsr |= 1 << 30;
            HARD_FAULT
        } else {
            exception
        };
        let thread = self.mcu.nvic.active.is_empty();
        let back = if thread { 0xffff_fff9 } else { 0xffff_fff1 };
        self.mcu.nvic.enter(exception);
        self.figures.enter(exception);
        self.accesses.enter(exception, self.tick);
        if let Some(trace) = &mut self.trace {
            trace.enter(exception);
        }
        let entry = self.vector(exception);
        let engine = &mut self.engine;
        engine.set(Reg::SP, new);
        engine.set(Reg::LR, if float { back & !0x10 } else { back });
        engine.set(Reg::CONTROL, control & !6);
        engine.set(Reg::XPSR, xpsr & 0xf80f_0000 | 1 << 24 | exception);
        engine.set(Reg::PC, entry & !1);
        self.mcu.now += EXCEPTION * self.mcu.core;
        self.idle.disturbed = true;
    }

    pub(crate) fn leave(&mut self) {
        let kind = self.engine.get(Reg::PC);
        self.figures.leave(self.mcu.nvic.active.last());
        self.mcu.nvic.leave();
        if self.mcu.rcc.nmi() {
            // The NMI comes again until its cause is cleared.
            self.mcu.nvic.pend(NMI);
        }
        let sp = self.engine.get(Reg::SP);
        let float = kind & 0x10 == 0;
        let words = if float { 26 } else { 8 };
        let word = |n: u32| -> u32 {
            let at = (sp + 4 * n).wrapping_sub(RAM) as usize;
            self.mcu.ram.get(at..at + 4).map_or(0, |bytes| {
                u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])
            })
        };
        let frame: Vec<u32> = (0..words).map(word).collect();
        let engine = &mut self.engine;
        for (n, place) in [0, 1, 2, 3, 12].into_iter().zip(0..) {
            engine.set(Reg::r(n), frame[place]);
        }
        engine.set(Reg::LR, frame[5]);
        let xpsr = frame[7];
        engine.set(Reg::XPSR, xpsr & !(1 << 9));
        if float {
            for n in 0..16 {
                engine.set(Reg::s(n), frame[8 + n as usize]);
            }
            engine.set(Reg::FPSCR, frame[24]);
        }
        let control = engine.get(Reg::CONTROL) & !4;
        engine.set(Reg::CONTROL, if float { control | 4 } else { control });
        engine.set(Reg::FAULTMASK, 0);
        engine.set(Reg::SP, sp + 4 * words + 4 * (xpsr >> 9 & 1));
        engine.set(Reg::PC, frame[6]);
        self.mcu.now += EXCEPTION * self.mcu.core;
    }

    /// A fault of the processor: all go to the HardFault handler; within that one or the
    /// NMI's the core locks up.
    pub(crate) fn fault(&mut self) {
        if self.mcu.nvic.active_priority() <= -1 {
            self.locked_up = true;
            return;
        }
        self.mcu.nvic.hfsr |= 1 << 30;
        self.mcu.nvic.pend(HARD_FAULT);
        self.mcu.nvic.next();
        self.enter(HARD_FAULT);
    }
}
