//! Chips that are not as the manual says.

/// What can be wrong with a chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Defect {
    /// The watchdog does not bite.
    NoWatchdog,
    /// The flash has no accelerator: its enables stay off.
    NoAccelerator,
    /// The option bytes keep what the factory put there.
    FixedOptionBytes,
    /// The flash has 512 KiB, as an STM32F405RE.
    HalfFlash,
    /// An erase takes three times as long as is typical.
    WornFlash,
}
