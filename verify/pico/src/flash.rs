//! What the ROM's functions do to the flash, whole and cut short by a loss of power.

/// A change of the flash.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FlashEvent {
    /// Blocks are erased.
    Erase {
        /// From the start of the flash [bytes].
        from: usize,
        /// [bytes].
        count: usize,
    },
    /// Pages are programmed: bits become 0.
    Program {
        /// From the start of the flash [bytes].
        at: usize,
        /// Their bytes.
        bytes: Vec<u8>,
    },
}

/// How much of a change has happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Share {
    /// All of it.
    Whole,
    /// Of every byte some bits.
    Bits,
    /// The first half of the bytes.
    FirstHalf,
}

impl FlashEvent {
    /// Makes this share of the change.
    pub fn happen(&self, flash: &mut [u8], share: Share) {
        let done = |count: usize| match share {
            Share::FirstHalf => count / 2,
            Share::Whole | Share::Bits => count,
        };
        match self {
            Self::Erase { from, count } => {
                let erased = &mut flash[*from..from + done(*count)];
                for (at, byte) in erased.iter_mut().enumerate() {
                    *byte |= match share {
                        Share::Bits => (at as u8).wrapping_mul(37),
                        Share::Whole | Share::FirstHalf => 0xff,
                    };
                }
            }
            Self::Program { at, bytes } => {
                let programmed = &mut flash[*at..at + done(bytes.len())];
                for (slot, byte) in programmed.iter_mut().zip(bytes) {
                    *slot &= match share {
                        Share::Bits => byte | 0x5a,
                        Share::Whole | Share::FirstHalf => *byte,
                    };
                }
            }
        }
    }
}
