//! Pins by their place in the table of boards: how they are set up, read and written.

use crate::drivers::boards::{Peripheral, Pin};
use core::convert::Infallible;
use embedded_hal::digital::{ErrorType, InputPin, OutputPin, PinState};
use stm32f4xx_hal::pac::{GPIOC, RCC, gpioc};

/// Bytes from the registers of one port to those of the next.
const PORT_SIZE: u32 = 0x400;
/// Port A's registers.
const PORT_A: u32 = 0x4002_0000;
/// The offset of BSRR.
const BSRR: u32 = 0x18;

/// The chip's own resistor at a pin, about 40 kΩ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resistor {
    /// None: the pin floats.
    None = 0,
    /// To 3.3 V.
    Up = 1,
    /// To ground.
    Down = 2,
}

/// The modes, as in MODER.
#[derive(Clone, Copy)]
enum Mode {
    Input = 0,
    Output = 1,
    Alternate = 2,
    Analog = 3,
}

/// An input, the pin of this code.
pub struct In<const PIN: u8>(());

/// An output, the pin of this code.
pub struct Out<const PIN: u8>(());

/// The address of the register that sets and resets this pin.
pub const fn set_reset(pin: Pin) -> u32 {
    PORT_A + PORT_SIZE * pin.port() as u32 + BSRR
}

/// The registers of a pin's port, which are the same for every port.
pub fn registers(pin: Pin) -> &'static gpioc::RegisterBlock {
    let offset = usize::from(pin.port()) * PORT_SIZE as usize;
    // SAFETY: the address is that of a port's registers. What is written to a register for one pin leaves the others.
    #[allow(unsafe_code)]
    unsafe {
        let first = PORT_A as *const u8;
        debug_assert!(first.add(2 * PORT_SIZE as usize).cast() == GPIOC::ptr());
        &*first.add(offset).cast()
    }
}

/// An input with this resistor.
pub fn input<const PIN: u8>(resistor: Resistor) -> In<PIN> {
    set_up(Pin(PIN), Mode::Input, resistor);
    In(())
}

/// An output that is at this level from the first moment on.
pub fn output<const PIN: u8>(high: bool) -> Out<PIN> {
    clock(Pin(PIN));
    let mut output = Out(());
    output.write(high);
    set_up(Pin(PIN), Mode::Output, Resistor::None);
    output
}

/// Gives a pin to a peripheral. The table of boards is checked: the pin has the signal.
pub fn connect(pin: Pin, peripheral: Peripheral, resistor: Resistor) {
    clock(pin);
    let (function, _) = peripheral.places();
    let (port, at) = (registers(pin), u32::from(pin.number() % 8) * 4);
    // SAFETY: any 4 bits are a function.
    #[allow(unsafe_code)]
    let put = |bits: u32| bits & !(0xf << at) | u32::from(function) << at;
    #[allow(unsafe_code)]
    unsafe {
        match pin.number() {
            ..8 => port.afrl().modify(|r, w| w.bits(put(r.bits()))),
            8.. => port.afrh().modify(|r, w| w.bits(put(r.bits()))),
        };
    }
    set_up(pin, Mode::Alternate, resistor);
}

/// Gives a pin to the converters.
pub fn analog(pin: Pin) {
    set_up(pin, Mode::Analog, Resistor::None);
}

/// Lets a peripheral drive a pin that was connected to it, or lets the pin float.
pub fn drive(pin: Pin, driven: bool) {
    set_mode(pin, if driven { Mode::Alternate } else { Mode::Input });
}

fn set_up(pin: Pin, mode: Mode, resistor: Resistor) {
    clock(pin);
    let at = u32::from(pin.number()) * 2;
    // SAFETY: the values are 0 to 2 of 2 bits.
    #[allow(unsafe_code)]
    registers(pin)
        .pupdr()
        .modify(|r, w| unsafe { w.bits(r.bits() & !(0b11 << at) | (resistor as u32) << at) });
    set_mode(pin, mode);
}

fn set_mode(pin: Pin, mode: Mode) {
    let at = u32::from(pin.number()) * 2;
    // SAFETY: any 2 bits are a mode.
    #[allow(unsafe_code)]
    registers(pin)
        .moder()
        .modify(|r, w| unsafe { w.bits(r.bits() & !(0b11 << at) | (mode as u32) << at) });
}

/// Gives a pin's port its clock.
fn clock(pin: Pin) {
    // SAFETY: only at the start, before any other code changes this register.
    #[allow(unsafe_code)]
    unsafe {
        let enables = (*RCC::ptr()).ahb1enr();
        enables.modify(|r, w| w.bits(r.bits() | 1 << pin.port()));
        // The clock runs two cycles of the bus later.
        let _ = enables.read();
    }
}

impl<const PIN: u8> ErrorType for In<PIN> {
    type Error = Infallible;
}

impl<const PIN: u8> InputPin for In<PIN> {
    #[inline(always)]
    fn is_high(&mut self) -> Result<bool, Infallible> {
        let pin = Pin(PIN);
        Ok(registers(pin).idr().read().bits() & 1 << pin.number() != 0)
    }

    #[inline(always)]
    fn is_low(&mut self) -> Result<bool, Infallible> {
        self.is_high().map(|high| !high)
    }
}

impl<const PIN: u8> Out<PIN> {
    /// Sets the level.
    #[inline(always)]
    pub fn write(&mut self, high: bool) {
        let pin = Pin(PIN);
        let bit = 1 << pin.number() << if high { 0 } else { 16 };
        // SAFETY: zeros leave the other pins.
        #[allow(unsafe_code)]
        registers(pin).bsrr().write(|w| unsafe { w.bits(bit) });
    }
}

impl<const PIN: u8> ErrorType for Out<PIN> {
    type Error = Infallible;
}

impl<const PIN: u8> OutputPin for Out<PIN> {
    #[inline(always)]
    fn set_high(&mut self) -> Result<(), Infallible> {
        self.write(true);
        Ok(())
    }

    #[inline(always)]
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.write(false);
        Ok(())
    }

    #[inline(always)]
    fn set_state(&mut self, state: PinState) -> Result<(), Infallible> {
        self.write(state == PinState::High);
        Ok(())
    }
}
