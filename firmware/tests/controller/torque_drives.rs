//! The controller on drives that close their own current loops.

use fivebar_firmware::controller::{
    ArmController, Excitation, Excited, Request, RequestError, Status,
};
use fivebar_firmware::drives::words::torque_of;
use fivebar_firmware::drives::{
    DriveHealth, Drives, OLDEST_ANSWER, TorqueDrives, TorqueSample, TorqueSetPoint,
};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::{ArmCommand, ArmSample, Settings};

const OLDEST: u16 = OLDEST_ANSWER;

/// An arm that stands, whose drives answered so many ticks ago.
fn standing(counts: [i32; 2], age: [u16; 2]) -> ArmSample<TorqueSample> {
    ArmSample {
        counts,
        drives: TorqueSample {
            age,
            health: [DriveHealth::Drives; 2],
            ..TorqueSample::default()
        },
        ..ArmSample::default()
    }
}

/// An arm that is armed 20 counts beside its set-point, so that the drives push.
fn pushing() -> ArmController<TorqueDrives> {
    let settings = Settings::BENCHTOP.check().expect("valid settings");
    let mut controller = ArmController::<TorqueDrives>::new(&settings);
    controller.tick(&standing([0; 2], [0; 2]));
    for request in [Request::SetAngles([2.2, 0.9]), Request::Arm] {
        controller.request(request).expect("accepted");
    }
    // 50 ms until they are awake.
    for _ in 0..510 {
        controller.tick(&standing([20, -20], [OLDEST, 0]));
    }
    assert_eq!(controller.state(), State::Armed);
    controller
}

#[test]
fn the_drives_get_the_torques_that_the_status_tells() {
    let mut controller = pushing();
    let command = controller.tick(&standing([20, -20], [0; 2]));
    let Status { torque, duty, .. } = controller.status();
    let [torque1, torque4] = command.drives.torque;
    assert!(
        torque1 < -1e-3 && torque4 > 1e-3,
        "{torque1}, {torque4} N·m"
    );
    for (given, told) in command.drives.torque.into_iter().zip(torque) {
        assert!((given - told).abs() < 1e-6, "{given}, {told} N·m");
    }
    assert_eq!((command.enable, duty), ([true; 2], [0.0; 2]));
}

#[test]
fn the_drives_hold_an_arm_that_is_armed_about_its_place_and_none_that_homes() {
    let mut controller = pushing();
    let command = controller.tick(&standing([20, -20], [0; 2]));
    for ((ahead, counts), axis) in command
        .drives
        .ahead
        .into_iter()
        .zip([20.0, -20.0])
        .zip(&Settings::BENCHTOP.axes)
    {
        let per_count = core::f32::consts::TAU / (axis.encoder_counts as f32 * axis.gear_ratio);
        // The counts that it was armed at were 0.
        assert!((ahead + counts * per_count).abs() < 1e-6, "{ahead} rad");
    }
    assert_eq!(command.drives.velocity, [0.0; 2]);
    assert!(command.drives.is_stiff);

    let settings = Settings::BENCHTOP.check().expect("valid settings");
    let mut homing = ArmController::<TorqueDrives>::new(&settings);
    homing.tick(&standing([0; 2], [0; 2]));
    homing.request(Request::Home).expect("accepted");
    let mut pushed = false;
    for _ in 0..700 {
        let set_point = homing.tick(&standing([0; 2], [0; 2])).drives;
        let TorqueSetPoint { torque, ahead, .. } = set_point;
        assert!(!set_point.is_stiff);
        pushed |= torque[0].abs() > 1e-3;
        assert_eq!(ahead, [0.0; 2]);
    }
    assert!(pushed && homing.state() == State::Homing);
}

#[test]
fn what_a_drive_or_the_bus_shows_stops_both_in_its_tick() {
    let sample = |change: fn(&mut TorqueSample)| {
        let mut sample = standing([20, -20], [0; 2]);
        change(&mut sample.drives);
        sample
    };
    let late1 = sample(|it| it.age[0] = OLDEST + 1);
    let late4 = sample(|it| it.age[1] = OLDEST + 1);
    for (sample, fault) in [
        (late1, Fault::DriveSilent),
        (late4, Fault::DriveSilent),
        (
            sample(|it| it.health[0] = DriveHealth::Error),
            Fault::DriveError,
        ),
        (
            sample(|it| it.health[1] = DriveHealth::Off),
            Fault::DriveError,
        ),
        (sample(|it| it.bus_off = true), Fault::BusOff),
    ] {
        let mut controller = pushing();
        let command = controller.tick(&sample);
        let safe = ArmCommand {
            drives: TorqueSetPoint::default(),
            enable: [false; 2],
            brake: true,
            tool: 0,
        };
        assert_eq!(command, safe, "{fault:?}");
        assert_eq!(controller.status().fault, Some(fault));
    }
}

#[test]
fn a_drive_may_be_off_while_it_wakes_up_but_neither_silent_nor_in_error() {
    let settings = Settings::BENCHTOP.check().expect("valid settings");
    for (health, age, fault) in [
        (DriveHealth::Off, 1, None),
        (DriveHealth::Error, 1, Some(Fault::DriveError)),
        (DriveHealth::Off, OLDEST + 1, Some(Fault::DriveSilent)),
    ] {
        let mut controller = ArmController::<TorqueDrives>::new(&settings);
        let mut sample = standing([0; 2], [age; 2]);
        sample.drives.health = [health; 2];
        controller.tick(&sample);
        for request in [Request::SetAngles([2.2, 0.9]), Request::Arm] {
            controller.request(request).expect("accepted");
        }
        for _ in 0..400 {
            controller.tick(&sample);
        }
        assert_eq!(controller.status().fault, fault, "{health:?}");
    }
}

#[test]
fn only_a_clear_of_the_host_clears_the_errors_of_drives_and_once() {
    let mut controller = pushing();
    let mut broken = standing([20, -20], [0; 2]);
    broken.drives.health[0] = DriveHealth::Error;
    let fine = standing([20, -20], [0; 2]);
    let clears = |controller: &mut ArmController<TorqueDrives>, ticks| {
        let ticks = (0..ticks).map(|_| controller.tick(&fine).drives.clear_errors);
        ticks.collect::<Vec<_>>()
    };
    assert!(!controller.tick(&broken).drives.clear_errors);
    assert_eq!(controller.status().fault, Some(Fault::DriveError));
    assert_eq!(clears(&mut controller, 3), [false; 3]);
    controller.request(Request::ClearFault).expect("accepted");
    // Also where it arms at once.
    controller.request(Request::Arm).expect("accepted");
    assert_eq!(clears(&mut controller, 3), [true, false, false]);
    assert_eq!(controller.status().fault, None);
}

#[test]
fn no_voltage_or_current_is_set_through_a_torque_drive() {
    let settings = Settings::BENCHTOP.check().expect("valid settings");
    let mut controller = ArmController::<TorqueDrives>::new(&settings);
    controller.tick(&standing([0; 2], [0; 2]));
    let excitation = Excitation {
        joint: 0,
        of: Excited::Current,
        offset: 0.1,
        amplitude: 0.0,
        hold: 1,
        ticks: 10,
        current: 0.5,
        travel: 0.1,
    };
    let refused = controller.request(Request::Excite(excitation));
    assert_eq!(refused, Err(RequestError::Excitation));
    assert_eq!(controller.state(), State::Stopped);
}

#[test]
fn the_log_tells_both_torques_and_the_ages_and_what_is_too_great_as_the_greatest() {
    let settings = Settings::BENCHTOP.check().expect("valid settings");
    let drives = TorqueDrives::new(&settings);
    let [peak1, peak4] = settings.peak_torque();
    let sample = TorqueSample {
        torque: [0.5 * peak1, -3.0 * peak4],
        age: [1, u16::MAX],
        ..TorqueSample::default()
    };
    let words = drives.sensed_words(&sample);
    assert_eq!((words.joints, words.both), ([8192, 0x8000], 0xFF01));
    let told = drives.told_words(&TorqueSetPoint {
        torque: [-0.25 * peak1, peak4],
        ..TorqueSetPoint::default()
    });
    assert_eq!(told, [-4096_i16 as u16, 16384]);
    let torque = torque_of(told[0], peak1);
    assert!((torque + 0.25 * peak1).abs() < 1e-6, "{torque} N·m");
}
