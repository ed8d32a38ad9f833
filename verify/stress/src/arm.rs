//! The arm of the sessions.

use crate::orders;
use fivebar_kinematics::five_bar::{Geometry, Side};
use fivebar_plant::{Mismatch, Parameters, Plant};

/// θ1, θ4 at the start of a session with these flags [rad]; of an arm that crosses, those where the
/// crossing begins.
pub(crate) fn start(flags: u8) -> [f32; 2] {
    if orders::crosses(flags) {
        [2.161_249, 0.578_428_03]
    } else {
        [2.2, 0.9]
    }
}

/// The arm of these flags at its start, with or without the usual mismatch.
pub(crate) fn plant(flags: u8) -> Plant {
    let (settings, angles) = (&orders::settings(flags), start(flags));
    let parameters = Parameters::from_settings(settings, 24.0).expect("an arm");
    let geometry = Geometry::new(settings.lengths.map(f64::from)).expect("an arm");
    let [theta1, theta4] = angles.map(f64::from);
    let pose = geometry.forward(theta1, theta4, Side::Left);
    let mismatch = if flags & 1 == 0 {
        Mismatch::NONE
    } else {
        Mismatch::default()
    };
    let pose = pose.expect("a pose of this arm");
    Plant::new(&parameters, &mismatch, &pose, u64::from(flags))
}
