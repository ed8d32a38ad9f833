//! How stiff springs may be that the controller renders at the tip.

use fivebar_files::robot::{DriveKind, MissingMasses, Robot};
use fivebar_firmware::controller::RenderingBounds;
use fivebar_firmware::drives::BrushedDrives;
use fivebar_kinematics::five_bar::Pose;

/// The greatest stiffness that the controller takes, without dampers [N/m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassiveStiffness {
    /// At home: along the stiffest direction of the joints' friction, and along the softest.
    pub home: [f64; 2],
    /// The least and the greatest over all poses and directions.
    pub range: [f64; 2],
}

impl PassiveStiffness {
    /// By the function with which the controller refuses springs, at these poses, of which home is the first; none of drives and
    /// belts with which an arm renders none.
    pub(super) fn new<'p>(
        robot: &Robot,
        poses: impl Iterator<Item = &'p Pose<f64>>,
    ) -> Result<Option<Self>, MissingMasses> {
        if robot.drive_kind() != DriveKind::Brushed || robot.gains().belts.is_some() {
            return Ok(None);
        }
        let (Ok(settings), Ok(tool)) = (robot.settings()?.check(), robot.tool_on_link()) else {
            return Ok(None);
        };
        let bounds = RenderingBounds::new::<BrushedDrives>(&settings);
        let mut each = poses.filter_map(|pose| {
            let jacobian = tool.jacobian(pose).ok()?;
            let columns = [jacobian.c1, jacobian.c4].map(|column| column.map(|x| x as f32));
            Some(bounds.greatest_stiffness(columns).map(f64::from))
        });
        Ok(each.next().map(|home| Self {
            home,
            range: each.fold(home, |[least, most], [low, high]| {
                [least.min(low), most.max(high)]
            }),
        }))
    }
}
