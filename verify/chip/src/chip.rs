//! The chip: the core of the emulator between the peripherals, and the passing of time.

use crate::accesses::{Accesses, tick_of};
use crate::callbacks::{
    on_block, on_interrupt, on_invalid_instruction, on_invalid_memory, read_at, read_sectors,
    write_at, write_sectors,
};
use crate::cpu::{Cpu, IdleLoop, Stop};
use crate::defect::Defect;
use crate::figures::Figures;
use crate::image::{CODE, Image};
use crate::mcu::{Mcu, Options, RAM};
use crate::peripherals::bxcan::CanStatistics;
use crate::peripherals::flash::{self, FlashEvent};
use crate::peripherals::reset_cause::ResetCause;
use crate::peripherals::tim1::RepetitionReading;
use crate::report::Report;
use crate::time::{NEVER, Time};
use crate::trace::{self, Step, Trace};
use crate::unicorn::{EXECUTE, EmulatorError, Engine, READ, Reg, WRITE};
use crate::violation::{Access, Violation, refuse};
use crate::wiring::Wiring;
use std::ffi::c_void;
use std::ptr::NonNull;
use std::sync::Arc;

const CCM: u32 = 0x1000_0000;
/// System memory: the unique identifier and the flash's size are in this page.
const SYSTEM: u32 = 0x1fff_7000;

/// A simulated STM32F405 and what is wired to it.
pub struct Chip {
    cpu: NonNull<Cpu>,
}

impl Chip {
    /// A chip that is about to get power. `settings` are the contents of its settings'
    /// sectors, blank if empty.
    ///
    /// # Errors
    /// The emulator cannot be set up.
    pub fn new(
        image: Arc<Image>,
        options: Options,
        settings: Vec<u8>,
        wiring: Box<dyn Wiring>,
    ) -> Result<Self, EmulatorError> {
        let mut sectors = settings;
        sectors.resize(flash::SIZE, 0xff);
        let mut system = vec![0xff; 0x1000].into_boxed_slice();
        system[0xa10..0xa1c].copy_from_slice(b"\x11\x22\x33fivebar-1");
        let size: u16 = match options.defect {
            Some(Defect::HalfFlash) => 512,
            _ => 1024,
        };
        system[0xa22..0xa24].copy_from_slice(&size.to_le_bytes());
        let figures = Figures::new(&image);
        let idle = IdleLoop {
            anchor: trace::planner(&image),
            ..IdleLoop::default()
        };
        let cpu = Box::new(Cpu {
            engine: Engine::open()?,
            mcu: Mcu::new(options, sectors, wiring),
            code: image.code.clone().into_boxed_slice(),
            image,
            ccm: vec![0x5a; 64 * 1024].into_boxed_slice(),
            system,
            block: 0,
            block_size: 0,
            stop: None,
            limit: 0,
            deadline: 0,
            waiting: false,
            locked_up: false,
            resets: Vec::new(),
            figures,
            stack_left: None,
            idle,
            trace: None,
            accesses: Accesses::default(),
            tick: tick_of(options.drives),
        });
        let cpu = NonNull::from(Box::leak(cpu));
        let mut chip = Self { cpu };
        chip.connect()?;
        chip.cpu_mut().start(ResetCause::Power);
        Ok(chip)
    }

    fn connect(&mut self) -> Result<(), EmulatorError> {
        let data = self.cpu.as_ptr().cast::<c_void>();
        let cpu = self.cpu_mut();
        cpu.engine.map(CODE, &mut cpu.code, READ | EXECUTE)?;
        cpu.engine.map(CCM, &mut cpu.ccm, READ | WRITE)?;
        cpu.engine.map(SYSTEM, &mut cpu.system, READ)?;
        cpu.engine
            .map(RAM, &mut cpu.mcu.ram, READ | WRITE | EXECUTE)?;
        let engine = &mut cpu.engine;
        engine.map_registers(
            0x4000_0000,
            0x8_0000,
            read_at::<0x4000_0000>,
            write_at::<0x4000_0000>,
            data,
        )?;
        engine.map_registers(
            0x4200_0000,
            0x200_0000,
            read_at::<0x4200_0000>,
            write_at::<0x4200_0000>,
            data,
        )?;
        engine.map_registers(
            0xe000_0000,
            0x10_0000,
            read_at::<0xe000_0000>,
            write_at::<0xe000_0000>,
            data,
        )?;
        engine.map_registers(flash::START, flash::SIZE, read_sectors, write_sectors, data)?;
        engine.on_block(on_block, data)?;
        engine.on_interrupt(on_interrupt, data)?;
        engine.on_invalid_memory(on_invalid_memory, data)?;
        engine.on_invalid_instruction(on_invalid_instruction, data)
    }

    pub(crate) fn cpu(&self) -> &Cpu {
        // SAFETY: it lives as long as the chip; no callback runs meanwhile.
        unsafe { self.cpu.as_ref() }
    }

    pub(crate) fn cpu_mut(&mut self) -> &mut Cpu {
        // SAFETY: as above.
        unsafe { self.cpu.as_mut() }
    }

    /// Time since power-up.
    pub fn now(&self) -> Time {
        self.cpu().mcu.now
    }

    /// Runs for this long.
    ///
    /// # Errors
    /// The first violation.
    pub fn run(&mut self, time: Time) -> Result<(), Report> {
        self.run_until(self.now() + time)
    }

    /// Runs until this time, or at most a block of code longer.
    ///
    /// # Errors
    /// The first violation.
    pub fn run_until(&mut self, limit: Time) -> Result<(), Report> {
        while self.step(limit)? {}
        Ok(())
    }

    /// Runs to the core's next stop; false at the end.
    fn step(&mut self, limit: Time) -> Result<bool, Report> {
        let cpu = self.cpu_mut();
        cpu.mcu.run_events();
        if let Some(violation) = cpu.mcu.violation.take() {
            return Err(cpu.report(violation));
        }
        if let Some(cause) = cpu.mcu.reset {
            cpu.start(cause);
            return Ok(true);
        }
        if cpu.mcu.now >= limit {
            return Ok(false);
        }
        let stalled = cpu.mcu.stalled_until;
        let stands = cpu.locked_up || cpu.mcu.debug.is_halted();
        if stalled > cpu.mcu.now || stands {
            let until = if stands { limit } else { stalled.min(limit) };
            cpu.mcu.now = cpu.mcu.due.clamp(cpu.mcu.now, until);
            return Ok(true);
        }
        if std::mem::take(&mut cpu.mcu.bus_error) {
            cpu.fault();
            return Ok(true);
        }
        cpu.look_for_exceptions();
        if let Some(exception) = cpu.takeable() {
            cpu.enter(exception);
            return Ok(true);
        }
        cpu.limit = limit;
        cpu.stop = None;
        cpu.deadline = cpu.mcu.due.min(limit);
        let pc = cpu.engine.get(Reg::PC);
        let handle = cpu.engine.handle();
        let outcome = Engine::run(handle, pc);
        let cpu = self.cpu_mut();
        match (cpu.stop, outcome) {
            (Some(Stop::Return), _) => cpu.leave(),
            (Some(Stop::Fault), _) => cpu.fault(),
            (_, Ok(())) => {}
            (_, Err(error)) if cpu.mcu.violation.is_none() => {
                let violation = Violation {
                    register: format!("the emulator stops with error {}", error.0),
                    written: None,
                    rule: "unexpected".to_owned(),
                };
                return Err(cpu.report(violation));
            }
            (_, Err(_)) => {}
        }
        Ok(true)
    }

    pub(crate) fn mcu(&mut self) -> &mut Mcu {
        &mut self.cpu_mut().mcu
    }

    /// The host sends bytes on the serial line.
    pub fn send(&mut self, bytes: &[u8]) {
        let now = self.now();
        self.mcu().usart.send_to_chip(bytes, now);
        self.mcu().settle(now);
    }

    /// Takes the bytes that the host has received, so many at most.
    pub fn receive(&mut self, most: usize) -> Vec<u8> {
        let outgoing = &mut self.mcu().usart.outgoing;
        outgoing.drain(..most.min(outgoing.len())).collect()
    }

    /// Levels outside have changed: the pins follow at once.
    pub fn pins_changed(&mut self) {
        let now = self.now();
        self.mcu().settle(now);
    }

    /// The crystal stops.
    pub fn crystal_fails(&mut self) {
        self.mcu().run_events();
        self.mcu().crystal_fails();
    }

    /// What the program would read from a register.
    ///
    /// # Errors
    /// A register that must not be read.
    pub fn register(&mut self, address: u32) -> Access<u32> {
        self.mcu().read(address, 4)
    }

    /// The supply of the chip falls to this voltage [V], and rises again if the brown-out
    /// reset acts.
    pub fn supply_falls(&mut self, volts: f64) {
        let level = [2.7, 2.4, 2.1, 0.0][self.mcu().flash.brown_out_level() as usize];
        if volts < 1.7 {
            self.reset(ResetCause::Power);
        } else if volts < level {
            self.reset(ResetCause::BrownOut);
        } else if volts < 2.7 {
            let mcu = self.mcu();
            let rule = "five wait states at 168 MHz need 2.7 V";
            if mcu.core < 8_000_000 {
                mcu.note::<()>(refuse("the supply", (1000.0 * volts) as u32, rule));
            }
        }
    }

    /// Which of the manual's readings of the repetition counter holds.
    pub fn read_repetitions(&mut self, reading: RepetitionReading) {
        self.mcu().tim1.reading = reading;
    }

    /// Protects the flash's sectors of these bits, and no others, from being written.
    pub fn protect_sectors(&mut self, sectors: u32) {
        self.mcu().flash.protect(sectors);
    }

    /// The flash takes the longest time that its data sheet gives for an erase.
    pub fn slow_flash(&mut self) {
        self.mcu().flash.slow_down();
    }

    /// Notes from now on what the program does between its control ticks.
    pub fn trace(&mut self) {
        let cpu = self.cpu_mut();
        cpu.trace = Some(Trace::new(&cpu.image));
    }

    /// What the program has done since [`Chip::trace`], each step with the number of control ticks
    /// that had begun before it.
    pub fn steps(&self) -> &[(usize, Step)] {
        self.cpu().trace.as_ref().map_or(&[], Trace::steps)
    }

    /// What the program did to the settings' sectors.
    pub fn flash_events(&mut self) -> Vec<FlashEvent> {
        std::mem::take(&mut self.mcu().flash.events)
    }

    /// Whether the flash keeps the core waiting.
    pub fn is_stalled(&self) -> bool {
        let mcu = &self.cpu().mcu;
        mcu.stalled_until > mcu.now && mcu.stalled_until != NEVER
    }

    /// When the timer of the ticks last began one, with steppers or drives on a bus.
    pub fn tick_began(&mut self) -> Time {
        self.mcu().ticks.began()
    }

    /// The most accesses to registers over APB1 and over APB2 in the interrupt of a tick.
    pub fn most_accesses_in_a_tick(&self) -> [u32; 2] {
        self.cpu().accesses.most()
    }

    /// What CAN1's program has met on the bus.
    pub fn can_statistics(&mut self) -> CanStatistics {
        self.mcu().can.statistics
    }

    /// TIM1's counter when it last triggered the converters.
    pub fn counter_at_last_trigger(&mut self) -> Option<u32> {
        self.mcu().triggered_at.map(|(counter, _)| counter)
    }

    /// Least and greatest time from TIM1's trigger to that of the encoders' counts which the program reads,
    /// since the last call.
    pub fn latched_after(&mut self) -> Option<[Time; 2]> {
        self.mcu().latched_after.take()
    }

    /// Whether the watchdog has been started.
    pub fn watchdog_runs(&mut self) -> bool {
        self.mcu().iwdg.runs()
    }

    /// Resets the chip from outside.
    pub fn reset(&mut self, cause: ResetCause) {
        self.cpu_mut().start(cause);
    }

    /// The resets so far, the power-up included, with their times.
    pub fn resets(&self) -> &[(Time, ResetCause)] {
        &self.cpu().resets
    }

    /// Whether the core has locked up: a fault within the handler of a fault.
    pub fn is_locked_up(&self) -> bool {
        self.cpu().locked_up
    }

    /// The function that runs.
    pub fn function(&self) -> &str {
        let cpu = self.cpu();
        cpu.image.function(cpu.block).unwrap_or("?")
    }

    /// Reads a word of the RAM.
    pub fn ram_word(&self, address: u32) -> Option<u32> {
        let at = address.checked_sub(RAM)? as usize;
        let bytes = self.cpu().mcu.ram.get(at..at + 4)?;
        Some(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
    }

    /// Writes a word of the RAM, as a debug probe does.
    pub fn write_ram_word(&mut self, address: u32, word: u32) {
        let at = address.wrapping_sub(RAM) as usize;
        if let Some(bytes) = self.mcu().ram.get_mut(at..at + 4) {
            bytes.copy_from_slice(&word.to_le_bytes());
        }
    }

    /// The settings' sectors.
    pub fn settings(&self) -> &[u8] {
        &self.cpu().mcu.flash.sectors
    }
}

impl Drop for Chip {
    fn drop(&mut self) {
        let cpu = self.cpu_mut();
        cpu.figures.look_at_stack(&cpu.mcu.ram);
        // The figures are those of the image for brushed motors.
        if cpu.mcu.has_brushed_motors() {
            cpu.figures.store();
        }
        // SAFETY: it came from a box and is not used again.
        drop(unsafe { Box::from_raw(self.cpu.as_ptr()) });
    }
}
