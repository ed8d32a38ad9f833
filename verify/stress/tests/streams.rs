//! Streams that are cut in any tick end at rest within every limit: random arms near their limits and singularities.

use fivebar_firmware::controller::Controller;
use fivebar_firmware::motion::{StreamConfig, StreamMode, StreamPoint, StreamPolicy};
use fivebar_firmware::planner::{StreamPhase, StreamReason};
use fivebar_firmware::safety::State;
use fivebar_firmware::settings::{AxisSettings, CheckedSettings, MotionSettings};
use fivebar_firmware::{Planner, Request, Settings};
use fivebar_kinematics::five_bar::{Geometry, Side};
use fivebar_plant::{Mismatch, Parameters, Plant};
use fivebar_stress::limits::{Followed, Limits, Reached};
use fivebar_stress::{bytes_of, run_points};

/// Ticks of a millisecond.
const MS: u32 = 10;

/// Numbers of a seed.
struct Chance(std::vec::IntoIter<u8>);

impl Chance {
    fn within(&mut self, low: f64, high: f64) -> f64 {
        let word = u16::from_le_bytes([(); 2].map(|()| self.0.next().expect("enough bytes")));
        low + (high - low) * f64::from(word) / 65_535.0
    }

    fn pair(&mut self, low: f64, high: f64) -> [f64; 2] {
        [(); 2].map(|()| self.within(low, high))
    }
}

/// An arm somewhere near its limits, and a host that drives it on.
struct Case {
    settings: CheckedSettings,
    start: [f64; 2],
    mode: StreamMode,
    policy: StreamPolicy,
    /// Of the joints [rad/s²], or as far as the tool goes.
    push: [f64; 2],
    /// How long it pushes before it turns round [s].
    turns: f64,
    /// Ticks of a period, and periods of the delay.
    period: u32,
    delay: u32,
    /// The tick in which the host falls silent for the stream.
    cut: u32,
}

fn case(seed: u64) -> Option<Case> {
    let mut chance = Chance(bytes_of(seed, 128).into_iter());
    let start = [chance.within(1.2, 3.0), chance.within(0.1, 1.9)];
    let benchtop = Settings::BENCHTOP;
    let lengths = benchtop
        .lengths
        .map(|length| length * chance.within(0.8, 1.25) as f32);
    let speed = chance.within(5.0, 35.0) as f32;
    let acceleration = chance.within(100.0, 1000.0) as f32;
    let axis = |axis: AxisSettings, joint: usize, chance: &mut Chance| {
        let [below, above] = chance.pair(0.05, 1.0);
        AxisSettings {
            angle_limits: [(start[joint] - below) as f32, (start[joint] + above) as f32],
            home_angle: start[joint] as f32,
            max_speed: speed,
            max_acceleration: acceleration,
            ..axis
        }
    };
    let [axis1, axis4] = benchtop.axes;
    let settings = Settings {
        lengths,
        axes: [axis(axis1, 0, &mut chance), axis(axis4, 1, &mut chance)],
        gravity: [0.0, chance.within(-9.81, 0.0) as f32],
        motion: MotionSettings {
            singularity_margin: chance.within(0.08, 0.3) as f32,
            ..benchtop.motion
        },
        ..benchtop
    };
    let period = [10, 20, 50][chance.within(0.0, 2.99) as usize];
    Some(Case {
        settings: settings.check().ok()?,
        start,
        mode: [StreamMode::Joint, StreamMode::Tip][chance.within(0.0, 1.99) as usize],
        push: chance
            .pair(-0.8, 0.8)
            .map(|share| share * f64::from(acceleration)),
        turns: chance.within(0.02, 0.2),
        period,
        delay: chance.within(4.0, 20.0) as u32,
        cut: chance.within(50.0, 4_000.0) as u32,
        policy: [StreamPolicy::Stop, StreamPolicy::Limit][chance.within(0.0, 1.99) as usize],
    })
}

impl Case {
    /// Position and velocity of the host's motion at a time [s]: it pushes to one side, then to the other, and so on.
    fn at(&self, time: f64, tool: [f64; 2]) -> [[f32; 2]; 2] {
        let w = std::f64::consts::PI / self.turns;
        let (sine, cosine) = (w * time).sin_cos();
        // ∫∫ sin: it drifts away.
        let (way, rate) = ((time - sine / w) / w, (1.0 - cosine) / w);
        let (from, scale) = match self.mode {
            StreamMode::Joint => (self.start, 1.0),
            StreamMode::Tip | StreamMode::Free | StreamMode::Impedance(_) => (tool, 0.1),
        };
        let along = |axis: usize| scale * self.push[axis];
        [
            [0, 1].map(|axis| (from[axis] + along(axis) * way) as f32),
            [0, 1].map(|axis| (along(axis) * rate) as f32),
        ]
    }

    /// Streams, falls silent, and waits for the rest. None if the arm cannot begin there. Returns how near its limits it
    /// came, why its stream ended, and whether it moved when it was cut.
    fn run(&self, seed: u64) -> Option<(Reached, Option<StreamReason>, bool)> {
        let settings = &self.settings;
        let mut controller = Controller::new(settings);
        let mut planner = Planner::new(settings);
        let parameters = Parameters::from_settings(settings, 24.0).ok()?;
        let geometry = Geometry::new(settings.lengths.map(f64::from)).ok()?;
        let [theta1, theta4] = self.start;
        let pose = geometry.forward(theta1, theta4, Side::Left).ok()?;
        let mut plant = Plant::new(&parameters, &Mismatch::NONE, &pose, seed);
        let period = 1.0 / f64::from(settings.control.tick_rate);
        let mut tick = |controller: &mut Controller| {
            controller.feed_host_timeout();
            let command = controller.tick(&plant.sense());
            plant.step(&command, period);
        };
        tick(&mut controller);
        controller
            .request(Request::SetAngles(self.start.map(|angle| angle as f32)))
            .ok()?;
        controller.request(Request::Arm).ok()?;
        for _ in 0..20 {
            tick(&mut controller);
        }
        let config = StreamConfig {
            id: 1,
            mode: self.mode,
            period: self.period as u16,
            delay: (self.delay * self.period) as u16,
            policy: self.policy,
        };
        planner.begin_stream(&mut controller, &config).ok()?;
        let begun = controller.ticks();
        let mut limits = Limits::new(settings)?;
        let mut reached = Reached::default();
        let mut moved = false;
        for ticks in 0..self.cut + 1_500 * MS {
            if ticks < self.cut && ticks.is_multiple_of(self.period) {
                let time = f64::from(ticks) * period;
                let [position, velocity] = self.at(time, [pose.c.x, pose.c.y]);
                let due = begun + ticks + u32::from(config.delay);
                let id = config.id;
                let point = StreamPoint {
                    id,
                    due,
                    position: position.into(),
                    velocity: velocity.into(),
                    force: (0.0, 0.0),
                };
                planner.take_point(&mut controller, (ticks / self.period) as u16, &point);
            }
            planner.run(&mut controller);
            tick(&mut controller);
            let status = controller.status();
            assert_eq!(
                status.fault,
                None,
                "seed {seed}, tick {ticks}: {:?}",
                planner.stream()
            );
            let snapshot = controller.planning_snapshot();
            let kept = limits.check(
                &status,
                Some(Followed::Timed),
                snapshot.path_generation,
                snapshot.assembly,
            );
            match kept {
                Ok(now) => reached = reached.max(now),
                Err(broken) => panic!("seed {seed}, tick {ticks}: {broken}"),
            }
            moved |= ticks == self.cut && status.state == State::Running;
            let follows = planner.stream()?.phase == StreamPhase::Follows;
            if ticks > self.cut && status.state == State::Armed && !follows {
                break;
            }
        }
        assert_eq!(controller.state(), State::Armed, "seed {seed}");
        let progress = planner.stream()?;
        assert_ne!(progress.phase, StreamPhase::Follows, "seed {seed}");
        Some((reached, progress.reason, moved))
    }
}

/// Cuts the streams of so many cases; all that can begin end at rest within every limit.
fn cut(cases: u64) {
    let (mut sum, mut begun, mut moved, mut limited) = (Reached::default(), 0, 0, 0);
    for seed in 0..cases {
        let Some((reached, reason, moves)) = case(seed).and_then(|case| case.run(seed)) else {
            continue;
        };
        begun += 1;
        sum = sum.max(reached);
        moved += u32::from(moves);
        limited += u32::from(matches!(reason, Some(StreamReason::Limit(_))));
    }
    println!(
        "{begun} of {cases} begun, {moved} moved when they were cut, {limited} were stopped at a limit: {sum:?}"
    );
    let cases = cases as u32;
    assert!(
        3 * begun > cases && 4 * moved > begun && 10 * limited > begun,
        "{begun} {moved} {limited}"
    );
    assert!(
        sum.margin > 0.97 && sum.joint_acceleration > 0.9 && sum.torque > 0.9,
        "{sum:?}"
    );
}

#[test]
fn streams_that_are_cut_in_any_tick_end_at_rest_within_every_limit() {
    cut(150);
}

/// A long row: `cargo test -p fivebar-stress --test streams -- --ignored`.
#[test]
#[ignore = "ten thousand arms take minutes"]
fn streams_of_ten_thousand_arms_end_at_rest_within_every_limit() {
    cut(10_000);
}

/// Most begin to move: points of which nothing is followed would show nothing.
#[test]
fn points_with_any_numbers_leave_the_arm_within_its_limits_and_at_rest() {
    let (mut moved, mut given) = (0, 0);
    for seed in 0..300 {
        let report = run_points(&bytes_of(seed, 600))
            .unwrap_or_else(|broken| panic!("seed {seed}: {broken}"));
        moved += u32::from(report.followed > 0);
        given += report.given;
    }
    assert!(
        moved > 100 && given > 3000,
        "{moved} of 300 moved, {given} points"
    );
}
