//! UART0 at 1 Mbaud. The chip holds 32 bytes each way.
//!
//! An interrupt takes what has come when half of that is full or the line is quiet for 32 bits. A frame is handed to the
//! chip by the idle task, as much in each round as there is room: no byte is waited for.

use super::clocks::CORE;
use super::resets;
use crate::protocol::{Frame, MAX_FRAME};
use heapless::Deque;
use rp235x_pac::{RESETS, UART0};

/// Symbols per second.
const BAUD: u32 = 1_000_000;
/// Sixty-fourths of a sixteenth of a symbol: 9 and 24/64.
const DIVIDER: u32 = CORE * 4 / BAUD;
/// Bytes that the chip holds.
const HELD: usize = 32;
/// Two of the longest frames.
const ROOM: usize = 2 * MAX_FRAME;

/// The receiving half, for the interrupt.
pub struct Receiver(());

/// Bytes on their way to the chip.
pub type Waiting = Deque<u8, ROOM>;

/// The sending half.
pub struct Sender {
    waiting: &'static mut Waiting,
}

/// Sets the line up.
pub fn new(uart: &UART0, waiting: &'static mut Waiting, resets: &RESETS) -> (Receiver, Sender) {
    resets::reset(resets, resets::UART0);
    // SAFETY: 16 and 6 bits of the divider, and the codes of 8 bits and of half full.
    #[allow(unsafe_code)]
    unsafe {
        uart.uartibrd().write(|w| w.bits(DIVIDER >> 6));
        uart.uartfbrd().write(|w| w.bits(DIVIDER & 0x3f));
        uart.uartlcr_h()
            .write(|w| w.wlen().bits(0b11).fen().set_bit());
        uart.uartifls().write(|w| w.rxiflsel().bits(0b010));
    }
    uart.uartimsc()
        .write(|w| w.rxim().set_bit().rtim().set_bit());
    uart.uartcr()
        .write(|w| w.uarten().set_bit().txe().set_bit().rxe().set_bit());
    (Receiver(()), Sender { waiting })
}

impl Receiver {
    /// Hands over the bytes that have come. For the interrupt, which that clears; what comes meanwhile raises it again.
    pub fn drain(&mut self, mut byte: impl FnMut(u8)) {
        // SAFETY: nothing else reads the data register.
        #[allow(unsafe_code)]
        let uart = unsafe { &*UART0::ptr() };
        for _ in 0..HELD {
            if uart.uartfr().read().rxfe().bit_is_set() {
                break;
            }
            byte(uart.uartdr().read().data().bits());
        }
    }
}

impl Sender {
    /// Takes a frame; drops it if those before have not been sent. The host then asks again.
    pub fn send(&mut self, frame: &Frame) {
        if self.waiting.capacity() - self.waiting.len() < frame.len() {
            return;
        }
        for &byte in frame {
            let _ = self.waiting.push_back(byte);
        }
        self.advance();
    }

    /// Hands the chip as many bytes as it has room for. Called in each round of the idle task.
    pub fn advance(&mut self) {
        // SAFETY: nothing else writes the data register.
        #[allow(unsafe_code)]
        let uart = unsafe { &*UART0::ptr() };
        while uart.uartfr().read().txff().bit_is_clear()
            && let Some(byte) = self.waiting.pop_front()
        {
            // SAFETY: any 8 bits are a byte.
            #[allow(unsafe_code)]
            uart.uartdr().write(|w| unsafe { w.data().bits(byte) });
        }
    }
}
