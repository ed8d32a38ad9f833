//! What a run takes of its motors' limits.

use crate::steppers::run;
use fivebar_design::Noise;
use fivebar_files::robot::{
    BUILT_IN, CanMotor, Draft, Motor, Motors, Robot, ServoMotor, StepperMotor,
};
use fivebar_files::scenario::Scenario;
use fivebar_sim::simulation::Simulate;

/// A robot's petal job, as fast as its limits allow, with masses and friction of this share more than its model's.
fn petal(robot: Robot, off: f64) -> Scenario {
    let text = include_str!("../../../host/files/jobs/petal.gcode");
    let mut scenario = Scenario::new("petal", robot, "petal.gcode", text.into());
    scenario.fit().unwrap();
    (scenario.mismatch.link_mass, scenario.mismatch.friction) = (off, off);
    scenario
}

#[test]
fn a_job_that_is_drawn_takes_no_more_than_its_limits_whatever_turns_the_joints() {
    let mut noise = Noise::new(71);
    let mut drawn = 0;
    for built_in in BUILT_IN {
        let robot = built_in.robot().unwrap();
        if robot.arm().is_err() {
            continue;
        }
        let (summary, _) = run(&petal(robot, 0.3 * (2.0 * noise.uniform() - 1.0)));
        if !summary.verdict.drawn {
            continue;
        }
        let share = summary.torque_share.expect("a job");
        println!("{}: {share:.3}", summary.robot);
        assert!(share > 0.0 && share <= 1.0, "{}: {share}", summary.robot);
        drawn += 1;
    }
    assert!(drawn >= 5, "{drawn}");
}

/// An arm of random lengths about the benchtop arm's, as `fivebar new` makes it, on these motors.
fn random_arm(motors: Motors, noise: &mut Noise) -> Option<Robot> {
    let mut about = |least: f64, most: f64| least + (most - least) * noise.uniform();
    let mut draft = Draft::new("random");
    draft.set_base(about(0.04, 0.12));
    let crank = about(0.06, 0.14);
    draft.set_cranks([crank, crank * about(0.85, 1.18)]);
    draft.payload = about(0.01, 0.05);
    if let Motors::HobbyServos(_) = motors {
        draft.voltage = 5.0;
    }
    draft.motors = motors;
    draft.check().ok()
}

#[test]
fn a_random_arm_takes_no_more_than_its_limits_for_a_job_that_it_draws_whatever_turns_its_joints() {
    let mut noise = Noise::new(72);
    for motors in [
        Motors::Brushed(Motor::TYPICAL),
        Motors::Steppers(StepperMotor::TYPICAL),
        Motors::CanDrives(CanMotor::TYPICAL),
        Motors::CanDrives(CanMotor::TYPICAL_MIT),
        Motors::HobbyServos(ServoMotor::TYPICAL),
    ] {
        let (mut drawn, mut tried) = (0, 0);
        while drawn < 2 {
            tried += 1;
            assert!(tried < 10, "{motors:?}: of {tried} arms {drawn} draw");
            let Some(robot) = random_arm(motors.clone(), &mut noise) else {
                continue;
            };
            let off = 0.3 * (2.0 * noise.uniform() - 1.0);
            let (summary, _) = run(&petal(robot, off));
            if !summary.verdict.drawn {
                println!("{:?}", summary.verdict.why);
                continue;
            }
            let share = summary.torque_share.expect("a job");
            println!("{:.40}: {share:.3}", format!("{motors:?}"));
            assert!(share > 0.0 && share <= 1.0, "{motors:?}: {share}");
            drawn += 1;
        }
    }
}
