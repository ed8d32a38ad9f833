//! Puts blocks of the chip into reset, and takes them out.

use rp235x_pac::RESETS;

/// The functions of the pins.
pub const IO_BANK0: u32 = 1 << 6;
/// Their pads.
pub const PADS_BANK0: u32 = 1 << 9;
/// The state machines of the pulses.
pub const PIO0: u32 = 1 << 11;
/// The core's PLL.
pub const PLL_SYS: u32 = 1 << 14;
/// The PLL of USB.
pub const PLL_USB: u32 = 1 << 15;
/// The tool's output.
pub const PWM: u32 = 1 << 16;
/// The serial line.
pub const UART0: u32 = 1 << 26;
/// USB.
pub const USBCTRL: u32 = 1 << 28;

/// How often the flags are read: a block needs some clocks.
const TIMEOUT_READS: u32 = 10_000;

/// Resets these blocks. One that stays in reset drives no pin and answers nothing, which the host sees.
pub fn reset(resets: &RESETS, blocks: u32) {
    // SAFETY: the bits are those of blocks that nothing uses yet.
    #[allow(unsafe_code)]
    resets
        .reset()
        .modify(|bits, w| unsafe { w.bits(bits.bits() | blocks) });
    release(resets, blocks);
}

/// Takes these blocks out of reset, without a reset of one that is out of it.
pub fn release(resets: &RESETS, blocks: u32) {
    // SAFETY: as above.
    #[allow(unsafe_code)]
    resets
        .reset()
        .modify(|bits, w| unsafe { w.bits(bits.bits() & !blocks) });
    let _ = (0..TIMEOUT_READS).any(|_| resets.reset_done().read().bits() & blocks == blocks);
}
