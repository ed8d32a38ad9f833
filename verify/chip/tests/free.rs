//! A hand leads the arm of the production image.

mod bench;

use bench::{Bench, Driven, arm_at, robot};
use fivebar_chip::Options;
use fivebar_chip::time::MILLISECOND;
use fivebar_firmware::Request;
use fivebar_firmware::motion::{StreamConfig, StreamMode, StreamPolicy};
use fivebar_firmware::protocol::HostCommand;
use fivebar_firmware::safety::State;
use fivebar_sim::drive::Drive;
use nalgebra::Vector2;

/// Ticks per second.
const TICK_RATE: f64 = 10_000.0;
/// What the hand pulls with [N].
const PULL: f64 = 1.5;

fn armed() -> Driven {
    let [x, y] = robot().best_point().expect("a point");
    let arm = arm_at([x as f32, y as f32], MILLISECOND);
    let mut driven = Bench::of(arm, Options::default(), Vec::new()).ready();
    driven.arm();
    driven
}

fn tool(driven: &mut Driven) -> Vector2<f64> {
    let [x, y] = driven.status().tool.expect("a position").map(f64::from);
    Vector2::new(x, y)
}

#[test]
fn an_arm_gives_way_to_a_hand_stays_without_one_and_is_held_afterwards() {
    let mut driven = armed();
    let (before, arm) = (tool(&mut driven), driven.arm.clone());
    let mut states = 0;
    let mut drive = Drive::new(&mut driven.client, &|| false);
    let led = drive.be_led(TICK_RATE, &mut |state| {
        states += 1;
        let pull = if (20..50).contains(&states) {
            PULL
        } else {
            0.0
        };
        arm.get().pull_tool(Vector2::new(pull, 0.0));
        assert!(state.velocity.iter().all(|speed| speed.abs() < 20.0));
        states < 90
    });
    led.expect("a hand leads the arm");
    let status = driven.status();
    assert_eq!((status.state, status.fault), (State::Armed, None));
    let pulled = tool(&mut driven) - before;
    assert!(
        pulled.x > 5e-3 && pulled.y.abs() < 2.0 * pulled.x,
        "{pulled}"
    );
    // Held again: the same pull moves it by the little that the loop gives way.
    let held = tool(&mut driven);
    driven.arm.get().pull_tool(Vector2::new(PULL, 0.0));
    driven.run(300 * MILLISECOND);
    let given = (tool(&mut driven) - held).norm();
    assert!(given < 1e-3, "{given} m");
}

#[test]
fn walls_hold_an_arm_that_a_hand_pulls_to_the_ends_of_its_reach() {
    for (x, y) in [(0.0, 1.0), (0.0, -1.0), (1.0, 0.0), (-1.0, 0.3)] {
        let mut driven = armed();
        let arm = driven.arm.clone();
        let mut states = 0;
        let mut farthest = 0.0_f64;
        let mut drive = Drive::new(&mut driven.client, &|| false);
        let led = drive.be_led(TICK_RATE, &mut |state| {
            states += 1;
            arm.get().pull_tool(Vector2::new(x, y));
            farthest = state
                .velocity
                .iter()
                .fold(farthest, |most, speed| most.max(f64::from(speed.abs())));
            states < 120
        });
        led.expect("a hand leads the arm");
        let status = driven.status();
        assert_eq!(
            (status.state, status.fault),
            (State::Armed, None),
            "{x} {y}"
        );
        assert!(farthest > 0.2 && farthest < 10.0, "{farthest} rad/s");
        for (angle, axis) in status.angle.into_iter().zip(&bench::settings().axes) {
            let [least, greatest] = axis.angle_limits;
            assert!(angle > least && angle < greatest, "{angle}");
        }
    }
}

#[test]
fn without_points_the_arm_is_held_and_an_emergency_stop_switches_off() {
    for stops in [false, true] {
        let mut driven = armed();
        let config = StreamConfig {
            id: 7,
            mode: StreamMode::Free,
            period: 100,
            delay: 200,
            policy: StreamPolicy::Stop,
        };
        let begun = driven.client.command(HostCommand::BeginStream(config));
        begun.expect("an answer").expect("a stream");
        assert_eq!(driven.status().state, State::Compliant);
        if stops {
            driven.request(Request::EmergencyStop).expect("a stop");
            let status = driven.status();
            assert!(status.fault.is_some() && driven.is_off(), "{status:?}");
            continue;
        }
        // The host lives, but leads no stream on.
        for _ in 0..20 {
            driven.run(20 * MILLISECOND);
            driven.status();
        }
        let status = driven.status();
        assert_eq!((status.state, status.fault), (State::Armed, None));
    }
}
