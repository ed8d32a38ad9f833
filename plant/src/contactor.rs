//! The contactor in the bridges' supply, and the capacitor behind it.
//!
//! The emergency stop's second contact opens it without the controller. The capacitor C1 then
//! discharges through R1, and charges through the NTC when the contactor closes (`docs/use/wiring.md`).

/// R1 C1: 4.7 kΩ, 1000 µF [s].
const DISCHARGE: f64 = 4.7;
/// NTC and C1: 5 Ω, 1000 µF [s].
const CHARGE: f64 = 5e-3;

/// The contactor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Contactor {
    /// Whether its contact stays closed whatever its coil does.
    pub(crate) welded: bool,
    /// The capacitor's voltage as a share of the supply's.
    charge: f64,
}

impl Contactor {
    /// Closed, and the capacitor full.
    pub(crate) const CLOSED: Self = Self {
        welded: false,
        charge: 1.0,
    };

    /// The bridges' voltage at this voltage of the supply.
    #[inline]
    pub(crate) fn behind(&self, supply: f64) -> f64 {
        self.charge * supply
    }

    /// Passes time [s]; `pressed` is the emergency stop.
    #[inline]
    pub(crate) fn pass(&mut self, pressed: bool, time: f64) {
        if pressed && !self.welded {
            self.charge -= self.charge * (time / DISCHARGE).min(1.0);
        } else if self.charge < 1.0 {
            self.charge += (1.0 - self.charge) * (time / CHARGE).min(1.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Contactor;

    fn after(mut contactor: Contactor, pressed: bool, seconds: f64) -> Contactor {
        for _ in 0..(seconds * 1e4) as u32 {
            contactor.pass(pressed, 1e-4);
        }
        contactor
    }

    #[test]
    fn the_bus_falls_while_the_emergency_stop_is_pressed_and_comes_back() {
        let fallen = after(Contactor::CLOSED, true, 4.7);
        assert!((fallen.behind(24.0) - 24.0 / std::f64::consts::E).abs() < 0.01);
        let back = after(fallen, false, 0.05);
        assert!(back.behind(24.0) > 23.9);
        assert_eq!(after(Contactor::CLOSED, false, 1.0), Contactor::CLOSED);
    }

    #[test]
    fn the_bus_stays_if_the_contact_is_welded() {
        let welded = Contactor {
            welded: true,
            ..Contactor::CLOSED
        };
        assert_eq!(after(welded, true, 4.7).behind(24.0), 24.0);
    }
}
