//! Hobby servos against closed forms: the dead band, the greatest speed, the delay of a frame, the error under a load, and
//! a load above the stall torque.

use fivebar_design::Noise;
use fivebar_firmware::ArmCommand;
use fivebar_firmware::Settings;
use fivebar_firmware::drives::StepCommand;
use fivebar_kinematics::five_bar::{Joint, Pose};
use fivebar_plant::{FaultKind, HobbyServo, HobbyServoPlant, Mismatch, Parameters};
use nalgebra::Vector2;
use std::f64::consts::PI;

const TICK: f64 = 1e-4;
const SUPPLY: f64 = 5.0;
/// Where the arm begins: both joints' angles [rad]. Its servos are at the middle of their widths there.
const START: [f64; 2] = [2.2, 0.9];

/// A servo of 60 g, such as a DS3218 at 5 V.
const SERVO: HobbyServo = HobbyServo {
    gear_ratio: 1.0,
    rotor_inertia: 5e-3,
    pulse_range: [0.5e-3, 2.5e-3],
    travel: PI,
    home_width: 1.5e-3,
    dead_band: 3e-6,
    frame_rate: 50.0,
    max_speed: 6.5,
    stall_torque: 1.9,
};

fn parameters() -> Parameters {
    let mut settings = Settings::BENCHTOP;
    settings.axes[0].home_angle = START[0] as f32;
    settings.axes[1].home_angle = START[1] as f32;
    let mut parameters = Parameters::from_settings(&settings, SUPPLY).unwrap();
    for motor in &mut parameters.motors {
        (motor.viscous_friction, motor.coulomb_friction) = (0.0, 0.0);
    }
    parameters
}

fn pose([theta1, theta4]: [f64; 2]) -> Pose<f64> {
    let geometry = *parameters().arm.geometry();
    geometry
        .forward(theta1, theta4, Settings::BENCHTOP.assembly())
        .unwrap()
}

fn arm(servo: HobbyServo) -> HobbyServoPlant {
    let backwards = HobbyServo {
        gear_ratio: -1.0,
        ..servo
    };
    let servos = [servo, backwards];
    HobbyServoPlant::new(&parameters(), &servos, &Mismatch::NONE, &pose(START), 1)
}

fn command(steps: [i32; 2]) -> ArmCommand<StepCommand> {
    ArmCommand {
        drives: StepCommand { steps },
        enable: [true; 2],
        brake: false,
        tool: 0,
    }
}

fn rest(plant: &mut HobbyServoPlant, seconds: f64) {
    for _ in 0..(seconds / TICK).round() as u32 {
        plant.step(&command([0; 2]), TICK);
    }
}

fn angles(plant: &HobbyServoPlant) -> [f64; 2] {
    Joint::ALL.map(|j| plant.angle(j))
}

/// The angle of one unit of the timer [rad].
fn unit(servo: &HobbyServo) -> f64 {
    HobbyServo::UNIT * servo.angle_per_width()
}

#[test]
fn at_rest_a_joint_is_within_the_dead_band_of_its_set_point() {
    let mut noise = Noise::new(7);
    for dead_band in [0.0, 3e-6, 10e-6] {
        let servo = HobbyServo { dead_band, ..SERVO };
        let mut plant = arm(servo);
        let mut units = [0_i32; 2];
        let mut greatest = 0.0_f64;
        for _ in 0..12 {
            let wanted = [0, 1].map(|_| (400.0 * (2.0 * noise.uniform() - 1.0)) as i32);
            let steps = [wanted[0] - units[0], wanted[1] - units[1]];
            units = wanted;
            plant.step(&command(steps), TICK);
            rest(&mut plant, 0.8);
            let [theta1, theta4] = angles(&plant);
            // Joint 4's servo turns against it.
            let errors = [
                START[0] + f64::from(units[0]) * unit(&servo) - theta1,
                START[1] - f64::from(units[1]) * unit(&servo) - theta4,
            ];
            for error in errors {
                assert!(error.abs() <= servo.dead_angle() + 2e-4, "{error}");
                greatest = greatest.max(error.abs());
            }
        }
        // The servo stops where the dead band begins: no better than that.
        assert!(greatest > 0.5 * servo.dead_angle(), "{greatest}");
    }
}

#[test]
fn a_distant_set_point_is_reached_at_the_greatest_speed_of_the_supply() {
    for supply in [SUPPLY, 0.8 * SUPPLY] {
        let mut plant = arm(SERVO);
        let kind = FaultKind::BusVoltage { volts: supply };
        plant.arm_mut().inject(kind);
        rest(&mut plant, 0.1);
        // Both cranks turn outwards.
        let radian = (1.0 / unit(&SERVO)) as i32;
        let before = plant.angle(Joint::Joint1);
        plant.step(&command([radian, radian]), TICK);
        let mut fastest = 0.0_f64;
        let mut last = before;
        for _ in 0..3000 {
            plant.step(&command([0; 2]), TICK);
            let now = plant.angle(Joint::Joint1);
            fastest = fastest.max((now - last).abs() / TICK);
            last = now;
        }
        let expected = SERVO.max_speed * supply / SUPPLY;
        assert!((fastest - expected).abs() < 0.02 * expected, "{fastest}");
        let turned = last - before;
        assert!((turned - 1.0).abs() < 2.0 * SERVO.dead_angle(), "{turned}");
    }
}

/// The next pulse begins up to a frame later, and the servo knows its width when it ends.
#[test]
fn a_set_point_acts_when_the_next_pulse_ends() {
    for frame_rate in [50.0, 333.0] {
        let servo = HobbyServo {
            frame_rate,
            ..SERVO
        };
        for waited in [0.1, 0.5, 0.9] {
            let mut plant = arm(servo);
            let frames = 4.0 + waited;
            rest(&mut plant, frames / frame_rate);
            assert_eq!(plant.torque(), [0.0; 2]);
            plant.step(&command([100, 100]), TICK);
            let mut ticks = 1;
            while plant.torque()[0] == 0.0 {
                plant.step(&command([0; 2]), TICK);
                ticks += 1;
                assert!(ticks < 1000, "never");
            }
            let width = plant.width()[0];
            let expected = (1.0 - waited) / frame_rate + width;
            let found = f64::from(ticks) * TICK;
            assert!((found - expected).abs() < 3.0 * TICK, "{found} {expected}");
            assert!(found < servo.longest_delay() + 3.0 * TICK);
        }
    }
}

/// The tool's displacement per angle of joint 1 [m/rad].
fn lever() -> Vector2<f64> {
    let small = 1e-6;
    let at = |angle: f64| -> Vector2<f64> {
        let mut plant = arm(SERVO);
        let moved = pose([START[0] + angle, START[1]]);
        plant.arm_mut().hold_by_hand(&moved, TICK);
        plant.tool()
    };
    (at(small) - at(-small)) / (2.0 * small)
}

#[test]
fn a_load_turns_a_joint_by_the_dead_band_and_its_share_of_the_stall_torque_and_a_greater_one_away()
{
    let lever = lever();
    for share in [0.2, 0.6, 1.15] {
        let mut plant = arm(SERVO);
        // A force along the lever loads joint 1 by its torque.
        let force = -share * SERVO.stall_torque * lever / lever.norm_squared();
        plant.arm_mut().set_tool_force(force);
        rest(&mut plant, 0.25);
        let turned = plant.angle(Joint::Joint1) - START[0];
        let held = SERVO.dead_angle() + share * SERVO.stall_error();
        if share < 1.0 {
            rest(&mut plant, 0.5);
            let turned = plant.angle(Joint::Joint1) - START[0];
            assert!((turned + held).abs() < 0.1 * held, "{turned} for {held}");
        } else {
            assert!(turned < -5.0 * held, "{turned}");
            assert!(plant.torque()[0] > 0.9 * SERVO.stall_torque);
        }
    }
}

#[test]
fn without_power_a_servo_gives_no_torque_and_with_it_turns_to_its_set_point() {
    let mut plant = arm(SERVO);
    let pushed = pose([START[0] + 0.2, START[1] - 0.2]);
    let off = ArmCommand {
        enable: [false; 2],
        ..command([0; 2])
    };
    plant.arm_mut().hold_by_hand(&pushed, TICK);
    for _ in 0..500 {
        plant.step(&off, TICK);
    }
    assert_eq!(plant.torque(), [0.0; 2]);
    assert!((plant.angle(Joint::Joint1) - START[0] - 0.2).abs() < 1e-6);
    rest(&mut plant, 0.5);
    assert!((plant.angle(Joint::Joint1) - START[0]).abs() < 2.0 * SERVO.dead_angle());
    plant.arm_mut().inject(FaultKind::EmergencyStop);
    rest(&mut plant, 0.1);
    assert_eq!(plant.torque(), [0.0; 2]);
}

#[test]
fn on_too_little_voltage_a_servo_gives_no_torque_and_on_too_much_it_breaks_for_good() {
    let pushed = pose([START[0] + 0.2, START[1] - 0.2]);
    for (volts, then) in [(0.0, true), (3.0, true), (60.0, false)] {
        let mut plant = arm(SERVO);
        plant.arm_mut().hold_by_hand(&pushed, TICK);
        rest(&mut plant, 0.05);
        assert_ne!(plant.torque()[0], 0.0);
        plant.arm_mut().inject(FaultKind::BusVoltage { volts });
        rest(&mut plant, 0.05);
        assert_eq!(plant.torque(), [0.0; 2], "{volts} V");
        let volts = SUPPLY;
        plant.arm_mut().inject(FaultKind::BusVoltage { volts });
        plant.arm_mut().hold_by_hand(&pushed, TICK);
        rest(&mut plant, 0.05);
        assert_eq!(plant.torque()[0] != 0.0, then, "{volts} V");
    }
}

#[test]
fn a_horn_that_sits_wrongly_turns_its_joint_by_that_angle() {
    let mismatch = Mismatch {
        home_error: [0.05, 0.0],
        ..Mismatch::NONE
    };
    let servos = [SERVO; 2];
    let mut plant = HobbyServoPlant::new(&parameters(), &servos, &mismatch, &pose(START), 1);
    rest(&mut plant, 0.5);
    let [theta1, theta4] = angles(&plant);
    assert!((theta1 - START[0] - 0.05).abs() < 2.0 * SERVO.dead_angle());
    assert!((theta4 - START[1]).abs() < 2.0 * SERVO.dead_angle());
}

#[test]
fn no_pulse_leaves_the_range_of_the_widths() {
    let mut plant = arm(SERVO);
    plant.step(&command([5000, -5000]), TICK);
    assert_eq!(plant.width(), [2.5e-3, 0.5e-3]);
    // The sample has the units that were told.
    assert_eq!(plant.sense().counts, [5000, -5000]);
}

#[test]
fn the_torque_is_that_of_the_motor_at_a_voltage_of_the_supply() {
    let mut noise = Noise::new(3);
    for _ in 0..10_000 {
        let mut within = |most: f64| most * (2.0 * noise.uniform() - 1.0);
        let (error, speed) = (within(0.3), within(1.2 * SERVO.max_speed));
        let supply = 1.0 + within(0.3);
        let torque = SERVO.torque(error, speed, supply);
        let back_emf = speed / SERVO.max_speed;
        let voltage = torque / SERVO.stall_torque + back_emf;
        assert!(
            voltage.abs() <= supply + 1e-12,
            "{error} {speed}: {voltage}"
        );
        // A shorted motor brakes.
        if error.abs() <= SERVO.dead_angle() {
            assert!(voltage.abs() < 1e-12, "{error} {speed}: {voltage}");
        }
        // A joint that rests beyond the dead band is driven to its set-point, the more the farther it is.
        let at_rest = |error: f64| SERVO.torque(error, 0.0, supply);
        assert!(at_rest(error) * error >= 0.0);
        assert!(at_rest(1.1 * error.abs()) >= at_rest(error.abs()));
        let mirrored = SERVO.torque(-error, -speed, supply);
        assert!((mirrored + torque).abs() < 1e-12);
    }
}

#[test]
fn a_unit_of_the_timer_is_its_share_of_the_travel() {
    assert_eq!(SERVO.units_per_turn(), 8000.0);
    assert!((unit(&SERVO) - PI / 4000.0).abs() < 1e-15);
    // At its greatest speed a servo has no torque left, and at half of it half.
    let far = 1.0;
    assert_eq!(SERVO.torque(far, SERVO.max_speed, 1.0), 0.0);
    let half = SERVO.torque(far, 0.5 * SERVO.max_speed, 1.0);
    assert!((half - 0.5 * SERVO.stall_torque).abs() < 1e-12);
}
