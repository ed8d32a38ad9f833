//! The last check before the bridges.

use crate::controller::Request;
use crate::safety::Fault;
use crate::{ActuatorCommand, Controller, SensorSample, Settings};

/// Zero current, 24 V.
const SAMPLE: SensorSample = SensorSample {
    counts: [0; 2],
    current: [2048; 2],
    bus_voltage: 2048,
    home: [false; 2],
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
    for joint in [0, 1] {
        let mut controller = armed(&Settings::BENCHTOP);
        let axis = controller.model.axes.get_mut(joint).expect("two joints");
        axis.current_offset = f32::NAN;
        let command = controller.tick(&SAMPLE);
        assert_eq!(
            command,
            ActuatorCommand {
                duty: [0.0; 2],
                enable: [false; 2],
                brake: true,
                tool: 0,
            }
        );
        // The next tick latches the fault.
        assert!(!controller.tick(&SAMPLE).enable.contains(&true));
        assert_eq!(controller.status().fault, Some(Fault::NotANumber));
    }
}
