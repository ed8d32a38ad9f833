//! RCC: oscillators, PLL, bus clocks, clock gates, reset flags.

use super::reset_cause::ResetCause;
use crate::register::Register;
use crate::time::{MICROSECOND, MILLISECOND, NEVER, Time, period};
use crate::violation::{Access, refuse};

/// Time that a healthy crystal needs to start.
const CRYSTAL_START: Time = 2 * MILLISECOND;
/// Time in which the PLL locks.
const PLL_LOCK: Time = 200 * MICROSECOND;
const LSI_START: Time = 40 * MICROSECOND;

/// The clocks of the chip.
#[derive(Clone, Debug)]
pub(crate) struct Rcc {
    cr: Register,
    pllcfgr: Register,
    cfgr: Register,
    cir: Register,
    /// RSTR and ENR registers of AHB1, AHB2, AHB3, APB1, APB2.
    rstr: [Register; 5],
    enr: [Register; 5],
    lpenr: [Register; 5],
    csr: Register,
    hse_ready_at: Time,
    pll_ready_at: Time,
    lsi_ready_at: Time,
    /// Frequencies of the crystal and of the internal oscillator [Hz].
    crystal: f64,
    hsi: f64,
    pub(crate) crystal_works: bool,
}

/// The clock of the core-coupled memory in AHB1's register.
const CCM: u32 = 1 << 20;
const AHB1: u32 = 0x7e74_11ff;
const AHB2: u32 = 0xf1;
const AHB3: u32 = 1;
const APB1: u32 = 0x36fe_c9ff;
const APB2: u32 = 0x0007_5f33;

impl Rcc {
    pub(crate) fn new(crystal: f64, hsi: f64) -> Self {
        let gates = |name: [&'static str; 5], reset: [u32; 5]| {
            let masks = [AHB1, AHB2, AHB3, APB1, APB2];
            std::array::from_fn(|i| Register::new(name[i], reset[i], masks[i] | reset[i], 0))
        };
        Self {
            cr: Register::new("RCC_CR", 0x83, 0x050d_00f9, 0x0a02_ff02),
            pllcfgr: Register::new("RCC_PLLCFGR", 0x2400_3010, 0x0f43_7fff, 0),
            cfgr: Register::new("RCC_CFGR", 0, 0xffff_fcf3, 0xc),
            cir: Register::new("RCC_CIR", 0, 0x3f00, 0x00bf_00bf),
            rstr: gates(
                [
                    "RCC_AHB1RSTR",
                    "RCC_AHB2RSTR",
                    "RCC_AHB3RSTR",
                    "RCC_APB1RSTR",
                    "RCC_APB2RSTR",
                ],
                [0; 5],
            ),
            enr: gates(
                [
                    "RCC_AHB1ENR",
                    "RCC_AHB2ENR",
                    "RCC_AHB3ENR",
                    "RCC_APB1ENR",
                    "RCC_APB2ENR",
                ],
                [0x0010_0000, 0, 0, 0, 0],
            ),
            lpenr: gates(
                [
                    "RCC_AHB1LPENR",
                    "RCC_AHB2LPENR",
                    "RCC_AHB3LPENR",
                    "RCC_APB1LPENR",
                    "RCC_APB2LPENR",
                ],
                [0x7e67_91ff, 0xf1, 1, 0x36fe_c9ff, 0x0007_5f33],
            ),
            csr: Register::new("RCC_CSR", 0, 1, 0xff00_0002),
            hse_ready_at: NEVER,
            pll_ready_at: NEVER,
            lsi_ready_at: NEVER,
            crystal,
            hsi,
            crystal_works: true,
        }
    }

    pub(crate) fn reset(&mut self, cause: ResetCause) {
        let flags = self.csr.value & 0xfe00_0000 | cause.flags();
        let works = self.crystal_works;
        *self = Self::new(self.crystal, self.hsi);
        self.crystal_works = works;
        self.csr.value = if cause == ResetCause::Power {
            cause.flags()
        } else {
            flags
        };
    }

    /// Period of the core's clock; none if it stands still.
    pub(crate) fn core_period(&self) -> Option<Time> {
        let divider = match self.cfgr.field(4, 4) {
            0..8 => 1,
            8 => 2,
            9 => 4,
            10 => 8,
            11 => 16,
            12 => 64,
            13 => 128,
            14 => 256,
            _ => 512,
        };
        let source = match self.cfgr.field(2, 2) {
            0 => self.hsi,
            1 => self.hse()?,
            _ => self.pll(1 + self.pllcfgr.field(16, 2))?,
        };
        Some(period(source) * divider)
    }

    /// Period of the crystal's clock divided as for the RTC; none without the crystal or a divider.
    pub(crate) fn divided_crystal(&self) -> Option<Time> {
        let divider = u64::from(self.cfgr.field(16, 5));
        let runs = self.cr.bit(17) && divider >= 2;
        self.hse()
            .filter(|_| runs)
            .map(|crystal| period(crystal) * divider)
    }

    fn hse(&self) -> Option<f64> {
        self.crystal_works.then_some(self.crystal)
    }

    /// The PLL's output behind the divider 2·`half`.
    fn pll(&self, half: u32) -> Option<f64> {
        let source = if self.pllcfgr.bit(22) {
            self.hse()?
        } else {
            self.hsi
        };
        let vco =
            source / f64::from(self.pllcfgr.field(0, 6)) * f64::from(self.pllcfgr.field(6, 9));
        Some(vco / f64::from(2 * half))
    }

    fn bus_divider(field: u32) -> u64 {
        match field {
            0..4 => 1,
            _ => 2 << (field - 4),
        }
    }

    /// Dividers of the first and second peripheral bus.
    fn buses(&self) -> [u64; 2] {
        [self.cfgr.field(10, 3), self.cfgr.field(13, 3)].map(Self::bus_divider)
    }

    /// Period of the bus APB1 (0) or APB2 (1), in core cycles.
    pub(crate) fn bus_cycles(&self, bus: usize) -> u64 {
        self.buses()[bus]
    }

    /// Period of the timers' clock on a bus, in core cycles.
    pub(crate) fn timer_cycles(&self, bus: usize) -> u64 {
        match self.buses()[bus] {
            1 => 1,
            divider => divider / 2,
        }
    }

    /// Whether the peripheral at this bit is clocked and out of reset; `bus` counts AHB1,
    /// AHB2, AHB3, APB1, APB2.
    pub(crate) fn is_clocked(&self, bus: usize, bit: u32) -> bool {
        self.enr[bus].bit(bit) && !self.rstr[bus].bit(bit)
    }

    /// Bits of a reset register that are set.
    pub(crate) fn in_reset(&self, bus: usize) -> u32 {
        self.rstr[bus].value
    }

    pub(crate) fn due(&self) -> Time {
        self.hse_ready_at
            .min(self.pll_ready_at)
            .min(self.lsi_ready_at)
    }

    /// Sets the ready flags that are due.
    pub(crate) fn advance(&mut self, now: Time) {
        if self.hse_ready_at <= now {
            self.hse_ready_at = NEVER;
            self.cr.set(17, true);
        }
        if self.pll_ready_at <= now {
            self.pll_ready_at = NEVER;
            self.cr.set(25, true);
        }
        if self.lsi_ready_at <= now {
            self.lsi_ready_at = NEVER;
            self.csr.set(1, true);
        }
        self.follow_switch();
    }

    fn follow_switch(&mut self) {
        let wanted = self.cfgr.field(0, 2);
        let ready = [1, 17, 25]
            .get(wanted as usize)
            .is_some_and(|&bit| self.cr.bit(bit));
        if ready {
            self.cfgr.value = self.cfgr.value & !0xc | wanted << 2;
        }
    }

    /// The crystal stops. True if the clock security system noticed: the NMI is raised.
    pub(crate) fn crystal_fails(&mut self) -> bool {
        self.crystal_works = false;
        self.hse_ready_at = NEVER;
        let noticed = self.cr.bit(19) && self.cr.bit(17);
        if noticed {
            self.cr.clear(1 << 16 | 1 << 17 | 1 << 19);
            if self.pllcfgr.bit(22) {
                self.cr.clear(1 << 24 | 1 << 25);
                self.pll_ready_at = NEVER;
            }
            self.cr.value |= 0b11;
            if self.cfgr.field(2, 2) != 0 {
                self.cfgr.clear(0xf);
            }
            self.cir.set(7, true);
        }
        noticed
    }

    /// Whether the clock security system's interrupt waits.
    pub(crate) fn nmi(&self) -> bool {
        self.cir.bit(7)
    }

    pub(crate) fn read(&self, offset: u32) -> u32 {
        match offset {
            0x00 => self.cr.value,
            0x04 => self.pllcfgr.value,
            0x08 => self.cfgr.value,
            0x0c => self.cir.value,
            _ => match self.gate(offset) {
                Some((0, bus)) => self.rstr[bus].value,
                Some((1, bus)) => self.enr[bus].value,
                Some((_, bus)) => self.lpenr[bus].value,
                None if offset == 0x74 => self.csr.value,
                None => 0,
            },
        }
    }

    /// Which of RSTR, ENR, LPENR an offset is, and of which bus.
    fn gate(&self, offset: u32) -> Option<(usize, usize)> {
        let kind = match offset {
            0x10..0x28 => 0,
            0x30..0x48 => 1,
            0x50..0x68 => 2,
            _ => return None,
        };
        let bus = match (offset - [0x10, 0x30, 0x50][kind]) / 4 {
            bus @ 0..=2 => bus,
            bus @ 4..=5 => bus - 1,
            _ => return None,
        };
        Some((kind, bus as usize))
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Time) -> Access<()> {
        match offset {
            0x00 => return self.write_cr(value, now),
            0x04 => {
                if self.cr.bit(24) {
                    return refuse("RCC_PLLCFGR", value, "the PLL runs");
                }
                self.pllcfgr.write(value)?;
            }
            0x08 => {
                self.cfgr.write(value)?;
                self.follow_switch();
            }
            0x0c => {
                self.cir.write(value)?;
                self.cir.clear(value >> 16 & 0xbf);
            }
            0x74 => {
                self.csr.write(value)?;
                if value >> 24 & 1 != 0 {
                    self.csr.clear(0xfe00_0000);
                }
                if self.csr.bit(0) && !self.csr.bit(1) {
                    self.lsi_ready_at = now + LSI_START;
                }
            }
            _ => match self.gate(offset) {
                Some((0, bus)) => self.rstr[bus].write(value)?,
                Some((1, 0)) if value & CCM == 0 => {
                    return refuse(
                        "RCC_AHB1ENR",
                        value,
                        "the core-coupled memory loses its clock",
                    );
                }
                Some((1, bus)) => self.enr[bus].write(value)?,
                Some((_, bus)) => self.lpenr[bus].write(value)?,
                None => return refuse("RCC", value, format!("no register at {offset:#x} here")),
            },
        }
        Ok(())
    }

    fn write_cr(&mut self, value: u32, now: Time) -> Access<()> {
        let before = self.cr;
        self.cr.write(value)?;
        let source = self.cfgr.field(2, 2);
        if source == 1 && !self.cr.bit(16) || source == 2 && !self.cr.bit(24) {
            return refuse("RCC_CR", value, "the clock in use is switched off");
        }
        self.cr.set(1, self.cr.bit(0));
        if !self.cr.bit(16) {
            self.cr.set(17, false);
            self.hse_ready_at = NEVER;
        } else if !before.bit(16) && self.crystal_works {
            self.hse_ready_at = now + CRYSTAL_START;
        }
        if !self.cr.bit(24) {
            self.cr.set(25, false);
            self.pll_ready_at = NEVER;
        } else if !before.bit(24) {
            self.check_pll(value)?;
            self.pll_ready_at = now + PLL_LOCK;
        }
        Ok(())
    }

    fn check_pll(&self, value: u32) -> Access<()> {
        let source = if self.pllcfgr.bit(22) {
            self.crystal
        } else {
            self.hsi
        };
        let input = source / f64::from(self.pllcfgr.field(0, 6)).max(1.0);
        let vco = input * f64::from(self.pllcfgr.field(6, 9));
        let rule = if self.pllcfgr.bit(22) && !self.cr.bit(17) {
            "the PLL starts before its crystal is ready"
        } else if !(0.95e6..=2.1e6).contains(&input) || self.pllcfgr.field(0, 6) < 2 {
            "the PLL's input is not 1 to 2 MHz"
        } else if !(100e6..=432e6).contains(&vco) {
            "the PLL's oscillator is not within 100 to 432 MHz"
        } else if vco / f64::from(self.pllcfgr.field(24, 4)) > 48.001e6 {
            "the PLL's 48 MHz output is above 48 MHz"
        } else {
            return Ok(());
        };
        refuse("RCC_CR", value, rule)
    }

    /// The rule that the clocks break with these flash wait states.
    pub(crate) fn check_limits(&self, wait_states: u32) -> Option<&'static str> {
        let period = self.core_period()?;
        let core = 1e15 / period as f64;
        let [first, second] = self.buses().map(|divider| core / divider as f64);
        if core > 168.1e6 {
            Some("the core's clock is above 168 MHz")
        } else if f64::from(wait_states + 1) * 30.05e6 < core {
            Some("the flash has too few wait states for this clock")
        } else if first > 42.1e6 {
            Some("the bus APB1 is above 42 MHz")
        } else if second > 84.1e6 {
            Some("the bus APB2 is above 84 MHz")
        } else {
            None
        }
    }
}
