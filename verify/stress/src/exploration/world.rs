//! A controller with its planner and its session, its host and its arm. A clone of it goes on from
//! where it is.

use super::arm::{Disturbance, FollowingArm};
use super::history::{Broken, History};
use super::kind::ExploredDrives;
use super::view::{Outside, View};
use crate::rules::{Rules, Violation};
use crate::way_out::Machine;
use fivebar_firmware::controller::{ArmController, Request};
use fivebar_firmware::drives::Drives;
use fivebar_firmware::motion::{StreamConfig, StreamMode, StreamPoint, StreamPolicy};
use fivebar_firmware::protocol::{
    Board as Kind, CommandError, ControllerMessage, Decoder, HostCommand, HostMessage, Identity,
    Reply, Reset, Sequence, VERSION,
};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::session;
use fivebar_firmware::session::Board;
use fivebar_firmware::storage::StorageError;
use fivebar_firmware::{ActuatorCommand, Move, MoveKind, Planner, SensorSample, Settings, Status};

/// Ticks between two requests of the status.
const POLL: u32 = 50;
/// The host's stream: a point in each millisecond, 5 ms ahead.
const STREAM: StreamConfig = StreamConfig {
    id: 1,
    mode: StreamMode::Tip,
    period: 2,
    delay: 10,
    policy: StreamPolicy::Stop,
};
/// Ticks in which the zeros of the current sensors are measured with the bridges off.
const ZERO_TICKS: u32 = 64 + 2048;

/// A board that stores everything.
struct Flash;

impl<D: Drives> Board<D> for Flash {
    fn save(&mut self, _: &Settings) -> Result<(), StorageError> {
        Ok(())
    }

    fn tick(
        &mut self,
        _: &mut ArmController<D>,
        _: &SensorSample,
    ) -> Option<(ActuatorCommand, u32)> {
        None
    }
}

#[derive(Clone)]
pub(super) struct World<D: ExploredDrives> {
    controller: ArmController<D>,
    planner: Planner,
    session: session::Session,
    settings: Settings,
    arm: FollowingArm,
    rules: Rules,
    history: History,
    next: Sequence,
    ticks: u32,
    status: Status,
    command: ActuatorCommand,
    outside: Outside,
    /// The tick in which the host began its last stream, and the tool then [m].
    stream: (u32, [f32; 2]),
    /// Ticks with the bridges off.
    unpowered_for: u32,
    /// The view after the last tick, and how long it has lasted.
    view: (View, u32),
}

impl<D: ExploredDrives> World<D> {
    /// After power-up and the hello of a host.
    pub(super) fn new(has_settings: bool) -> Result<Self, Violation> {
        let settings = D::settings();
        let checked = settings.check().expect("the settings are valid");
        let controller = ArmController::<D>::new(&checked);
        let identity = Identity::new(Kind::Desktop, Reset::Power);
        let protection = &settings.protection;
        let rate = settings.control.tick_rate;
        let mut rules = Rules::with_timeout((protection.command_timeout * rate) as u32);
        rules.tool_off = settings.tool_output.off();
        rules.open_loop = D::OPEN_LOOP;
        let status = controller.status();
        let command = ActuatorCommand {
            brake: true,
            tool: settings.tool_output.off(),
            ..ActuatorCommand::default()
        };
        let outside = Outside {
            is_planned: true,
            stream: None,
            has_settings,
            is_silent: false,
            zeros_are_wrong: false,
            disturbance: None,
        };
        let snapshot = controller.planning_snapshot();
        let mut world = Self {
            planner: Planner::new(&checked),
            session: session::Session::new(identity, &checked, has_settings),
            settings,
            arm: FollowingArm::at_start(),
            rules,
            history: History::new((D::WAKE_UP_TIME * rate) as u32),
            next: Sequence(0),
            ticks: 0,
            status,
            command,
            outside,
            stream: (0, [0.0; 2]),
            unpowered_for: 0,
            view: (View::new(&status, &snapshot, &command, outside), 0),
            controller,
        };
        world.command(HostCommand::Hello {
            version: VERSION,
            session: 1,
        })?;
        world.tick(true, &mut |_| ())?;
        Ok(world)
    }

    pub(super) fn fresh_planner(&self) -> Planner {
        Planner::new(&self.settings.check().expect("the settings are valid"))
    }

    /// The view now.
    pub(super) fn view(&self) -> View {
        let (view, ticks) = self.view;
        view.aged(ticks)
    }

    pub(super) fn ticks(&self) -> u32 {
        self.ticks
    }

    pub(super) fn true_angles(&self) -> [f32; 2] {
        self.arm.angle.map(|angle| angle as f32)
    }

    /// Where the tool should be or is [m].
    pub(super) fn tool(&self) -> [f32; 2] {
        let Status {
            reference, tool, ..
        } = self.status;
        reference.or(tool).unwrap_or_default()
    }

    pub(super) fn disturb(&mut self, disturbance: Option<Disturbance>) {
        self.arm.disturb(disturbance, &self.settings);
        self.look();
    }

    pub(super) fn jump(&mut self) {
        self.arm.jump(&self.settings);
    }

    pub(super) fn miss(&mut self, ticks: u32) {
        self.arm.missed = ticks;
    }

    /// The board latches a fault.
    pub(super) fn latch(&mut self, fault: Fault) -> Result<(), Violation> {
        self.controller.latch_fault(fault);
        self.status = self.controller.status();
        let kept = self.history.step(&self.status, false);
        self.broken(kept)?;
        self.look();
        Ok(())
    }

    pub(super) fn send_move(
        &mut self,
        tool: u16,
        kind: MoveKind,
    ) -> Result<Option<CommandError>, Violation> {
        let tag = self.ticks;
        self.command(HostCommand::Move(Move { tag, tool, kind }))
    }

    /// The host sends a command with the next number. Returns why it was refused, if it was.
    pub(super) fn command(
        &mut self,
        command: HostCommand,
    ) -> Result<Option<CommandError>, Violation> {
        let sequence = self.next;
        let before = self.trace();
        let Some(reply) = self.answer(&HostMessage { sequence, command }) else {
            let kept = Err(("every command gets a reply", format!("{command:?}")));
            return self.broken(kept).map(|()| None);
        };
        self.next = sequence.next();
        let error = match reply {
            Reply::Refused(error) => Some(error),
            _ => None,
        };
        if error.is_some() {
            let after = self.trace();
            if before != after {
                let found = format!("{command:?}: {before:?} became {after:?}");
                self.broken(Err(("a refused order changes nothing", found)))?;
            }
        } else {
            if Self::powers(&command) && !self.outside.has_settings {
                let found = format!("{command:?}");
                self.broken(Err(("default settings power no motor", found)))?;
            }
            let kept = self.history.accepted(&command, &self.status);
            self.broken(kept)?;
            self.note(&command);
        }
        self.look();
        Ok(error)
    }

    /// Whether an executed command gives the drives power.
    fn powers(command: &HostCommand) -> bool {
        match command {
            HostCommand::Request(Request::Arm | Request::Home | Request::Excite(_)) => true,
            HostCommand::Request(Request::SetAngles(_)) => D::OPEN_LOOP,
            _ => false,
        }
    }

    /// What an executed command means for the rules and for what is known outside.
    fn note(&mut self, command: &HostCommand) {
        match command {
            powering if Self::powers(powering) => self.rules.permitted = true,
            HostCommand::Request(Request::EmergencyStop) => self.rules.permitted = false,
            HostCommand::Request(Request::ClearFault) => self.rules.cleared = true,
            HostCommand::ApplySettings => {
                (self.rules.permitted, self.rules.renewed) = (false, true);
                self.outside.has_settings = true;
                self.outside.zeros_are_wrong = false;
                self.unpowered_for = 0;
            }
            _ => {}
        }
    }

    /// The host begins a stream of set-points of this mode.
    pub(super) fn begin_stream(
        &mut self,
        mode: StreamMode,
        policy: StreamPolicy,
    ) -> Result<(), Violation> {
        let config = StreamConfig {
            mode,
            policy,
            ..STREAM
        };
        let begun = self.command(HostCommand::BeginStream(config))?;
        if begun.is_none() {
            self.stream = (self.status.tick, self.tool());
        }
        Ok(())
    }

    /// The host sends some points of its stream, which are due a delay later, to and fro by half a millimetre.
    pub(super) fn stream_points(&mut self, points: u16) -> Result<(), Violation> {
        let (begun, [x, y]) = self.stream;
        let period = u32::from(STREAM.period);
        let since = self.status.tick.wrapping_sub(begun) / period;
        for n in (since..).take(points.into()) {
            let (sine, cosine) = (0.2 * n as f32).sin_cos();
            let point = StreamPoint {
                id: STREAM.id,
                due: begun
                    .wrapping_add(n.wrapping_mul(period))
                    .wrapping_add(u32::from(STREAM.delay)),
                position: (x + 2.5e-4 * (1.0 - cosine), y),
                velocity: (0.05 * sine, 0.0),
                force: (0.0, 0.0),
            };
            self.send_point(n as u16, point)?;
        }
        Ok(())
    }

    /// The host sends a point whose number is infinite.
    pub(super) fn wrong_point(&mut self) -> Result<(), Violation> {
        let point = StreamPoint {
            id: STREAM.id,
            due: self.status.tick + u32::from(STREAM.delay),
            position: (f32::INFINITY, f32::INFINITY),
            velocity: (0.0, 0.0),
            force: (0.0, 0.0),
        };
        self.send_point(0, point)
    }

    fn send_point(&mut self, n: u16, point: StreamPoint) -> Result<(), Violation> {
        let (sequence, command) = (Sequence(n), HostCommand::Point(point));
        if let Some(reply) = self.answer(&HostMessage { sequence, command }) {
            let found = format!("{command:?}: {reply:?}");
            self.broken(Err(("a point gets no reply", found)))?;
        }
        let kept = self.history.step(&self.status, false);
        self.broken(kept)?;
        self.look();
        Ok(())
    }

    /// An emergency stop whose number is not the next one.
    pub(super) fn old_emergency_stop(&mut self) -> Result<(), Violation> {
        let sequence = Sequence(self.next.0.wrapping_sub(9));
        let command = HostCommand::Request(Request::EmergencyStop);
        let _ = self.answer(&HostMessage { sequence, command });
        self.rules.permitted = false;
        let kept = self.history.emergency_stopped(&self.status);
        self.broken(kept)?;
        let kept = self.history.step(&self.status, false);
        self.broken(kept)?;
        self.look();
        Ok(())
    }

    fn answer(&mut self, message: &HostMessage) -> Option<Reply> {
        self.rules.silence = 0;
        let (controller, planner) = (&mut self.controller, &mut self.planner);
        let frame = self
            .session
            .answer(message, controller, planner, &mut Flash);
        self.status = self.controller.status();
        let mut decoder = Decoder::new();
        match frame?.iter().find_map(|&byte| decoder.feed(byte)) {
            Some(Ok(ControllerMessage::Reply { reply, .. })) => Some(reply),
            _ => None,
        }
    }

    /// One tick. `polls`: the host asks for the status now and then.
    pub(super) fn tick(
        &mut self,
        polls: bool,
        seen: &mut impl FnMut(&Self),
    ) -> Result<(), Violation> {
        if polls && self.ticks.is_multiple_of(POLL) {
            self.command(HostCommand::Status)?;
        }
        if self.arm.disturbance != Some(Disturbance::LatePlanner) {
            self.planner.run(&mut self.controller);
            // The end of a crossing is judged here.
            self.status = self.controller.status();
            let kept = self.history.step(&self.status, false);
            self.broken(kept)?;
        }
        let sample = self.arm.sense(&self.settings);
        let command = self.controller.tick(&D::sample(&self.arm, &sample));
        self.command = D::seen(&command);
        self.status = self.controller.status();
        self.ticks += 1;
        self.rules
            .check(self.ticks, &sample, &self.command, &self.status)?;
        let snapshot = self.controller.planning_snapshot();
        self.history.path_is(snapshot.path_generation);
        let kept = self.history.ticked(&sample, &self.command, &self.status);
        self.broken(kept)?;
        let searches = matches!(self.status.state, State::Homing | State::Exciting);
        // Nothing moves while the drives wake up.
        let wake_up = (D::WAKE_UP_TIME * self.settings.control.tick_rate) as u32;
        if searches && self.rules.silence > self.rules.timeout.max(wake_up) + 2 {
            let rule = "a search and an excitation end for a silent host";
            self.broken(Err((rule, format!("{:?}", self.status.state))))?;
        }
        D::step(&mut self.arm, &command, &self.status, &self.settings);
        self.measure_zeros();
        let (view, ticks) = self.view;
        let now = self.seen_from_outside();
        self.view = (
            now,
            if now == view {
                ticks.saturating_add(1)
            } else {
                0
            },
        );
        seen(self);
        Ok(())
    }

    /// Follows when the controller judges the zeros of the current sensors.
    fn measure_zeros(&mut self) {
        if self.command.enable == [true; 2] {
            self.unpowered_for = 0;
            return;
        }
        self.unpowered_for += 1;
        if self.unpowered_for >= ZERO_TICKS {
            self.unpowered_for = 0;
            let disturbance = self.arm.disturbance;
            self.outside.zeros_are_wrong = matches!(
                disturbance,
                Some(Disturbance::WrongZero | Disturbance::OverCurrent)
            );
        }
    }

    /// Something happened between two ticks.
    fn look(&mut self) {
        let now = self.seen_from_outside();
        if now != self.view.0 {
            self.view = (now, 0);
        }
        self.history
            .path_is(self.controller.planning_snapshot().path_generation);
    }

    fn seen_from_outside(&self) -> View {
        let outside = Outside {
            is_planned: self.planner.is_empty(),
            stream: self.planner.stream().map(|stream| stream.phase),
            is_silent: self.rules.silence > self.rules.timeout,
            disturbance: self.arm.disturbance,
            ..self.outside
        };
        let snapshot = self.controller.planning_snapshot();
        View::new(&self.status, &snapshot, &self.command, outside)
    }

    /// All that an order could change.
    fn trace(&self) -> (Status, u32, f32, Option<(usize, bool)>) {
        let snapshot = self.controller.planning_snapshot();
        // Where no path is followed, and while brakes engage, the queue waits to be dropped.
        let follows = snapshot.hold.is_some() || snapshot.state == State::Running;
        let queue = follows.then(|| (self.planner.free_slots(), self.planner.is_empty()));
        (
            self.controller.status(),
            snapshot.path_generation,
            snapshot.path_left,
            queue,
        )
    }

    fn broken(&self, kept: Result<(), Broken>) -> Result<(), Violation> {
        kept.map_err(|(rule, found)| Violation::new(self.ticks, rule, found))
    }
}

impl<D: ExploredDrives> Machine for World<D> {
    fn send(&mut self, command: HostCommand) -> Result<Option<CommandError>, Violation> {
        self.command(command)
    }

    fn pass(&mut self, ticks: u32) -> Result<(), Violation> {
        (0..ticks).try_for_each(|_| self.tick(true, &mut |_| ()))
    }

    fn status(&self) -> Status {
        self.status
    }

    fn angles(&self) -> [f32; 2] {
        self.true_angles()
    }
}
