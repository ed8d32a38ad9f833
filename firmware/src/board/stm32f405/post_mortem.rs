//! Why the chip started: the reset flags, and a note in RAM that the handlers of panics and hard
//! faults write.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;
use cortex_m::peripheral::DWT;
use stm32f4xx_hal::pac::RCC;

use crate::board::end_cause::EndCause;
use crate::protocol::Reset;

/// A note that survives a reset but not a loss of power: the start-up code leaves
/// `.uninit` alone.
#[repr(C)]
struct Note {
    /// One of the marks below, or whatever the RAM held at power-up.
    mark: UnsafeCell<MaybeUninit<u32>>,
    /// With `HUNG`: how long the program has hung [cycles].
    cycles: UnsafeCell<MaybeUninit<u32>>,
}

// SAFETY: it is read once at start-up and written by functions that never return.
#[allow(unsafe_code)]
unsafe impl Sync for Note {}

#[allow(unsafe_code)]
#[unsafe(link_section = ".uninit.post_mortem")]
static NOTE: Note = Note {
    mark: UnsafeCell::new(MaybeUninit::uninit()),
    cycles: UnsafeCell::new(MaybeUninit::uninit()),
};

/// Beside those of [`EndCause`]. RAM holds such a mark by chance once in 2³¹ power-ups, and only a software reset or one by
/// the watchdog reads them.
const HUNG: u32 = 0x4855_4e47;
const NOTHING: u32 = 0;

/// Writes the note and resets the chip. The caller switches the bridges off first.
pub fn reset_after(cause: EndCause) -> ! {
    write(cause.mark());
    cortex_m::asm::dsb();
    cortex_m::peripheral::SCB::sys_reset();
}

/// Hangs until the watchdog resets the chip, and notes how long that takes.
pub fn hang() -> ! {
    let began = DWT::cycle_count();
    write_to(&NOTE.cycles, 0);
    write(HUNG);
    loop {
        write_to(&NOTE.cycles, DWT::cycle_count().wrapping_sub(began));
    }
}

/// Why the chip started, and how long the program had hung in [`hang`] [cycles]. Clears the note and the
/// flags, so it must be called only once.
pub fn reset_reason(rcc: &RCC) -> (Reset, Option<u32>) {
    let note = read(&NOTE.mark);
    write(NOTHING);
    let flags = rcc.csr().read();
    let reason = if flags.wdgrstf().bit_is_set() || flags.wwdgrstf().bit_is_set() {
        Reset::Watchdog
    } else if flags.sftrstf().bit_is_set() {
        EndCause::reset(note)
    } else if flags.lpwrrstf().bit_is_set() {
        Reset::Unknown
    } else if flags.porrstf().bit_is_set() {
        // Power-up sets the flags of the brown-out and of the pin, too.
        Reset::Power
    } else if flags.borrstf().bit_is_set() {
        Reset::BrownOut
    } else if flags.padrstf().bit_is_set() {
        // Every reset sets this flag: the chip pulls its own pin.
        Reset::Pin
    } else {
        Reset::Unknown
    };
    rcc.csr().modify(|_, w| w.rmvf().set_bit());
    let hung = note == HUNG && reason == Reset::Watchdog;
    (reason, hung.then(|| read(&NOTE.cycles)))
}

fn read(word: &UnsafeCell<MaybeUninit<u32>>) -> u32 {
    // SAFETY: the word is valid whatever it holds; the volatile read hides from the compiler that
    // it is not initialised.
    #[allow(unsafe_code)]
    unsafe {
        word.get().cast::<u32>().read_volatile()
    }
}

fn write(mark: u32) {
    write_to(&NOTE.mark, mark);
}

fn write_to(word: &UnsafeCell<MaybeUninit<u32>>, value: u32) {
    // SAFETY: nothing else accesses the word meanwhile, see `Sync`.
    #[allow(unsafe_code)]
    unsafe {
        word.get().cast::<u32>().write_volatile(value);
    }
}
