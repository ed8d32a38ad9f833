//! The switches, the encoders' index outputs and the bridges' fault outputs.
//!
//! Each is wired so that a broken wire reads as the unsafe case: switches are normally closed to
//! ground with a pull-up, so open is pressed; a fault output has its pull-up at the bridge and a
//! weaker pull-down at the controller, so open is low, a fault; an index that stays high has no
//! pulse. See `docs/use/wiring.md`.

use crate::ArmSample;
use core::convert::Infallible;
use embedded_hal::digital::{ErrorType, InputPin};

/// In the place of an input that the drives do not have: an index output without a pulse, a fault output without a fault.
pub struct Level<const HIGH: bool>;

impl<const HIGH: bool> ErrorType for Level<HIGH> {
    type Error = Infallible;
}

impl<const HIGH: bool> InputPin for Level<HIGH> {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(HIGH)
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(!HIGH)
    }
}

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

    /// A sensor sample: these counts, what the drives sense, and what the inputs show. `missed_ticks` is the number of ticks
    /// missed since the last one; `stopped` is an emergency stop that the button no longer shows.
    #[inline]
    pub fn sample<T>(
        &mut self,
        counts: [i32; 2],
        drives: T,
        missed_ticks: u32,
        stopped: bool,
    ) -> ArmSample<T> {
        ArmSample {
            counts,
            drives,
            home: self.home(),
            index: self.index(),
            emergency_stop: self.emergency_stop() || stopped,
            driver_fault: self.driver_fault(),
            missed_ticks,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embedded_hal::digital::{Error, ErrorKind};

    /// A pin at a level; none: it cannot be read.
    struct Pin(Option<bool>);

    #[derive(Debug)]
    struct Unreadable;

    impl Error for Unreadable {
        fn kind(&self) -> ErrorKind {
            ErrorKind::Other
        }
    }

    impl ErrorType for Pin {
        type Error = Unreadable;
    }

    impl InputPin for Pin {
        fn is_high(&mut self) -> Result<bool, Unreadable> {
            self.0.ok_or(Unreadable)
        }

        fn is_low(&mut self) -> Result<bool, Unreadable> {
            self.is_high().map(|high| !high)
        }
    }

    /// What is read with the pin of this number at a level, and all others at theirs of a sound arm.
    fn read(pin: usize, level: Option<bool>) -> [bool; 7] {
        let sound = [false, false, false, false, false, true, true];
        let at = |n: usize| Pin(if n == pin { level } else { Some(sound[n]) });
        let mut inputs = Inputs {
            home1: at(0),
            home4: at(1),
            index1: at(2),
            index4: at(3),
            emergency_stop: at(4),
            fault1: at(5),
            fault4: at(6),
        };
        let ([home1, home4], [index1, index4]) = (inputs.home(), inputs.index());
        let [fault1, fault4] = inputs.driver_fault();
        let stop = inputs.emergency_stop();
        [home1, home4, index1, index4, stop, fault1, fault4]
    }

    #[test]
    fn each_input_is_read_from_its_pin_and_a_broken_wire_is_the_unsafe_case() {
        assert_eq!(read(7, None), [false; 7]);
        for pin in 0..7 {
            let mut unsafe_case = [false; 7];
            unsafe_case[pin] = true;
            let is_fault_output = pin >= 5;
            for level in [Some(!is_fault_output), None] {
                assert_eq!(read(pin, level), unsafe_case, "pin {pin}, {level:?}");
            }
        }
    }
}
