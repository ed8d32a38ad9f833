//! The function of each pin of a Pico 2. `docs/use/wiring.md` has the same table.

use super::resets;
use core::convert::Infallible;
use embedded_hal::digital::{ErrorType, InputPin};
use rp235x_pac::io_bank0::gpio::gpio_ctrl::FUNCSEL_A;
use rp235x_pac::{IO_BANK0, PADS_BANK0, RESETS, SIO};

/// The serial line: out, in.
pub const SERIAL: [usize; 2] = [0, 1];
/// The pulses of the servos of joints 1 and 4.
pub const SERVO: [usize; 2] = [2, 3];
/// The tool: channel A of slice 2.
pub const TOOL: usize = 4;
/// The emergency stop: high is pressed.
pub const STOP: usize = 5;
/// Releases the brake when high.
pub const BRAKE: usize = 6;

/// The chip's own resistor at a pin, about 60 kΩ.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Resistor {
    Up,
    Down,
}

/// The emergency stop's pin, which also the state machines of the pulses read.
pub struct Stop(());

/// The brake's transistor.
pub struct Brake(());

/// Gives each pin its function. The brake is engaged.
pub fn set_up(io: &IO_BANK0, pads: &PADS_BANK0, resets: &RESETS) -> (Stop, Brake) {
    resets::release(resets, resets::IO_BANK0 | resets::PADS_BANK0);
    let mut brake = Brake(());
    brake.write(false);
    // SAFETY: single bits of registers that set and clear nothing else.
    #[allow(unsafe_code)]
    unsafe {
        let sio = &*SIO::ptr();
        sio.gpio_oe_set().write(|w| w.bits(1 << BRAKE));
        sio.gpio_oe_clr().write(|w| w.bits(1 << STOP));
    }
    let connect = |pin: usize, function: FUNCSEL_A, resistor: Resistor| {
        let up = resistor == Resistor::Up;
        pads.gpio(pin).write(|w| {
            w.ie().set_bit().od().clear_bit();
            w.pue().bit(up).pde().bit(!up).schmitt().set_bit()
        });
        io.gpio(pin)
            .gpio_ctrl()
            .write(|w| w.funcsel().variant(function));
        // Isolated from power-up on, and only then connected.
        pads.gpio(pin).modify(|_, w| w.iso().clear_bit());
    };
    let [out, input] = SERIAL;
    connect(out, FUNCSEL_A::UART, Resistor::Up);
    connect(input, FUNCSEL_A::UART, Resistor::Up);
    for pin in SERVO {
        connect(pin, FUNCSEL_A::PIO0, Resistor::Down);
    }
    connect(TOOL, FUNCSEL_A::NULL, Resistor::Down);
    connect(STOP, FUNCSEL_A::SIO, Resistor::Up);
    connect(BRAKE, FUNCSEL_A::SIO, Resistor::Down);
    (Stop(()), brake)
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

impl Stop {
    /// Whether the pin has risen since the last call: a press that was over before the tick.
    #[inline]
    pub fn was_pressed(&mut self) -> bool {
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
}

impl ErrorType for Stop {
    type Error = Infallible;
}

impl InputPin for Stop {
    #[inline]
    fn is_high(&mut self) -> Result<bool, Infallible> {
        // SAFETY: the register is only read.
        #[allow(unsafe_code)]
        let levels = unsafe { (*SIO::ptr()).gpio_in().read().bits() };
        Ok(levels & 1 << STOP != 0)
    }

    #[inline]
    fn is_low(&mut self) -> Result<bool, Infallible> {
        self.is_high().map(|high| !high)
    }
}

impl Brake {
    /// Releases the brake, or lets it engage.
    #[inline]
    pub fn write(&mut self, released: bool) {
        // SAFETY: single bits of registers that set and clear nothing else.
        #[allow(unsafe_code)]
        unsafe {
            let sio = &*SIO::ptr();
            if released {
                sio.gpio_out_set().write(|w| w.bits(1 << BRAKE));
            } else {
                sio.gpio_out_clr().write(|w| w.bits(1 << BRAKE));
            }
        }
    }
}
