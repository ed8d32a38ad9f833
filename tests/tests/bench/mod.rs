//! The simulated arm, a controller at the other end of a line, and a twin of that controller in
//! this process. Both get the same commands, and every reply must have the same bits, with every
//! tick's duties, state and estimates.

#![allow(dead_code, reason = "each test file uses its own part")]

use fivebar_files::robot::Robot;
use fivebar_firmware::protocol::{
    CommandError, ControllerMessage, HostCommand, Reply, Sequence, StepResult, encode,
};
use fivebar_firmware::safety::{Fault, Response, State};
use fivebar_firmware::{FULL_TOOL, Move, MoveKind, Request, Settings, Status};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::Plant;
use fivebar_plant::{FaultKind, Mismatch};
use fivebar_sim::link::{Client, FaultInjector, FaultRates, Loopback};
use nalgebra::Vector2;
use std::io::{Read, Write};

/// A row of `docs/verify/data/injected_faults.csv`: what an injected fault leads to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stated {
    /// The fault that it raises.
    pub(crate) fault: Fault,
    /// The latest tick after the injection in which the fault is latched.
    pub(crate) within: u32,
    /// Ticks after that within which the arm comes to rest, if it is held.
    pub(crate) at_rest: Option<u32>,
}

/// The table that states what is tested.
const INJECTED: &str = include_str!("../../../docs/verify/data/injected_faults.csv");

/// The row of the table of injected faults that names this test.
#[track_caller]
pub(crate) fn stated(test: &str) -> Stated {
    let row = INJECTED
        .lines()
        .map(|line| line.split(',').collect::<Vec<_>>())
        .find(|cells| cells[4] == test)
        .unwrap_or_else(|| panic!("injected_faults.csv has no row of {test}"));
    let number = |cell: &str| cell.split(' ').find_map(|word| word.parse::<u32>().ok());
    let fault = number(row[1]).expect("the number of a fault");
    Stated {
        fault: Fault::try_from(fault as u8).expect("a known fault"),
        within: number(row[2]).expect("a count of ticks"),
        at_rest: number(row[3]),
    }
}

/// The requests that would move a stopped arm, or change what the controller assumes of it.
const REQUESTS: [Request; 5] = [
    Request::Arm,
    Request::Home,
    Request::SetAngles([2.2, 0.9]),
    Request::Stop,
    Request::Disarm,
];
/// Ticks between two signs of life of the host.
const TALK_EVERY: u32 = 400;

pub(crate) struct Bench<L> {
    pub(crate) board: Client<FaultInjector<L>>,
    twin: Client<Loopback>,
    pub(crate) plant: Plant,
    pub(crate) settings: Settings,
    /// The host gives signs of life.
    pub(crate) host_talks: bool,
    ticks: u32,
}

pub(crate) fn robot() -> Robot {
    Robot::load("benchtop").expect("a built-in robot")
}

/// The ends of a line of 60 mm in the middle of the workspace [m].
pub(crate) fn ends() -> [[f32; 2]; 2] {
    let [x, y] = robot().best_point().expect("a point").map(|x| x as f32);
    [[x + 0.03, y], [x - 0.03, y]]
}

impl<L: Read + Write> Bench<L> {
    /// Both controllers have the benchtop arm's settings; nothing is homed.
    pub(crate) fn new(line: L) -> Self {
        Self::with(line, FaultRates::default(), |_| ())
    }

    /// A line with these fault rates, and settings other than the benchtop arm's.
    pub(crate) fn with(line: L, rates: FaultRates, change: impl FnOnce(&mut Settings)) -> Self {
        let robot = robot();
        let mut settings = robot.settings().expect("masses");
        change(&mut settings);
        let [[x, y], _] = ends().map(|end| end.map(f64::from));
        let pose = robot
            .geometry
            .inverse(Vector2::new(x, y), robot.elbows)
            .expect("within reach");
        let parameters = robot.plant_parameters().expect("masses");
        let plant = Plant::new(&parameters, &Mismatch::default(), &pose, 7);
        Self::of(line, rates, settings, plant)
    }

    /// This arm with these settings, not homed.
    pub(crate) fn of(line: L, rates: FaultRates, settings: Settings, plant: Plant) -> Self {
        let twin = Loopback::lockstep(&settings).expect("valid settings");
        let (mut board, _) = Client::open(FaultInjector::new(line, rates, 1)).expect("a board");
        let (twin, _) = Client::open(twin).expect("a twin");
        board
            .write_settings(&settings)
            .expect("a line")
            .expect("valid settings");
        let mut bench = Self {
            board,
            twin,
            plant,
            settings,
            host_talks: true,
            ticks: 0,
        };
        bench.tick();
        bench
    }

    /// The arm moves along a line at 0.1 m/s with the tool down.
    pub(crate) fn moving(line: L) -> Self {
        Self::moving_on(line, FaultRates::default())
    }

    /// The same on a line with these fault rates.
    pub(crate) fn moving_on(line: L, rates: FaultRates) -> Self {
        let mut bench = Self::with(line, rates, |_| ());
        let angles = Joint::ALL.map(|joint| bench.plant.angle(joint) as f32);
        bench.is_done(HostCommand::Request(Request::SetAngles(angles)));
        bench.is_done(HostCommand::Request(Request::Arm));
        let reply = bench.ask(bench.a_move());
        assert!(matches!(reply, Reply::Taken { .. }), "{reply:?}");
        for _ in 0..480 {
            bench.tick();
        }
        bench.is_moving();
        bench
    }

    #[track_caller]
    pub(crate) fn is_moving(&mut self) {
        let status = self.status();
        assert_eq!((status.state, status.tool_level), (State::Running, 1.0));
        let speed = self.plant.model().tool_velocity(self.plant.state()).norm();
        assert!(speed > 0.09, "{speed} m/s");
    }

    /// A line to the other side.
    fn a_move(&self) -> HostCommand {
        let [_, to] = ends();
        let kind = MoveKind::Line { to, feed: 0.1 };
        HostCommand::Move(Move {
            tag: 1,
            tool: FULL_TOOL,
            kind,
        })
    }

    /// Injects a fault now.
    pub(crate) fn inject(&mut self, fault: FaultKind) {
        self.plant.inject(fault);
    }

    /// The reply, which must be the same from both.
    #[track_caller]
    pub(crate) fn ask(&mut self, command: HostCommand) -> Reply {
        let there = self.board.call(command).expect("an answer");
        let here = self.twin.call(command).expect("an answer");
        assert_eq!(
            bits(there),
            bits(here),
            "{command:?}: {there:?} on the board, {here:?} in this process"
        );
        there
    }

    #[track_caller]
    pub(crate) fn is_done(&mut self, command: HostCommand) {
        assert_eq!(self.ask(command), Reply::Done, "{command:?}");
    }

    #[track_caller]
    pub(crate) fn is_refused(&mut self, command: HostCommand) -> CommandError {
        match self.ask(command) {
            Reply::Refused(refusal) => refusal,
            other => panic!("{command:?}: {other:?}"),
        }
    }

    #[track_caller]
    pub(crate) fn status(&mut self) -> Status {
        match self.ask(HostCommand::Status) {
            Reply::Status { status, .. } => status,
            other => panic!("{other:?}"),
        }
    }

    /// One tick of arm and controllers.
    #[track_caller]
    pub(crate) fn tick(&mut self) -> StepResult {
        self.ticks += 1;
        if self.host_talks && self.ticks.is_multiple_of(TALK_EVERY) {
            self.status();
        }
        let sample = self.plant.sense();
        match self.ask(HostCommand::Tick(sample)) {
            Reply::StepResult(result) => {
                let period = 1.0 / f64::from(self.settings.control.tick_rate);
                self.plant.step(&result.command, period);
                let follows = matches!(result.state, State::Armed | State::Running);
                let tool = result.command.tool;
                assert!(follows || tool == 0, "the tool is on: {result:?}");
                result
            }
            other => panic!("{other:?}"),
        }
    }

    /// Runs ticks until the stated fault is latched, which must be in time; returns the tick that
    /// latched it.
    #[track_caller]
    pub(crate) fn faults(&mut self, stated: Stated) -> StepResult {
        for count in 1..=stated.within {
            let result = self.tick();
            if result.state == State::Fault {
                println!("{:?} in tick {count} of {}", result.fault, stated.within);
                assert_eq!(result.fault, Some(stated.fault));
                return result;
            }
            assert_eq!(result.fault, None);
        }
        panic!("no fault within {} ticks", stated.within);
    }

    /// The stated fault is latched in time and switches the bridges off in the same tick; no
    /// request switches them on until the fault is cleared.
    #[track_caller]
    pub(crate) fn powers_off(&mut self, stated: Stated) {
        assert_eq!(stated.fault.response(), Response::PowerOff);
        let result = self.faults(stated);
        self.stays_off(result);
        self.is_cleared();
    }

    #[track_caller]
    pub(crate) fn stays_off(&mut self, mut result: StepResult) {
        let fault = result.fault;
        for request in REQUESTS {
            for _ in 0..8 {
                assert_eq!((result.state, result.fault), (State::Fault, fault));
                is_off(&result);
                result = self.tick();
            }
            self.is_refused(HostCommand::Request(request));
            self.is_refused(self.a_move());
        }
    }

    /// The arm that is held under a fault stays held, bridges on, whatever is requested.
    #[track_caller]
    pub(crate) fn stays_held(&mut self) {
        let angles = |plant: &Plant| [plant.angle(Joint::Joint1), plant.angle(Joint::Joint4)];
        let held = angles(&self.plant);
        for request in REQUESTS {
            for _ in 0..20 {
                let result = self.tick();
                assert_eq!(result.state, State::Fault);
                assert_eq!(result.command.enable, [true; 2]);
                for (angle, held) in angles(&self.plant).into_iter().zip(held) {
                    assert!((angle - held).abs() < 1e-4, "{angle} after {held} rad");
                }
            }
            self.is_refused(HostCommand::Request(request));
            self.is_refused(self.a_move());
        }
    }

    /// Clearing the fault leads to Stopped.
    #[track_caller]
    pub(crate) fn is_cleared(&mut self) {
        self.is_done(HostCommand::Request(Request::ClearFault));
        let result = self.tick();
        assert_eq!((result.state, result.fault), (State::Stopped, None));
        is_off(&result);
    }
}

/// Duties exactly zero, bridges off, brake on.
#[track_caller]
pub(crate) fn is_off(result: &StepResult) {
    assert_eq!(
        result.command.drives.duty.map(f32::to_bits),
        [0; 2],
        "{result:?}"
    );
    assert_eq!(result.command.enable, [false; 2]);
    assert!(result.command.brake);
}

/// A reply byte by byte, without the instructions, which only one end counts.
fn bits(mut reply: Reply) -> Vec<u8> {
    if let Reply::StepResult(result) = &mut reply {
        result.instructions = 0;
    }
    let sequence = Sequence(0);
    let message = ControllerMessage::Reply { sequence, reply };
    encode(&message).expect("it came in a frame").to_vec()
}
