//! An arm on a CAN bus against closed forms: when its drives sense and act, how stiff they are, and that they end their
//! torque by themselves.

use fivebar_firmware::Settings;
use fivebar_firmware::drives::can::mit::Ranges;
use fivebar_firmware::drives::can::odrive::{self, Message};
use fivebar_firmware::drives::can::{Frame, Protocol, sensed_after};
use fivebar_kinematics::five_bar::{Joint, Pose};
use fivebar_plant::{
    BusEvent, CanDrive, CanPlant, FaultKind, Mismatch, Parameters, Wires, bits_on_bus,
};
use nalgebra::Vector2;
use std::f64::consts::TAU;

const TICK: f64 = 1e-3;
const WATCHDOG: f64 = 2e-3;
const GEAR: f64 = 3.0;
const NODES: [u8; 2] = [1, 2];
const MIT: Ranges = Ranges {
    position: 12.5,
    velocity: 100.0,
    torque: 2.0,
};

fn parameters() -> Parameters {
    let mut settings = Settings::BENCHTOP;
    for axis in &mut settings.axes {
        axis.gear_ratio = GEAR as f32;
        // Fine, so that counts hide nothing.
        axis.encoder_counts = 1 << 18;
    }
    let mut parameters = Parameters::from_settings(&settings, 24.0).unwrap();
    for motor in &mut parameters.motors {
        (motor.viscous_friction, motor.coulomb_friction) = (1e-3, 0.0);
    }
    parameters
}

fn pose() -> Pose<f64> {
    let assembly = Settings::BENCHTOP.assembly();
    let geometry = parameters().arm.geometry().to_owned();
    geometry.forward(2.2, 0.9, assembly).unwrap()
}

fn arm(protocol: Protocol) -> CanPlant {
    let drive = |node| CanDrive {
        node,
        gear_ratio: GEAR,
        rotor_inertia: 3e-5,
        peak_torque: 1.0,
        lag: 3e-4,
        watchdog: WATCHDOG,
    };
    let bus = (protocol, NODES.map(drive));
    CanPlant::new(&parameters(), bus, &Mismatch::NONE, &pose(), 1)
}

/// A tick in which the controller sends these frames; those that it then has received.
fn tick(plant: &mut CanPlant, frames: &[Frame]) -> Vec<Frame> {
    plant.step(frames, false, 0, TICK);
    plant.take_received()
}

/// Starts ODrives that follow this torque [N·m] about their present place, with these gains.
fn start(plant: &mut CanPlant, [of_position, of_velocity]: [f32; 2]) {
    for frames in [
        NODES.map(odrive::set_mode),
        NODES.map(|node| odrive::set_position_gain(node, of_position)),
        NODES.map(|node| odrive::set_velocity_gain(node, of_velocity)),
        NODES.map(|node| odrive::set_axis_state(node, odrive::CLOSED_LOOP)),
    ] {
        tick(plant, &frames);
    }
    for _ in 0..20 {
        tick(plant, &inputs(0.0));
    }
}

fn inputs(torque: f32) -> [Frame; 2] {
    [
        odrive::set_input(1, 0.0, 0.0, torque),
        odrive::set_input(2, 0.0, 0.0, -torque),
    ]
}

/// The turns that each ODrive tells in these frames.
fn told(frames: &[Frame]) -> [f64; 2] {
    NODES.map(|node| {
        let of = |frame: &Frame| match Message::decode(frame) {
            Some((from, Message::Estimates { position, .. })) if from == node => Some(position),
            _ => None,
        };
        frames.iter().find_map(of).expect("an answer").into()
    })
}

#[test]
fn odrives_tell_where_they_were_at_the_time_stated() {
    let mut plant = arm(Protocol::Odrive);
    start(&mut plant, [0.0, 0.0]);
    // Until the joints turn.
    for _ in 0..60 {
        tick(&mut plant, &inputs(0.02));
    }
    let angles = |plant: &CanPlant| Joint::ALL.map(|j| plant.angle(j));
    let asked = |torque| {
        let [first, second] = inputs(torque);
        [
            first,
            second,
            odrive::ask_for_estimates(1),
            odrive::ask_for_estimates(2),
        ]
    };
    let zero = {
        let turns = told(&tick(&mut plant, &asked(0.0)));
        let angles = angles(&plant);
        [0, 1].map(|j| angles[j] - TAU * turns[j] / GEAR)
    };
    let stated = sensed_after(&Protocol::Odrive, NODES).map(f64::from);
    let before = angles(&plant);
    let turns = told(&tick(&mut plant, &asked(0.0)));
    let after = angles(&plant);
    for j in 0..2 {
        let speed = (after[j] - before[j]) / TICK;
        assert!(speed.abs() > 0.3, "{speed} rad/s");
        // `zero` was taken as long before its tick's end as this is.
        let at = TAU * turns[j] / GEAR + zero[j];
        let age = (after[j] - at) / speed;
        assert!(age.abs() < 2e-5, "{age} s");
        let told = TAU * turns[j] / GEAR;
        let start = [pose().angles()[0], pose().angles()[3]][j];
        let sensed = (told + start - before[j]) / speed;
        assert!(
            (sensed - stated[j]).abs() < 3e-5,
            "{sensed} s for {} s",
            stated[j]
        );
    }
}

#[test]
fn the_drives_own_gains_make_the_stiffness_that_was_set() {
    // 0.5 N·m·s/turn and 60/s: 30 N·m/turn at the drive.
    let mut plant = arm(Protocol::Odrive);
    start(&mut plant, [60.0, 0.5]);
    let hold = |plant: &mut CanPlant, seconds: f64| {
        for _ in 0..(seconds / TICK) as u32 {
            tick(plant, &inputs(0.0));
        }
        (Joint::ALL.map(|j| plant.angle(j)), plant.tool())
    };
    let (before, tool) = hold(&mut plant, 0.5);
    let force = Vector2::new(0.6, 0.4);
    plant.arm_mut().set_tool_force(force);
    let (after, moved) = hold(&mut plant, 1.0);
    // k (Δθ1² + Δθ4²) = F·Δx.
    let squares: f64 = [0, 1].map(|j| (after[j] - before[j]).powi(2)).iter().sum();
    let stiffness = force.dot(&(moved - tool)) / squares;
    let expected = 30.0 / TAU * GEAR * GEAR;
    assert!(
        (stiffness / expected - 1.0).abs() < 0.01,
        "{stiffness} for {expected} N·m/rad"
    );
}

#[test]
fn a_torque_turns_the_joints_as_the_mass_matrix_says() {
    for protocol in [Protocol::Odrive, Protocol::Mit(MIT)] {
        let mut plant = arm(protocol);
        let torque = 0.05;
        let frames = match protocol {
            Protocol::Odrive => {
                start(&mut plant, [0.0, 0.0]);
                inputs(torque)
            }
            Protocol::Mit(ranges) => {
                use fivebar_firmware::drives::can::mit::{Command, enable};
                let commands = |torque: f32| {
                    [(1, torque), (2, -torque)].map(|(node, torque)| {
                        let command = Command {
                            torque,
                            ..Command::default()
                        };
                        Frame::new(node, command.encode(&ranges))
                    })
                };
                tick(&mut plant, &NODES.map(|node| enable(node, true)));
                for _ in 0..9 {
                    tick(&mut plant, &commands(0.0));
                }
                commands(torque)
            }
        };
        let before = Joint::ALL.map(|j| plant.angle(j));
        for _ in 0..10 {
            tick(&mut plant, &frames);
        }
        let mass = parameters().arm.mass_matrix(&pose()).unwrap();
        let rotor = 3e-5 * GEAR * GEAR - parameters().arm.rotor_inertia()[0];
        let mass = mass + nalgebra::Matrix2::from_diagonal_element(rotor);
        let joint = GEAR * f64::from(torque);
        let alpha = mass.try_inverse().unwrap() * Vector2::new(joint, -joint);
        // From the arrival on, through the current loop: ½ α (t − t0)², t0 about 0.5 ms.
        for (j, before) in Joint::ALL.into_iter().zip(before) {
            let turned = plant.angle(j) - before;
            let time = (2.0 * turned / alpha[j.index()]).sqrt();
            assert!(
                (9.2e-3..9.8e-3).contains(&time),
                "{protocol:?}, {j}: {time} s"
            );
        }
    }
}

#[test]
fn a_drive_that_hears_nothing_ends_its_torque_by_its_watchdog_and_one_that_resets_is_silent() {
    let mut plant = arm(Protocol::Odrive);
    start(&mut plant, [0.0, 0.0]);
    tick(&mut plant, &inputs(0.1));
    tick(&mut plant, &inputs(0.1));
    assert!(plant.torque().iter().all(|torque| torque.abs() > 0.2));
    // The last command came 0.25 ms after the last tick's beginning at the latest.
    let ticks = (WATCHDOG / TICK) as u32 - 1;
    for _ in 0..ticks {
        tick(&mut plant, &[]);
    }
    assert!(plant.torque().iter().all(|torque| torque.abs() > 0.2));
    tick(&mut plant, &[]);
    assert_eq!(plant.torque(), [0.0; 2]);

    plant.arm_mut().inject(FaultKind::CanReset {
        joint: Joint::Joint1,
    });
    let asks = NODES.map(odrive::ask_for_estimates);
    let answers = |frames: &[Frame]| {
        NODES.map(|node| {
            frames
                .iter()
                .filter(|frame| frame.id == u16::from(node) << 5 | 9)
                .count()
        })
    };
    assert_eq!(answers(&tick(&mut plant, &asks)), [0, 1]);
    for _ in 0..1000 {
        tick(&mut plant, &[]);
    }
    assert_eq!(answers(&tick(&mut plant, &asks)), [1, 1]);
}

/// What a controller sees of the bus in this time [s] that offers this frame once, each with its time [µs].
fn seen(plant: &mut CanPlant, offered: Frame, time: f64) -> Vec<(f64, BusEvent)> {
    plant.offer(Some(offered));
    let (mut now, mut events) = (0.0, Vec::new());
    while now < time {
        let (passed, event) = plant.pass(true, 0, time - now);
        now += passed;
        events.extend(event.map(|event| (1e6 * now, event)));
        if event == Some(BusEvent::Began) {
            plant.offer(None);
        }
    }
    events
}

#[test]
fn a_controller_that_offers_a_frame_sees_it_begin_and_end_among_those_of_the_drives() {
    let mut plant = arm(Protocol::Odrive);
    let asked = odrive::ask_for_estimates(1);
    let events = seen(&mut plant, asked, 1e-3);
    let ids: Vec<Option<u16>> = events
        .iter()
        .map(|(_, event)| match event {
            BusEvent::Received(frame) => Some(frame.id),
            _ => None,
        })
        .collect();
    // The heartbeat of joint 1 is before the question, its answer before the heartbeat of joint 4.
    assert_eq!(ids, [Some(0x21), None, None, Some(0x29), Some(0x41)]);
    let [_, (begun, began), (ended, sent), ..] = events[..] else {
        panic!("{events:?}");
    };
    assert_eq!((began, sent), (BusEvent::Began, BusEvent::Sent));
    let bits = f64::from(bits_on_bus(&asked));
    assert!((ended - begun - bits).abs() < 0.2, "{begun} {ended} {bits}");
}

#[test]
fn a_frame_on_shorted_wires_or_that_nobody_takes_fails() {
    for (wires, acknowledged) in [(Wires::Shorted, true), (Wires::Whole, false)] {
        let mut plant = arm(Protocol::Mit(MIT));
        plant.set_wires(wires);
        if wires == Wires::Whole {
            for joint in Joint::ALL {
                plant.arm_mut().inject(FaultKind::CanSilent { joint });
            }
        }
        let asked = fivebar_firmware::drives::can::mit::enable(1, true);
        let events = seen(&mut plant, asked, 1e-3);
        let failed = BusEvent::Failed { acknowledged };
        let events: Vec<BusEvent> = events.into_iter().map(|(_, event)| event).collect();
        assert_eq!(events, [BusEvent::Began, failed]);
    }
}
