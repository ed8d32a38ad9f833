//! Robot files: from the text to settings that are valid, and an arm that runs for some ticks.
#![no_main]

use fivebar_files::robot::{Robot, SliderRobot};
use fivebar_firmware::drives::BrushedCommand;
use fivebar_firmware::{ActuatorCommand, Planner};
use fivebar_plant::{Mismatch, Plant};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let text = String::from_utf8_lossy(bytes);
    if let Err(error) = SliderRobot::parse("arm.toml", &text) {
        assert!(error.to_string().starts_with("arm.toml"));
    }
    let robot = match Robot::parse("arm.toml", &text) {
        Ok(robot) => robot,
        Err(error) => {
            assert!(error.to_string().starts_with("arm.toml"));
            return;
        }
    };
    let (Ok(settings), Ok(home)) = (robot.settings(), robot.home_pose()) else {
        return;
    };
    let Ok(checked) = settings.check() else {
        return;
    };
    let _ = Planner::new(&checked);
    let parameters = robot.plant_parameters().expect("it has masses");
    let mut plant = Plant::new(&parameters, &Mismatch::default(), &home, 1);
    let command = ActuatorCommand {
        drives: BrushedCommand { duty: [0.5, -0.5] },
        enable: [true; 2],
        brake: false,
        tool: 0,
    };
    for _ in 0..5 {
        plant.sense();
        plant.step(&command, 1.0 / robot.control.tick_rate);
    }
});
