//! Streams of set-points to the emulated boards: what goes to the drives has the bits of this process in each tick, through
//! points that are lost, late or beyond a limit, and through a pause.

use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_firmware::controller::Request;
use fivebar_firmware::drives::can::BusDrives;
use fivebar_firmware::drives::{BrushedDrives, DriveInterface, StepDrives};
use fivebar_firmware::motion::{StreamConfig, StreamMode, StreamPoint, StreamPolicy};
use fivebar_firmware::planner::{StreamPhase, StreamProgress};
use fivebar_firmware::safety::State;
use fivebar_firmware::{ArmCommand, ArmSample, FULL_TOOL, Move, MoveKind, Status};
use fivebar_kinematics::five_bar::Pose;
use fivebar_plant::{CanPlant, HobbyServoPlant, Mismatch, Plant, StepperPlant};
use fivebar_sim::link::{EmulatedDrives, Emulator, Lockstep, Target, TargetError};
use fivebar_sim::simulation::{SimulatedArm, Simulation};
use std::f64::consts::TAU;

/// Points per second.
const RATE: f64 = 500.0;
/// Points of a motion that begins and ends at rest.
const POINTS: u16 = 100;
/// From the first tick at rest to the stream, from its last point to its end, and in the pause [points].
const PAUSE: u32 = 50;
/// The delay [points].
const DELAY: u32 = 10;

/// A board and its twin that are given a stream between arming and the first move.
struct Streamed<I: EmulatedDrives> {
    lockstep: Lockstep<Emulator, I>,
    config: StreamConfig,
    /// How far it goes in each coordinate [rad or m].
    reach: [f64; 2],
    /// Ticks in which the arm was ready.
    ready: u32,
    /// Where and when the stream began.
    begun: Option<([f64; 2], u32)>,
    /// Points made so far.
    made: u16,
    /// What it has done in the twin and on the board.
    done: [Option<StreamProgress>; 2],
}

impl<I: EmulatedDrives> Streamed<I> {
    /// Where the stream goes from `begin`, and how fast: out and back, pause, and the same once more.
    fn point(&self, begin: [f64; 2], k: u16) -> ([f64; 2], [f64; 2]) {
        let u = f64::from(k % POINTS) / f64::from(POINTS);
        let (sine, cosine) = (TAU * u).sin_cos();
        let rate = RATE / f64::from(POINTS) * TAU;
        let at = [0, 1].map(|i| begin[i] + 0.5 * self.reach[i] * (1.0 - cosine));
        (at, self.reach.map(|reach| 0.5 * reach * rate * sine))
    }

    /// What a host does in this tick.
    fn host(&mut self, status: &Status) -> Result<(), TargetError> {
        let period = u32::from(self.config.period);
        if self.begun.is_none() && !(status.state == State::Armed && self.is_idle()) {
            return Ok(());
        }
        self.ready += 1;
        let Some((begin, at)) = self.begun else {
            // Not while a brake is released.
            let may_begin = self.ready.is_multiple_of(PAUSE * period);
            if may_begin && self.lockstep.begin_stream(&self.config)?.is_ok() {
                let begin = match self.config.mode {
                    StreamMode::Joint => status.angle,
                    _ => status.tool.expect("a homed arm"),
                };
                self.begun = Some((begin.map(f64::from), status.tick));
            }
            return Ok(());
        };
        let since = status.tick - at;
        if !since.is_multiple_of(period) {
            return Ok(());
        }
        // The second motion begins after a pause in which the stream runs dry.
        let slot = since / period - 1;
        let pause = if self.made > POINTS { PAUSE } else { 0 };
        if self.made > 2 * POINTS {
            if slot == u32::from(self.made) + 3 * PAUSE {
                self.lockstep.end_stream()?;
            }
        } else if slot == u32::from(self.made) + pause {
            let n = self.made;
            let (position, velocity) = self.point(begin, n);
            let late = if n % 31 == 30 { 2 * DELAY } else { 0 };
            let point = StreamPoint {
                id: self.config.id,
                due: (status.tick + DELAY * period).wrapping_sub(late * period),
                position: (position[0] as f32, position[1] as f32),
                velocity: (velocity[0] as f32, velocity[1] as f32),
                force: (0.0, 0.0),
            };
            self.made += 1;
            // One in 17 is lost.
            if n % 17 != 16 {
                self.lockstep.send_point(n, &point)?;
            }
        }
        let [_, before] = self.done;
        let [here, there] = self.lockstep.stream();
        self.done = [here, there.or(before)];
        Ok(())
    }
}

impl<I: EmulatedDrives> Target<I> for Streamed<I> {
    fn tick(
        &mut self,
        sample: &ArmSample<<I as DriveInterface>::Sample>,
    ) -> Result<(ArmCommand<<I as DriveInterface>::Command>, Status), TargetError> {
        let (command, status) = self.lockstep.tick(sample)?;
        self.host(&status)?;
        Ok((command, status))
    }

    fn request(&mut self, request: Request) -> Result<(), TargetError> {
        self.lockstep.request(request)
    }

    fn offer(&mut self, next: &Move) -> Result<bool, TargetError> {
        match self.done {
            [Some(here), Some(there)]
                if [here, there].map(|it| it.phase) == [StreamPhase::Ended; 2] =>
            {
                self.lockstep.offer(next)
            }
            _ => Ok(false),
        }
    }

    fn is_idle(&self) -> bool {
        self.lockstep.is_idle()
    }
}

/// A built-in robot whose file has other text in some places.
fn robot<const N: usize>(name: &str, replaced: [[&str; 2]; N]) -> Robot {
    let text = BuiltIn::find(name).expect("a built-in robot").text;
    let text = replaced
        .iter()
        .fold(text.to_owned(), |text, [old, new]| text.replace(old, new));
    Robot::parse("arm.toml", &text).expect("a robot")
}

const HOMED_BY_HAND: [&str; 2] = ["[limits]", "[homing]\nmethod = \"given\"\n\n[limits]"];
const MIT: [&str; 2] = [
    "protocol = \"odrive\"",
    "protocol = \"mit\"\nposition_range = 12.5\nvelocity_range = 640.0\ntorque_range = 2.0",
];

/// Streams to the board of this robot and asserts that every bit is that of this process. Returns the twin's last word.
fn is_exact<P: SimulatedArm<Interface = I>, I: EmulatedDrives>(
    robot: &Robot,
    arm: P,
    (mode, policy, reach): (StreamMode, StreamPolicy, [f64; 2]),
) -> StreamProgress {
    let settings = robot.settings().expect("settings");
    let board = Emulator::start(&I::built_image()).expect("an emulated board");
    let (lockstep, _) = Lockstep::begin(board, &settings, &settings).expect("a start");
    let period = (f64::from(settings.control.tick_rate) / RATE).round() as u16;
    let mut target = Streamed {
        lockstep,
        config: StreamConfig {
            id: 7,
            mode,
            period,
            delay: DELAY as u16 * period,
            policy,
        },
        reach,
        ready: 0,
        begun: None,
        made: 0,
        done: [None; 2],
    };
    let dwell = Move {
        tag: 1,
        tool: FULL_TOOL,
        kind: MoveKind::Dwell { duration: 0.01 },
    };
    let simulation = Simulation::new(&mut target, arm, robot.control.tick_rate);
    let record = simulation.run(&[dwell], &[], &mut |_| ()).expect("a run");
    assert_eq!(record.faults, []);
    assert_eq!(target.lockstep.first_difference(), None);
    let [here, there] = target.done;
    assert_eq!(here, there, "what the stream has done");
    here.expect("a stream")
}

/// So far from the home angles [rad].
fn pose(robot: &Robot, off: [f64; 2]) -> Pose<f64> {
    robot.pose_near_home(off).expect("a pose")
}

const SMALL: (StreamMode, StreamPolicy, [f64; 2]) =
    (StreamMode::Joint, StreamPolicy::Stop, [0.05, -0.04]);

/// That points were taken, lost and late.
fn was_disturbed(progress: &StreamProgress) {
    assert_eq!(progress.last, Some(2 * POINTS), "{progress:?}");
    assert!(progress.lost >= 10 && progress.late >= 5, "{progress:?}");
}

#[test]
fn brushed_motors_follow_a_stream_with_the_bits_of_this_process() {
    let robot = robot("benchtop", []);
    let arm = || {
        let parameters = robot.plant_parameters().expect("masses");
        let pose = pose(&robot, [-0.01, 0.01]);
        Plant::new(&parameters, &Mismatch::default(), &pose, 7)
    };
    was_disturbed(&is_exact::<_, BrushedDrives>(&robot, arm(), SMALL));
    // Beyond the arm's reach, with both answers to it.
    let beyond = [0.0, 0.5];
    let tip = |policy| (StreamMode::Tip, policy, beyond);
    let kept = is_exact::<_, BrushedDrives>(&robot, arm(), tip(StreamPolicy::Limit));
    assert!(kept.limited > 10, "{kept:?}");
    let ended = is_exact::<_, BrushedDrives>(&robot, arm(), tip(StreamPolicy::Stop));
    assert!(ended.last < Some(POINTS), "{ended:?}");
}

#[test]
fn steppers_and_hobby_servos_follow_a_stream_with_the_bits_of_this_process() {
    let stepper = robot("benchtop_stepper", [HOMED_BY_HAND]);
    let parameters = stepper.plant_parameters().expect("masses");
    let motors = stepper.steppers().expect("steppers");
    let arm = StepperPlant::new(
        &parameters,
        &motors,
        &Mismatch::default(),
        &pose(&stepper, [0.0; 2]),
        7,
    );
    was_disturbed(&is_exact::<_, StepDrives>(&stepper, arm, SMALL));

    let servo = robot("classroom_servo", []);
    let parameters = servo.plant_parameters().expect("masses");
    let motors = servo.hobby_servos().expect("servos");
    let arm = HobbyServoPlant::new(
        &parameters,
        &motors,
        &Mismatch::default(),
        &pose(&servo, [0.0; 2]),
        7,
    );
    was_disturbed(&is_exact::<_, StepDrives>(&servo, arm, SMALL));
}

#[test]
fn drives_on_a_bus_follow_a_stream_with_the_bits_of_this_process() {
    for change in [["", ""], MIT] {
        let leg = robot("leg", [change]);
        let parameters = leg.plant_parameters().expect("masses");
        let bus = leg.can_bus().expect("a bus");
        let arm = CanPlant::new(
            &parameters,
            bus,
            &Mismatch::default(),
            &pose(&leg, [-0.01, 0.01]),
            7,
        );
        was_disturbed(&is_exact::<_, BusDrives>(&leg, arm, SMALL));
    }
}
