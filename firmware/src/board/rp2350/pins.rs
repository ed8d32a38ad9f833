//! The function of each pin of a Pico 2 in every image. `docs/use/wiring.md` has the same table.

use super::resets;
use core::convert::Infallible;
use embedded_hal::digital::{ErrorType, InputPin, OutputPin, PinState};
use rp235x_pac::io_bank0::gpio::gpio_ctrl::FUNCSEL_A;
use rp235x_pac::{IO_BANK0, PADS_BANK0, RESETS, SIO};

/// The serial line: out, in.
pub const SERIAL: [usize; 2] = [0, 1];
/// The pulses of the servos, or the steps, of joints 1 and 4.
pub const PULSES: [usize; 2] = [2, 3];
/// The tool: channel A of slice 2.
pub const TOOL: usize = 4;
/// The emergency stop: high is pressed.
pub const STOP: usize = 5;
/// Releases the brake when high.
pub const BRAKE: usize = 6;

/// What a pad is for, with the chip's own resistor of about 60 kΩ.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Pad {
    /// Reads; the resistor pulls it up.
    In,
    /// Drives alone: with its input on, a floating pad can stay at 2.2 V (erratum RP2350-E9). The resistor pulls it up.
    OutUp,
    /// The same; the resistor pulls it down.
    OutDown,
}

/// The registers of the pins.
pub struct Pins<'a> {
    io: &'a IO_BANK0,
    pads: &'a PADS_BANK0,
}

/// An input of the core.
pub struct In<const PIN: usize>(());

/// An output of the core.
pub struct Out<const PIN: usize>(());

/// The emergency stop's pin, which also the state machines of the pulses read.
pub type Stop = In<STOP>;

/// The brake's transistor: high releases it.
pub type Brake = Out<BRAKE>;

/// Gives the common pins their functions. The brake is engaged, and the pulses' pins are not driven.
pub fn set_up(pins: &Pins<'_>) -> Brake {
    let [out, input] = SERIAL;
    pins.connect(out, FUNCSEL_A::UART, Pad::OutUp);
    pins.connect(input, FUNCSEL_A::UART, Pad::In);
    for pin in PULSES {
        pins.connect(pin, FUNCSEL_A::PIO0, Pad::OutDown);
    }
    pins.connect(TOOL, FUNCSEL_A::NULL, Pad::OutDown);
    pins.output(false)
}

impl<'a> Pins<'a> {
    /// Pins whose blocks are out of reset.
    pub fn new(io: &'a IO_BANK0, pads: &'a PADS_BANK0, resets: &RESETS) -> Self {
        resets::release(resets, resets::IO_BANK0 | resets::PADS_BANK0);
        Self { io, pads }
    }

    fn connect(&self, pin: usize, function: FUNCSEL_A, pad: Pad) {
        let down = pad == Pad::OutDown;
        self.pads.gpio(pin).write(|w| {
            w.ie().bit(pad == Pad::In).od().clear_bit();
            w.pue().bit(!down).pde().bit(down).schmitt().set_bit()
        });
        self.io
            .gpio(pin)
            .gpio_ctrl()
            .write(|w| w.funcsel().variant(function));
        // Isolated from power-up on, and only then connected.
        self.pads.gpio(pin).modify(|_, w| w.iso().clear_bit());
    }

    /// An input of the core with a pull-up.
    pub fn input<const PIN: usize>(&self) -> In<PIN> {
        // SAFETY: a single bit of a register that clears nothing else.
        #[allow(unsafe_code)]
        unsafe {
            (*SIO::ptr()).gpio_oe_clr().write(|w| w.bits(1 << PIN));
        }
        self.connect(PIN, FUNCSEL_A::SIO, Pad::In);
        In(())
    }

    /// An output of the core with this level, and without a driver its resistor's.
    pub fn output<const PIN: usize>(&self, high: bool) -> Out<PIN> {
        let mut output = Out(());
        output.write(high);
        // SAFETY: a single bit of a register that sets nothing else.
        #[allow(unsafe_code)]
        unsafe {
            (*SIO::ptr()).gpio_oe_set().write(|w| w.bits(1 << PIN));
        }
        let pad = if high { Pad::OutUp } else { Pad::OutDown };
        self.connect(PIN, FUNCSEL_A::SIO, pad);
        output
    }
}

/// Lets PWM drive the tool's pin, or lets the pin float.
pub fn drive_tool(driven: bool) {
    let function = if driven {
        FUNCSEL_A::PWM
    } else {
        FUNCSEL_A::NULL
    };
    // SAFETY: nothing else writes the register of this pin after the start.
    #[allow(unsafe_code)]
    let io = unsafe { &*IO_BANK0::ptr() };
    io.gpio(TOOL)
        .gpio_ctrl()
        .write(|w| w.funcsel().variant(function));
}

/// Whether the emergency stop's pin has risen since the last call: a press that was over before the tick.
#[inline]
pub fn stop_was_pressed() -> bool {
    /// Four bits a pin, eight pins a register; the last of the four is the rising edge.
    const RISEN: u32 = 8 << (4 * (STOP % 8));
    // SAFETY: the flags are cleared by writing 1; nothing else uses them.
    #[allow(unsafe_code)]
    unsafe {
        let flags = (*IO_BANK0::ptr()).intr(STOP / 8);
        let risen = flags.read().bits() & RISEN != 0;
        if risen {
            flags.write(|w| w.bits(RISEN));
        }
        risen
    }
}

impl<const PIN: usize> ErrorType for In<PIN> {
    type Error = Infallible;
}

impl<const PIN: usize> InputPin for In<PIN> {
    #[inline]
    fn is_high(&mut self) -> Result<bool, Infallible> {
        // SAFETY: the register is only read.
        #[allow(unsafe_code)]
        let levels = unsafe { (*SIO::ptr()).gpio_in().read().bits() };
        Ok(levels & 1 << PIN != 0)
    }

    #[inline]
    fn is_low(&mut self) -> Result<bool, Infallible> {
        self.is_high().map(|high| !high)
    }
}

impl<const PIN: usize> Out<PIN> {
    /// Drives the pin.
    #[inline]
    pub fn write(&mut self, high: bool) {
        // SAFETY: single bits of registers that set and clear nothing else.
        #[allow(unsafe_code)]
        unsafe {
            let sio = &*SIO::ptr();
            if high {
                sio.gpio_out_set().write(|w| w.bits(1 << PIN));
            } else {
                sio.gpio_out_clr().write(|w| w.bits(1 << PIN));
            }
        }
    }
}

impl<const PIN: usize> ErrorType for Out<PIN> {
    type Error = Infallible;
}

impl<const PIN: usize> OutputPin for Out<PIN> {
    fn set_high(&mut self) -> Result<(), Infallible> {
        self.set_state(PinState::High)
    }

    fn set_low(&mut self) -> Result<(), Infallible> {
        self.set_state(PinState::Low)
    }

    #[inline]
    fn set_state(&mut self, state: PinState) -> Result<(), Infallible> {
        self.write(state == PinState::High);
        Ok(())
    }
}
