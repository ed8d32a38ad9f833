//! Points of a stream whose numbers may be anything: a fuzzer's, or random ones.

use crate::bytes::Bytes;
use crate::limits::{Followed, Limits};
use fivebar_firmware::controller::Controller;
use fivebar_firmware::motion::{StreamConfig, StreamMode, StreamPoint, StreamPolicy};
use fivebar_firmware::planner::StreamPhase;
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::settings::CheckedSettings;
use fivebar_firmware::{Planner, Request, Settings};
use fivebar_kinematics::five_bar::{Geometry, Side};
use fivebar_plant::{Mismatch, Parameters, Plant};

/// Where the arm begins, θ1 and θ4 [rad].
const START: [f64; 2] = [2.2, 0.9];
/// Ticks from one point to the next.
const PERIOD: u16 = 20;
/// Ticks of the delay.
const DELAY: u16 = 200;
/// The longest time in which an arm comes to rest [ticks].
const REST: u32 = 15_000;

/// What became of the points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PointsReport {
    /// Points that were given.
    pub given: u32,
    /// Ticks in which the arm followed one.
    pub followed: u32,
    /// Whether the arm was pressed out of its place by a force that nothing held.
    pub gave_way: bool,
}

/// The benchtop arm, simulated, with a stream.
struct Streamed {
    controller: Controller,
    planner: Planner,
    plant: Plant,
    limits: Limits,
    period: f64,
    report: PointsReport,
    /// Whether a point had a force.
    forced: bool,
}

/// Streams the points that bytes describe to the benchtop arm, in one of the modes Joint and Tip and with one of both policies, and
/// lets it come to rest.
///
/// # Errors
/// The rule that is broken, with its tick: the set-point leaves a limit, a fault other than an arm that gives way to the host's
/// force, or no rest.
///
/// # Panics
/// If the benchtop arm does not hold at its start.
pub fn run_points(bytes: &[u8]) -> Result<PointsReport, String> {
    let mut bytes = Bytes(bytes);
    let settings = Settings::BENCHTOP.check().expect("valid settings");
    let mut streamed = Streamed::held(&settings);
    let mode = [StreamMode::Joint, StreamMode::Tip][usize::from(bytes.flag())];
    let begun = streamed.planner.begin_stream(
        &mut streamed.controller,
        &StreamConfig {
            id: 1,
            mode,
            period: PERIOD,
            delay: DELAY,
            policy: [StreamPolicy::Stop, StreamPolicy::Limit][usize::from(bytes.flag())],
        },
    );
    begun.expect("a stream");
    let geometry = Geometry::new(settings.lengths.map(f64::from)).expect("an arm");
    let [theta1, theta4] = START;
    let tool = geometry
        .forward(theta1, theta4, Side::Left)
        .expect("a pose");
    let from = match mode {
        StreamMode::Joint => START,
        _ => [tool.c.x, tool.c.y],
    };
    let mut host = Host {
        place: from,
        velocity: [0.0; 2],
        due: streamed.controller.ticks() + u32::from(DELAY),
    };
    let mut n = 0_u16;
    while !bytes.is_empty() && streamed.controller.state() != State::Fault {
        let how = bytes.byte();
        n = n.wrapping_add(1 + u16::from(how >> 7));
        let point = host.point(&mut bytes);
        streamed.forced |= point.force != (0.0, 0.0);
        streamed
            .planner
            .take_point(&mut streamed.controller, n, &point);
        streamed.report.given += 1;
        streamed.ticks(u32::from(how & 0x1f))?;
    }
    streamed.come_to_rest()
}

/// A host whose motion wanders, with points that are sometimes anything.
struct Host {
    /// [rad or m], and its change [1/s].
    place: [f64; 2],
    velocity: [f64; 2],
    /// The tick of its next point.
    due: u32,
}

impl Host {
    /// The next point.
    fn point(&mut self, bytes: &mut Bytes<'_>) -> StreamPoint {
        let period = f64::from(PERIOD) * 1e-4;
        for (place, rate) in self.place.iter_mut().zip(&mut self.velocity) {
            let before = *rate;
            *rate += f64::from(bytes.within(-0.02, 0.02));
            *place += 0.5 * period * (before + *rate);
        }
        self.due = self.due.wrapping_add(u32::from(PERIOD));
        let mut point = StreamPoint {
            id: 1,
            due: self.due,
            position: self.place.map(|place| place as f32).into(),
            velocity: self.velocity.map(|rate| rate as f32).into(),
            force: (0.0, 0.0),
        };
        match bytes.byte() {
            0 => point.position = bytes.pair(-0.2, 2.5).into(),
            1 => point.velocity = bytes.pair(-10.0, 10.0).into(),
            2 => point.due = bytes.word(),
            3 => point.due = point.due.wrapping_sub(bytes.short().into()),
            4..=9 => point.force = bytes.pair(-1.0, 1.0).into(),
            _ => {}
        }
        point
    }
}

impl Streamed {
    /// Held at its start.
    fn held(settings: &CheckedSettings) -> Self {
        let geometry = Geometry::new(settings.lengths.map(f64::from)).expect("an arm");
        let [theta1, theta4] = START;
        let pose = geometry
            .forward(theta1, theta4, Side::Left)
            .expect("a pose");
        let parameters = Parameters::from_settings(settings, 24.0).expect("masses");
        let mut streamed = Self {
            controller: Controller::new(settings),
            planner: Planner::new(settings),
            plant: Plant::new(&parameters, &Mismatch::NONE, &pose, 1),
            limits: Limits::new(settings).expect("an arm"),
            period: 1.0 / f64::from(settings.control.tick_rate),
            report: PointsReport::default(),
            forced: false,
        };
        streamed.tick();
        for request in [
            Request::SetAngles(START.map(|angle| angle as f32)),
            Request::Arm,
        ] {
            let accepted = streamed.controller.request(request);
            accepted.expect("an arm at rest");
        }
        (0..20).for_each(|_| streamed.tick());
        streamed
    }

    fn tick(&mut self) {
        self.controller.feed_host_timeout();
        self.planner.run(&mut self.controller);
        let command = self.controller.tick(&self.plant.sense());
        self.plant.step(&command, self.period);
    }

    /// Runs so many ticks and looks at the limits in each.
    fn ticks(&mut self, count: u32) -> Result<(), String> {
        for _ in 0..count {
            self.tick();
            let status = self.controller.status();
            let now = self.controller.ticks();
            match status.fault {
                None => {}
                Some(Fault::FollowingError | Fault::Envelope) if self.forced => {
                    self.report.gave_way = true;
                    return Ok(());
                }
                Some(fault) => return Err(format!("tick {now}: {fault:?}")),
            }
            let snapshot = self.controller.planning_snapshot();
            let kept = self.limits.check(
                &status,
                Some(Followed::Timed),
                snapshot.path_generation,
                snapshot.assembly,
            );
            kept.map_err(|broken| format!("tick {now}: {broken}"))?;
            self.report.followed += u32::from(status.state == State::Running);
        }
        Ok(())
    }

    /// Gives no more points.
    fn come_to_rest(mut self) -> Result<PointsReport, String> {
        for _ in 0..REST {
            let phase = self.planner.stream().map(|progress| progress.phase);
            if self.controller.state() != State::Running && phase != Some(StreamPhase::Follows) {
                return Ok(self.report);
            }
            self.ticks(1)?;
        }
        Err(format!("no rest: {:?}", self.planner.stream()))
    }
}
