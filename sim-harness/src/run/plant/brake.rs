//! Holding brakes: engaged when unpowered, so that an arm in gravity does not fall.

/// A joint slower than this is caught [rad/s]; a faster one is slowed down first.
const CATCHING: f64 = 0.2;

/// The brake of one joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Brake {
    /// With what it slows its joint down [N·m]; zero where none is fitted.
    pub(super) torque: f64,
    /// It holds the joint.
    pub(super) holding: bool,
}

impl Brake {
    pub(super) fn new(torque: f64) -> Self {
        Self {
            torque,
            holding: false,
        }
    }

    /// Engages or releases it with the joint at `omega` [rad/s].
    pub(super) fn set(&mut self, engaged: bool, omega: f64) {
        let fitted = self.torque > 0.0;
        self.holding = fitted && engaged && (self.holding || omega.abs() <= CATCHING);
    }

    /// Its torque on a joint that it does not hold yet [N·m].
    pub(super) fn slowing(&self, engaged: bool, omega: f64) -> f64 {
        if engaged && !self.holding {
            -self.torque * omega.signum()
        } else {
            0.0
        }
    }
}
