//! A stream of the mode Free: a hand leads the arm.

use crate::rig::{Rig, settings, with};
use fivebar_firmware::controller::Request;
use fivebar_firmware::motion::{StreamConfig, StreamMode, StreamPoint, StreamPolicy};
use fivebar_firmware::planner::{StreamError, StreamPhase, StreamReason};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::settings::{BeltSettings, Settings};
use fivebar_firmware::{Move, MoveKind};

/// The ticks of a millisecond.
const MS: u32 = 10;

/// An arm that a hand leads.
struct Led {
    rig: Rig,
    n: u16,
}

fn config() -> StreamConfig {
    StreamConfig {
        id: 5,
        mode: StreamMode::Free,
        period: 100,
        delay: 200,
        policy: StreamPolicy::Stop,
    }
}

impl Led {
    fn begin(settings: &Settings) -> Self {
        let mut rig = Rig::armed(settings);
        let begun = rig.planner.begin_stream(&mut rig.controller, &config());
        assert_eq!(begun, Ok(()));
        assert_eq!(rig.controller.state(), State::Compliant);
        Self { rig, n: 0 }
    }

    /// A sign of life of the host, and a point.
    fn point(&mut self) {
        self.n += 1;
        let point = StreamPoint {
            id: 5,
            due: 0,
            position: (0.0, 0.0),
            velocity: (0.0, 0.0),
            force: (0.0, 0.0),
        };
        self.rig.controller.feed_host_timeout();
        self.rig
            .planner
            .take_point(&mut self.rig.controller, self.n, &point);
    }

    fn tick(&mut self) {
        self.rig.planner.run(&mut self.rig.controller);
        self.rig.tick_alone();
    }

    /// So many milliseconds, with a point every ten of them.
    fn run(&mut self, ms: u32) {
        for ms in 0..ms {
            if ms % 10 == 0 {
                self.point();
            }
            (0..MS).for_each(|_| self.tick());
        }
    }

    /// So many milliseconds without points, with other signs of life or without.
    fn without_points(&mut self, ms: u32, alive: bool) {
        for _ in 0..ms * MS {
            if alive {
                self.rig.controller.feed_host_timeout();
            }
            self.tick();
        }
    }

    fn state(&self) -> State {
        self.rig.controller.state()
    }

    fn stream(&self) -> (StreamPhase, Option<StreamReason>) {
        let progress = self.rig.planner.stream().unwrap();
        (progress.phase, progress.reason)
    }

    /// The greatest distance of a joint from where it was [rad].
    fn away(&self, from: [f64; 2]) -> f64 {
        let [theta1, theta4] = self.rig.bench.theta;
        (theta1 - from[0]).abs().max((theta4 - from[1]).abs())
    }

    /// The tool's speed [m/s].
    fn speed(&mut self) -> f64 {
        let before = self.rig.bench.tool();
        self.tick();
        let after = self.rig.bench.tool();
        (after[0] - before[0]).hypot(after[1] - before[1]) / 1e-4
    }
}

/// The benchtop arm that stands upright: its weight acts in its plane.
fn upright() -> Settings {
    with(|settings| settings.gravity = [0.0, -9.81])
}

#[test]
fn a_hand_moves_the_arm_and_it_stays_where_the_hand_leaves_it() {
    for settings in [settings(), upright()] {
        let mut led = Led::begin(&settings);
        let from = led.rig.bench.theta;
        led.run(300);
        assert!(
            led.away(from) < 2e-3,
            "it moves by itself: {}",
            led.away(from)
        );
        led.rig.bench.push = [0.02, -0.02];
        led.run(100);
        led.rig.bench.push = [0.0; 2];
        assert!(led.away(from) > 0.05, "{}", led.away(from));
        led.run(700);
        let left = led.rig.bench.theta;
        led.run(500);
        assert!(led.away(left) < 2e-3, "it drifts: {}", led.away(left));
        assert_eq!(led.state(), State::Compliant);
    }
}

#[test]
fn the_arm_coasts_farther_than_with_all_of_its_friction() {
    let [with_share, with_all] = [true, false].map(|yields| {
        let mut led = Led::begin(&settings());
        led.rig.bench.push = [0.03, 0.0];
        led.run(60);
        led.rig.bench.push = [0.0; 2];
        if !yields {
            led.rig.controller.request(Request::Disarm).unwrap();
        }
        let from = led.rig.bench.theta;
        led.run(500);
        led.away(from)
    });
    assert!(
        with_share > 2.0 * with_all && with_all > 0.02,
        "{with_share} {with_all}"
    );
}

#[test]
fn walls_and_damping_keep_what_the_motors_can_bear_within_limits_and_speed() {
    let settings = upright();
    for push in [
        [0.15, 0.0],
        [-0.15, 0.0],
        [0.0, 0.15],
        [0.0, -0.15],
        [0.15, -0.15],
    ] {
        let mut led = Led::begin(&settings);
        led.rig.bench.push = push;
        let mut fastest = 0.0_f64;
        for ms in 0..3000 {
            if ms % 10 == 0 {
                led.point();
            }
            for _ in 0..MS {
                fastest = fastest.max(led.speed());
            }
            assert_eq!(
                led.state(),
                State::Compliant,
                "{push:?} {ms}: {:?}",
                led.rig.controller.fault()
            );
        }
        assert!(fastest < 0.3, "{push:?}: {fastest} m/s");
        assert!(fastest > 0.1, "{push:?}: {fastest} m/s");
        for (theta, axis) in led.rig.bench.theta.into_iter().zip(&settings.axes) {
            let [low, high] = axis.angle_limits.map(f64::from);
            assert!(low < theta && theta < high, "{push:?}: {theta}");
        }
    }
}

#[test]
fn the_arm_is_damped_without_points_and_goes_on_with_them() {
    let mut led = Led::begin(&settings());
    led.rig.bench.push = [0.04, 0.0];
    led.run(100);
    let fast = led.speed();
    assert!(fast > 0.1, "{fast}");
    led.without_points(45, true);
    assert_eq!(led.stream().0, StreamPhase::Starved);
    let slow = led.speed();
    assert!(slow < 0.02, "{slow}");
    led.run(100);
    assert_eq!(led.stream(), (StreamPhase::Follows, None));
    let fast = led.speed();
    assert!(fast > 0.1, "{fast}");
}

#[test]
fn the_arm_is_held_where_points_have_not_come_for_long() {
    let mut led = Led::begin(&settings());
    led.rig.bench.push = [0.04, 0.0];
    led.run(100);
    led.without_points(200, true);
    assert_eq!(led.state(), State::Armed);
    assert_eq!(
        led.stream(),
        (StreamPhase::Ended, Some(StreamReason::Silent))
    );
    let held = led.rig.bench.theta;
    led.without_points(300, true);
    assert!(led.away(held) < 2e-3, "{}", led.away(held));
    // It moves as before.
    let [x, y] = led.rig.tool_position();
    let kind = MoveKind::Line {
        to: [x + 0.01, y],
        feed: 0.1,
    };
    let (tag, tool) = (1, 0);
    let pushed = led
        .rig
        .planner
        .push(&mut led.rig.controller, &Move { tag, tool, kind });
    assert_eq!(pushed, Ok(()));
    led.without_points(400, true);
    let [after, _] = led.rig.tool_position();
    assert!((after - x - 0.01).abs() < 1e-4, "{after} {x}");
}

#[test]
fn a_silent_host_is_fault_12_and_the_arm_is_held() {
    let mut led = Led::begin(&upright());
    led.rig.bench.push = [0.04, 0.0];
    led.run(100);
    led.without_points(88, false);
    assert_eq!(led.state(), State::Compliant);
    led.without_points(10, false);
    let fault = led.rig.controller.fault().map(|snapshot| snapshot.fault);
    assert_eq!(fault, Some(Fault::CommandTimeout));
    let held = led.rig.bench.theta;
    led.without_points(300, false);
    assert!(led.away(held) < 5e-3, "{}", led.away(held));
    let fault = led.rig.controller.fault().map(|snapshot| snapshot.fault);
    assert_eq!(fault, Some(Fault::CommandTimeout));
}

#[test]
fn a_stop_and_the_end_of_the_stream_damp_the_arm_and_hold_it() {
    for asked in [true, false] {
        let mut led = Led::begin(&upright());
        led.rig.bench.push = [0.04, 0.0];
        led.run(100);
        if asked {
            led.rig.planner.end_stream(StreamReason::Asked);
        } else {
            led.rig.controller.request(Request::Stop).unwrap();
        }
        led.without_points(45, true);
        let slow = led.speed();
        assert!(slow < 0.02, "{slow}");
        assert_eq!(led.state(), State::Compliant);
        // Points do not let it go on.
        led.point();
        led.without_points(200, true);
        assert_eq!(led.state(), State::Armed);
        let reason = if asked {
            StreamReason::Asked
        } else {
            StreamReason::Stopped
        };
        assert_eq!(led.stream(), (StreamPhase::Ended, Some(reason)));
    }
}

#[test]
fn an_emergency_stop_and_a_disarm_switch_off_at_once() {
    let mut led = Led::begin(&settings());
    led.run(50);
    led.rig.controller.request(Request::Disarm).unwrap();
    assert_eq!(led.state(), State::Stopped);
    let mut led = Led::begin(&settings());
    led.run(50);
    led.rig.bench.overlay.emergency_stop = true;
    let command = led.rig.tick_alone();
    assert_eq!(command.enable, [false; 2]);
    let fault = led.rig.controller.fault().map(|snapshot| snapshot.fault);
    assert_eq!(fault, Some(Fault::EmergencyStop));
    led.tick();
    assert_eq!(
        led.stream(),
        (StreamPhase::Ended, Some(StreamReason::Stopped))
    );
}

#[test]
fn moves_are_refused_meanwhile_and_arms_on_belts_or_with_late_torques_give_way_to_no_hand() {
    let mut led = Led::begin(&settings());
    let kind = MoveKind::Dwell { duration: 0.1 };
    let (tag, tool) = (1, 0);
    let pushed = led
        .rig
        .planner
        .push(&mut led.rig.controller, &Move { tag, tool, kind });
    assert!(pushed.is_err());
    let again = led
        .rig
        .planner
        .begin_stream(&mut led.rig.controller, &config());
    assert_eq!(again, Err(StreamError::State(State::Compliant)));
    let belts = with(|settings| {
        settings.belts = [BeltSettings {
            stiffness: 30.0,
            bandwidth: 100.0,
            damping_ratio: 1.0,
            ..BeltSettings::RIGID
        }; 2];
    });
    let mut rig = Rig::armed(&belts);
    let begun = rig.planner.begin_stream(&mut rig.controller, &config());
    assert_eq!(begun, Err(StreamError::Belts));
    let late = with(|settings| {
        settings
            .axes
            .iter_mut()
            .for_each(|axis| axis.encoder_latency = 2.5e-3);
    });
    let mut rig = Rig::armed(&late);
    let begun = rig.planner.begin_stream(&mut rig.controller, &config());
    assert_eq!(begun, Err(StreamError::LateTorque));
}
