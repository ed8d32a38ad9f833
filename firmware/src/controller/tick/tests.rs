//! The last check before the bridges.

use crate::controller::Request;
use crate::controller::setpoint::Setpoint;
use crate::controller::tick::TorqueCommand;
use crate::drives::{BrushedCommand, BrushedSample};
use crate::safety::{Fault, Limits};
use crate::settings::ToolOutputSettings;
use crate::{
    ActuatorCommand, Controller, FULL_TOOL, Move, MoveKind, Planner, SensorSample, Settings,
};
use fivebar_kinematics::five_bar::{Joint, Side, WorkingMode};

/// Zero current, 24 V.
const SAMPLE: SensorSample = SensorSample {
    counts: [0; 2],
    drives: BrushedSample {
        current: [2048; 2],
        bus_voltage: 2048,
    },
    home: [false; 2],
    index: [false; 2],
    emergency_stop: false,
    driver_fault: [false; 2],
    missed_ticks: 0,
};

fn armed(settings: &Settings) -> Controller {
    let mut controller = Controller::new(&settings.check().expect("valid settings"));
    controller.tick(&SAMPLE);
    for request in [Request::SetAngles([2.2, 0.9]), Request::Arm] {
        controller.request(request).expect("accepted");
    }
    for _ in 0..20 {
        controller.tick(&SAMPLE);
    }
    assert!(!controller.tick(&SAMPLE).brake, "it drives");
    controller
}

#[test]
fn a_duty_of_either_joint_that_is_not_a_number_switches_off_in_its_tick() {
    for joint in Joint::ALL {
        let mut controller = armed(&Settings::BENCHTOP);
        controller.drives.spoil(joint);
        let command = controller.tick(&SAMPLE);
        assert_eq!(
            command,
            ActuatorCommand {
                drives: BrushedCommand::default(),
                enable: [false; 2],
                brake: true,
                tool: 0,
            }
        );
        assert_eq!(controller.status().duty, [0.0; 2]);
        // The next tick latches the fault.
        assert!(!controller.tick(&SAMPLE).enable.contains(&true));
        assert_eq!(controller.status().fault, Some(Fault::NotANumber));
    }
}

#[test]
fn a_duty_that_is_not_a_number_switches_the_tool_off_in_its_tick() {
    let mut settings = Settings::BENCHTOP;
    settings.tool_output = ToolOutputSettings::Switch {
        active_low: false,
        down_time: 0.01,
        up_time: 0.01,
    };
    let mut controller = armed(&settings);
    let mut planner = Planner::new(&settings.check().expect("valid settings"));
    let dwell = Move {
        tag: 1,
        tool: FULL_TOOL,
        kind: MoveKind::Dwell { duration: 0.5 },
    };
    planner.push(&mut controller, &dwell).expect("armed");
    let off = settings.tool_output.off();
    let is_on = (0..1000).any(|_| {
        controller.feed_host_timeout();
        planner.run(&mut controller);
        controller.tick(&SAMPLE).tool != off
    });
    assert!(is_on);
    controller.drives.spoil(Joint::Joint1);
    let command = controller.tick(&SAMPLE);
    assert_eq!((command.enable, command.tool), ([false; 2], off));
}

#[test]
fn what_waits_for_its_turn_and_what_moves_end_with_the_power() {
    let mut controller = armed(&Settings::BENCHTOP);
    controller.pending_stop = Some(Fault::CommandTimeout);
    controller.pending_off = Some(Fault::OverTemperature);
    controller.at_rest = true;
    controller.setpoint.omega = [1.0, -1.0];
    controller.setpoint.alpha = [10.0, -10.0];
    controller.request(Request::Disarm).expect("accepted");
    controller.tick(&SAMPLE);
    assert_eq!(
        (controller.pending_stop, controller.pending_off),
        (None, None)
    );
    assert!(!controller.at_rest);
    let Setpoint { omega, alpha, .. } = controller.setpoint;
    assert_eq!((omega, alpha), ([0.0; 2], [0.0; 2]));
}

#[test]
fn an_arm_is_armed_in_the_working_mode_in_which_it_is() {
    let mut controller = armed(&Settings::BENCHTOP);
    let mode = controller.working_mode();
    controller.request(Request::Disarm).expect("accepted");
    controller.tick(&SAMPLE);
    // That of a joint move before; somebody has turned the arm back by hand.
    controller.mode = WorkingMode::new(Side::Left, Side::Left);
    assert_ne!(controller.mode, mode);
    for request in [Request::SetAngles([2.2, 0.9]), Request::Arm] {
        controller.request(request).expect("accepted");
    }
    assert_eq!(controller.working_mode(), mode);
}

#[test]
fn each_motor_gets_the_current_of_its_own_torque_constant() {
    let [axis, _] = Settings::BENCHTOP.axes;
    for joint in [0, 1] {
        let mut settings = Settings::BENCHTOP;
        settings.axes[joint].torque_constant = 2.0 * axis.torque_constant;
        let mut controller = armed(&settings);
        let command = TorqueCommand {
            torque: [0.1, -0.1],
            limits: Limits::empty(),
        };
        controller.drive(command).expect("numbers");
        let [current1, current4] = controller.status().current_demand.map(f32::abs);
        let expected = if joint == 0 { 0.5 } else { 2.0 };
        assert!((current1 / current4 - expected).abs() < 1e-5, "{joint}");
    }
}
