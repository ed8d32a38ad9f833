//! The place of a job in the reach of an arm: where it is drawn, how large and how turned.
//!
//! A job without an origin is placed with its middle at the point where the arm moves best. Where
//! it does not fit there, its middle goes to the middle of the largest clear rectangle; then every
//! place of its cells on a map of the workspace is tried, those with the best conditioned worst cell
//! first. A place is taken if the planner accepts every move of the job there.
//!
//! A drawing longer than the longer side of that rectangle could lie only along the edge of the
//! reach, so it is searched a place only by `--fit`.

mod fit;
mod margin;
mod outline;
mod refusal;
mod trials;

use super::{ModeChangeError, RefusedModeChange, Scenario, ScenarioError};
use crate::job::{Job, Placement};
use crate::robot::Robot;
use fivebar_design::workspace::{Grid, Rectangle, WorkspaceMap};
use fivebar_firmware::planner::MoveError;
use fivebar_firmware::{Move, MoveKind, Planner};
use fivebar_kinematics::five_bar::{Side, WorkingMode};
use nalgebra::Vector2;
use outline::Outline;
use std::f64::consts::TAU;
use trials::Trials;

pub use fit::{FitError, Kept};
pub use refusal::place_in_job;

/// Cells along the longer side of the reach.
const CELLS: u32 = 160;
/// Places on the map that are tried.
const MOST_TRIED: usize = 8;
/// Speed of the joints on the way to the job, as a share of their limits.
const APPROACH_SPEED: f32 = 0.3;

/// A move of a job that cannot be done.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RefusedMove {
    #[error(transparent)]
    /// A move.
    Move(#[from] MoveError),
    #[error(transparent)]
    /// A change of the working mode.
    ModeChange(#[from] RefusedModeChange),
}

/// The reach of an arm on the branch of its home pose. Clear are cells with a margin around them.
struct Reach {
    map: WorkspaceMap,
    assembly: Side,
    /// The largest clear rectangle.
    page: Rectangle,
    /// How far around a drawing must be clear, too [m].
    margin: f64,
}

impl Reach {
    /// None if nothing is clear.
    fn of(robot: &Robot, margin: f64) -> Option<Self> {
        let workspace = robot.workspace(robot.working_mode()).ok()?;
        let grid = Grid::with_cells(&workspace.tool, CELLS).ok()?;
        let assembly = robot.home_pose().ok()?.assembly();
        let map = WorkspaceMap::new(workspace, grid);
        let page = map.largest_rectangle(assembly)?;
        let map = map.with_margin(assembly, margin);
        Some(Self {
            map,
            assembly,
            page,
            margin,
        })
    }

    /// Width and height of the page within the margin [m].
    fn page_size(&self) -> [f64; 2] {
        let size: [f64; 2] = self.page.size().into();
        size.map(|side| (side - 2.0 * self.margin).max(0.0))
    }

    fn page_middle(&self) -> [f64; 2] {
        ((self.page.low + self.page.high) * 0.5).into()
    }

    /// Positions of the lower left corner of an outline at which all of its cells are clear [m],
    /// the best first.
    fn corners(&self, outline: &Outline) -> Vec<[f64; 2]> {
        let grid = self.map.grid();
        let [width, height] = outline.extent().size();
        let size = grid.high() - grid.low();
        if width > size.x || height > size.y {
            return Vec::new();
        }
        let shape = outline.cells(grid.pitch());
        let mut places = self.map.placements(self.assembly, &shape);
        places.sort_by(|a, b| b.inverse_condition.total_cmp(&a.inverse_condition));
        let corner = |cell: [i32; 2]| {
            let index = cell[1] as usize * grid.columns() + cell[0] as usize;
            grid.cell_centre(index).into()
        };
        places.iter().map(|place| corner(place.cell)).collect()
    }
}

impl Scenario {
    /// The job, read and placed.
    ///
    /// # Errors
    /// A line that is not valid, no motion where the job is to start, or a robot without a home pose.
    pub fn job(&self) -> Result<Job, ScenarioError> {
        let job = self.whole_job()?;
        let Some(line) = self.from_line else {
            return Ok(job);
        };
        job.starting_at(line)
            .ok_or_else(|| ScenarioError::FromLine {
                file: self.job_file.clone(),
                line,
            })
    }

    fn whole_job(&self) -> Result<Job, ScenarioError> {
        let (job, unplaced) = match self.origin {
            Some(origin) => (self.placed(origin)?, None),
            None => {
                let unplaced = self.placed([0.0; 2])?;
                let first = self.at_best_point(&unplaced)?;
                (self.moved_or_read(&unplaced, first)?, Some(unplaced))
            }
        };
        let Some(mut planner) = self.planner() else {
            return Ok(job);
        };
        if self.accepts(&mut planner, &job) {
            return Ok(job);
        }
        if let Some(drawn) = job.without_parking()
            && self.accepts(&mut planner, &drawn)
        {
            return Ok(drawn);
        }
        let (Some(unplaced), Some(reach)) = (unplaced, Reach::of(&self.robot, self.margin)) else {
            return Ok(job);
        };
        let mut trials = Trials::new(planner);
        for unplaced in [Some(&unplaced), unplaced.without_parking().as_ref()] {
            let Some(unplaced) = unplaced else { continue };
            if let Some(origin) = self.search(&reach, &mut trials, unplaced) {
                let job = self.moved_or_read(unplaced, origin)?;
                return Ok(match self.accepts(&mut trials.planner, &job) {
                    true => job,
                    false => job.without_parking().unwrap_or(job),
                });
            }
        }
        Ok(job)
    }

    fn moved_or_read(&self, unplaced: &Job, origin: [f64; 2]) -> Result<Job, ScenarioError> {
        match self.moved(unplaced, self, origin) {
            Some(job) => Ok(job),
            None => self.placed(origin),
        }
    }

    /// The origin with the middle of the job at the point where the arm moves best [m].
    fn at_best_point(&self, unplaced: &Job) -> Result<[f64; 2], ScenarioError> {
        let middle = super::middle(unplaced);
        let best = self.robot.best_point()?;
        Ok([0, 1].map(|axis| best[axis] - middle[axis]))
    }

    /// An origin at which the planner accepts the job; `unplaced` has its origin at 0.
    fn search(&self, reach: &Reach, trials: &mut Trials, unplaced: &Job) -> Option<[f64; 2]> {
        let outline = Outline::of(unplaced);
        let extent = outline.extent();
        let (middle, page) = (extent.middle(), reach.page_middle());
        let on_page = [0, 1].map(|axis| page[axis] - middle[axis]);
        let longer = |[a, b]: [f64; 2]| a.max(b);
        if !self.anywhere && longer(extent.size()) > longer(reach.page_size()) {
            return None;
        }
        let mut fits = |origin| trials.accept(self, unplaced, origin);
        if fits(on_page) {
            return Some(on_page);
        }
        let apart = 3.0 * reach.map.grid().pitch();
        let mut tried: Vec<[f64; 2]> = Vec::new();
        for corner in reach.corners(&outline) {
            let near =
                |other: &[f64; 2]| (corner[0] - other[0]).hypot(corner[1] - other[1]) < apart;
            if tried.iter().any(near) {
                continue;
            }
            let origin = [0, 1].map(|axis| corner[axis] - extent.low[axis]);
            if fits(origin) {
                return Some(origin);
            }
            tried.push(corner);
            if tried.len() == MOST_TRIED {
                break;
            }
        }
        None
    }

    /// The job of this scenario with its (0, 0) at `origin` [m], from `unplaced`, the job of `other`
    /// at 0, which has another scale and turn. Reading a long job again would take a second.
    fn moved(&self, unplaced: &Job, other: &Self, origin: [f64; 2]) -> Option<Job> {
        if unplaced.depends_on_home {
            return self.placed(origin).ok();
        }
        Some(unplaced.moved(&Placement {
            origin,
            scale: self.scale / other.scale,
            turn: self.turn - other.turn,
            home: [0.0; 2],
        }))
    }

    /// The job with its (0, 0) at `origin` [m].
    fn placed(&self, origin: [f64; 2]) -> Result<Job, ScenarioError> {
        let placement = Placement {
            origin,
            scale: self.scale,
            turn: self.turn,
            home: self.robot.tool_at(&self.robot.home_pose()?),
        };
        self.read(&placement)
    }

    /// The planner of the arm; none if it has no masses or its settings are not valid.
    fn planner(&self) -> Option<Planner> {
        let settings = self.robot.settings().ok()?.check().ok()?;
        Some(Planner::new(&settings))
    }

    fn accepts(&self, planner: &mut Planner, job: &Job) -> bool {
        self.has_margin(job) && self.verify(planner, job).is_ok()
    }

    /// Checks the moves of the job from home on.
    ///
    /// # Errors
    /// The first move that cannot be done.
    pub fn verify(&self, planner: &mut Planner, job: &Job) -> Result<(), RefusedMove> {
        let Some(tool) = self.home_point() else {
            return Ok(());
        };
        let moves = self.moves_from_home(planner, job)?;
        let joints = self.robot.home.map(|angle| angle as f32);
        Ok(planner.check_all_from(tool, Some(joints), &moves)?)
    }

    /// The job as moves for the planner, wherever the arm is before them, in the robot's working mode.
    /// A servo or a switch that the job leaves on is switched off at its end.
    ///
    /// # Errors
    /// A change of the working mode that cannot be done.
    pub fn moves(&self, job: &Job) -> Result<Vec<Move>, RefusedModeChange> {
        self.moves_in(self.robot.working_mode(), None, job)
    }

    /// As [`Scenario::moves`], for an arm that is in another working mode before them, and in this
    /// assembly mode; none: in that of home.
    ///
    /// # Errors
    /// As [`Scenario::moves`].
    pub fn moves_in(
        &self,
        mode: WorkingMode,
        assembly: Option<Side>,
        job: &Job,
    ) -> Result<Vec<Move>, RefusedModeChange> {
        let mut moves: Vec<Move> = match job.first_change_of_mode() {
            None => job.moves(self.robot.motion.max_speed).collect(),
            Some(line) => {
                let refuse = |error| RefusedModeChange { line, error };
                let planner = self.planner().ok_or(ModeChangeError::NoPlanner);
                let mut planner = planner.map_err(refuse)?;
                if let Some(assembly) = assembly {
                    planner = planner.in_assembly(assembly);
                }
                self.moves_with_changes(planner, mode, job)?
            }
        };
        if let Some(last) = moves.last().filter(|last| last.tool > 0)
            && self.robot.tool_output.waits()
        {
            let kind = MoveKind::Dwell { duration: 0.0 };
            let lift = Move {
                tag: last.tag,
                tool: 0,
                kind,
            };
            moves.push(lift);
        }
        Ok(moves)
    }

    /// The job as moves for an arm at home. The motion to the job is straight, or by the joints if a
    /// straight line would leave the workspace.
    ///
    /// # Errors
    /// As [`Scenario::moves`].
    pub fn moves_from_home(
        &self,
        planner: &Planner,
        job: &Job,
    ) -> Result<Vec<Move>, RefusedModeChange> {
        let mut moves = self.moves(job)?;
        let first = moves
            .iter_mut()
            .find(|next| !matches!(next.kind, MoveKind::Dwell { .. }));
        if let (Some(first), Some(home)) = (first, self.home_point())
            && let MoveKind::Line { to, .. } = first.kind
            && planner.check(home, first).is_err()
            && let Some(joints) = self.joints(to)
        {
            let by_joints = Move {
                kind: MoveKind::Joint {
                    to: joints,
                    speed: APPROACH_SPEED,
                },
                ..*first
            };
            if planner.check(home, &by_joints).is_ok() {
                *first = by_joints;
            }
        }
        Ok(moves)
    }

    /// The tool at home [m].
    pub fn home_point(&self) -> Option<[f32; 2]> {
        let home = self.robot.home_pose().ok()?;
        Some(self.robot.tool_at(&home).map(|x| x as f32))
    }

    /// θ1, θ4 with the tool at a point, nearest to home [rad]; none if it is out of reach.
    fn joints(&self, [x, y]: [f32; 2]) -> Option<[f32; 2]> {
        let tool = self.robot.tool_on_link().ok()?;
        let point = Vector2::new(f64::from(x), f64::from(y));
        let pose = tool.inverse(point, self.robot.working_mode()).ok()?;
        let [theta1, _, _, theta4] = pose.angles();
        let home = self.robot.home;
        let near = |angle: f64, home: f64| angle + TAU * ((home - angle) / TAU).round();
        Some([near(theta1, home[0]) as f32, near(theta4, home[1]) as f32])
    }
}
