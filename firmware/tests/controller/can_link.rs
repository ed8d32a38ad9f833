//! The link to drives on a CAN bus: what it sends, and what it makes of answers.

use fivebar_firmware::Settings;
use fivebar_firmware::drives::can::mit::Ranges;
use fivebar_firmware::drives::can::{Frame, Frames, Link, Protocol, mit, odrive, watchdog};
use fivebar_firmware::drives::{DriveHealth, DriveStiffness, TorqueSetPoint};
use fivebar_firmware::settings::CheckedSettings;
use std::f32::consts::TAU;

/// The frames of a tick.
fn sent(link: &mut Link, enable: [bool; 2], set_point: &TorqueSetPoint) -> Frames {
    let mut frames = Frames::new();
    link.send(enable, set_point, &mut frames);
    frames
}

const NODES: [u8; 2] = [1, 2];
const MIT: Protocol = Protocol::Mit(Ranges {
    position: 12.5,
    velocity: 30.0,
    torque: 10.0,
});

fn settings() -> CheckedSettings {
    let mut settings = Settings::BENCHTOP;
    settings.control.tick_rate = 1000.0;
    settings.control.current_bandwidth = 350.0;
    settings.control.bandwidth = 80.0;
    settings.control.integral_rate = 20.0;
    settings.control.observer_bandwidth = 800.0;
    settings.axes[1].gear_ratio = -settings.axes[0].gear_ratio;
    settings.check().expect("settings")
}

fn link(protocol: Protocol) -> Link {
    Link::new(protocol, NODES, &settings())
}

/// What a drive sends: CANSimple's heartbeat, and its estimates at this position [turns].
fn heartbeat(node: u8, error: u32, state: u8) -> Frame {
    let [a, b, c, d] = error.to_le_bytes();
    Frame::new(u16::from(node) << 5 | 1, [a, b, c, d, state, 0, 0, 0])
}

fn estimates(node: u8, turns: f32) -> Frame {
    let [a, b, c, d] = turns.to_le_bytes();
    Frame::new(u16::from(node) << 5 | 9, [a, b, c, d, 0, 0, 0, 0])
}

/// An answer of an MIT-type drive in this state, in the middle of its ranges.
fn reply(node: u8, state: u8) -> Frame {
    Frame::new(0, [state << 4 | node, 0x80, 0, 0x80, 8, 0, 30, 30])
}

#[test]
fn an_answer_is_a_tick_old_and_grows_old_without_another() {
    let mut link = link(Protocol::Odrive);
    assert_eq!(link.sample(false).1.age, [u16::MAX; 2]);
    for node in NODES {
        link.receive(&heartbeat(node, 0, odrive::IDLE));
        link.receive(&estimates(node, 0.25));
    }
    let counts = Settings::BENCHTOP.axes[0].encoder_counts as i32 / 4;
    for age in 1..20 {
        let (counted, sample) = link.sample(false);
        assert_eq!(sample.age, [1, age]);
        assert_eq!(counted, [counts; 2]);
        link.receive(&estimates(1, 0.25));
        // Not a number, another drive, another message: no answers of drive 2.
        link.receive(&estimates(2, f32::NAN));
        link.receive(&estimates(3, 9.0));
        link.receive(&odrive::ask_for_estimates(2));
    }
    assert!(link.sample(true).1.bus_off);
}

#[test]
fn a_drive_whose_heartbeat_is_missing_is_silent() {
    let mut link = link(Protocol::Odrive);
    let mut ages = Vec::new();
    for tick in 0..100 {
        for node in NODES {
            link.receive(&estimates(node, 0.0));
            if tick % 10 == 0 && (node == 1 || tick < 30) {
                link.receive(&heartbeat(node, 0, odrive::CLOSED_LOOP));
            }
        }
        ages.push(link.sample(false).1.age);
    }
    // The last heartbeat of drive 2 is that of tick 20, and 1 tick old there: it is believed for 50 ms.
    let silent = ages.iter().position(|age| *age != [1, 1]);
    assert_eq!(silent, Some(20 + 50));
    assert!(ages[70..].iter().all(|age| *age == [1, u16::MAX]));
}

#[test]
fn a_late_answer_is_replaced_by_a_shaft_that_turns_on() {
    let mut link = link(Protocol::Odrive);
    let (mut moving, mut counted) = ([0; 8], Vec::new());
    moving[..4].copy_from_slice(&0.25_f32.to_le_bytes());
    moving[4..].copy_from_slice(&8.0_f32.to_le_bytes());
    link.receive(&heartbeat(1, 0, odrive::IDLE));
    link.receive(&Frame::new(1 << 5 | 9, moving));
    for _ in 0..4 {
        counted.push(link.sample(false).0[0]);
    }
    // 8 turns/s are 0.008 turns in a tick of 1 kHz; then the answer is too old to go on.
    let count = |turns: f32| (turns * Settings::BENCHTOP.axes[0].encoder_counts as f32).round();
    let wanted = [0.25, 0.258, 0.258, 0.258].map(|turns| count(turns) as i32);
    assert_eq!(counted, wanted);
}

#[test]
fn the_watchdog_of_a_drive_waits_for_the_ticks_that_may_be_missed_and_no_longer() {
    // Two of 1 ms may be missed, one is due, and a frame may come early in one tick and late in another.
    assert_eq!(watchdog(1000.0), 4e-3);
    assert_eq!(watchdog(500.0), 8e-3);
}

#[test]
fn a_clear_takes_the_place_of_commands_and_goes_to_those_who_know_it() {
    let clears = TorqueSetPoint {
        clear_errors: true,
        ..TorqueSetPoint::default()
    };
    let mut odrives = link(Protocol::Odrive);
    for node in NODES {
        odrives.receive(&heartbeat(node, 1 << 24, odrive::IDLE));
    }
    assert_eq!(odrives.sample(false).1.health, [DriveHealth::Error; 2]);
    let frames = sent(&mut odrives, [false; 2], &clears);
    assert_eq!(frames[..2], NODES.map(odrive::clear_errors));
    assert_eq!([frames[0].id, frames[1].id], [0x38, 0x58]);
    assert_eq!(frames.len(), 4);
    // Not in error until one tells it again in a frame that cannot be older than the order: after three ticks.
    for _ in 0..3 {
        odrives.receive(&heartbeat(2, 1 << 24, odrive::IDLE));
        assert_eq!(odrives.sample(false).1.health, [DriveHealth::Off; 2]);
    }
    odrives.receive(&heartbeat(2, 1 << 24, odrive::IDLE));
    let health = odrives.sample(false).1.health;
    assert_eq!(health, [DriveHealth::Off, DriveHealth::Error]);

    let mut pair = link(MIT);
    pair.receive(&reply(1, 0xD));
    pair.receive(&reply(2, 0));
    let frames = sent(&mut pair, [false; 2], &clears);
    // To drive 2, which tells no state, the frame would be a command of the greatest values.
    assert_eq!(frames[0], mit::clear_error(1));
    assert_eq!(frames[1], mit::enable(2, false));
}

#[test]
fn while_the_torque_is_limited_an_mit_type_drive_gets_no_spring_that_could_exceed_it() {
    // A step of 1250 rad over 65536 positions times the spring would be more than any limit of homing.
    let wide = Protocol::Mit(Ranges {
        position: 1250.0,
        velocity: 30.0,
        torque: 10.0,
    });
    let mut link = link(wide);
    let mut gains = |is_stiff: bool| {
        let set_point = TorqueSetPoint {
            is_stiff,
            ..TorqueSetPoint::default()
        };
        let data = sent(&mut link, [true; 2], &set_point)[0]
            .data
            .expect("data");
        let stiffness = u16::from(data[3] & 0xF) << 8 | u16::from(data[4]);
        let damping = u16::from(data[5]) << 4 | u16::from(data[6] >> 4);
        [stiffness, damping]
    };
    gains(false);
    assert_eq!(gains(false), [0; 2]);
    assert!(gains(true).iter().all(|&gain| gain > 0));
}

#[test]
fn odrives_are_started_in_order_and_stopped_until_they_tell_it() {
    let mut link = link(Protocol::Odrive);
    let set_point = TorqueSetPoint {
        torque: [0.3, 0.3],
        ahead: [0.02, 0.02],
        velocity: [2.0, 2.0],
        ..TorqueSetPoint::default()
    };
    for node in NODES {
        link.receive(&estimates(node, 0.5));
    }
    let [of, _] = DriveStiffness::of(&settings());
    let gear = settings().axes[0].gear_ratio;
    let starts = [
        odrive::set_mode(1),
        odrive::set_position_gain(1, of.stiffness / of.damping),
        odrive::set_velocity_gain(1, TAU * of.damping / (gear * gear)),
        odrive::set_axis_state(1, odrive::CLOSED_LOOP),
    ];
    for start in starts {
        let frames = sent(&mut link, [true; 2], &set_point);
        assert_eq!(frames.len(), 4);
        let (ours, theirs) = (frames[0].data.expect("data"), start.data.expect("data"));
        assert_eq!(frames[0].id, start.id);
        let single = |data: [u8; 8]| f32::from_le_bytes([data[0], data[1], data[2], data[3]]);
        let off = (single(ours) / single(theirs) - 1.0).abs();
        assert!(ours == theirs || off < 1e-5, "{ours:?} for {theirs:?}");
    }
    let frames = sent(&mut link, [true; 2], &set_point);
    // Where the drive is, and what the joint is to turn: backwards behind a negative gear.
    for (frame, (node, gear)) in frames.iter().zip([(1, gear), (2, -gear)]) {
        let turns = 0.5 + 0.02 * gear / TAU;
        let wanted = odrive::set_input(node, turns, 2.0 * gear / TAU, 0.3 / gear);
        assert_eq!(*frame, wanted);
    }
    assert_eq!(frames[2..], NODES.map(odrive::ask_for_estimates));
    // Drive 1 did not hear the order to stop.
    link.receive(&heartbeat(1, 0, odrive::CLOSED_LOOP));
    let idle = NODES.map(|node| odrive::set_axis_state(node, odrive::IDLE));
    assert_eq!(sent(&mut link, [false; 2], &set_point)[..2], idle);
    let feeds = odrive::set_input(2, 0.5, 0.0, 0.0);
    assert_eq!(
        sent(&mut link, [false; 2], &set_point)[..2],
        [idle[0], feeds]
    );
    link.receive(&heartbeat(1, 0, odrive::IDLE));
    let feeds = NODES.map(|node| odrive::set_input(node, 0.5, 0.0, 0.0));
    assert_eq!(sent(&mut link, [false; 2], &set_point)[..2], feeds);
}

#[test]
fn mit_type_drives_enter_follow_and_leave_and_are_told_to_leave_in_every_tick_without_power() {
    let mut link = link(MIT);
    let last = |frames: &[Frame]| [0, 1].map(|i| frames[i].data.expect("data")[7]);
    let set_point = TorqueSetPoint::default();
    assert_eq!(last(&sent(&mut link, [false; 2], &set_point)), [0xFD; 2]);
    assert_eq!(last(&sent(&mut link, [true; 2], &set_point)), [0xFC; 2]);
    let frames = sent(&mut link, [true; 2], &set_point);
    assert_eq!((frames.len(), [frames[0].id, frames[1].id]), (2, [1, 2]));
    // Torque 0 is in the middle of its range.
    assert_eq!(last(&frames), [0xFF; 2]);
    for _ in 0..3 {
        assert_eq!(last(&sent(&mut link, [false; 2], &set_point)), [0xFD; 2]);
    }
}

#[test]
fn a_drive_tells_its_state_and_one_that_never_does_is_believed() {
    let mut odrives = link(Protocol::Odrive);
    let mut others = link(MIT);
    let told = |link: &mut Link, frame: Frame| {
        link.receive(&frame);
        link.sample(false).1.health[0]
    };
    for (error, state, health) in [
        (0, odrive::IDLE, DriveHealth::Off),
        (0, odrive::CLOSED_LOOP, DriveHealth::Drives),
        (0x0100_0000, odrive::IDLE, DriveHealth::Error),
    ] {
        assert_eq!(told(&mut odrives, heartbeat(1, error, state)), health);
    }
    for (state, health) in [
        (0, DriveHealth::Drives),
        (1, DriveHealth::Drives),
        (0, DriveHealth::Off),
        (0xD, DriveHealth::Error),
    ] {
        assert_eq!(told(&mut others, reply(1, state)), health, "{state}");
    }
}
