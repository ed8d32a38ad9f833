//! The crystals that an image takes, and the factors by which each gives 168 MHz.
//!
//! A board says by measurement which of 8, 12 and 16 MHz its crystal has: the internal oscillator against which it
//! measures has −8 to +4.5 % over parts and temperature, and their ranges lie apart. Those of 24 and 25 MHz do not, and the
//! wrong one of them would run the core at 175 MHz. So an image takes one of these only if it is built for it, with
//! `FIVEBAR_CRYSTAL=24` or `=25`, and no other then.

/// A crystal's nominal frequency [MHz].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crystal(u32);

/// The factors of the PLL: the crystal's frequency divided by `divider`, times `multiplier`, over 2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PllFactors {
    /// PLLM.
    pub divider: u8,
    /// PLLN.
    pub multiplier: u16,
}

impl Crystal {
    /// What this image takes.
    pub const TAKEN: &[Self] = match option_env!("FIVEBAR_CRYSTAL") {
        None => &[Self(8), Self(12), Self(16)],
        Some(one) => match one.as_bytes() {
            b"24" => &[Self(24)],
            b"25" => &[Self(25)],
            _ => panic!("FIVEBAR_CRYSTAL must be 24 or 25 [MHz]; leave it out for 8, 12 and 16"),
        },
    };

    /// The crystal that the internal oscillator measures with this frequency [Hz]; none if this image takes none such.
    pub fn measured(frequency: u32) -> Option<Self> {
        let of = |crystal: &Self| crystal.shows(frequency);
        Self::TAKEN.iter().copied().find(of)
    }

    /// Whether an internal oscillator within its tolerance can measure it with this frequency [Hz]: −5 to +9.4 %.
    fn shows(self, frequency: u32) -> bool {
        let nominal = self.0 * 1_000_000;
        (nominal / 20 * 19..=nominal / 32 * 35).contains(&frequency)
    }

    /// Nominal frequency [MHz].
    pub fn megahertz(self) -> u32 {
        self.0
    }

    /// The factors that give 168 MHz, from 2 MHz where that is a whole part of the crystal's frequency: the loop then has
    /// the least jitter (RM0090, RCC_PLLCFGR).
    pub fn pll(self) -> PllFactors {
        let (per, multiplier) = if self.0.is_multiple_of(2) {
            (2, 168)
        } else {
            (1, 336)
        };
        PllFactors {
            // At most 25.
            divider: (self.0 / per) as u8,
            multiplier,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Crystal; 5] = [
        Crystal(8),
        Crystal(12),
        Crystal(16),
        Crystal(24),
        Crystal(25),
    ];

    #[test]
    fn each_crystal_gives_168_megahertz_within_the_bounds_of_the_loop() {
        for crystal in ALL {
            let PllFactors {
                divider,
                multiplier,
            } = crystal.pll();
            let input = f64::from(crystal.megahertz()) / f64::from(divider);
            assert!((1.0..=2.0).contains(&input), "{crystal:?}: {input} MHz");
            assert_eq!(input * f64::from(multiplier) / 2.0, 168.0, "{crystal:?}");
        }
    }

    #[test]
    fn crystals_that_are_told_apart_by_measurement_are_so_by_every_oscillator_in_tolerance() {
        for crystal in Crystal::TAKEN {
            for oscillator in [0.92, 1.0, 1.045] {
                let measured = f64::from(crystal.megahertz()) * 1e6 / oscillator;
                assert_eq!(Crystal::measured(measured as u32), Some(*crystal));
            }
        }
        for other in [4e6, 7e6, 10e6, 14e6, 20e6, 24e6, 25e6, 27e6] {
            assert_eq!(Crystal::measured(other as u32), None, "{other}");
        }
    }

    /// Why these two are not told apart.
    #[test]
    fn an_oscillator_in_tolerance_can_show_24_megahertz_as_25() {
        let [.., crystal24, crystal25] = ALL;
        assert!(crystal24.shows(25_000_000) && crystal25.shows(24_000_000));
    }
}
