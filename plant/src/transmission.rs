//! What connects a motor to its joint.

/// The gear or belt of one drive. Angles and torques are at the joint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Transmission {
    /// Stiffness [N·m/rad]; none: rigid.
    pub stiffness: Option<f64>,
    /// Damping beside the stiffness [N·m·s/rad].
    pub damping: f64,
}
