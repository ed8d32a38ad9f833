//! The motor's equation: a current sensor that lies and an encoder that stops are found in time in every state
//! with power, and nothing sound is taken for them.

use crate::rig::{Bench, Rig, WAKING_TICKS, settings, with};
use fivebar_firmware::controller::{Excitation, Excited, Request};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::settings::{AxisSettings, Settings};
use fivebar_firmware::{FULL_TOOL, Move, MoveKind};

/// A current sensor's defect.
type Sensor = fn(f64) -> f64;
/// An arm in one of its states, by name.
type InState = (&'static str, fn() -> Rig);
/// A difference of a motor from its settings, by name.
type Change = (&'static str, fn(&mut AxisSettings));

/// An arm in each state with power whose current loops drive, a motion or a load on its joints in it.
const STATES: [InState; 6] = [
    ("holding against a load", holding),
    ("running", || drawing(&settings(), 0.2)),
    ("stopping", || {
        let mut rig = drawing(&settings(), 0.2);
        rig.controller.request(Request::Stop).unwrap();
        rig
    }),
    ("held under a fault", || {
        let mut rig = drawing(&settings(), 0.2);
        rig.controller.latch_fault(Fault::CommandTimeout);
        rig
    }),
    ("homing", homing),
    ("exciting by a current", || {
        let mut rig = Rig::new(&settings());
        let excitation = Excitation {
            joint: 0,
            of: Excited::Current,
            offset: 1.0,
            amplitude: 0.0,
            hold: 1,
            ticks: 10_000,
            current: 1.3,
            travel: 2.0,
        };
        rig.controller.request(Request::Excite(excitation)).unwrap();
        rig.run(WAKING_TICKS + 100);
        rig
    }),
];

fn holding() -> Rig {
    let mut rig = Rig::armed(&settings());
    // 1.6 A.
    rig.bench.push = [0.3, 0.0];
    rig.run(2000);
    rig
}

/// An arm that draws a line of 60 mm.
fn drawing(settings: &Settings, feed: f32) -> Rig {
    let mut rig = Rig::armed(settings);
    let [x, y] = rig.tool_position();
    let to = [x - 0.06, y];
    rig.push(3, MoveKind::Line { to, feed }).unwrap();
    rig.run(1500);
    rig
}

fn homing() -> Rig {
    let mut rig = Rig::new(&settings());
    rig.controller.request(Request::Home).unwrap();
    rig.run(WAKING_TICKS + 1500);
    assert_eq!(rig.controller.state(), State::Homing);
    rig
}

/// Runs until a fault, at most so many ticks; the tick in which it is latched, and how far joint 1 turned
/// until then [rad].
fn latched(rig: &mut Rig, within: u32) -> Option<(Fault, u32, f64)> {
    let start = rig.bench.theta[0];
    for tick in 1..=within {
        rig.tick();
        if let Some(fault) = rig.controller.fault()
            && fault.fault != Fault::CommandTimeout
        {
            return Some((fault.fault, tick, (rig.bench.theta[0] - start).abs()));
        }
    }
    None
}

#[test]
fn a_current_sensor_that_shows_nothing_or_the_reverse_is_found_within_20_ms_in_every_state() {
    let sensors: [(&str, Sensor); 4] = [
        ("dead", |_| 0.0),
        ("reversed", |i| -i),
        ("at its rail", |_| 5.9),
        ("stuck", |_| 0.7),
    ];
    for (state, begin) in STATES {
        for (name, sensor) in sensors {
            let mut rig = begin();
            rig.bench.current_sensor[0] = sensor;
            let found = latched(&mut rig, 200);
            println!("{state}, {name}: {found:?}");
            // An excitation ends by itself where its sensor shows too much.
            let ended = rig.controller.excitation_end().is_some();
            assert!(
                matches!(found, Some((Fault::CurrentSensor, ..))) || ended,
                "{state}, {name}: {found:?}"
            );
        }
    }
}

#[test]
fn a_sensor_with_half_or_a_quarter_of_its_gain_is_found_within_20_ms_under_more_than_the_continuous_current()
 {
    let sensors: [(&str, Sensor); 2] = [("half", |i| 0.5 * i), ("a quarter", |i| 0.25 * i)];
    for (name, sensor) in sensors {
        let mut rig = holding();
        rig.bench.current_sensor[0] = sensor;
        let found = latched(&mut rig, 200);
        println!("{name}: {found:?}");
        assert!(
            matches!(found, Some((Fault::CurrentSensor, ..))),
            "{name}: {found:?}"
        );
    }
}

/// Joint 1 turns at 1.6 to 0.3 rad/s. At 0.06 rad/s its error grows more slowly, and it is found after 16 ms.
#[test]
fn an_encoder_that_stops_in_motion_is_found_within_8_ms_and_a_twentieth_of_a_radian() {
    for (feed, within) in [(0.4, 80), (0.2, 80), (0.05, 80), (0.01, 200)] {
        let mut rig = drawing(&settings(), feed);
        println!("ω1 = {} rad/s", rig.bench.omega[0]);
        rig.bench.stuck_counts[0] = Some(rig.bench.sense().counts[0]);
        let found = latched(&mut rig, within);
        println!("{feed} m/s: {found:?}");
        assert!(
            matches!(found, Some((Fault::EncoderStuck, _, turned)) if turned < 0.05),
            "{feed} m/s: {found:?}"
        );
    }
}

#[test]
fn an_encoder_that_stops_while_homing_is_found_before_it_turns_a_twentieth_of_a_radian() {
    let mut rig = homing();
    println!("ω1 = {} rad/s", rig.bench.omega[0]);
    rig.bench.stuck_counts[0] = Some(rig.bench.sense().counts[0]);
    let found = latched(&mut rig, 160);
    println!("{found:?}");
    assert!(
        matches!(found, Some((Fault::EncoderStuck, _, turned)) if turned < 0.05),
        "{found:?}"
    );
}

#[test]
fn an_encoder_that_stops_at_rest_is_found_when_the_arm_is_to_move() {
    let mut rig = Rig::armed(&settings());
    rig.bench.stuck_counts[0] = Some(rig.bench.sense().counts[0]);
    assert_eq!(latched(&mut rig, 3000), None);
    let [x, y] = rig.tool_position();
    let to = [x - 0.06, y];
    rig.push(3, MoveKind::Line { to, feed: 0.2 }).unwrap();
    let found = latched(&mut rig, 1000);
    println!("{found:?}");
    assert!(
        matches!(found, Some((Fault::EncoderStuck, _, turned)) if turned < 0.05),
        "{found:?}"
    );
}

/// It has no back-EMF: its encoder is right.
#[test]
fn a_joint_that_jams_is_a_following_error_as_ever() {
    for feed in [0.2, 0.05] {
        let mut rig = drawing(&settings(), feed);
        rig.bench.jammed[0] = true;
        let found = latched(&mut rig, 2000);
        println!("{found:?}");
        assert!(
            matches!(found, Some((Fault::FollowingError, ..))),
            "{found:?}"
        );
    }
}

/// Settings that differ from the motors: the bench keeps the motors of the settings.
fn mistaken(change: impl Fn(&mut AxisSettings)) -> Settings {
    with(|settings| settings.axes.iter_mut().for_each(change))
}

#[test]
fn motors_that_differ_from_their_settings_are_sound() {
    let changes: [Change; 6] = [
        ("R as of hot copper", |axis| axis.resistance /= 1.4),
        ("R 10 % less", |axis| axis.resistance /= 0.9),
        ("k 10 % more", |axis| axis.torque_constant /= 1.1),
        ("k 10 % less", |axis| axis.torque_constant /= 0.9),
        ("L 30 % more", |axis| axis.inductance /= 1.3),
        ("L 30 % less", |axis| axis.inductance /= 0.7),
    ];
    for (name, change) in changes {
        for bus in [23.3, 24.0, 24.7] {
            let mut rig = Rig::armed(&mistaken(change));
            rig.bench = Bench::new(&settings());
            rig.run(1);
            // The sensor of the bus is wrong by up to 3 %.
            rig.bench.bus = bus;
            let [x, y] = rig.tool_position();
            for (tag, to) in [(3, [x - 0.06, y]), (4, [x, y])] {
                let (tool, kind) = (FULL_TOOL, MoveKind::Line { to, feed: 0.4 });
                let line = Move { tag, tool, kind };
                rig.planner.push(&mut rig.controller, &line).unwrap();
            }
            assert_eq!(latched(&mut rig, 6000), None, "{name}, {bus} V");
            // 4 A for a while, and a hand that lets go.
            rig.bench.push = [0.7, 0.0];
            assert_eq!(latched(&mut rig, 400), None, "{name}, {bus} V, pushed");
            rig.bench.push = [0.0; 2];
            assert_eq!(latched(&mut rig, 400), None, "{name}, {bus} V, let go");
        }
    }
}

/// The heat of the current that the voltage drives, not of the one that is shown.
#[test]
fn the_heat_of_a_motor_is_that_of_the_current_that_its_voltage_drives_if_its_sensor_shows_less() {
    let hot_after = |sensor: Sensor| {
        let mut rig = Rig::armed(&with(|s| {
            s.axes[1].continuous_current = 0.36;
            s.axes[1].thermal_time_constant = 0.5;
        }));
        rig.bench.push = [0.0, 0.1];
        rig.bench.current_sensor[1] = sensor;
        latched(&mut rig, 20_000)
    };
    // 0.53 A. What the second sensor shows, 0.33 A, would never be too hot; hot copper would have that current.
    for sensor in [|i| i, |i| 0.62 * i] {
        let found = hot_after(sensor);
        println!("{found:?}");
        assert!(
            matches!(found, Some((Fault::OverTemperature, ..))),
            "{found:?}"
        );
    }
}
