//! CAN1, the chip's bxCAN, at 1 Mbit/s: its registers.
//!
//! A bit has 14 quanta of APB1's clock over 3:
//!
//! ```text
//! 42 MHz / 3 = 14 MHz;   14 MHz / (1 + 11 + 2) = 1 Mbit/s;   sample point (1 + 11)/14 = 85.7 %
//! ```
//!
//! With a jump of 2 quanta, both ends' clocks may be off by 2/(2 · (13 · 14 − 2)) = 0.55 %, which a crystal keeps by far and
//! the internal oscillator does not: without the crystal the chip stays off the bus.
//!
//! Frames leave in the order in which they were put into the mailboxes. After a bus off the chip returns by itself when it has
//! seen 128 times 11 recessive bits, 1.4 ms at least: longer than a tick, so a tick sees it and the fault is latched.
//! A FIFO that overruns keeps the newest frames; what is lost is an answer that does not come.

use crate::drives::can::{CanController, Frame, Payload};
use stm32f4xx_hal::pac::{CAN1, RCC, can1};
use stm32f4xx_hal::rcc::{Enable, Reset};

/// How often the flag of the initialisation mode is looked at. The bus is idle, so the mode begins within a few bits.
const TIMEOUT_READS: u32 = 10_000;
/// CAN1 in RCC's registers of APB1.
const CAN1_BIT: u32 = 1 << 25;

// MCR: initialisation, the order of the mailboxes, the return after a bus off; a debugger that halts the core halts it, too.
const INITIALISE: u32 = 1;
const IN_ORDER: u32 = 1 << 2;
const RETURN_BY_ITSELF: u32 = 1 << 6;
const HALT_WITH_CORE: u32 = 1 << 16;
const RUNNING: u32 = HALT_WITH_CORE | RETURN_BY_ITSELF | IN_ORDER;
/// MSR: in initialisation, and asleep.
const NOT_ON_BUS: u32 = 0b11;
/// ESR: off the bus.
const BUS_OFF: u32 = 1 << 2;
/// BTR: the jump, the second and the first segment, and the prescaler, each less one.
const TIMING: u32 = (2 - 1) << 24 | (2 - 1) << 20 | (11 - 1) << 16 | (3 - 1);
/// IER: a mailbox has become free.
const MAILBOX_FREE: u32 = 1;
// TSR, of the three mailboxes: done, abort, free.
const DONE: u32 = 1 | 1 << 8 | 1 << 16;
const ABORT: u32 = 1 << 7 | 1 << 15 | 1 << 23;
const FREE: [u32; 3] = [1 << 26, 1 << 27, 1 << 28];
// TIR and RIR: a request to send, a frame without data; the identifier's place.
const SEND: u32 = 1;
const REMOTE: u32 = 1 << 1;
const IDENTIFIER: u32 = 21;
/// TDTR and RDTR: the length.
const LENGTH: u32 = 0xf;
const EIGHT_BYTES: u32 = 8;
// RFR: frames in the FIFO, and the release of the oldest.
const HELD: u32 = 0b11;
const RELEASE: u32 = 1 << 5;
/// FMR: the filters are set up, with the chip's second controller's filters from 14 on, as after a reset.
const FILTERS_CLOSED: u32 = 0x2a1c_0e01;
const FILTERS_OPEN: u32 = 0x2a1c_0e00;

/// The controller. The other functions here are for handlers that own no peripheral.
pub struct BxCan(CAN1);

/// A frame as a mailbox holds it: TIR, TDTR, TDLR and TDHR.
pub type Words = [u32; 4];

/// A frame's words, with the request to send.
#[inline]
pub fn words(frame: &Frame) -> Words {
    let id = u32::from(frame.id) << IDENTIFIER | SEND;
    match frame.data {
        Some([a, b, c, d, e, f, g, h]) => [
            id,
            EIGHT_BYTES,
            u32::from_le_bytes([a, b, c, d]),
            u32::from_le_bytes([e, f, g, h]),
        ],
        None => [id | REMOTE, EIGHT_BYTES, 0, 0],
    }
}

/// Data with zeros behind those of a frame of this length.
#[inline]
fn filled_up(low: u32, high: u32, length: u32) -> Payload {
    let data = u64::from(high) << 32 | u64::from(low);
    let kept = match length {
        0 => 0,
        1..8 => u64::MAX >> (64 - 8 * length),
        _ => u64::MAX,
    };
    (data & kept).to_le_bytes()
}

impl BxCan {
    /// Programs the controller and lets it join the bus, which it does after 11 recessive bits; without a crystal it stays
    /// asleep. It takes no frames yet.
    pub fn new(can: CAN1, crystal_runs: bool, rcc: &mut RCC) -> Self {
        CAN1::enable(rcc);
        CAN1::reset(rcc);
        if crystal_runs && begins_initialisation(&can) {
            // SAFETY: the values are those of the tables above.
            #[allow(unsafe_code)]
            unsafe {
                can.btr().write(|w| w.bits(TIMING));
                can.ier().write(|w| w.bits(MAILBOX_FREE));
                can.mcr().write(|w| w.bits(RUNNING));
            }
        }
        Self(can)
    }

    /// Takes frames with data and these identifiers, two in each FIFO, and no others.
    // SAFETY: the registers of the filters are written while these are closed.
    #[allow(unsafe_code)]
    pub fn accept(&mut self, answers: [[u16; 2]; 2]) {
        let can = &self.0;
        unsafe {
            can.fmr().write(|w| w.bits(FILTERS_CLOSED));
            can.fa1r().write(|w| w.bits(0));
            // Both are lists of identifiers of 16 bits; the second one fills the second FIFO.
            can.fm1r().write(|w| w.bits(0b11));
            can.fs1r().write(|w| w.bits(0));
            can.ffa1r().write(|w| w.bits(0b10));
            for (bank, ids) in [0, 1].into_iter().zip(answers) {
                let [one, other] = ids.map(|id| u32::from(id) << 5);
                let pair = other << 16 | one;
                can.fb(bank).fr1().write(|w| w.bits(pair));
                can.fb(bank).fr2().write(|w| w.bits(pair));
            }
            can.fa1r().write(|w| w.bits(0b11));
            can.fmr().write(|w| w.bits(FILTERS_OPEN));
        }
    }

    /// Takes the interrupt of a mailbox that has become free.
    #[inline]
    pub fn take_done(&mut self) {
        // SAFETY: a flag is cleared by writing 1 to it; zeros leave the others.
        #[allow(unsafe_code)]
        self.0.tsr().write(|w| unsafe { w.bits(DONE) });
    }

    /// The oldest frame of this FIFO.
    #[inline]
    fn take_from(&mut self, fifo: usize) -> Option<Frame> {
        let can = &self.0;
        let state = can.rfr(fifo).read().bits();
        // A release that goes on has not counted its frame out yet.
        if state & HELD == 0 || state & RELEASE != 0 {
            return None;
        }
        let mailbox = can.rx(fifo);
        let (id, length) = (mailbox.rir().read().bits(), mailbox.rdtr().read().bits());
        let (low, high) = (mailbox.rdlr().read().bits(), mailbox.rdhr().read().bits());
        // SAFETY: the bit releases the frame that was read.
        #[allow(unsafe_code)]
        can.rfr(fifo).write(|w| unsafe { w.bits(RELEASE) });
        let has_data = id & REMOTE == 0;
        Some(Frame {
            id: (id >> IDENTIFIER) as u16,
            data: has_data.then(|| filled_up(low, high, length & LENGTH)),
        })
    }
}

impl CanController for BxCan {
    #[inline]
    fn take(&mut self) -> Option<Frame> {
        self.take_from(0).or_else(|| self.take_from(1))
    }

    #[inline]
    fn put(&mut self, frame: &Frame) -> bool {
        put(&self.0, words(frame))
    }

    #[inline]
    fn abort(&mut self) {
        abort(&self.0);
    }

    #[inline]
    fn is_off(&self) -> bool {
        let can = &self.0;
        can.esr().read().bits() & BUS_OFF != 0 || can.msr().read().bits() & NOT_ON_BUS != 0
    }
}

/// Leaves the bus, from any context: the clock is not that of the bit rate any more.
#[allow(unsafe_code)]
pub fn leave() {
    // SAFETY: nothing else changes this register after the start, and a reset only takes the controller off the bus: it is
    // asleep behind it.
    unsafe {
        let resets = (*RCC::ptr()).apb1rstr();
        resets.modify(|r, w| w.bits(r.bits() | CAN1_BIT));
        resets.modify(|r, w| w.bits(r.bits() & !CAN1_BIT));
    }
}

/// Takes the controller's registers, from any context.
///
/// # Safety
/// The caller does not return to code that has [`BxCan`].
#[allow(unsafe_code)]
pub unsafe fn registers() -> &'static can1::RegisterBlock {
    // SAFETY: the address is that of the registers.
    unsafe { &*CAN1::ptr() }
}

/// Puts a frame into a free mailbox.
#[inline]
pub fn put(can: &can1::RegisterBlock, [id, length, low, high]: Words) -> bool {
    let state = can.tsr().read().bits();
    let Some(free) = FREE.iter().position(|bit| state & bit != 0) else {
        return false;
    };
    let mailbox = can.tx(free);
    // SAFETY: the mailbox is free; the write that requests to send is the last one.
    #[allow(unsafe_code)]
    unsafe {
        mailbox.tdtr().write(|w| w.bits(length));
        mailbox.tdlr().write(|w| w.bits(low));
        mailbox.tdhr().write(|w| w.bits(high));
        mailbox.tir().write(|w| w.bits(id));
    }
    true
}

/// Takes back what waits for the bus.
#[inline]
pub fn abort(can: &can1::RegisterBlock) {
    // SAFETY: of a mailbox that is free the bit has no effect.
    #[allow(unsafe_code)]
    can.tsr().write(|w| unsafe { w.bits(ABORT) });
}

/// Whether all mailboxes are free.
pub fn is_empty(can: &can1::RegisterBlock) -> bool {
    let [one, two, three] = FREE;
    let all = one | two | three;
    can.tsr().read().bits() & all == all
}

/// Wakes the controller up into its initialisation mode; false if that takes too long.
fn begins_initialisation(can: &CAN1) -> bool {
    // SAFETY: asleep no longer, and in initialisation.
    #[allow(unsafe_code)]
    can.mcr()
        .write(|w| unsafe { w.bits(HALT_WITH_CORE | INITIALISE) });
    (0..TIMEOUT_READS).any(|_| can.msr().read().bits() & NOT_ON_BUS == INITIALISE)
}
