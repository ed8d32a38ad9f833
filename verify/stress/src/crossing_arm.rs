//! An arm that crosses a singularity, and its crossing; `firmware/tests/controller` has this file, too.

use fivebar_firmware::{CrossingMove, Settings};

/// From the plan of `fivebar plan --crossing` for this arm.
pub(crate) const CROSSING: CrossingMove = CrossingMove {
    from: [0.06, 0.115],
    to: [0.03, 0.012],
    duration: 0.3,
    crosses_at: 0.165,
    law: [-3.770_132_3, -7.055_689, 0.061_562_1],
};

/// Makes of the benchtop arm one with couplers of 0.12 m, as in the built-in example of crossings.
pub(crate) fn cross(settings: &mut Settings) {
    settings.lengths = [0.10, 0.12, 0.12, 0.10, 0.08];
    let [_, link2, link3, _] = &mut settings.links;
    (link2.com, link2.inertia) = ([0.06, 0.0], 1.65e-4);
    (link3.com, link3.inertia) = ([0.045, 0.0], 1.2e-4);
    settings.motion.singularity_margin = 0.1;
    for axis in &mut settings.axes {
        axis.angle_limits = [-1.0, 4.0];
    }
    settings.crossing_allowed = true;
}
