//! An H-bridge with two PWM inputs and a sleep pin: DRV8874 or similar, in PWM mode.

use embedded_hal::digital::OutputPin;
use embedded_hal::pwm::SetDutyCycle;

/// How long a bridge takes from its sleep pin's rise until it drives [s]. The DRV8874 takes up to
/// 1 ms (t_WAKE, SLVSF66, 6.5); half as much again is for others of its class and for the
/// filter of its sleep line. Until then its outputs float whatever its inputs are, and its fault
/// output may be low. The controller waits so long, see [`Controller::tick`].
///
/// [`Controller::tick`]: crate::Controller::tick
pub const WAKE_UP_TIME: f32 = 1.5e-3;

/// One bridge.
///
/// | IN1 | IN2 | the motor |
/// |---|---|---|
/// | low | low | floats |
/// | high | low | is driven forwards |
/// | low | high | is driven backwards |
/// | high | high | is braked |
///
/// Forwards, IN1 is high all the time and IN2 for the share 1 − duty of each period: the motor is
/// driven and braked alternately (slow decay), and its mean voltage is duty times the bus voltage.
pub struct Bridge<In1, In2, Sleep> {
    in1: In1,
    in2: In2,
    sleep: Sleep,
}

impl<In1: SetDutyCycle, In2: SetDutyCycle, Sleep: OutputPin> Bridge<In1, In2, Sleep> {
    /// The bridge on these pins, off; `sleep` low puts it to sleep.
    pub fn new(in1: In1, in2: In2, sleep: Sleep) -> Self {
        let mut bridge = Self { in1, in2, sleep };
        bridge.float();
        bridge
    }

    /// Drives with `duty`, clipped to −1…1. If it is not a number, the motor floats.
    #[inline]
    pub fn drive(&mut self, duty: f32) {
        if duty.is_nan() {
            self.float();
            return;
        }
        if self.sleep.set_high().is_err() {
            self.float();
            return;
        }
        let full = self.in1.max_duty_cycle();
        // Not `min`, which would call the library.
        let size = duty.abs();
        let share = if size > 1.0 { 1.0 } else { size };
        // `as` saturates.
        let driven = (share * f32::from(full) + 0.5) as u16;
        let braked = full.saturating_sub(driven);
        let (in1, in2) = if duty < 0.0 {
            (braked, full)
        } else {
            (full, braked)
        };
        if self.in1.set_duty_cycle(in1).is_err() || self.in2.set_duty_cycle(in2).is_err() {
            self.float();
        }
    }

    /// Switches the motor off: both inputs low, the bridge asleep.
    #[inline]
    pub fn float(&mut self) {
        // Each of the three is enough; if one fails, the other two still switch off.
        let _ = self.in1.set_duty_cycle(0);
        let _ = self.in2.set_duty_cycle(0);
        let _ = self.sleep.set_low();
    }
}

#[cfg(test)]
mod tests {
    use super::Bridge;
    use core::convert::Infallible;
    use embedded_hal::digital::{ErrorType as PinType, OutputPin};
    use embedded_hal::pwm::{ErrorType as PwmType, SetDutyCycle};

    #[derive(Default)]
    struct Channel(u16);

    impl PwmType for Channel {
        type Error = Infallible;
    }
    impl SetDutyCycle for Channel {
        fn max_duty_cycle(&self) -> u16 {
            4200
        }
        fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
            self.0 = duty;
            Ok(())
        }
    }

    #[derive(Default)]
    struct Pin(bool);

    impl PinType for Pin {
        type Error = Infallible;
    }
    impl OutputPin for Pin {
        fn set_low(&mut self) -> Result<(), Infallible> {
            self.0 = false;
            Ok(())
        }
        fn set_high(&mut self) -> Result<(), Infallible> {
            self.0 = true;
            Ok(())
        }
    }

    fn driven(duty: f32) -> (u16, u16, bool) {
        let mut bridge = Bridge::new(Channel(7), Channel(7), Pin(true));
        assert_eq!((bridge.in1.0, bridge.in2.0, bridge.sleep.0), (0, 0, false));
        bridge.drive(duty);
        (bridge.in1.0, bridge.in2.0, bridge.sleep.0)
    }

    #[test]
    fn the_inputs_differ_by_the_duty() {
        assert_eq!(driven(0.0), (4200, 4200, true));
        assert_eq!(driven(0.25), (4200, 3150, true));
        assert_eq!(driven(-0.25), (3150, 4200, true));
        assert_eq!(driven(1.0), (4200, 0, true));
    }

    #[test]
    fn a_duty_beyond_one_is_clipped() {
        assert_eq!(driven(1.5), driven(1.0));
        assert_eq!(driven(f32::NEG_INFINITY), driven(-1.0));
    }

    #[test]
    fn not_a_number_unpowers_the_motor() {
        assert_eq!(driven(f32::NAN), (0, 0, false));
    }
}
