//! The chip with its program, and its time.

use crate::arm::Arm;
use crate::bus::{Bus, Violation};
use crate::flash::FlashEvent;
use crate::image::Image;
use crate::pins::Wires;
use crate::rom::{self, Function};
use crate::usb_host::UsbHost;
use crate::{acquire, fpu, masks};
use rp2350_emu::core::CortexM33;
use rp2350_emu::threaded::CoreAtomics;
use std::sync::Arc;

/// Cycles in a second.
pub const HZ: u64 = 150_000_000;
/// The interrupt of UART0.
const UART0: u32 = 33;
/// The interrupt of USB, and the number of its exception.
const USB: u32 = 14;
const USB_EXCEPTION: u32 = 16 + USB;
/// The number of the exception of the ticks.
const SYSTICK_EXCEPTION: u32 = 15;
/// What the flash takes: for a block of 64 KiB and a page of 256 bytes [cycles].
const BLOCK: u64 = HZ * 150 / 1000;
const PAGE: u64 = HZ * 400 / 1_000_000;
/// Peripherals but the state machines are advanced in steps of so many cycles.
const SLICE: u64 = 50;

/// A Pico 2 with a program.
pub struct Chip {
    core: CortexM33,
    bus: Bus,
    /// Up to here everything but the core has advanced [cycles].
    at: u64,
    /// Cycles before the last reset of the chip.
    before: u64,
    /// Of the core's own cycles: when a function of the ROM is done.
    done_at: Option<u64>,
    /// The core executes nothing.
    hangs: bool,
    /// The tick that lasts: the core's own cycle in which its interrupt began.
    tick_began: Option<u64>,
    /// Ticks that have ended.
    pub ticks: u64,
    /// The cycles of the longest one.
    pub longest_tick: u64,
    /// The interrupt of the ticks is lost.
    pub without_ticks: bool,
    /// Resets since power came on.
    pub resets: u32,
}

impl Chip {
    /// The chip, about to get power.
    pub fn new(image: &Image) -> Self {
        let atomics = Arc::new(CoreAtomics::default());
        let bus = Bus::new(image.flash.clone(), Arc::clone(&atomics));
        let mut chip = Self {
            core: CortexM33::new(0, atomics),
            bus,
            at: 0,
            before: 0,
            done_at: None,
            hangs: false,
            tick_began: None,
            ticks: 0,
            longest_tick: 0,
            without_ticks: false,
            resets: 0,
        };
        chip.boot();
        chip
    }

    /// What the boot ROM does with an image: it starts by the vectors at the beginning of the flash.
    fn boot(&mut self) {
        self.before += self.at;
        self.at = 0;
        self.done_at = None;
        self.hangs = false;
        self.without_ticks = false;
        self.tick_began = None;
        self.bus.flash_is_busy = false;
        self.bus.atomics.reset();
        self.core = CortexM33::new(0, Arc::clone(&self.bus.atomics));
        let word = |at: usize| {
            let bytes = self.bus.flash[at..at + 4].try_into();
            u32::from_le_bytes(bytes.unwrap_or_default())
        };
        let (stack, start) = (word(0), word(4));
        self.core.regs.msp = stack;
        self.core.regs.set_sp(stack);
        if start & 1 == 0 {
            self.bus.violate("the start is no Thumb code", start);
        }
        self.core.regs.set_pc(start & !1);
    }

    /// Takes the power away and gives it back; the flash stays.
    pub fn power_cycle(&mut self) {
        let flash = std::mem::take(&mut self.bus.flash);
        let stop = self.bus.blocks.wires.stop;
        let arm = self.bus.blocks.arm.take();
        let mut usb_host = std::mem::take(&mut self.bus.blocks.usb_host);
        usb_host.lose_device();
        self.bus = Bus::new(flash, Arc::clone(&self.bus.atomics));
        self.bus.blocks.wires.stop = stop;
        self.bus.blocks.arm = arm;
        self.bus.blocks.usb_host = usb_host;
        self.boot();
    }

    /// The flash with the program and the settings.
    pub fn flash(&mut self) -> &mut [u8] {
        &mut self.bus.flash
    }

    /// Takes what has changed the flash.
    pub fn flash_events(&mut self) -> Vec<FlashEvent> {
        std::mem::take(&mut self.bus.flash_events)
    }

    /// Cycles since power came on.
    pub fn now(&self) -> u64 {
        self.before + self.at
    }

    /// What is wired to its pins.
    pub fn wires(&mut self) -> &mut Wires {
        &mut self.bus.blocks.wires
    }

    /// Wires an arm to its pins.
    pub fn connect(&mut self, arm: impl Arm + 'static) {
        self.bus.blocks.arm = Some(Box::new(arm));
    }

    /// Presses or releases the emergency stop.
    pub fn press_stop(&mut self, pressed: bool) {
        self.bus.blocks.press_stop(pressed);
    }

    /// Whether the brake is released.
    pub fn brake_is_released(&self) -> bool {
        self.bus.blocks.brake_is_released()
    }

    /// The core executes an instruction that does not exist: a fault of the processor.
    pub fn fault(&mut self) {
        self.core.regs.set_pc(rom::UNDEFINED);
    }

    /// What runs below the ticks hangs, from the next moment without an interrupt on.
    pub fn hang_session(&mut self) {
        while self.core.regs.ipsr() != 0 {
            self.step();
        }
        self.core.regs.set_pc(rom::HANGS);
    }

    /// The core goes on at this address, such as that of a function that ends the program.
    pub fn jump(&mut self, address: u32) {
        self.core.regs.set_pc(address & !1);
    }

    /// The crystal does not swing, from now on.
    pub fn take_crystal(&mut self) {
        self.bus.blocks.crystal_is_dead = true;
    }

    /// The core hangs: it executes nothing any more.
    pub fn hang(&mut self) {
        self.hangs = true;
    }

    /// Sends bytes to the chip.
    pub fn send(&mut self, bytes: &[u8]) {
        self.bus.blocks.uart.from_host.extend(bytes);
    }

    /// Takes at most so many bytes that it has sent.
    pub fn receive(&mut self, most: usize) -> Vec<u8> {
        let sent = &mut self.bus.blocks.uart.to_host;
        sent.drain(..most.min(sent.len())).collect()
    }

    /// The host at its USB cable.
    pub fn usb(&mut self) -> &mut UsbHost {
        &mut self.bus.blocks.usb_host
    }

    /// Bytes that the chip has lost because nobody took them.
    pub fn overruns(&self) -> u32 {
        self.bus.blocks.uart.overruns
    }

    /// Runs for so many cycles.
    ///
    /// # Errors
    /// What the program may not do.
    pub fn run(&mut self, cycles: u64) -> Result<(), Violation> {
        let end = self.now() + cycles;
        while self.now() < end {
            self.step();
            if let Some(violation) = self.bus.violation {
                return Err(violation);
            }
        }
        Ok(())
    }

    fn step(&mut self) {
        if self.hangs {
            return self.advance(1);
        }
        let cycles = self.core.cycles();
        self.core.ppb.update_latest_cycles(cycles);
        if !self.step_unknown() {
            self.core.step(&mut self.bus);
        }
        if !self.bus.written.is_empty() {
            self.core.invalidate_decode_cache_entries(&self.bus.written);
            self.bus.written.clear();
        }
        let began = cycles;
        let cycles = self.core.cycles();
        self.time_ticks(began, cycles);
        self.count_systick(cycles);
        let pc = self.core.regs.pc();
        if pc < 0x8000 && self.core.regs.ipsr() == 0 {
            self.in_rom(pc, cycles);
        }
        let passed = cycles - self.at;
        if self.bus.blocks.pio_runs || passed >= SLICE {
            self.advance(passed);
        }
    }

    /// Notes when the interrupt of a tick begins and ends. Nothing interrupts it.
    fn time_ticks(&mut self, began: u64, now: u64) {
        let ticks = self.core.regs.ipsr() == SYSTICK_EXCEPTION;
        match self.tick_began {
            None if ticks => self.tick_began = Some(began),
            Some(began) if !ticks => {
                self.tick_began = None;
                self.ticks += 1;
                self.longest_tick = self.longest_tick.max(now - began);
            }
            _ => {}
        }
    }

    /// Lets SysTick count. The emulated one raises its interrupt when it passes 0, but not when it stops there.
    fn count_systick(&mut self, cycles: u64) {
        const ENABLED: u32 = 0b11;
        if self.without_ticks {
            return;
        }
        let ppb = &mut self.core.ppb;
        let before = ppb.syst_cvr;
        ppb.systick_advance(cycles);
        if before != 0 && ppb.syst_cvr == 0 && ppb.syst_csr & ENABLED == ENABLED {
            ppb.pend_systick();
        }
    }

    /// Executes an instruction that the emulated core does not know, or does otherwise than a chip; else nothing.
    fn step_unknown(&mut self) -> bool {
        let (core, bus) = (&mut self.core, &mut self.bus);
        let Some(instruction) = bus.instruction(core.regs.pc()) else {
            return false;
        };
        let is_wide = instruction[0] >> 13 == 7;
        masks::step(core, instruction[0])
            || is_wide
                && (fpu::step(core, bus, instruction) || acquire::step(core, bus, instruction))
    }

    /// Lets everything but the core advance.
    fn advance(&mut self, cycles: u64) {
        let now = self.now();
        let blocks = &mut self.bus.blocks;
        blocks.advance(now, cycles);
        self.at += cycles;
        if blocks.uart.advance(cycles) {
            self.bus.atomics.assert_irq(0, UART0);
        }
        // A level: it raises the interrupt again as long as it is there.
        let serves = self.core.regs.ipsr() == USB_EXCEPTION;
        if self.bus.blocks.advance_usb(cycles) && !serves {
            self.bus.atomics.assert_irq(0, USB);
        }
        if self.bus.blocks.watchdog.advance(cycles) {
            self.resets += 1;
            self.bus.blocks.reset();
            self.boot();
        }
    }

    /// Does what a function of the ROM does, and returns from it when that is done.
    fn in_rom(&mut self, pc: u32, cycles: u64) {
        let Some(function) = rom::at(pc) else {
            if pc != rom::HANGS {
                self.bus.violate("no function of the ROM is there", pc);
            }
            return;
        };
        let [first, second, third] = [0, 1, 2].map(|register| self.core.reg(register));
        let takes = match function {
            Function::Erase => BLOCK * u64::from(second.div_ceil(64 * 1024)),
            Function::Program => PAGE * u64::from(third / 256),
            _ => 0,
        };
        let done_at = *self.done_at.get_or_insert(cycles + takes);
        self.bus.flash_is_busy = takes > 0 && cycles < done_at;
        if cycles < done_at {
            return;
        }
        self.done_at = None;
        match function {
            Function::Lookup => self.core.set_reg(0, rom::find(first)),
            Function::Erase => self.bus.erase(first, second),
            Function::Program => self.bus.program(first, second, third),
            Function::Connect | Function::LeaveXip | Function::FlushCache | Function::EnterXip => {}
        }
        let back = self.core.regs.lr();
        self.core.regs.set_pc(back & !1);
    }
}
