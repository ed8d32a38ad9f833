//! Why the chip was reset, as RCC_CSR tells it.

/// Flags of RCC_CSR that tell why the chip was reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResetCause {
    /// Power-on.
    Power,
    /// The supply fell below the brown-out level, but not to zero.
    BrownOut,
    /// The reset pin.
    Pin,
    /// SYSRESETREQ.
    Software,
    /// The independent watchdog.
    Watchdog,
    /// A low-power mode that the option bytes forbid.
    LowPower,
}

impl ResetCause {
    pub(crate) fn flags(self) -> u32 {
        match self {
            Self::Power => 0b0111 << 25,
            Self::BrownOut => 0b0011 << 25,
            Self::Pin => 0b0010 << 25,
            Self::Software => 0b1010 << 25,
            Self::Watchdog => 0b1_0010 << 25,
            Self::LowPower => 0b100_0010 << 25,
        }
    }
}
