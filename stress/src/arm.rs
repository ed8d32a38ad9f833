//! The arm of the sessions.

use fivebar_firmware::Settings;
use fivebar_kinematics::five_bar::{Geometry, Side};
use fivebar_plant::{Mismatch, Parameters, Plant};

/// The benchtop arm at these angles [rad], with or without the usual mismatch.
pub(crate) fn plant(flags: u8, angles: [f32; 2]) -> Plant {
    let settings = &Settings::BENCHTOP;
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
