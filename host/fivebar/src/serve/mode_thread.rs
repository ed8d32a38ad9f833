//! The thread that plans the paths to the other working modes from where the arm rests, so that the
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

/// The corners of the path to a working mode, θ1 and θ4 [rad]; or why there is none.
type ModePath = Result<Vec<[f32; 2]>, String>;

/// The paths from one pose.
struct ModePaths {
    from: RestPose,
    to: [ModePath; 4],
}

/// The thread, seen from the controller's.
pub(super) struct ModeThread {
    orders: mpsc::Sender<RestPose>,
    results: mpsc::Receiver<ModePaths>,
    asked: Option<RestPose>,
    paths: Option<ModePaths>,
}

impl ModeThread {
    pub(super) fn start(preview: Preview) -> Self {
        let (orders, poses) = mpsc::channel();
        let (sender, results) = mpsc::channel();
        thread::spawn(move || {
            while let Ok(first) = poses.recv() {
                // Only the latest pose matters.
                let from = poses.try_iter().last().unwrap_or(first);
                let to = MODES.map(|mode| path(&preview, from, mode));
                if sender.send(ModePaths { from, to }).is_err() {
                    return;
                }
            }
        });
        Self {
            orders,
            results,
            asked: None,
            paths: None,
        }
    }

    /// Has the paths from the pose at which the arm rests planned; none while it moves.
    pub(super) fn look(&mut self, pose: Option<RestPose>) {
        if let (Some(pose), true) = (pose, pose != self.asked) {
            // It fails only when the program ends.
            let _ = self.orders.send(pose);
        }
        self.asked = pose;
        self.paths = self.results.try_iter().last().or(self.paths.take());
    }

    /// The paths from the present pose; none until they are planned, and while the arm moves.
    fn present(&self) -> Option<&ModePaths> {
        self.paths
            .as_ref()
            .filter(|paths| Some(paths.from) == self.asked)
    }

    /// The working modes that can be reached, as [`Self::present`].
    pub(super) fn reachable(&self) -> Option<Vec<[Side; 2]>> {
        let modes = MODES.iter().zip(&self.present()?.to);
        Some(
            modes
                .filter(|(_, path)| path.is_ok())
                .map(|(mode, _)| *mode)
                .collect(),
        )
    }

    /// The path to a working mode, as [`Self::present`].
    pub(super) fn path(&self, mode: [Side; 2]) -> Option<ModePath> {
        let index = MODES.iter().position(|other| *other == mode)?;
        Some(self.present()?.to[index].clone())
    }
}

fn path(preview: &Preview, (from, branch): RestPose, [elbow1, elbow4]: [Side; 2]) -> ModePath {
    let start = JobStart::on(branch);
    let planner = preview.planner(start).map_err(|error| error.to_string())?;
    change_of_mode(&planner, from, WorkingMode::new(elbow1, elbow4)).map_err(|error| {
        let mut sentence = format!("{error}.");
        sentence[..1].make_ascii_uppercase();
        sentence
    })
}
