//! The switches, the encoders' index outputs and the bridges' fault outputs.
//!
//! Each is wired so that a broken wire reads as the unsafe case: switches are normally closed to
//! ground with a pull-up, so open is pressed; a fault output has its pull-up at the bridge and a
//! weaker pull-down at the controller, so open is low, a fault; an index that stays high has no
//! pulse. See `docs/use/wiring.md`.

use embedded_hal::digital::InputPin;

/// Reads the two home switches, both index outputs, the emergency stop and both fault outputs.
pub struct Inputs<H1, H4, I1, I4, S, F1, F4> {
    /// Home switch of joint 1: high is pressed.
    pub home1: H1,
    /// Home switch of joint 4: high is pressed.
    pub home4: H4,
    /// Index output of joint 1's encoder: high in its pulse.
    pub index1: I1,
    /// Index output of joint 4's encoder: high in its pulse.
    pub index4: I4,
    /// Emergency stop, also the timers' break input: high is pressed.
    pub emergency_stop: S,
    /// Bridge 1's fault output: low is a fault.
    pub fault1: F1,
    /// Bridge 4's fault output: low is a fault.
    pub fault4: F4,
}

impl<
    H1: InputPin,
    H4: InputPin,
    I1: InputPin,
    I4: InputPin,
    S: InputPin,
    F1: InputPin,
    F4: InputPin,
> Inputs<H1, H4, I1, I4, S, F1, F4>
{
    /// Whether each home switch is pressed; one that cannot be read counts as pressed.
    #[inline]
    pub fn home(&mut self) -> [bool; 2] {
        [
            self.home1.is_high().unwrap_or(true),
            self.home4.is_high().unwrap_or(true),
        ]
    }

    /// Whether each encoder shows its index; one that cannot be read counts as a pulse that never
    /// ends.
    #[inline]
    pub fn index(&mut self) -> [bool; 2] {
        [
            self.index1.is_high().unwrap_or(true),
            self.index4.is_high().unwrap_or(true),
        ]
    }

    /// Whether the emergency stop is pressed; if it cannot be read, it counts as pressed.
    #[inline]
    pub fn emergency_stop(&mut self) -> bool {
        self.emergency_stop.is_high().unwrap_or(true)
    }

    /// Whether each bridge reports a fault; one that cannot be read counts as a fault.
    #[inline]
    pub fn driver_fault(&mut self) -> [bool; 2] {
        [
            self.fault1.is_low().unwrap_or(true),
            self.fault4.is_low().unwrap_or(true),
        ]
    }
}
