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
use fivebar_firmware::planner::{MoveErrorKind, StreamProgress, StreamReason};
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
    /// What the image has sent an answer to, and the tick that it told; none: a state of a stream.
    commands: Vec<Option<(HostCommand, Option<u32>)>>,
    /// The points of a stream, with their numbers.
    points: Vec<(u16, StreamPoint)>,
    /// What the image told of it last.
    told: Option<StreamProgress>,
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
            told: None,
        }
    }

    fn call(&mut self, command: HostCommand) -> Reply {
        let before = self.driven.client.repeats();
        let reply = self.driven.client.call(command).expect("an answer");
        let repeats = self.driven.client.repeats() - before;
        // They came before the answer.
        while let Some(state) = self.driven.client.take_stream_state() {
            self.told = Some(state.progress);
            self.commands.push(None);
        }
        // What was refused has changed nothing.
        let kept = match reply {
            Reply::Refused(_) => HostCommand::Status,
            _ => command,
        };
        let tick = match &reply {
            Reply::Status { status, .. } if repeats == 0 => Some(status.tick),
            _ => None,
        };
        self.commands.push(Some((kept, tick)));
        // The repeat of a command changes nothing, either.
        let again = (0..repeats).map(|_| Some((HostCommand::Status, None)));
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

    /// The ticks before the image got its settings: from then on it counts.
    fn begins(&self) -> usize {
        let mut locked = 0;
        let mut sent = 0..self.sent_before;
        let mut commands = self.commands.iter();
        for &(at, step) in self.driven.chip().steps() {
            match step {
                Step::Locked => locked = at,
                Step::Sent if sent.next().is_none() => {
                    if let Some(Some((_, Some(tick)))) = commands.next() {
                        return locked - *tick as usize;
                    }
                }
                Step::Sent | Step::Planned | Step::Pointed => {}
            }
        }
        panic!("the image has told no tick")
    }

    /// Asserts that the controller here gives the image's duties in every tick, of which at least
    /// so many have the bridges on.
    fn assert_agrees(&self, least: usize) {
        let begins = self.begins();
        let (chip, arm) = (self.driven.chip(), self.driven.arm.get());
        let checked = self.settings.check().expect("valid settings");
        let mut here = Here::new(&checked, &arm.ticks, begins);
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
                    let answered = commands.next().expect("a command for each reply");
                    let Some((command, tick)) = answered else {
                        continue;
                    };
                    if let Some(tick) = tick {
                        assert_eq!(here.controller.status().tick, *tick, "a tick for each");
                    }
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
    settings: &'a CheckedSettings,
    /// The ticks before the image got these settings.
    begins: usize,
    ticks: &'a [Tick],
    /// Ticks so far.
    number: usize,
    /// What it gave in the last two ticks.
    given: [ActuatorCommand; 2],
    /// Ticks with the bridges on.
    compared: usize,
}

impl<'a> Here<'a> {
    fn new(settings: &'a CheckedSettings, ticks: &'a [Tick], begins: usize) -> Self {
        Self {
            controller: Controller::new(settings),
            settings,
            begins,
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
            if self.number == self.begins {
                self.controller = Controller::new(self.settings);
            }
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

/// Three quarters of a circle at 500 points a second. Points are lost, late and in a pause.
#[test]
fn a_stream_gives_the_duties_of_the_controller_in_this_process() {
    const PERIOD: u16 = 20;
    const POINTS: u16 = 150;
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
    let (radius, turns) = (5e-3_f32, 0.75 * TAU);
    let point = |n: u16| {
        let u = f32::from(n) / f32::from(POINTS);
        let (sine, cosine) = (turns * u * u * (3.0 - 2.0 * u)).sin_cos();
        let speed = radius * turns * 6.0 * u * (1.0 - u) * 500.0 / f32::from(POINTS);
        StreamPoint {
            id: 3,
            due: from + u32::from(DELAY) + u32::from(PERIOD) * u32::from(n),
            position: (x + radius * sine, y + radius * (1.0 - cosine)),
            velocity: (speed * cosine, speed * sine),
            force: (0.0, 0.0),
        }
    };
    for n in 0..=POINTS {
        recorder.driven.run(2 * MILLISECOND);
        // A pause that is shorter than the delay is bridged.
        if n % 17 == 16 || (60..65).contains(&n) {
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
    }
    assert_eq!(recorder.call(HostCommand::EndStream), Reply::Done);
    recorder.run(300 * MILLISECOND);
    let rest = recorder.status();
    assert_eq!(rest.state, State::Armed);
    let [end_x, end_y] = rest.tool.expect("a position");
    let off = (end_x - x + radius).hypot(end_y - y - radius);
    assert!(off < 5e-5, "{off} m");
    let told = recorder.told.expect("states of the stream");
    assert_eq!(told.last, Some(POINTS), "{told:?}");
    assert_eq!([told.late, told.lost, told.refused], [3, 16, 0]);
    recorder.request(Request::Disarm);
    recorder.run(40 * MILLISECOND);
    recorder.assert_agrees(6_000);
}
