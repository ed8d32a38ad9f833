//! What can happen in a state of an exploration.

use super::arm::Disturbance;
use super::kind::ExploredDrives;
use super::world::World;
use crate::crossing_arm::CROSSING;
use crate::rules::Violation;
use crate::timed::timed_run;
use fivebar_firmware::controller::{Excitation, Excited, Request};
use fivebar_firmware::motion::{Impedance, StreamMode, StreamPolicy};
use fivebar_firmware::protocol::{BoardTest, HostCommand, Section, SectionKey, VERSION};
use fivebar_firmware::recorder::LogConfig;
use fivebar_firmware::safety::Fault;
use fivebar_firmware::{CrossingMove, FULL_TOOL, MoveKind, Settings, TimedMove};

/// θ1 at the start [rad].
const START: f32 = 2.16125;
/// A second place of the tool near the start [m].
const ASIDE: [f32; 2] = [0.06, 0.119];

/// An event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Event {
    /// The host sends this command.
    Command(HostCommand),
    /// The host asks for all that can be read.
    Read,
    /// An emergency stop arrives with the number of a command long ago.
    OldEmergencyStop,
    /// The host declares the joints to be where they are.
    DeclareAngles,
    /// A line to the other one of two places, or to 3 mm beside; the tool is at this level.
    Line(u16),
    /// A move of the joints by 0.01 rad.
    Joint,
    /// The first of this many pieces of a motion that the host has planned from the start.
    Timed(usize),
    /// The host begins a stream of set-points.
    BeginStream(StreamPolicy),
    /// The host lets a hand lead the arm.
    BeginFree,
    /// The host begins a stream with a spring at the tool, or changes it.
    BeginImpedance(Impedance),
    /// So many points of it.
    Points(u16),
    /// A point that is none.
    WrongPoint,
    /// The host's moves other than these.
    Move(MoveKind),
    /// This disturbance begins.
    Disturb(Disturbance),
    /// The disturbance ends.
    Undisturb,
    /// An encoder's counts jump.
    Jump,
    /// The controller misses ticks.
    Missed(u32),
    /// The board has found this fault.
    Latch(Fault),
    /// Time passes; the host asks for the status.
    Ticks(u32),
    /// Time passes until the zeros of the current sensors are judged.
    Zeros,
    /// Time passes until something can be seen, at most this many ticks.
    Until(u32),
    /// Time passes, and the host is silent.
    Silence(u32),
}

/// A spring that every arm of brushed motors may render.
const SPRING: Impedance = Impedance {
    stiffness: (5.0, 0.0, 5.0),
    damping: (0.01, 0.0, 0.01),
};

/// What becomes of it.
const SOFTER: Impedance = Impedance {
    stiffness: (2.0, 0.0, 4.0),
    damping: (0.0, 0.0, 0.0),
};

/// All events, those of the board's faults included.
pub(super) fn alphabet<D: ExploredDrives>() -> Vec<Event> {
    use Event::{
        BeginFree, BeginImpedance, BeginStream, Command, DeclareAngles, Disturb, Joint, Jump,
        Latch, Line, Missed, Move, OldEmergencyStop, Points, Read, Silence, Ticks, Timed,
        Undisturb, Until, WrongPoint, Zeros,
    };
    let requests = [
        Request::Arm,
        Request::Disarm,
        Request::Home,
        Request::SetAngles([9.0, 9.0]),
        Request::Stop,
        Request::EmergencyStop,
        Request::ClearFault,
        // As long as a host may be silent, and longer.
        Request::Excite(excitation(Excited::Current, 0.2, 40)),
        Request::Excite(excitation(Excited::Voltage, 0.05, 600)),
        Request::Excite(excitation(Excited::Voltage, 1e9, 40)),
    ];
    let hello = |session| HostCommand::Hello {
        version: VERSION,
        session,
    };
    let commands = [
        hello(1),
        hello(2),
        HostCommand::SetSection(Section::Payload(-1.0)),
        HostCommand::SetSection(Section::Link(9, Settings::BENCHTOP.links[0])),
        HostCommand::ApplySettings,
        HostCommand::SaveSettings,
        HostCommand::Telemetry { every: 7 },
        HostCommand::EndStream,
        HostCommand::BeginLog(LogConfig {
            signals: 0xff,
            every: 1,
            powered: true,
        }),
    ];
    let mut events = vec![Read, OldEmergencyStop, DeclareAngles];
    events.extend(requests.map(|request| Command(HostCommand::Request(request))));
    events.extend(commands.map(Command));
    events.extend([Line(0), Line(FULL_TOOL), Joint, Timed(1), Timed(usize::MAX)]);
    events.extend([
        BeginStream(StreamPolicy::Stop),
        BeginStream(StreamPolicy::Limit),
        BeginFree,
        BeginImpedance(SPRING),
        BeginImpedance(SOFTER),
        Points(3),
        Points(20),
        WrongPoint,
    ]);
    let to = [1.0, 1.0];
    let wrong = CrossingMove {
        law: [0.0; 3],
        ..CROSSING
    };
    events.extend(
        [
            MoveKind::Line { to, feed: 0.1 },
            MoveKind::Dwell { duration: 0.01 },
            MoveKind::Crossing(CROSSING),
            MoveKind::Crossing(wrong),
        ]
        .map(Move),
    );
    let felt = Disturbance::ALL.into_iter();
    events.extend(felt.filter(|&it| D::feels(it)).map(Disturb));
    events.extend([Undisturb, Jump, Missed(2), Missed(3)]);
    events.extend(Fault::all().map(Latch));
    events.extend([Ticks(1), Ticks(10), Zeros, Until(700), Silence(230)]);
    events
}

impl Event {
    /// Whether it is tried in a state with this fault. One fault of each response meets all
    /// disturbances and all other faults, the others some of them.
    pub(super) fn is_tried_under(self, fault: Option<Fault>) -> bool {
        let is_typical = |fault| {
            matches!(
                fault,
                Fault::EmergencyStop | Fault::CommandTimeout | Fault::EncoderJump
            )
        };
        let Some(latched) = fault else {
            return true;
        };
        match self {
            Self::Disturb(disturbance) => {
                disturbance == Disturbance::EmergencyStop || is_typical(latched)
            }
            Self::Latch(other) => is_typical(other) || is_typical(latched),
            _ => true,
        }
    }
}

fn excitation(of: Excited, offset: f32, ticks: u32) -> Excitation {
    Excitation {
        joint: 0,
        of,
        offset,
        amplitude: 0.0,
        hold: 1,
        ticks,
        current: 1.0,
        travel: 0.5,
    }
}

/// The pieces of a motion that the host has planned from the start.
pub(super) fn planned_run<D: ExploredDrives>(world: &World<D>) -> Vec<TimedMove> {
    let [x, y] = CROSSING.from;
    let planner = world.fresh_planner();
    (0..64)
        .map(|seed| timed_run(&crate::bytes_of(seed, 64), 1.5, [x, y], &planner))
        .find(|pieces| pieces.len() > 1)
        .unwrap_or_default()
}

impl<D: ExploredDrives> World<D> {
    /// Lets an event happen.
    ///
    /// # Errors
    /// The rule that it breaks.
    pub(super) fn happen(
        &mut self,
        event: Event,
        run: &[TimedMove],
        seen: &mut impl FnMut(&Self),
    ) -> Result<(), Violation> {
        match event {
            Event::Command(command) => self.command(command).map(drop),
            Event::Read => self.read(),
            Event::OldEmergencyStop => self.old_emergency_stop(),
            Event::DeclareAngles => {
                let angles = self.true_angles();
                let request = Request::SetAngles(angles);
                self.command(HostCommand::Request(request)).map(drop)
            }
            Event::Line(tool) => {
                let to = self.other_place();
                self.send_move(tool, MoveKind::Line { to, feed: 0.1 })
                    .map(drop)
            }
            Event::Joint => {
                let [theta1, theta4] = self.true_angles();
                let by = if theta1 > START { -0.01 } else { 0.01 };
                let to = [theta1 + by, theta4];
                self.send_move(0, MoveKind::Joint { to, speed: 0.5 })
                    .map(drop)
            }
            Event::Timed(pieces) => {
                for &piece in run.iter().take(pieces) {
                    if self.send_move(0, MoveKind::Timed(piece))?.is_some() {
                        break;
                    }
                }
                Ok(())
            }
            Event::BeginStream(policy) => self.begin_stream(StreamMode::Tip, policy),
            Event::BeginFree => self.begin_stream(StreamMode::Free, StreamPolicy::Stop),
            Event::BeginImpedance(spring) => {
                self.begin_stream(StreamMode::Impedance(spring), StreamPolicy::Stop)
            }
            Event::Points(points) => self.stream_points(points),
            Event::WrongPoint => self.wrong_point(),
            Event::Move(kind) => self.send_move(0, kind).map(drop),
            Event::Disturb(disturbance) => {
                self.disturb(Some(disturbance));
                Ok(())
            }
            Event::Undisturb => {
                self.disturb(None);
                Ok(())
            }
            Event::Jump => {
                self.jump();
                self.tick(true, seen)
            }
            Event::Missed(ticks) => {
                self.miss(ticks);
                self.tick(true, seen)
            }
            Event::Latch(fault) => self.latch(fault),
            Event::Ticks(ticks) => (0..ticks).try_for_each(|_| self.tick(true, seen)),
            Event::Zeros => {
                let before = self.view();
                let is_wrong = before.disturbance == Some(Disturbance::WrongZero);
                let changes = before.zeros_are_wrong != is_wrong && !before.has_power();
                let ticks = if changes { 2_200 } else { 0 };
                (0..ticks).try_for_each(|_| self.tick(true, seen))
            }
            Event::Until(most) => {
                let before = self.view();
                let most = if before.has_power() { most } else { 20 };
                for _ in 0..most {
                    self.tick(true, seen)?;
                    if self.view().aged(0) != before.aged(0) {
                        break;
                    }
                }
                Ok(())
            }
            Event::Silence(ticks) => (0..ticks).try_for_each(|_| self.tick(false, seen)),
        }
    }

    /// All commands that only read.
    fn read(&mut self) -> Result<(), Violation> {
        for command in [
            HostCommand::Status,
            HostCommand::Snapshot,
            HostCommand::GetSection(SectionKey::Homing),
            HostCommand::GetSection(SectionKey::Link(9)),
            HostCommand::Stack,
            HostCommand::Sample,
            HostCommand::ReadLog { from: 3 },
            HostCommand::ExcitationEnd,
            HostCommand::BoardTest(BoardTest::Facts),
        ] {
            self.command(command)?;
        }
        Ok(())
    }

    fn other_place(&self) -> [f32; 2] {
        let [x, y] = self.tool();
        let is_at = |[a, b]: [f32; 2]| (x - a).hypot(y - b) < 1e-3;
        if is_at(CROSSING.from) {
            ASIDE
        } else if is_at(ASIDE) {
            CROSSING.from
        } else {
            [x + 0.003, y]
        }
    }
}
