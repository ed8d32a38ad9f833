//! The springs and dampers that torque drives make themselves.

use crate::settings::{AxisSettings, CheckedSettings};

/// The spring and the damper that a drive makes itself, of its own encoder and many times in a tick. They answer what the
/// tick's torques, which come late, cannot: friction and loads that the model does not know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveStiffness {
    /// k [N·m/rad].
    pub stiffness: f32,
    /// d [N·m·s/rad].
    pub damping: f32,
}

/// The bandwidth of spring and damper, times what the drive's damper is late [1], and by how much less it is for each second
/// of the current loop's lag [1/s]. The controller's own loop is late, too: beside a slow drive a stiffer spring would take of
/// its margin, and beside a fast one give to it, up to here (`fivebar margins`, over the range of inertias).
const PER_LAG: f32 = 0.6;
const LESS_PER_LAG: f32 = 600.0;
/// Its bounds [1].
const PER_LAG_BOUNDS: [f32; 2] = [0.2, 0.3];
/// What a drive tells its damper of its velocity is late by the current loop and by the tracking loop of its encoder: as
/// many times the lag of the current loop, if both have the same bandwidth.
const VELOCITY_LAGS: f32 = 3.0;

impl DriveStiffness {
    /// Of the drives of joint 1 and joint 4: k = I ω², d = 2 I ω of its inertia I.
    pub fn of(settings: &CheckedSettings) -> [Self; 2] {
        let ([axis1, axis4], [inertia1, inertia4]) = (&settings.axes, settings.nominal_inertia());
        [(axis1, inertia1), (axis4, inertia4)].map(|(axis, inertia)| {
            let lag = loop_lag(axis);
            let [least, most] = PER_LAG_BOUNDS;
            let per_lag = (PER_LAG - LESS_PER_LAG * lag).clamp(least, most);
            let bandwidth = per_lag / (VELOCITY_LAGS * lag);
            Self {
                stiffness: inertia * bandwidth * bandwidth,
                damping: 2.0 * inertia * bandwidth,
            }
        })
    }
}

/// The lag of a drive's own current loop [s].
pub(super) fn loop_lag(axis: &AxisSettings) -> f32 {
    axis.inductance / axis.resistance
}
