//! USART1 at 1 Mbaud: received by DMA into a ring, sent by DMA from a buffer.
//!
//! At 1 Mbaud a byte comes every 10 µs. An interrupt for each would sometimes wait too long for
//! the tick, so the DMA receives the bytes, and the interrupt comes when the line is idle. If the
//! DMA does not start (an emulator has none), an interrupt stores each byte in the same ring, and
//! bytes are sent by waiting for each.

use stm32f4xx_hal::pac::dma2::{RegisterBlock as DmaRegisters, ST};
use stm32f4xx_hal::pac::{DMA2, RCC, USART1};
use stm32f4xx_hal::rcc::{Enable, Reset};

use crate::protocol::{Frame, MAX_FRAME};

/// Symbols per second.
const BAUD: u32 = 1_000_000;
/// The receive ring: 5 ms of a line that is always busy.
pub const RING: usize = 512;
/// DMA2's streams and channel for USART1.
const RECEIVE_STREAM: usize = 2;
const SEND_STREAM: usize = 7;
const CHANNEL: u8 = 4;
/// How often a flag is read before a frame is dropped: at 3 cycles or more each, longer than the
/// 2.6 ms that the longest frame takes.
const TIMEOUT_READS: u32 = 150_000;

/// Memory that the DMA reads and writes; it must be `'static`.
pub struct Buffers {
    ring: [u8; RING],
    out: [u8; MAX_FRAME],
}

impl Buffers {
    /// Empty buffers.
    pub const fn new() -> Self {
        Self {
            ring: [0; RING],
            out: [0; MAX_FRAME],
        }
    }
}

impl Default for Buffers {
    fn default() -> Self {
        Self::new()
    }
}

/// The receiving half, for the interrupt.
pub struct Receiver {
    ring: *mut u8,
    /// Where the next byte is read.
    tail: usize,
    /// Where the next byte is written, when the interrupt writes it.
    head: usize,
    dma: bool,
}

/// The sending half.
pub struct Sender {
    out: &'static mut [u8; MAX_FRAME],
    dma: bool,
}

// SAFETY: the pointer is to a static ring that nothing else reads.
#[allow(unsafe_code)]
unsafe impl Send for Receiver {}

/// The divider of the baud rate with this clock of the second bus [Hz]. With 16 samples per bit
/// it counts sixteenths, so the register holds clock/baud.
const fn divider(bus: u32) -> u16 {
    ((bus + BAUD / 2) / BAUD) as u16
}

/// Keeps the baud rate when the second bus runs from the internal oscillator instead: for the
/// NMI, which owns nothing. The byte that is being sent is lost.
pub fn follow_internal_oscillator() {
    // SAFETY: any 16 bits are a divider, and nothing else writes it after the start.
    #[allow(unsafe_code)]
    unsafe {
        let bus = super::clocks::Source::Internal.second_bus();
        (*USART1::ptr()).brr().write(|w| w.bits(divider(bus)));
    }
}

/// Sets the line up; `bus` is the clock of the second bus [Hz].
pub fn new(
    usart: &USART1,
    dma: &DMA2,
    buffers: &'static mut Buffers,
    bus: u32,
    rcc: &mut RCC,
) -> (Receiver, Sender) {
    USART1::enable(rcc);
    USART1::reset(rcc);
    DMA2::enable(rcc);
    DMA2::reset(rcc);
    // SAFETY: any 16 bits are a divider.
    #[allow(unsafe_code)]
    usart.brr().write(|w| unsafe { w.bits(divider(bus)) });

    let Buffers { ring, out } = buffers;
    let ring = ring.as_mut_ptr();
    let dma_works = start_receiving(dma.st(RECEIVE_STREAM), ring);
    usart
        .cr3()
        .write(|w| w.dmar().bit(dma_works).dmat().bit(dma_works));
    usart.cr1().write(|w| {
        w.re().enabled().te().enabled();
        w.idleie().bit(dma_works).rxneie().bit(!dma_works);
        w.ue().enabled()
    });
    let receiver = Receiver {
        ring,
        tail: 0,
        head: 0,
        dma: dma_works,
    };
    let sender = Sender {
        out,
        dma: dma_works,
    };
    (receiver, sender)
}

/// Starts the DMA, which fills the ring again and again; false if it does not start.
fn start_receiving(stream: &ST, ring: *mut u8) -> bool {
    // SAFETY: the addresses are the data register and a static ring of RING bytes; the channel is 3 bits wide.
    #[allow(unsafe_code)]
    unsafe {
        stream
            .par()
            .write(|w| w.bits((*USART1::ptr()).dr().as_ptr() as u32));
        stream.m0ar().write(|w| w.bits(ring as u32));
        stream.ndtr().write(|w| w.ndt().bits(RING as u16));
        stream.cr().write(|w| {
            w.chsel().bits(CHANNEL);
            w.dir().peripheral_to_memory();
            w.minc()
                .incremented()
                .circ()
                .enabled()
                .pl()
                .high()
                .en()
                .enabled()
        });
    }
    stream.cr().read().en().is_enabled()
}

impl Receiver {
    /// Hands over the bytes received since the last call. For the interrupt, whose flags it
    /// clears.
    // A function of its own: the bounds of its loops are stated by its name.
    #[inline(never)]
    pub fn drain(&mut self, mut byte: impl FnMut(u8)) {
        // SAFETY: shared access to the registers; the ring is written by the DMA at the
        // head. If the program is slower than the line, the head passes the tail: frames are
        // then damaged, and their checksums show it.
        #[allow(unsafe_code)]
        unsafe {
            let usart = &*USART1::ptr();
            // Reading the status and then the data clears every flag.
            let status = usart.sr().read();
            if self.dma {
                if status.idle().bit_is_set() {
                    let _ = usart.dr().read();
                }
                let left =
                    usize::from((*DMA2::ptr()).st(RECEIVE_STREAM).ndtr().read().ndt().bits());
                self.head = (RING - left.min(RING)) % RING;
            } else if status.rxne().bit_is_set() {
                self.ring
                    .add(self.head)
                    .write_volatile(usart.dr().read().bits() as u8);
                self.head = (self.head + 1) % RING;
            }
            while self.tail != self.head {
                byte(self.ring.add(self.tail).read_volatile());
                self.tail = (self.tail + 1) % RING;
            }
        }
    }
}

impl Sender {
    /// Sends a frame. Waits, with a bound, until the frame before has been sent.
    pub fn send(&mut self, frame: &Frame) {
        // SAFETY: shared access to the registers; the buffer is not written while the
        // DMA reads it.
        #[allow(unsafe_code)]
        let (usart, dma) = unsafe { (&*USART1::ptr(), &*DMA2::ptr()) };
        if self.dma {
            self.send_by_dma(dma, frame);
            return;
        }
        for &byte in frame {
            if !within_patience(|| usart.sr().read().txe().bit_is_set()) {
                return;
            }
            usart.dr().write(|w| w.dr().set(u16::from(byte)));
        }
    }

    fn send_by_dma(&mut self, dma: &DmaRegisters, frame: &Frame) {
        let stream = dma.st(SEND_STREAM);
        // The longest frame takes 256 byte times.
        if !within_patience(|| stream.cr().read().en().is_disabled()) {
            return;
        }
        for (slot, &byte) in self.out.iter_mut().zip(frame) {
            *slot = byte;
        }
        dma.hifcr().write(|w| {
            w.ctcif7().clear().chtif7().clear();
            w.cteif7().clear().cdmeif7().clear().cfeif7().clear()
        });
        // SAFETY: as in `start_receiving`, the other way round; a frame's length is at
        // most MAX_FRAME.
        #[allow(unsafe_code)]
        unsafe {
            stream
                .par()
                .write(|w| w.bits((*USART1::ptr()).dr().as_ptr() as u32));
            stream.m0ar().write(|w| w.bits(self.out.as_ptr() as u32));
            stream.ndtr().write(|w| w.ndt().bits(frame.len() as u16));
            cortex_m::asm::dmb();
            stream.cr().write(|w| {
                w.chsel().bits(CHANNEL);
                w.dir().memory_to_peripheral();
                w.minc().incremented().en().enabled()
            });
        }
    }
}

fn within_patience(ready: impl Fn() -> bool) -> bool {
    (0..TIMEOUT_READS).any(|_| ready())
}
