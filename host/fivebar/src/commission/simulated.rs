//! The simulated arm behind a controller in this process, and what an operator does with it.

use super::StepError;
use super::line::Line;
use super::observer::Observer;
use super::operator::Task;
use super::question::{Answer, Question};
use fivebar_design::joint_path::find_path;
use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::drives::DriveInterface;
use fivebar_firmware::{ArmCommand, ArmSample};
use fivebar_kinematics::five_bar::{Geometry, Joint, Pose, Side, WorkingMode};
use fivebar_plant::Hands;
use fivebar_sim::link::{EmulatedDrives, Loopback};
use fivebar_sim::simulation::{ByHand, SimulatedArm, WithArm, with_arm};
use nalgebra::Vector2;
use std::f64::consts::TAU;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Time for which the operator moves the arm [s].
const MOVING: f64 = 0.2;

/// A motion of the arm by hand.
#[derive(Clone, Copy)]
enum HandMotion {
    /// Angles of joints 1 and 4 [rad].
    Joints([[f64; 2]; 2]),
    /// Positions of C on a straight line [m].
    Tip([[f64; 2]; 2]),
}

/// The arm and what the operator does with it.
struct Held<P> {
    arm: P,
    /// The lengths as they are.
    geometry: Geometry<f64>,
    assembly: Side,
    mode: WorkingMode,
    period: f64,
    /// Ticks of a motion by hand.
    moving_ticks: u32,
    hands: Hands,
    /// The motions that are left and the ticks of the first one; none if nobody holds the arm.
    motion: Option<(Vec<HandMotion>, u32)>,
    /// Angles at which the arm moves best [rad]: motions lead through there.
    middle: [f64; 2],
    /// The home angles of its jig [rad].
    home: [f64; 2],
    /// The joints' angles when the operator began to look [rad].
    looked_from: [f64; 2],
    observer: Observer,
}

/// What an operator does with an arm, whatever turns its joints.
trait Handled: Send {
    fn begin(&mut self, task: &Task) -> Result<(), StepError>;
    fn look(&mut self);
    fn seen(&self, question: &Question) -> Answer;
    fn tool(&self) -> [f64; 2];
    fn observer(&mut self) -> &mut Observer;
    fn is_done(&self) -> bool;
}

/// The actions of an operator at the simulated arm.
#[derive(Clone)]
pub(super) struct OperatorActions(Arc<Mutex<dyn Handled>>);

impl<P: SimulatedArm + ByHand> Held<P> {
    fn tick(
        &mut self,
        command: &ArmCommand<<P::Interface as DriveInterface>::Command>,
    ) -> ArmSample<<P::Interface as DriveInterface>::Sample> {
        self.arm.plant_mut().press(self.hands);
        match &mut self.motion {
            None => self.arm.step(command, self.period),
            Some((motions, ticks)) => {
                *ticks += 1;
                if *ticks > self.moving_ticks && motions.len() > 1 {
                    motions.remove(0);
                    *ticks = 1;
                }
                let s = (f64::from(*ticks) / f64::from(self.moving_ticks)).min(1.0);
                let share = s * s * (3.0 - 2.0 * s);
                let pose = motions.first().and_then(|motion| {
                    motion.pose(share, &self.geometry, self.assembly, self.mode)
                });
                if let Some(pose) = pose {
                    self.arm.hold_by_hand(&pose, command, self.period);
                }
            }
        }
        let powered = command.enable != [false; 2];
        self.observer
            .observe(self.arm.plant(), powered, self.period);
        self.arm.sense()
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

    /// A way around what no hand can move the arm through; none if there is none within a turn more.
    fn around(&self, from: [f64; 2], to: [f64; 2]) -> Option<Vec<HandMotion>> {
        let range = |joint: usize| {
            let ends = [from[joint], to[joint]];
            [ends[0].min(ends[1]) - TAU, ends[0].max(ends[1]) + TAU]
        };
        let is_free = |[theta1, theta4]: [f64; 2]| {
            let pose = self.geometry.forward(theta1, theta4, self.assembly);
            pose.is_ok_and(|pose| pose.sin32().abs() > 0.05)
        };
        let is_clear = |from, to| self.is_free(&HandMotion::Joints([from, to]));
        let corners = find_path([range(0), range(1)], from, to, is_free, is_clear)?;
        let mut last = from;
        let motions = corners.into_iter().map(|corner| {
            let motion = HandMotion::Joints([last, corner]);
            last = corner;
            motion
        });
        Some(motions.collect())
    }

    /// Begins to move the arm to these angles, where C is at `place`.
    fn move_to(&mut self, to: [f64; 2], place: [f64; 2]) -> Result<(), StepError> {
        let from = Joint::ALL.map(|joint| self.arm.angle(joint));
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
            .find(|motions| motions.iter().all(|motion| self.is_free(motion)))
            .or_else(|| self.around(from, to));
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

    /// Begins to move the arm to these angles [rad].
    fn move_to_angles(&mut self, to: [f64; 2]) -> Result<(), StepError> {
        let pose = self.geometry.forward(to[0], to[1], self.assembly);
        self.move_to(to, pose.map_err(StepError::other)?.c.into())
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

impl<P: SimulatedArm + ByHand + Send> Handled for Held<P> {
    fn begin(&mut self, task: &Task) -> Result<(), StepError> {
        match *task {
            Task::PressStop => self.hands.emergency_stop = true,
            Task::ReleaseStop => self.hands.emergency_stop = false,
            Task::PressSwitch(joint) => self.hands.home[joint] = true,
            Task::ReleaseSwitches => self.hands.home = [false; 2],
            Task::Turn(joint, by) => {
                let mut to = Joint::ALL.map(|joint| self.arm.angle(joint));
                to[joint] += by;
                self.move_to_angles(to)?;
            }
            Task::Hole(_, place) => {
                let pose = self.geometry.inverse(Vector2::from(place), self.mode);
                let angles = pose.map_err(StepError::other)?.angles();
                let to = Joint::ALL.map(|joint| {
                    let (middle, angle) = (self.middle[joint], angles[3 * joint.index()]);
                    angle + ((middle - angle) / TAU).round() * TAU
                });
                self.move_to(to, place)?;
            }
            Task::Home => self.move_to_angles(self.home)?,
            Task::Place(angles) => self.move_to_angles(angles)?,
            Task::LetGo => self.motion = None,
            // The mark is where the tip is, and drivers and drives are set as the scenario has them.
            Task::Mark(_) | Task::SetCurrent | Task::SetDrives => {}
        }
        Ok(())
    }

    fn look(&mut self) {
        self.looked_from = Joint::ALL.map(|joint| self.arm.angle(joint));
    }

    fn seen(&self, question: &Question) -> Answer {
        let turned = Joint::ALL.map(|joint| self.arm.angle(joint) - self.looked_from[joint]);
        question.seen(turned, self.arm.current().map(f64::abs))
    }

    fn tool(&self) -> [f64; 2] {
        self.arm.tool()
    }

    fn observer(&mut self) -> &mut Observer {
        &mut self.observer
    }

    fn is_done(&self) -> bool {
        let rests = |(motions, ticks): &(Vec<HandMotion>, u32)| {
            motions.len() == 1 && *ticks >= self.moving_ticks
        };
        self.motion.as_ref().is_none_or(rests)
    }
}

impl OperatorActions {
    fn held(&self) -> MutexGuard<'_, dyn Handled + 'static> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins a task.
    pub(super) fn begin(&self, task: &Task) -> Result<(), StepError> {
        self.held().begin(task)
    }

    /// Looks where the joints are before they turn.
    pub(super) fn look(&self) {
        self.held().look();
    }

    /// What the operator sees and feels.
    pub(super) fn seen(&self, question: &Question) -> Answer {
        self.held().seen(question)
    }

    /// The true position of the arm's tool [m].
    pub(super) fn tool(&self) -> [f64; 2] {
        self.held().tool()
    }

    /// What follows belongs to this step.
    pub(super) fn begin_step(&self, step: &'static str) {
        self.held().observer().begin(step);
    }

    /// What happened to the arm in each step, as JSON.
    pub(super) fn observed(&self) -> Result<String, StepError> {
        self.held().observer().report().map_err(StepError::other)
    }

    /// Whether the arm is where the task has it.
    pub(super) fn is_done(&self) -> bool {
        self.held().is_done()
    }
}

/// A controller in this process with the settings of `robot`, which moves the arm of `scenario`.
pub(super) fn arm(
    scenario: &Scenario,
    robot: &Robot,
) -> Result<(Box<dyn Line>, OperatorActions), StepError> {
    with_arm(scenario, Handed { scenario, robot }).map_err(StepError::other)?
}

/// Gives an arm to a controller and to an operator.
struct Handed<'a> {
    scenario: &'a Scenario,
    robot: &'a Robot,
}

impl WithArm for Handed<'_> {
    type Output = Result<(Box<dyn Line>, OperatorActions), StepError>;

    fn with<P>(self, mut arm: P) -> Self::Output
    where
        P: SimulatedArm<Interface: EmulatedDrives> + ByHand + Send + 'static,
    {
        let settings = self.robot.settings().map_err(StepError::other)?;
        let true_robot = self.scenario.arm();
        let mismatch = &self.scenario.mismatch;
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
        let plant = arm.plant_mut();
        *plant = plant.clone().with_resolved_windings();
        let held = Held {
            looked_from: Joint::ALL.map(|joint| arm.angle(joint)),
            arm,
            middle: [middle[0], middle[3]],
            home: Joint::ALL.map(|joint| true_robot.home[joint] + mismatch.home_error[joint]),
            geometry,
            assembly: true_robot.home_pose().map_err(StepError::other)?.assembly(),
            mode: true_robot.elbows,
            period: 1.0 / true_robot.control.tick_rate,
            moving_ticks: (MOVING * true_robot.control.tick_rate) as u32,
            hands: Hands::default(),
            motion: None,
            observer: Observer::new(),
        };
        let held = Arc::new(Mutex::new(held));
        let moved = Arc::clone(&held);
        let tick = move |command: &ArmCommand<<P::Interface as DriveInterface>::Command>| {
            let mut held = moved.lock().unwrap_or_else(PoisonError::into_inner);
            held.tick(command)
        };
        let line = Loopback::<P::Interface>::driving(&settings, Box::new(tick));
        Ok((
            Box::new(line.map_err(StepError::other)?),
            OperatorActions(held),
        ))
    }
}
