//! What the firmware carries of the robot files.

use fivebar::input::robot::Robot;
use fivebar_firmware::Settings;

#[test]
fn the_firmware_starts_with_the_benchtop_robot_to_the_bit() {
    let robot = Robot::load("benchtop").expect("a built-in robot");
    let settings = robot.settings().expect("a robot with motors");
    assert_eq!(settings, Settings::BENCHTOP);
}
