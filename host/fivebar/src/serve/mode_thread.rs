//! The thread that plans the ways to the other working modes from where the arm rests, so that the
//! controller's thread waits for no search.

use super::preview::{Branch, JobStart, Preview};
use fivebar_files::scenario::change_of_mode;
use fivebar_kinematics::five_bar::{Side, WorkingMode};
use std::sync::mpsc;
use std::thread;

/// The working modes, in the order in which pages list them.
const MODES: [[Side; 2]; 4] = [
    [Side::Right, Side::Left],
    [Side::Left, Side::Left],
    [Side::Right, Side::Right],
    [Side::Left, Side::Right],
];

/// Where the arm rests: θ1, θ4 [rad] and its branch.
pub(super) type RestPose = ([f32; 2], Branch);

/// The corners of the way to a working mode, θ1 and θ4 [rad]; or why there is none.
type Way = Result<Vec<[f32; 2]>, String>;

/// The ways from one pose.
struct Ways {
    from: RestPose,
    to: [Way; 4],
}

/// The thread, seen from the controller's.
pub(super) struct ModeThread {
    orders: mpsc::Sender<RestPose>,
    results: mpsc::Receiver<Ways>,
    asked: Option<RestPose>,
    ways: Option<Ways>,
}

impl ModeThread {
    pub(super) fn start(preview: Preview) -> Self {
        let (orders, poses) = mpsc::channel();
        let (sender, results) = mpsc::channel();
        thread::spawn(move || {
            while let Ok(first) = poses.recv() {
                // Only the latest pose matters.
                let from = poses.try_iter().last().unwrap_or(first);
                let to = MODES.map(|mode| way(&preview, from, mode));
                if sender.send(Ways { from, to }).is_err() {
                    return;
                }
            }
        });
        Self {
            orders,
            results,
            asked: None,
            ways: None,
        }
    }

    /// Has the ways from the pose at which the arm rests planned; none while it moves.
    pub(super) fn look(&mut self, pose: Option<RestPose>) {
        if let (Some(pose), true) = (pose, pose != self.asked) {
            // It fails only when the program ends.
            let _ = self.orders.send(pose);
        }
        self.asked = pose;
        self.ways = self.results.try_iter().last().or(self.ways.take());
    }

    /// The ways from the present pose; none until they are planned, and while the arm moves.
    fn present(&self) -> Option<&Ways> {
        self.ways
            .as_ref()
            .filter(|ways| Some(ways.from) == self.asked)
    }

    /// The working modes that can be reached, as [`Self::present`].
    pub(super) fn reachable(&self) -> Option<Vec<[Side; 2]>> {
        let modes = MODES.iter().zip(&self.present()?.to);
        Some(
            modes
                .filter(|(_, way)| way.is_ok())
                .map(|(mode, _)| *mode)
                .collect(),
        )
    }

    /// The way to a working mode, as [`Self::present`].
    pub(super) fn way(&self, mode: [Side; 2]) -> Option<Way> {
        let index = MODES.iter().position(|other| *other == mode)?;
        Some(self.present()?.to[index].clone())
    }
}

fn way(preview: &Preview, (from, branch): RestPose, [elbow1, elbow4]: [Side; 2]) -> Way {
    let start = JobStart::on(branch);
    let planner = preview.planner(start).map_err(|error| error.to_string())?;
    change_of_mode(&planner, from, WorkingMode::new(elbow1, elbow4)).map_err(|error| {
        let mut sentence = format!("{error}.");
        sentence[..1].make_ascii_uppercase();
        sentence
    })
}
