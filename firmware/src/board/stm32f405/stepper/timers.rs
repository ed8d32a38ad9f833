//! TIM4 counts the ticks; TIM1 and TIM8 make the pulses of joints 1 and 4.
//!
//! Each update of TIM4 starts TIM1 and TIM8 anew by their slave mode, at the same clock, and with that both take the top and the
//! compare value which the tick before has prepared. Within a tick they count period after period: their repetition
//! counters, always full, keep every other update away. So nothing but a trigger changes the pulses, and no interrupt is
//! needed from one to the next.
//!
//! The break inputs (the emergency stop on two pins, so wired that a broken wire trips both) and the clock security system
//! force both outputs low within nanoseconds, without the processor. They stay low until [`StepTimers::power`] is called
//! again.

use super::pins::PINS;
use crate::board::stm32f405::gpio::registers;
use crate::drivers::steps::{Pulses, TICK_CLOCKS};
use stm32f4xx_hal::pac::{RCC, TIM1, TIM4, TIM8, tim1};
use stm32f4xx_hal::rcc::{Enable, Reset};

/// Cycles of the core from one tick to the next.
pub const TICK_CYCLES: u32 = TICK_CLOCKS as u32;
/// Clocks of TIM4, at half the clock of the others, from one tick to the next.
const TICK_COUNTS: u16 = TICK_CLOCKS / 2;
/// TIM4 among the triggers of TIM1 and of TIM8.
const TIM4_OF_TIM1: u8 = 3;
const TIM4_OF_TIM8: u8 = 2;
/// More periods than a tick has.
const NO_REPETITION_ENDS: u8 = u8::MAX;
/// The channels of the pulses: 1 of TIM1, 3 of TIM8.
const CHANNEL1: usize = 0;
const CHANNEL4: usize = 2;
/// The flags of the status registers of TIM1 and TIM8, and of TIM4.
const FLAGS: u32 = 0x1eff;
const TICK_FLAGS: u32 = 0x1e5f;
/// The drivers' enables, in one port: high is without power.
pub const ENABLE_PINS: u32 = 1 << PINS.enable[0].number() | 1 << PINS.enable[1].number();
/// Their modes in MODER, two bits each; zeros: inputs.
const ENABLE_MODES: u32 = 3 << (2 * PINS.enable[0].number()) | 3 << (2 * PINS.enable[1].number());

/// Takes the power from both motors and stops the pulses by three register writes, from any context and in any state: for
/// the handlers of panics and faults, which own no peripheral and end in a reset.
#[allow(unsafe_code)]
pub fn unpower() {
    // SAFETY: the writes only switch off, and the callers do not return to code that would switch on again.
    unsafe {
        registers(PINS.enable[0])
            .bsrr()
            .write(|w| w.bits(ENABLE_PINS));
        (*TIM1::ptr()).bdtr().modify(|_, w| w.moe().clear_bit());
        (*TIM8::ptr()).bdtr().modify(|_, w| w.moe().clear_bit());
    }
}

/// Takes the power from both motors until the next reset, for a handler that returns.
///
/// A tick that it interrupts goes on to apply its command, which may give the motors power. So the drivers' enables are no
/// outputs of the chip any more, and no tick makes them that; the drivers' pull-ups keep them high. Pulses may go on
/// until the next tick: to drivers without power.
pub fn unpower_until_reset() {
    unpower();
    // SAFETY: nothing else writes the register after the start, which calls this again at its end.
    #[allow(unsafe_code)]
    unsafe {
        registers(PINS.enable[0])
            .moder()
            .modify(|modes, w| w.bits(modes.bits() & !ENABLE_MODES));
    }
}

/// Lets the ticks begin. Called once, when interrupts are enabled.
pub fn start() {
    // SAFETY: after its setup, nothing else writes this register.
    #[allow(unsafe_code)]
    unsafe {
        (*TIM4::ptr()).cr1().modify(|_, w| w.cen().enabled());
    }
}

/// Cycles since the update that raised the tick's interrupt.
#[inline]
pub fn since_tick() -> u32 {
    // SAFETY: the counter is only read.
    #[allow(unsafe_code)]
    let count = unsafe { (*TIM4::ptr()).cnt().read().bits() };
    2 * count
}

/// Takes the interrupt's flag of the tick.
#[inline]
pub fn take_tick() {
    // SAFETY: a flag is cleared by writing 0 to it; nothing else writes the register.
    #[allow(unsafe_code)]
    unsafe {
        (*TIM4::ptr())
            .sr()
            .write(|w| w.bits(TICK_FLAGS).uif().clear_bit());
    }
}

/// Both timers of the pulses.
pub struct StepTimers {
    timer1: TIM1,
    timer4: TIM8,
    powered: bool,
    /// A break input is active still.
    held: bool,
}

impl StepTimers {
    /// Programs the timers: no pulses, outputs low, and no ticks yet.
    pub fn new(timer1: TIM1, timer4: TIM8, ticks: &TIM4, rcc: &mut RCC) -> Self {
        TIM1::enable(rcc);
        TIM1::reset(rcc);
        TIM8::enable(rcc);
        TIM8::reset(rcc);
        TIM4::enable(rcc);
        TIM4::reset(rcc);
        ticks.arr().write(|w| w.arr().set(TICK_COUNTS - 1));
        ticks.cr2().write(|w| w.mms().update());
        ticks.dier().write(|w| w.uie().enabled());
        timer1
            .ccmr1_output()
            .write(|w| w.oc1m().pwm_mode2().oc1pe().enabled());
        timer1.ccer().write(|w| w.cc1e().set_bit());
        set_up(&timer1, CHANNEL1, TIM4_OF_TIM1);
        timer4
            .ccmr2_output()
            .write(|w| w.oc3m().pwm_mode2().oc3pe().enabled());
        timer4.ccer().write(|w| w.cc3e().set_bit());
        set_up(&timer4, CHANNEL4, TIM4_OF_TIM8);
        Self {
            timer1,
            timer4,
            powered: false,
            held: false,
        }
    }

    /// Whether each timer has taken what was prepared last, or still repeats what it had before.
    #[inline]
    pub fn taken(&self) -> [bool; 2] {
        [&*self.timer1, &*self.timer4].map(|timer| timer.sr().read().uif().bit_is_set())
    }

    /// Prepares the pulses of the next tick. While a timer's values are written it takes none of them: a tick that begins
    /// meanwhile repeats its last one, and never mixes both.
    #[inline]
    pub fn prepare(&mut self, pulses: [Pulses; 2]) {
        let timers: [(&tim1::RegisterBlock, usize); 2] =
            [(&self.timer1, CHANNEL1), (&self.timer4, CHANNEL4)];
        for ((timer, channel), pulses) in timers.into_iter().zip(pulses) {
            timer.cr1().modify(|_, w| w.udis().set_bit());
            // SAFETY: a flag is cleared by writing 0 to it; writing 1 leaves the others.
            #[allow(unsafe_code)]
            timer
                .sr()
                .write(|w| unsafe { w.bits(FLAGS) }.uif().clear_bit());
            timer.arr().write(|w| w.arr().set(pulses.top));
            timer.ccr(channel).write(|w| w.ccr().set(pulses.compare));
            timer.cr1().modify(|_, w| w.udis().clear_bit());
        }
    }

    /// Connects the outputs when `on` turns true, disconnects them when it is false.
    ///
    /// Outputs that a break input has disconnected stay disconnected while `on` stays true.
    #[inline]
    pub fn power(&mut self, on: bool) {
        if on != self.powered {
            self.timer1.bdtr().modify(|_, w| w.moe().bit(on));
            self.timer4.bdtr().modify(|_, w| w.moe().bit(on));
            self.powered = on;
        }
    }

    /// Whether a break input was active at the end of the tick before. That of motor 4 is read by nothing else: with its
    /// wire off, motor 1 would step alone.
    #[inline]
    pub fn is_held(&self) -> bool {
        self.held
    }

    /// Enables the break interrupts again, once the inputs are released. Called in every tick.
    #[inline]
    pub fn rearm_break(&mut self) {
        self.held = false;
        for timer in [&*self.timer1, &*self.timer4] {
            if timer.dier().read().bie().bit_is_set() {
                continue;
            }
            // SAFETY: a flag is cleared by writing 0 to it; writing 1 leaves the others.
            #[allow(unsafe_code)]
            timer
                .sr()
                .write(|w| unsafe { w.bits(FLAGS) }.bif().clear_bit());
            if timer.sr().read().bif().bit_is_clear() {
                timer.dier().modify(|_, w| w.bie().set_bit());
            } else {
                self.held = true;
            }
        }
    }
}

/// Takes the break interrupt of motor 1's timer: true if its break input tripped.
///
/// The flag cannot be cleared while the input is active, so the interrupt is disabled here: otherwise it would repeat for
/// ever, above the tick. [`StepTimers::rearm_break`] enables it again.
pub fn take_break1() -> bool {
    // SAFETY: nothing else changes the enable while it is set, see `rearm_break`.
    #[allow(unsafe_code)]
    take_break(unsafe { &*TIM1::ptr() })
}

/// The same of motor 4's timer.
pub fn take_break4() -> bool {
    // SAFETY: as above.
    #[allow(unsafe_code)]
    take_break(unsafe { &*TIM8::ptr() })
}

fn take_break(timer: &tim1::RegisterBlock) -> bool {
    let tripped = timer.sr().read().bif().bit_is_set();
    timer.dier().modify(|_, w| w.bie().clear_bit());
    tripped
}

/// No pulses, the slave mode, and the break; then the counter runs, and its output is off.
fn set_up(timer: &tim1::RegisterBlock, channel: usize, trigger: u8) {
    let Pulses { top, compare } = Pulses::NONE;
    timer.arr().write(|w| w.arr().set(top));
    timer.ccr(channel).write(|w| w.ccr().set(compare));
    timer.rcr().write(|w| w.rep().set(NO_REPETITION_ENDS));
    // SAFETY: the number of a trigger.
    #[allow(unsafe_code)]
    timer.smcr().write(|w| unsafe { w.ts().bits(trigger) });
    timer.smcr().modify(|_, w| w.sms().reset_mode());
    // Break on a high level, idle states driven low, no return by itself; then locked.
    timer.bdtr().write(|w| {
        w.bke().enabled().bkp().active_high().aoe().manual();
        w.ossi().idle_level().ossr().idle_level();
        w.lock().level1()
    });
    timer.dier().write(|w| w.bie().set_bit());
    timer.cr1().write(|w| w.arpe().enabled().cen().enabled());
}
