//! The firmware's built-in settings are those of the benchtop arm's robot file.

use fivebar::input::robot::Robot;
use fivebar_firmware::Settings;

#[test]
fn the_firmware_starts_with_the_benchtop_robot_to_the_bit() {
    let robot = Robot::load("benchtop").expect("a built-in robot");
    let settings = robot.settings().expect("a robot with motors");
    assert_eq!(settings, Settings::BENCHTOP);
}
