//! The controller on drives that close their own current loops.

use fivebar_firmware::controller::{
    ArmController, Excitation, Excited, Request, RequestError, Status,
};
use fivebar_firmware::drives::{OLDEST_SAMPLE, TorqueDrives, TorqueSample, TorqueSetPoint};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::{ArmCommand, ArmSample, Settings};

/// An arm that stands, whose drives answered so many ticks ago.
fn standing(counts: [i32; 2], age: [u16; 2]) -> ArmSample<TorqueSample> {
    let torque = [0.0; 2];
    ArmSample {
        counts,
        drives: TorqueSample { torque, age },
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
    for _ in 0..5 {
        controller.tick(&standing([20, -20], [OLDEST_SAMPLE, 0]));
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
fn a_drive_that_is_silent_stops_both_in_the_tick_in_which_its_answer_is_too_old() {
    for age in [[OLDEST_SAMPLE + 1, 0], [0, OLDEST_SAMPLE + 1]] {
        let mut controller = pushing();
        let command = controller.tick(&standing([20, -20], age));
        let safe = ArmCommand {
            drives: TorqueSetPoint::default(),
            enable: [false; 2],
            brake: true,
            tool: 0,
        };
        assert_eq!(command, safe, "{age:?}");
        assert_eq!(controller.status().fault, Some(Fault::DriverFault));
    }
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
