//! The simulated arm behind a controller in this process, and what an operator does with it.

use super::StepError;
use super::observer::Observer;
use super::operator::Task;
use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::{ActuatorCommand, SensorSample};
use fivebar_kinematics::five_bar::{Geometry, Joint, Pose, Side, WorkingMode};
use fivebar_plant::{Hands, Plant};
use fivebar_sim::link::Loopback;
use fivebar_sim::simulation::Simulate;
use nalgebra::Vector2;
use std::f64::consts::TAU;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Ticks for which the operator moves the arm: at 10 kHz, 0.2 s.
const MOVING_TICKS: u32 = 2000;

/// A motion of the arm by hand.
#[derive(Clone, Copy)]
enum HandMotion {
    /// Angles of joints 1 and 4 [rad].
    Joints([[f64; 2]; 2]),
    /// Positions of C on a straight line [m].
    Tip([[f64; 2]; 2]),
}

/// The arm and what the operator does with it.
struct Held {
    plant: Plant,
    /// The lengths as they are.
    geometry: Geometry<f64>,
    assembly: Side,
    mode: WorkingMode,
    period: f64,
    hands: Hands,
    /// The motions that are left and the ticks of the first one; none if nobody holds the arm.
    motion: Option<(Vec<HandMotion>, u32)>,
    /// Angles at which the arm moves best [rad]: motions lead through there.
    middle: [f64; 2],
    /// The home angles of its jig [rad].
    home: [f64; 2],
    observer: Observer,
}

/// The actions of an operator at the simulated arm.
#[derive(Clone)]
pub(super) struct OperatorActions(Arc<Mutex<Held>>);

impl Held {
    fn tick(&mut self, command: &ActuatorCommand) -> SensorSample {
        self.plant.press(self.hands);
        match &mut self.motion {
            None => self.plant.step(command, self.period),
            Some((motions, ticks)) => {
                *ticks += 1;
                if *ticks > MOVING_TICKS && motions.len() > 1 {
                    motions.remove(0);
                    *ticks = 1;
                }
                let s = (f64::from(*ticks) / f64::from(MOVING_TICKS)).min(1.0);
                let share = s * s * (3.0 - 2.0 * s);
                let pose = motions.first().and_then(|motion| {
                    motion.pose(share, &self.geometry, self.assembly, self.mode)
                });
                if let Some(pose) = pose {
                    self.plant.hold_by_hand(&pose, self.period);
                }
            }
        }
        self.observer.observe(&self.plant, command, self.period);
        self.plant.sense()
    }

    /// Whether the arm can be moved like this, without a jump.
    fn is_free(&self, motion: &HandMotion) -> bool {
        let pose = |step: u32| {
            let share = f64::from(step) / 500.0;
            motion.pose(share, &self.geometry, self.assembly, self.mode)
        };
        let mut last: Option<[f64; 4]> = None;
        (0..=500).all(|step| {
            let Some(pose) = pose(step) else { return false };
            let angles = pose.angles();
            let near = |last: [f64; 4]| {
                let turned = |link: usize| (angles[link] - last[link]).sin().abs();
                turned(0) < 0.05 && turned(3) < 0.05
            };
            pose.sin32().abs() > 0.05 && last.replace(angles).is_none_or(near)
        })
    }

    /// Begins to move the arm to these angles, where C is at `place`.
    fn move_to(&mut self, to: [f64; 2], place: [f64; 2]) -> Result<(), StepError> {
        let from = Joint::ALL.map(|joint| self.plant.angle(joint));
        let now = self.geometry.forward(from[0], from[1], self.assembly);
        let now = now.map_err(StepError::other)?;
        let direct = [
            HandMotion::Joints([from, to]),
            HandMotion::Tip([now.c.into(), place]),
        ];
        let through = [
            HandMotion::Joints([from, self.middle]),
            HandMotion::Joints([self.middle, to]),
        ];
        let motions = direct
            .into_iter()
            .map(|motion| vec![motion])
            .chain([through.to_vec()])
            .find(|motions| motions.iter().all(|motion| self.is_free(motion)));
        let motions = motions.ok_or_else(|| {
            StepError::Other(format!(
                "no path of the arm leads to the hole at ({:.0}, {:.0}) mm: set limits.angle of the robot \
                 file to what the cranks can do, then commission it into another folder (--out)",
                1e3 * place[0],
                1e3 * place[1]
            ))
        })?;
        self.motion = Some((motions, 0));
        Ok(())
    }
}

impl HandMotion {
    /// The pose after this share of the motion; none out of reach.
    fn pose(
        &self,
        share: f64,
        geometry: &Geometry<f64>,
        assembly: Side,
        mode: WorkingMode,
    ) -> Option<Pose<f64>> {
        let between = |[from, to]: [[f64; 2]; 2]| {
            [0, 1].map(|axis: usize| from[axis] + share * (to[axis] - from[axis]))
        };
        match *self {
            Self::Joints(ends) => {
                let [theta1, theta4] = between(ends);
                geometry.forward(theta1, theta4, assembly).ok()
            }
            Self::Tip(ends) => geometry.inverse(between(ends).into(), mode).ok(),
        }
    }
}

impl OperatorActions {
    fn held(&self) -> MutexGuard<'_, Held> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins a task.
    pub(super) fn begin(&self, task: &Task) -> Result<(), StepError> {
        let mut held = self.held();
        match *task {
            Task::PressStop => held.hands.emergency_stop = true,
            Task::ReleaseStop => held.hands.emergency_stop = false,
            Task::PressSwitch(joint) => held.hands.home[joint] = true,
            Task::ReleaseSwitches => held.hands.home = [false; 2],
            Task::Turn(joint, by) => {
                let mut to = Joint::ALL.map(|joint| held.plant.angle(joint));
                to[joint] += by;
                let pose = held.geometry.forward(to[0], to[1], held.assembly);
                let place = pose.map_err(StepError::other)?.c.into();
                held.move_to(to, place)?;
            }
            Task::Hole(_, place) => {
                let pose = held.geometry.inverse(Vector2::from(place), held.mode);
                let angles = pose.map_err(StepError::other)?.angles();
                let to = Joint::ALL.map(|joint| {
                    let (now, angle) = (held.plant.angle(joint), angles[3 * joint.index()]);
                    angle + ((now - angle) / TAU).round() * TAU
                });
                held.move_to(to, place)?;
            }
            Task::Home => {
                let to = held.home;
                let pose = held.geometry.forward(to[0], to[1], held.assembly);
                let place = pose.map_err(StepError::other)?.c.into();
                held.move_to(to, place)?;
            }
            Task::LetGo => held.motion = None,
        }
        Ok(())
    }

    /// The true position of the arm's tool [m].
    pub(super) fn tool(&self) -> [f64; 2] {
        self.held().plant.tool().into()
    }

    /// What follows belongs to this step.
    pub(super) fn begin_step(&self, step: &'static str) {
        self.held().observer.begin(step);
    }

    /// What happened to the arm in each step, as JSON.
    pub(super) fn observed(&self) -> Result<String, StepError> {
        self.held().observer.report().map_err(StepError::other)
    }

    /// Whether the arm is where the task has it.
    pub(super) fn is_done(&self) -> bool {
        let held = self.held();
        let rests = |(motions, ticks): &(Vec<HandMotion>, u32)| {
            motions.len() == 1 && *ticks >= MOVING_TICKS
        };
        held.motion.as_ref().is_none_or(rests)
    }
}

/// A controller in this process with the settings of `robot`, which moves the arm of `scenario`.
pub(super) fn arm(
    scenario: &Scenario,
    robot: &Robot,
) -> Result<(Loopback, OperatorActions), StepError> {
    let settings = robot.settings().map_err(StepError::other)?;
    let true_robot = scenario.arm();
    let mismatch = &scenario.mismatch;
    let mut lengths = true_robot.geometry.lengths();
    let [l1, l2, l3, l4] = mismatch.link_length;
    for (length, extra) in lengths
        .iter_mut()
        .zip([l1, l2, l3, l4, mismatch.base_length])
    {
        *length += extra;
    }
    let geometry = Geometry::new(lengths).map_err(StepError::other)?;
    let best = true_robot.best_point().map_err(StepError::other)?;
    let middle = geometry.inverse(Vector2::from(best), true_robot.elbows);
    let middle = middle.map_err(StepError::other)?.angles();
    let plant = scenario.plant().map_err(StepError::other)?;
    let held = Held {
        middle: [middle[0], middle[3]],
        home: Joint::ALL.map(|joint| true_robot.home[joint] + mismatch.home_error[joint]),
        plant: plant.with_resolved_windings(),
        geometry,
        assembly: true_robot.home_pose().map_err(StepError::other)?.assembly(),
        mode: true_robot.elbows,
        period: 1.0 / true_robot.control.tick_rate,
        hands: Hands::default(),
        motion: None,
        observer: Observer::new(),
    };
    let actions = OperatorActions(Arc::new(Mutex::new(held)));
    let moved = actions.clone();
    let arm = move |command: &ActuatorCommand| moved.held().tick(command);
    let line = Loopback::driving(&settings, Box::new(arm)).map_err(StepError::other)?;
    Ok((line, actions))
}
