//! What the controller knows of its drives: the error of an encoder, friction, heat, and the noise
//! and the load of an arm that rests.

#![allow(
    clippy::needless_range_loop,
    reason = "a joint's number names it in every array"
)]

use crate::rig::{Rig, START, settings, with};
use fivebar_firmware::MoveKind;
use fivebar_firmware::controller::{Controller, Request};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::settings::EncoderTable;

/// Of the motor's shaft [rad].
fn error(measured: f64) -> f64 {
    0.05 * measured.sin()
}

/// Both encoders err by up to 6 mrad of the joint, and the settings know it.
fn erring() -> Rig {
    let settings = with(|settings| settings.encoder_tables = [EncoderTable::new(8.0, error); 2]);
    let mut rig = Rig::new(&settings);
    rig.bench.encoder_error = error;
    rig.controller = Controller::new(&settings.check().unwrap());
    rig.run(1);
    rig.controller.request(Request::SetAngles(START)).unwrap();
    rig
}

/// How far the angles are off [rad].
fn off(rig: &Rig) -> f64 {
    let pairs = rig
        .controller
        .status()
        .angle
        .into_iter()
        .zip(rig.bench.theta);
    let off = pairs.map(|(shown, true_angle)| (f64::from(shown) - true_angle).abs());
    off.fold(0.0, f64::max)
}

#[test]
fn a_known_error_of_the_encoders_is_corrected_along_a_move() {
    let mut rig = erring();
    rig.controller.request(Request::Arm).unwrap();
    rig.run(30);
    let to = [1.8, 1.3];
    rig.push(1, MoveKind::Joint { to, speed: 0.1 }).unwrap();
    let mut worst = 0.0_f64;
    while rig.controller.state() != State::Armed || !rig.planner.is_empty() {
        rig.tick();
        worst = worst.max(off(&rig));
    }
    assert!(
        (rig.bench.theta[0] - 1.8).abs() < 1e-3,
        "{:?}",
        rig.bench.theta
    );
    assert!(worst < 5e-4, "{worst} rad");
}

#[test]
fn a_known_error_of_the_encoders_is_corrected_while_the_arm_is_moved_by_hand() {
    let mut rig = erring();
    rig.bench.push = [0.03, -0.03];
    let mut worst = 0.0_f64;
    for _ in 0..4000 {
        rig.tick();
        worst = worst.max(off(&rig));
        if (rig.bench.theta[0] - f64::from(START[0])).abs() > 0.5 {
            break;
        }
    }
    assert!(
        (rig.bench.theta[0] - f64::from(START[0])).abs() > 0.3,
        "{:?}",
        rig.bench.theta
    );
    assert!(worst < 5e-4, "{worst} rad");
}

/// The changes of each joint's torque from tick to tick, while its counts change by one, summed up
/// [N·m].
fn answer_to_noise(rig: &mut Rig, ticks: u32) -> [f32; 2] {
    let mut sum = [0.0_f32; 2];
    for tick in 0..ticks {
        rig.bench.extra_counts = [(tick % 2) as i32; 2];
        let before = rig.controller.status().torque;
        rig.tick();
        let torque = rig.controller.status().torque;
        for joint in 0..2 {
            sum[joint] += (torque[joint] - before[joint]).abs();
        }
    }
    sum
}

#[test]
fn an_arm_at_rest_answers_the_encoders_noise_with_less_torque_until_it_is_armed_anew() {
    let mut rig = Rig::armed(&settings());
    let early = answer_to_noise(&mut rig, 500);
    answer_to_noise(&mut rig, 3000);
    let late = answer_to_noise(&mut rig, 500);
    rig.controller.request(Request::Disarm).unwrap();
    rig.run(10);
    rig.controller.request(Request::Arm).unwrap();
    rig.run(20);
    let anew = answer_to_noise(&mut rig, 500);
    for joint in 0..2 {
        let (early, late, anew) = (early[joint], late[joint], anew[joint]);
        assert!(early > 0.0 && late < 0.2 * early, "{late} of {early} N·m");
        assert!(anew > 0.8 * early, "{anew} of {early} N·m");
    }
}

#[test]
fn an_arm_that_begins_to_rest_under_a_load_keeps_its_torque_and_its_place() {
    let mut rig = Rig::armed(&settings());
    rig.bench.push = [0.06, -0.04];
    rig.run(1000);
    // Meanwhile the gains become those of rest. A count is worth more than the load while they are
    // still those of a moving arm, so means tell whether the torque is kept.
    let before = rig.bench.theta;
    for _ in 0..200 {
        let mut mean = [0.0; 2];
        for _ in 0..20 {
            rig.tick();
            let torque = rig.controller.status().torque;
            for joint in 0..2 {
                mean[joint] += torque[joint] / 20.0;
                let moved = rig.bench.theta[joint] - before[joint];
                assert!(moved.abs() < 1e-4, "{moved} rad");
            }
        }
        assert!((mean[0] + 0.06).abs() < 0.02, "{mean:?} N·m");
        assert!((mean[1] - 0.04).abs() < 0.02, "{mean:?} N·m");
    }
}

#[test]
fn the_friction_of_either_joint_is_compensated_in_the_direction_of_its_motion() {
    for (joint, turned) in [(0, 0.2), (0, -0.2), (1, 0.2), (1, -0.2)] {
        let mut rig = Rig::armed(&with(|settings| {
            settings.axes[joint].coulomb_friction = 0.1;
        }));
        let mut to = START;
        to[joint] += turned;
        rig.push(1, MoveKind::Joint { to, speed: 0.02 }).unwrap();
        let mut worst = 0.0_f64;
        while rig.controller.state() != State::Armed || !rig.planner.is_empty() {
            rig.tick();
            let reference = rig.controller.status().joint_reference.expect("armed");
            let error = f64::from(reference.angle[joint]) - rig.bench.theta[joint];
            worst = worst.max(error.abs());
        }
        assert!(worst < 3e-4, "{worst} rad");
    }
}

/// Both motors are held at a current that is too hot after a while; then they rest.
#[test]
fn a_motor_that_has_switched_off_cools_down_before_it_is_driven_again() {
    for joint in [0, 1] {
        let mut rig = Rig::armed(&with(|settings| {
            settings.axes[joint].continuous_current = 0.3;
            settings.axes[joint].thermal_time_constant = 0.1;
        }));
        rig.bench.push[joint] = 0.1;
        let ticks_to_fault = |rig: &mut Rig| {
            (0..20_000)
                .take_while(|_| {
                    rig.tick();
                    rig.controller.state() == State::Armed
                })
                .count()
        };
        let first = ticks_to_fault(&mut rig);
        let fault = rig.controller.status().fault;
        assert_eq!(fault, Some(Fault::OverTemperature));
        rig.bench.push = [0.0; 2];
        rig.bench.omega = [0.0; 2];
        rig.run(5000);
        rig.controller.request(Request::ClearFault).unwrap();
        rig.controller.request(Request::Arm).unwrap();
        rig.run(20);
        rig.bench.push[joint] = 0.1;
        let second = ticks_to_fault(&mut rig);
        assert!(second > first / 2, "{second} ticks after {first}");
    }
}

/// At 8 Ω, the current that holds against the push needs more voltage than the bus has.
#[test]
fn a_bridge_drives_for_no_more_than_a_share_of_its_period() {
    for joint in [0, 1] {
        let mut rig = Rig::armed(&with(|settings| {
            for axis in &mut settings.axes {
                axis.resistance = 8.0;
            }
        }));
        rig.bench.push[joint] = 0.7;
        let mut greatest = 0.0_f32;
        for _ in 0..2000 {
            let [duty1, duty4] = rig.tick().drives.duty;
            greatest = greatest.max(duty1.abs()).max(duty4.abs());
        }
        assert!((greatest - 0.95).abs() < 1e-6, "{greatest}");
    }
}

#[test]
fn a_known_error_of_the_encoders_is_corrected_from_the_home_switches_on() {
    let mut rig = erring();
    rig.controller.request(Request::Home).unwrap();
    while rig.controller.state() == State::Homing {
        rig.tick();
    }
    assert!(rig.controller.status().homed);
    rig.run(1000);
    assert!(off(&rig) < 5e-4, "{} rad", off(&rig));
    rig.controller.request(Request::Arm).unwrap();
    rig.run(30);
    let [to1, to4] = START;
    let kind = MoveKind::Joint {
        to: [to1, to4],
        speed: 0.1,
    };
    rig.push(1, kind).unwrap();
    let mut worst = 0.0_f64;
    while rig.controller.state() != State::Armed || !rig.planner.is_empty() {
        rig.tick();
        worst = worst.max(off(&rig));
    }
    assert!(worst < 5e-4, "{worst} rad");
}
