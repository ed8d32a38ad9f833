//! The blocks of the chip that the image uses, and the pins of the board.

use crate::arm::{self, Arm};
use crate::flags;
use crate::pins::{BRAKE, PULSES, STOP, WIRED, Wires};
use crate::uart::Uart;
use crate::usb::Usb;
use crate::usb_host::UsbHost;
use crate::watchdog::Watchdog;
use picoem_common::pio::PioBlock;
use std::collections::HashMap;

const UNCLOCKED: &str = "a block in reset is accessed";
const UNKNOWN: &str = "no such register";

/// Bits of RESETS.
const IO: u32 = 1 << 6;
const PADS: u32 = 1 << 9;
const PIO: u32 = 1 << 11;
const PLL: u32 = 1 << 14;
const PWM: u32 = 1 << 16;
const UART: u32 = 1 << 26;
const USB: u32 = 1 << 28;
const PLL_USB: u32 = 1 << 15;
const ALL: u32 = 0x1fff_ffff;
/// Functions of pins.
const BY_SIO: u32 = 5;
const BY_PIO: u32 = 6;
/// The isolation, the input and the pull-up of a pad.
const ISOLATED: u32 = 1 << 8;
const READS: u32 = 1 << 6;
const PULL_UP: u32 = 1 << 3;
/// Registers of PIO: which machines run, which buffers are empty or full, and where the first state machine is.
const CTRL: u32 = 0;
const FSTAT: u32 = 4;
const FIRST_ADDRESS: u32 = 0xd4;
/// The two machines that wait for numbers.
const BOTH: u32 = 0b11;

/// Registers of blocks whose behaviour is that they keep what is written, and the bits that they hold after a reset.
const STORED: [(u32, u32); 6] = [
    (0x4001_8000, 0),
    (0x4002_8000, IO),
    (0x4003_8000, PADS),
    (0x4005_0000, PLL),
    (0x4005_8000, PLL_USB),
    (0x400a_8000, PWM),
];

/// Pins that are modelled.
const PINS: u32 = 15;

/// Bits of the pins that are connected to a block, and of those that a resistor pulls up.
#[derive(Default)]
struct Connections {
    to_sio: u32,
    to_pio: u32,
    pulled_up: u32,
    reads: u32,
}

pub(crate) struct Blocks {
    /// Bits of the blocks that are in reset.
    resets: u32,
    stored: HashMap<u32, u32>,
    pins: Connections,
    pub(crate) uart: Uart,
    usb: Usb,
    pub(crate) usb_host: UsbHost,
    pub(crate) watchdog: Watchdog,
    pub(crate) pio: PioBlock,
    /// Whether a state machine may do something.
    pub(crate) pio_runs: bool,
    output: u32,
    enable: u32,
    pub(crate) wires: Wires,
    pub(crate) arm: Option<Box<dyn Arm>>,
    /// Cycles since the arm has advanced.
    since_arm: u64,
    /// Pins whose rising edge is kept.
    risen: u32,
    /// The crystal does not swing.
    pub(crate) crystal_is_dead: bool,
    /// POWMAN_CHIP_RESET.
    pub(crate) chip_reset: u32,
}

impl Default for Blocks {
    fn default() -> Self {
        Self {
            resets: ALL,
            stored: HashMap::new(),
            pins: Connections::default(),
            uart: Uart::default(),
            usb: Usb::default(),
            usb_host: UsbHost::default(),
            watchdog: Watchdog::default(),
            pio: PioBlock::new(),
            pio_runs: false,
            output: 0,
            enable: 0,
            wires: Wires::default(),
            arm: None,
            since_arm: 0,
            risen: 0,
            crystal_is_dead: false,
            // Power came on.
            chip_reset: 1 << 16,
        }
    }
}

impl Blocks {
    /// As after a reset of the chip: what is wired to it stays, and what the watchdog keeps.
    pub(crate) fn reset(&mut self) {
        let wires = std::mem::take(&mut self.wires);
        let arm = self.arm.take();
        let mut usb_host = std::mem::take(&mut self.usb_host);
        usb_host.lose_device();
        let mut watchdog = std::mem::take(&mut self.watchdog);
        watchdog.reset();
        *self = Self {
            wires,
            arm,
            usb_host,
            watchdog,
            ..Self::default()
        };
    }

    fn needs(&self, bit: u32) -> Result<(), &'static str> {
        if self.resets & bit == 0 {
            Ok(())
        } else {
            Err(UNCLOCKED)
        }
    }

    /// The USB controller, which needs its clock and its reset taken away.
    fn usb(&mut self) -> Result<&mut Usb, &'static str> {
        self.needs(USB | PLL_USB)?;
        // 48 MHz: 12 MHz times 100, over 5 and 5, and handed on.
        let stored = |address: u32| self.stored.get(&address).copied().unwrap_or(0);
        let divided = stored(0x4005_800c) >> 12 == 0x55;
        if !divided || stored(0x4001_0060) != 1 << 11 {
            return Err(UNCLOCKED);
        }
        Ok(&mut self.usb)
    }

    /// The bytes of the USB controller's memory at an address.
    pub(crate) fn usb_memory(
        &mut self,
        address: u32,
        size: usize,
    ) -> Result<&mut [u8], &'static str> {
        let at = (address & 0xffff) as usize;
        self.usb()?.bytes(at, size).ok_or(UNKNOWN)
    }

    /// Whether the USB controller takes a word at an address of its memory.
    pub(crate) fn usb_takes(&self, address: u32, word: u32) -> bool {
        self.usb.may_write((address & 0xfff) as usize, word)
    }

    /// Lets the USB host go on; true while the controller's interrupt is raised.
    pub(crate) fn advance_usb(&mut self, cycles: u64) -> bool {
        if self.resets & USB != 0 {
            return false;
        }
        self.usb_host.advance(&mut self.usb, cycles);
        self.usb.interrupts()
    }

    pub(crate) fn read(&mut self, address: u32) -> Result<u32, &'static str> {
        let (block, offset) = (address & 0xffff_c000, address & 0xfff);
        if let Some((_, bit)) = STORED.iter().find(|(base, _)| *base == block) {
            self.needs(*bit)?;
        }
        let stored = |address: u32| self.stored.get(&address).copied();
        Ok(match (block, offset) {
            (0x4002_0000, 0) => self.resets,
            (0x4002_0000, 8) => !self.resets & ALL,
            // The glitch-free multiplexers follow at once.
            (0x4001_0000, 0x38) => 1 << (stored(block + 0x30).unwrap_or(0) & 3),
            (0x4001_0000, 0x44) => 1 << (stored(block + 0x3c).unwrap_or(0) & 1),
            (0x4001_0000, ..0x90) => stored(block + offset).unwrap_or(0),
            // The crystal is stable once it is enabled.
            (0x4004_8000, 4) => {
                let swings = stored(block) == Some(0x00fa_baa0) && !self.crystal_is_dead;
                u32::from(swings) << 31
            }
            (0x4004_8000, ..0x14) => stored(block + offset).unwrap_or(0),
            (0x4005_0000, 0) => self.pll_status(block, 125),
            (0x4005_8000, 0) => self.pll_status(block, 100),
            (0x4005_0000 | 0x4005_8000, 4) => stored(block + 4).unwrap_or(0x2d),
            (0x4002_8000, 0x230..0x248) => {
                let first = (offset - 0x230) / 4 * 8;
                let bits = |pin: u32| (self.risen >> (first + pin) & 1) << (4 * pin + 3);
                (0..8).map(bits).sum()
            }
            (0x4003_8000, _) => stored(block + offset).unwrap_or(0x116),
            (0x4001_8000 | 0x4002_8000 | 0x4005_0000 | 0x4005_8000 | 0x400a_8000, _) => {
                stored(block + offset).unwrap_or(0)
            }
            (0x4007_0000, _) => {
                self.needs(UART)?;
                self.uart.read(offset).ok_or(UNKNOWN)?
            }
            (0x400d_8000, _) => self.watchdog.read(offset).ok_or(UNKNOWN)?,
            (0x4010_0000, 0x2c) => self.chip_reset,
            (0x4010_8000, 0x30) => self.watchdog.tick[0],
            (0x4010_8000, 0x34) => self.watchdog.tick[1],
            (0x5011_0000, _) => self.usb()?.read(offset).ok_or(UNKNOWN)?,
            (0x5020_0000, _) => {
                self.needs(PIO)?;
                self.pio.read32(offset)
            }
            (0xd000_0000, 0x04) => self.inputs(),
            (0xd000_0000, 0x10) => self.output,
            (0xd000_0000, 0x30) => self.enable,
            _ => return Err(UNKNOWN),
        })
    }

    /// A PLL locks with its multiplier and the power for it.
    fn pll_status(&self, block: u32, multiplier: u32) -> u32 {
        let stored = |offset: u32| self.stored.get(&(block + offset)).copied();
        let locks = stored(0) == Some(1)
            && stored(8) == Some(multiplier)
            && stored(4).is_some_and(|power| power & 0x21 == 0);
        stored(0).unwrap_or(1) | u32::from(locks) << 31
    }

    pub(crate) fn write(&mut self, address: u32, value: u32) -> Result<(), &'static str> {
        if address >> 28 == 0xd {
            return self.write_sio(address & 0xfff, value);
        }
        let (block, offset) = (address & 0xffff_c000, address & 0xfff);
        let alias = address >> 12 & 3;
        let value = match alias {
            0 => value,
            _ if block == 0x5020_0000 => value,
            _ => {
                let old = self.read(block + offset)?;
                [value, old ^ value, old | value, old & !value][alias as usize]
            }
        };
        match (block, offset) {
            (0x4002_0000, 0) => {
                if value & !self.resets & PIO != 0 {
                    self.pio.reset();
                }
                self.resets = value & ALL;
            }
            (0x4002_8000, 0x230..0x248) => {
                let first = (offset - 0x230) / 4 * 8;
                for pin in (0..8).filter(|pin| value >> (4 * pin + 3) & 1 != 0) {
                    self.risen &= !(1 << (first + pin));
                }
            }
            (0x4001_0000, ..0x90) | (0x4004_8000, ..0x14) => {
                self.stored.insert(block + offset, value);
            }
            (
                0x4001_8000 | 0x4002_8000 | 0x4003_8000 | 0x4005_0000 | 0x4005_8000 | 0x400a_8000,
                _,
            ) => {
                if let Some((_, bit)) = STORED.iter().find(|(base, _)| *base == block) {
                    self.needs(*bit)?;
                }
                self.stored.insert(block + offset, value);
            }
            (0x4007_0000, _) => {
                self.needs(UART)?;
                self.uart.write(offset, value).ok_or(UNKNOWN)?;
            }
            (0x400d_8000, _) => self.watchdog.write(offset, value).ok_or(UNKNOWN)?,
            (0x5011_0000, _) => self.usb()?.write(offset, value).ok_or(UNKNOWN)?,
            (0x4010_8000, 0x30) => self.watchdog.tick[0] = value & 1,
            (0x4010_8000, 0x34) => self.watchdog.tick[1] = value,
            (0x5020_0000, _) => {
                self.needs(PIO)?;
                self.pio.write32(offset, value, alias);
                self.pio_runs = true;
            }
            _ => return Err(UNKNOWN),
        }
        if matches!(block, 0x4002_0000 | 0x4002_8000 | 0x4003_8000) {
            self.connect();
        }
        Ok(())
    }

    fn write_sio(&mut self, offset: u32, value: u32) -> Result<(), &'static str> {
        match offset {
            0x18 => self.output |= value,
            0x20 => self.output &= !value,
            0x38 => self.enable |= value,
            0x40 => self.enable &= !value,
            _ => return Err(UNKNOWN),
        }
        Ok(())
    }

    /// Finds anew which pins are connected to what.
    fn connect(&mut self) {
        let stored = |address: u32, reset: u32| self.stored.get(&address).copied().unwrap_or(reset);
        let mut pins = Connections::default();
        if self.resets & (IO | PADS) == 0 {
            for pin in 0..PINS {
                let pad = stored(0x4003_8004 + 4 * pin, 0x116);
                if pad & ISOLATED != 0 {
                    continue;
                }
                let bit = 1 << pin;
                match stored(0x4002_8004 + 8 * pin, 0x1f) & 0x1f {
                    BY_SIO => pins.to_sio |= bit,
                    BY_PIO if self.resets & PIO == 0 => pins.to_pio |= bit,
                    _ => {}
                }
                if pad & PULL_UP != 0 {
                    pins.pulled_up |= bit;
                }
                if pad & READS != 0 {
                    pins.reads |= bit;
                }
            }
        }
        self.pins = pins;
    }

    /// The levels of all pins: of what drives them, of what is wired to them, or of their resistors.
    pub(crate) fn levels(&self) -> u32 {
        let by_pio = self.pins.to_pio & self.pio.pad_oe;
        let by_sio = self.pins.to_sio & self.enable;
        let others = self.pins.pulled_up & !WIRED | self.wires.wired();
        self.pio.pad_out & by_pio | self.output & by_sio | others & !(by_pio | by_sio)
    }

    /// What the chip sees of them.
    fn inputs(&self) -> u32 {
        self.levels() & self.pins.reads
    }

    /// Presses or releases the emergency stop.
    pub(crate) fn press_stop(&mut self, pressed: bool) {
        if pressed && !self.wires.stop {
            self.risen |= 1 << STOP;
        }
        self.wires.stop = pressed;
    }

    /// Whether the brake is released.
    pub(crate) fn brake_is_released(&self) -> bool {
        self.levels() >> BRAKE & 1 != 0
    }

    /// Lets the state machines run for some cycles, from `now` on, and the arm.
    pub(crate) fn advance(&mut self, now: u64, cycles: u64) {
        self.run_pio(now, cycles);
        self.since_arm += cycles;
        while self.since_arm >= arm::PERIOD {
            self.since_arm -= arm::PERIOD;
            let released = self.brake_is_released();
            if let Some(arm) = &mut self.arm {
                arm.advance(&mut self.wires, released);
            }
        }
    }

    fn run_pio(&mut self, now: u64, cycles: u64) {
        let mut levels = self.levels();
        self.wires.drive(now, levels);
        if self.resets & PIO != 0 || !self.pio_runs {
            return;
        }
        for cycle in 0..cycles {
            flags::step(&mut self.pio, levels & self.pins.reads);
            levels = self.levels();
            self.wires.drive(now + cycle + 1, levels);
        }
        // Both wait at their first instruction for a number, both pins are low, and there is no other machine.
        let empty = self.pio.read32(FSTAT) >> 24;
        let waits = |pio: &mut PioBlock, machine: u32| {
            empty >> machine & 1 != 0 && pio.read32(FIRST_ADDRESS + 0x18 * machine) == 0
        };
        let levels = self.levels();
        let low = PULSES.iter().all(|pin| levels >> pin & 1 == 0);
        let alone = self.pio.read32(CTRL) & 0xf & !BOTH == 0;
        let waiting = alone && (0..2).all(|machine| waits(&mut self.pio, machine));
        self.pio_runs = !(low && waiting);
    }
}
