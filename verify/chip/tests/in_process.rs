//! The duties of the production image equal those of the controller in this process, to within
//! the rounding of a compare register, for the same samples, commands and paths.
//!
//! The controller here gets each of the image's samples. The simulated chip tells between which
//! ticks the image answered a command and gave its planner time, so that the controller here
//! gets the same path in front of the same tick.

mod bench;

use bench::{Bench, Driven, arm_before_home, gear, moves};
use fivebar_chip::time::{MILLISECOND, Time};
use fivebar_chip::{Options, Step, Tick};
use fivebar_files::robot::Robot;
use fivebar_firmware::motion::{StreamConfig, StreamMode, StreamPoint, StreamPolicy};
use fivebar_firmware::planner::{MoveErrorKind, StreamReason};
use fivebar_firmware::protocol::{CommandError, HostCommand, Reply};
use fivebar_firmware::safety::State;
use fivebar_firmware::settings::CheckedSettings;
use fivebar_firmware::{ActuatorCommand, Controller, Move, Planner, Request, Settings, Status};
use fivebar_kinematics::five_bar::Joint;
use rtic_core::Mutex;
use std::f32::consts::TAU;

/// Counts of half a PWM period.
const FULL: f32 = 4200.0;

/// A host that keeps in mind what it told the image.
struct Recorder {
    driven: Driven,
    settings: Settings,
    /// Frames that the image had sent before the first command here.
    sent_before: usize,
    /// What the image has sent an answer to; none: a state of a stream.
    commands: Vec<Option<HostCommand>>,
    /// The points of a stream, with their numbers.
    points: Vec<(u16, StreamPoint)>,
}

impl Recorder {
    /// With a built-in robot.
    fn of(robot: &str) -> Self {
        let robot = Robot::load(robot).expect("a built-in robot");
        let settings = robot.settings().expect("masses");
        let bench = Bench::of(arm_before_home(&robot, 0), Options::default(), Vec::new());
        bench.line.chip().trace();
        let driven = bench.ready_as(&settings);
        let is_sent = |(_, step): &&(usize, Step)| *step == Step::Sent;
        let sent_before = driven.chip().steps().iter().filter(is_sent).count();
        Self {
            driven,
            settings,
            sent_before,
            commands: Vec::new(),
            points: Vec::new(),
        }
    }

    fn call(&mut self, command: HostCommand) -> Reply {
        let before = self.driven.client.repeats();
        let reply = self.driven.client.call(command).expect("an answer");
        let repeats = self.driven.client.repeats() - before;
        // They came before the answer.
        while self.driven.client.take_stream_state().is_some() {
            self.commands.push(None);
        }
        // What was refused has changed nothing.
        let kept = match reply {
            Reply::Refused(_) => HostCommand::Status,
            _ => command,
        };
        self.commands.push(Some(kept));
        // The repeat of a command changes nothing, either.
        let again = (0..repeats).map(|_| Some(HostCommand::Status));
        self.commands.extend(again);
        reply
    }

    fn request(&mut self, request: Request) {
        assert_eq!(self.call(HostCommand::Request(request)), Reply::Done);
    }

    fn status(&mut self) -> Status {
        match self.call(HostCommand::Status) {
            Reply::Status { status, .. } => status,
            other => panic!("{other:?}"),
        }
    }

    fn state(&mut self) -> State {
        self.status().state
    }

    /// Sends a point of a stream.
    fn send(&mut self, n: u16, point: StreamPoint) {
        self.driven.client.send_point(n, &point).expect("the line");
        self.points.push((n, point));
    }

    /// Lets the image run; it hears of the host.
    fn run(&mut self, time: Time) {
        for _ in 0..time / (20 * MILLISECOND) {
            self.driven.run(20 * MILLISECOND);
            self.state();
        }
    }

    /// Hands the image moves as fast as it takes them, and waits for the end of the last one.
    fn stream(&mut self, moves: &[Move]) {
        for &next in moves {
            let full = |reply: Reply| match reply {
                Reply::Taken { .. } => false,
                Reply::Refused(CommandError::Move(error)) => {
                    assert_eq!(error.kind, MoveErrorKind::Full);
                    true
                }
                other => panic!("{other:?}"),
            };
            while full(self.call(HostCommand::Move(next))) {
                self.driven.run(5 * MILLISECOND);
            }
        }
        while self.state() == State::Running {
            self.driven.run(5 * MILLISECOND);
        }
    }

    /// Asserts that the controller here gives the image's duties in every tick, of which at least
    /// so many have the bridges on.
    fn assert_agrees(&self, least: usize) {
        let (chip, arm) = (self.driven.chip(), self.driven.arm.get());
        let checked = self.settings.check().expect("valid settings");
        let mut here = Here::new(&checked, &arm.ticks);
        let mut steps = chip.steps().iter().peekable();
        let (mut commands, mut points) = (self.commands.iter(), self.points.iter());
        let mut to_skip = self.sent_before;
        // The controller's last lock, in which a command acts.
        let mut locked = 0;
        let mut planner = Planner::new(&checked);
        while let Some(&(at, step)) = steps.next() {
            match step {
                Step::Planned => {
                    here.tick_up_to(at);
                    planner.run(&mut Locks {
                        here: &mut here,
                        steps: &mut steps,
                    });
                }
                Step::Locked => locked = at,
                Step::Pointed => {
                    eprintln!("point {at}: {:?}", steps.clone().take_while(|(_, step)| *step == Step::Locked).map(|(at, _)| at).collect::<Vec<_>>());
                    here.tick_up_to(at);
                    here.controller.feed_host_timeout();
                    let (n, point) = points.next().expect("a point");
                    let mut locks = Locks {
                        here: &mut here,
                        steps: &mut steps,
                    };
                    planner.take_point(&mut locks, *n, point);
                }
                Step::Sent if to_skip > 0 => to_skip -= 1,
                Step::Sent => {
                    here.tick_up_to(locked);
                    let Some(command) = commands.next().expect("a command for each reply") else {
                        continue;
                    };
                    here.controller.feed_host_timeout();
                    match command {
                        HostCommand::BeginStream(config) => {
                            let begun = planner.begin_stream(&mut here.controller, config);
                            begun.expect("a stream");
                        }
                        HostCommand::EndStream => planner.end_stream(StreamReason::Asked),
                        HostCommand::Request(request) => {
                            here.controller.request(*request).expect("accepted");
                        }
                        HostCommand::Move(next) => {
                            let pushed = planner.push(&mut here.controller, next);
                            pushed.expect("a valid move");
                        }
                        _ => {}
                    }
                }
            }
        }
        assert_eq!(commands.next(), None, "a reply for each command");
        assert_eq!(points.next(), None, "each point was taken");
        assert!(here.compared >= least, "{}", here.compared);
    }
}

/// The controller in this process.
struct Here<'a> {
    controller: Controller,
    ticks: &'a [Tick],
    /// Ticks so far.
    number: usize,
    /// What it gave in the last two ticks.
    given: [ActuatorCommand; 2],
    /// Ticks with the bridges on.
    compared: usize,
}

impl<'a> Here<'a> {
    fn new(settings: &CheckedSettings, ticks: &'a [Tick]) -> Self {
        Self {
            controller: Controller::new(settings),
            ticks,
            number: 0,
            given: [ActuatorCommand::default(); 2],
            compared: 0,
        }
    }

    /// Runs ticks on the image's samples, and compares each with the image's.
    fn tick_up_to(&mut self, end: usize) {
        for tick in &self.ticks[self.number.min(end)..end] {
            // The bridges follow in the next tick, the preloaded duties in the one after it.
            let [before_last, last] = self.given;
            let enabled = last.enable == [true; 2];
            let duty = before_last.drives.duty.map(|duty| match enabled {
                true => (duty * FULL).round() as i32,
                false => 0,
            });
            let differs = (0..2).any(|joint| (duty[joint] - tick.duty[joint]).abs() > 1);
            assert!(
                !differs && enabled == tick.enabled,
                "tick {}, after {} with the bridges on: {duty:?}, on the image {:?}",
                self.number,
                self.compared,
                tick.duty,
            );
            self.compared += usize::from(enabled);
            self.given = [last, self.controller.tick(&tick.sample)];
            self.number += 1;
        }
    }
}

/// Lets the planner here lock the controller between the same ticks as on the image.
struct Locks<'a, 'b, I: Iterator<Item = &'b (usize, Step)>> {
    here: &'a mut Here<'b>,
    steps: &'a mut std::iter::Peekable<I>,
}

impl<'b, I: Iterator<Item = &'b (usize, Step)>> Mutex for Locks<'_, 'b, I> {
    type T = Controller;

    fn lock<R>(&mut self, work: impl FnOnce(&mut Controller) -> R) -> R {
        let locked = self.steps.next_if(|(_, step)| *step == Step::Locked);
        // The record may end in the middle of a turn.
        if let Some(&(at, _)) = locked {
            self.here.tick_up_to(at);
        }
        work(&mut self.here.controller)
    }
}

#[test]
fn homing_gives_the_duties_of_the_controller_in_this_process() {
    let mut recorder = Recorder::of("benchtop");
    recorder.run(60 * MILLISECOND);
    recorder.request(Request::Home);
    recorder.run(400 * MILLISECOND);
    recorder.assert_agrees(3000);
}

#[test]
fn a_job_and_disarming_give_the_duties_of_the_controller_in_this_process() {
    draws_as_here("benchtop");
}

#[test]
fn on_belts_a_job_gives_the_duties_of_the_controller_in_this_process() {
    draws_as_here("benchtop_belt");
}

fn draws_as_here(robot: &str) {
    let mut recorder = Recorder::of(robot);
    assert_eq!(recorder.settings.is_on_belts(), robot == "benchtop_belt");
    recorder.run(60 * MILLISECOND);
    let arm = recorder.driven.arm.clone();
    let angles = Joint::ALL.map(|joint| arm.get().plant().angle(joint) as f32);
    recorder.request(Request::SetAngles(angles));
    recorder.request(Request::Arm);
    recorder.driven.run(5 * MILLISECOND);
    // Lines, arcs and a dwell; then the corners of a gear, more moves than the queue holds.
    let tooth = gear().into_iter().take(60);
    let job: Vec<_> = (1..)
        .zip(moves().into_iter().chain(tooth))
        .map(|(tag, next)| Move { tag, ..next })
        .collect();
    recorder.stream(&job);
    recorder.request(Request::Disarm);
    recorder.run(40 * MILLISECOND);
    recorder.assert_agrees(10_000);
}

/// A circle of the tip at 500 points a second, in which points are lost and late, then a pause and half a circle more.
#[test]
fn a_stream_gives_the_duties_of_the_controller_in_this_process() {
    const PERIOD: u16 = 20;
    const DELAY: u16 = 10 * PERIOD;
    let mut recorder = Recorder::of("benchtop");
    recorder.run(60 * MILLISECOND);
    let arm = recorder.driven.arm.clone();
    let angles = Joint::ALL.map(|joint| arm.get().plant().angle(joint) as f32);
    recorder.request(Request::SetAngles(angles));
    recorder.request(Request::Arm);
    recorder.run(60 * MILLISECOND);
    let status = recorder.status();
    let [x, y] = status.tool.expect("a position");
    let begin = HostCommand::BeginStream(StreamConfig {
        id: 3,
        mode: StreamMode::Tip,
        period: PERIOD,
        delay: DELAY,
        policy: StreamPolicy::Stop,
    });
    assert_eq!(recorder.call(begin), Reply::Done);
    let from = recorder.status().tick;
    let (radius, turn) = (5e-3_f32, 100.0);
    let point = |n: u16| {
        let (sine, cosine) = (TAU * f32::from(n) / turn).sin_cos();
        let speed = radius * TAU / turn * 500.0;
        let share = (f32::from(n) / 20.0).min(1.0);
        // Its middle rests while it grows, so that it begins at rest.
        let radius = radius * share;
        let slow = share * speed;
        StreamPoint {
            id: 3,
            due: from + u32::from(DELAY) + u32::from(PERIOD) * u32::from(n),
            position: (x + radius * sine, y + radius * (1.0 - cosine)),
            velocity: (slow * cosine, slow * sine),
            force: (0.0, 0.0),
        }
    };
    for n in 0..150 {
        recorder.driven.run(2 * MILLISECOND);
        // A pause that is longer than the delay: the arm slows down and goes on.
        if n % 17 == 16 || (100..112).contains(&n) {
            continue;
        }
        let late = if n % 31 == 30 {
            40 * u32::from(PERIOD)
        } else {
            0
        };
        let point = point(n);
        recorder.send(
            n,
            StreamPoint {
                due: point.due.wrapping_sub(late),
                ..point
            },
        );
        if n % 10 == 0 {
            recorder.state();
        }
    }
    assert_eq!(recorder.call(HostCommand::EndStream), Reply::Done);
    recorder.run(300 * MILLISECOND);
    assert_eq!(recorder.state(), State::Armed);
    recorder.request(Request::Disarm);
    recorder.run(40 * MILLISECOND);
    recorder.assert_agrees(6_000);
}
