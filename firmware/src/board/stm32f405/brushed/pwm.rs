//! TIM1: four PWM channels for two bridges, the break input, and the trigger of the tick.
//!
//! The break input (emergency stop, wired so that a broken wire trips it) and the clock
//! security system force all four outputs low within nanoseconds, without the processor.
//! They stay low until [`PwmTimer::power`] is called again.

use super::pins::PINS;
use crate::board::stm32f405::gpio::registers;
use core::convert::Infallible;
use embedded_hal::pwm::{ErrorType, SetDutyCycle};
use stm32f4xx_hal::pac::{RCC, TIM1};
use stm32f4xx_hal::rcc::{Enable, Reset};

/// Half a PWM period in TIM1's clock: 168 MHz / (2 · 4200) = 20 kHz.
const HALF_PERIOD: u16 = 4200;
/// Half periods from one tick to the next, less one: two PWM periods make 10 kHz.
const HALF_PERIODS_PER_TICK: u8 = 3;
/// Cycles of the core from one tick to the next.
pub const TICK_CYCLES: u32 = 16_800;
/// So many ticks after the start are checked for their place in the period.
const TICKS_TO_CHECK: u8 = 8;
/// The flags of the timer's status register.
const FLAGS: u32 = 0x1eff;
/// The bridges' sleep inputs, in one port: low is asleep, outputs floating.
pub const SLEEP_PINS: u32 = 1 << PINS.sleep[0].number() | 1 << PINS.sleep[1].number();
/// Their modes in MODER, two bits each; zeros: inputs.
const SLEEP_MODES: u32 = 3 << (2 * PINS.sleep[0].number()) | 3 << (2 * PINS.sleep[1].number());

/// Switches both bridges off by two register writes, from any context and in any state: for the
/// handlers of panics and faults, which own no peripheral and end in a reset.
#[allow(unsafe_code)]
pub fn unpower() {
    // SAFETY: both writes only switch off, and the callers do not return to code that would
    // switch on again.
    unsafe {
        (*TIM1::ptr()).bdtr().modify(|_, w| w.moe().clear_bit());
        registers(PINS.sleep[0])
            .bsrr()
            .write(|w| w.bits(SLEEP_PINS << 16));
    }
}

/// Switches both bridges off until the next reset, for a handler that returns.
///
/// A tick that it interrupts goes on to apply its command, which may wake the bridges up. So their sleep inputs are no
/// outputs of the chip any more, and no tick makes them that; the bridges' pull-downs keep them low. The timer's outputs
/// may be connected until the next tick: to bridges that are asleep.
pub fn unpower_until_reset() {
    unpower();
    // SAFETY: nothing else writes the register after the start, which calls this again at its end.
    #[allow(unsafe_code)]
    unsafe {
        registers(PINS.sleep[0])
            .moder()
            .modify(|modes, w| w.bits(modes.bits() & !SLEEP_MODES));
    }
}

/// Lets the timer run: PWM at 20 kHz, the converter and so the tick at 10 kHz. Called once, when
/// interrupts are enabled: the first tick then begins in time.
pub fn start() {
    // SAFETY: after its setup, nothing else writes this register.
    #[allow(unsafe_code)]
    unsafe {
        (*TIM1::ptr()).cr1().modify(|_, w| w.cen().enabled());
    }
}

/// The timer: its main output enable and its break flag.
pub struct PwmTimer {
    timer: TIM1,
    powered: bool,
    /// Ticks whose place in the period is still to be checked.
    ticks_to_check: u8,
}

/// Channel `N` + 1 of the timer.
pub struct Channel<const N: usize>(());

impl PwmTimer {
    /// Programs the timer with all outputs low, and hands out its channels.
    pub fn new(
        timer: TIM1,
        rcc: &mut RCC,
    ) -> (Self, (Channel<0>, Channel<1>, Channel<2>, Channel<3>)) {
        TIM1::enable(rcc);
        TIM1::reset(rcc);
        // The repetition counter takes its value at an update only. So it is loaded, with the
        // preload registers, by an update here; the counter then starts upwards from zero with
        // all its half periods to go, and every later update comes at the bottom. The mode is
        // set while the counter is stopped, and before the update can start the converter.
        timer.arr().write(|w| w.arr().set(HALF_PERIOD));
        timer.rcr().write(|w| w.rep().set(HALF_PERIODS_PER_TICK));
        timer
            .cr1()
            .write(|w| w.cms().center_aligned1().arpe().enabled());
        timer.egr().write(|w| w.ug().update());
        timer.ccmr1_output().write(|w| {
            w.oc1m().pwm_mode1().oc1pe().enabled();
            w.oc2m().pwm_mode1().oc2pe().enabled()
        });
        timer.ccmr2_output().write(|w| {
            w.oc3m().pwm_mode1().oc3pe().enabled();
            w.oc4m().pwm_mode1().oc4pe().enabled()
        });
        timer.ccer().write(|w| {
            w.cc1e().set_bit().cc2e().set_bit();
            w.cc3e().set_bit().cc4e().set_bit()
        });
        // Idle states low; the update event starts the converter.
        timer.cr2().write(|w| {
            w.ois1()
                .reset()
                .ois2()
                .reset()
                .ois3()
                .reset()
                .ois4()
                .reset();
            w.mms().update()
        });
        // Break on a high level, idle states driven, no return by itself; then locked.
        timer.bdtr().write(|w| {
            w.bke().enabled().bkp().active_high().aoe().manual();
            w.ossi().idle_level().ossr().idle_level();
            w.lock().level1()
        });
        timer.dier().write(|w| w.bie().set_bit());
        let timer = Self {
            timer,
            powered: false,
            ticks_to_check: TICKS_TO_CHECK,
        };
        (timer, (Channel(()), Channel(()), Channel(()), Channel(())))
    }

    /// Whether the converter is triggered at the wrong end of the period, in the drive pulse.
    /// Called at the beginning of every tick; it looks in the first few.
    ///
    /// The counter counts up for 25 µs from an update at the bottom, down from one at the top.
    /// A tick of the first few begins about 4 µs after its update.
    #[inline]
    pub fn triggers_in_drive_pulse(&mut self) -> bool {
        if self.ticks_to_check == 0 {
            return false;
        }
        self.ticks_to_check -= 1;
        self.timer.cr1().read().dir().is_down()
    }

    /// Cycles since the timer last started the converters, read at the beginning of a tick: up to half
    /// a period, from where the counter counts down.
    #[inline]
    pub fn since_trigger(&self) -> u32 {
        self.timer.cnt().read().bits()
    }

    /// Connects the outputs when `on` turns true, disconnects them when it is false.
    ///
    /// Outputs that the break input has disconnected stay disconnected while `on` stays true.
    #[inline]
    pub fn power(&mut self, on: bool) {
        if on != self.powered {
            self.timer.bdtr().modify(|_, w| w.moe().bit(on));
            self.powered = on;
        }
    }

    /// Takes the break interrupt: true if the break input tripped.
    ///
    /// The flag cannot be cleared while the input is active, so the interrupt is disabled
    /// here: otherwise it would repeat for ever, above the tick.
    /// [`PwmTimer::rearm_break`] enables it again.
    pub fn take_break() -> bool {
        // SAFETY: nothing else changes the enable while it is set, see `rearm_break`.
        #[allow(unsafe_code)]
        let timer = unsafe { &*TIM1::ptr() };
        let tripped = timer.sr().read().bif().bit_is_set();
        timer.dier().modify(|_, w| w.bie().clear_bit());
        tripped
    }

    /// Enables the break interrupt again, once the input is released. Called in every tick.
    #[inline]
    pub fn rearm_break(&mut self) {
        if self.timer.dier().read().bie().bit_is_set() {
            return;
        }
        // SAFETY: a flag is cleared by writing 0 to it; writing 1 leaves the others.
        #[allow(unsafe_code)]
        self.timer
            .sr()
            .write(|w| unsafe { w.bits(FLAGS) }.bif().clear_bit());
        if self.timer.sr().read().bif().bit_is_clear() {
            self.timer.dier().modify(|_, w| w.bie().set_bit());
        }
    }
}

impl<const N: usize> ErrorType for Channel<N> {
    type Error = Infallible;
}

impl<const N: usize> SetDutyCycle for Channel<N> {
    fn max_duty_cycle(&self) -> u16 {
        HALF_PERIOD
    }

    #[inline]
    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        // SAFETY: channel N's compare register is written through this value alone.
        #[allow(unsafe_code)]
        let timer = unsafe { &*TIM1::ptr() };
        // Only a compare value beyond the counter's top keeps the output high all the time.
        let compare = if duty < HALF_PERIOD {
            duty
        } else {
            HALF_PERIOD + 1
        };
        timer.ccr(N).write(|w| w.ccr().set(compare));
        Ok(())
    }
}
