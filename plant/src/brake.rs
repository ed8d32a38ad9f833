//! Holding brakes. They engage when unpowered, so that an arm in gravity does not fall.

/// A joint slower than this is held at once [rad/s]; a faster one is slowed down first.
const HOLDING_SPEED: f64 = 0.2;

/// The brake of one joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Brake {
    /// Torque that slows the joint down [N·m]; zero without a brake.
    pub(crate) torque: f64,
    /// Whether it holds the joint.
    pub(crate) holding: bool,
}

impl Brake {
    pub(crate) fn new(torque: f64) -> Self {
        Self {
            torque,
            holding: false,
        }
    }

    /// Engages or releases it with the joint at `omega` [rad/s].
    pub(crate) fn set(&mut self, engaged: bool, omega: f64) {
        let fitted = self.torque > 0.0;
        self.holding = fitted && engaged && (self.holding || omega.abs() <= HOLDING_SPEED);
    }

    /// Its torque while it slows the joint down [N·m].
    pub(crate) fn slowing(&self, engaged: bool, omega: f64) -> f64 {
        if engaged && !self.holding {
            -self.torque * omega.signum()
        } else {
            0.0
        }
    }
}
