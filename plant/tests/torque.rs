//! The arm with torques on its rotors against the equations of motion of the controller's model.

use fivebar_firmware::Settings;
use fivebar_kinematics::five_bar::{Joint, Pose};
use fivebar_plant::{GREATEST_STEP, Mismatch, Parameters, TooFast, TorquePlant, TorqueState};
use nalgebra::Vector2;

fn parameters() -> Parameters {
    let mut parameters = Parameters::from_settings(&Settings::BENCHTOP, 24.0).unwrap();
    for motor in &mut parameters.motors {
        (motor.viscous_friction, motor.coulomb_friction) = (0.0, 0.0);
    }
    parameters
}

fn pose([theta1, theta4]: [f64; 2]) -> Pose<f64> {
    let assembly = Settings::BENCHTOP.assembly();
    let geometry = *parameters().arm.geometry();
    geometry.forward(theta1, theta4, assembly).unwrap()
}

#[test]
fn it_moves_as_the_equations_of_motion_say() {
    let parameters = parameters();
    let torque = [0.08, -0.05];
    // θ and ω of the model by RK4 with steps of 0.1 ms.
    let (mut q, mut v) = ([2.2, 0.9], [0.0; 2]);
    let acceleration = |q: [f64; 2], v: [f64; 2]| {
        let (pose, arm) = (pose(q), &parameters.arm);
        let velocities = arm.geometry().forward_velocities(&pose, v[0], v[1]);
        let found = arm.forward_dynamics(&pose, &velocities.unwrap(), torque, Vector2::zeros());
        found.unwrap()
    };
    let ahead = |x: [f64; 2], rate: [f64; 2], time: f64| [0, 1].map(|j| x[j] + time * rate[j]);
    let h = 1e-4;
    let mut arm = TorquePlant::new(&parameters, &Mismatch::NONE, &pose(q));
    for step in 0..1000 {
        let (v1, a1) = (v, acceleration(q, v));
        let (v2, a2) = (
            ahead(v, a1, h / 2.0),
            acceleration(ahead(q, v1, h / 2.0), ahead(v, a1, h / 2.0)),
        );
        let (v3, a3) = (
            ahead(v, a2, h / 2.0),
            acceleration(ahead(q, v2, h / 2.0), ahead(v, a2, h / 2.0)),
        );
        let (v4, a4) = (
            ahead(v, a3, h),
            acceleration(ahead(q, v3, h), ahead(v, a3, h)),
        );
        let mean = |one: [f64; 2], two: [f64; 2], three: [f64; 2], four: [f64; 2]| {
            [0, 1].map(|j| (one[j] + 2.0 * (two[j] + three[j]) + four[j]) / 6.0)
        };
        q = ahead(q, mean(v1, v2, v3, v4), h);
        v = ahead(v, mean(a1, a2, a3, a4), h);
        if step % 10 == 9 {
            arm.step(torque, 10.0 * h).unwrap();
        }
    }
    for j in Joint::ALL {
        let (angle, velocity) = (arm.angle(j) - q[j], arm.velocity(j) - v[j]);
        assert!(
            angle.abs() < 1e-7 && velocity.abs() < 1e-6,
            "{angle} rad, {velocity} rad/s"
        );
        assert!(v[j].abs() > 0.5, "it moves: {v:?}");
    }
    assert!((arm.time() - 0.1).abs() < 1e-12);
}

#[test]
fn friction_ends_the_motion_and_no_brake_holds_it() {
    let mut parameters = Parameters::from_settings(&Settings::BENCHTOP, 24.0).unwrap();
    parameters.brake_torque = [10.0; 2];
    let mut arm = TorquePlant::new(&parameters, &Mismatch::NONE, &pose([2.2, 0.9]));
    for _ in 0..50 {
        arm.step([0.1, 0.0], 1e-3).unwrap();
    }
    let turned = arm.angle(Joint::Joint1) - 2.2;
    assert!(turned > 0.01, "{turned} rad");
    let rolling = arm.velocity(Joint::Joint1);
    for _ in 0..200 {
        arm.step([0.0; 2], 1e-3).unwrap();
    }
    assert!(arm.velocity(Joint::Joint1).abs() < 0.9 * rolling.abs());
}

/// θ and ω of joints 1 and 4, and the time, bit by bit.
fn bits(arm: &TorquePlant) -> [u64; 5] {
    let [one, four] = Joint::ALL.map(|j| [arm.angle(j), arm.velocity(j)]);
    [one[0], one[1], four[0], four[1], arm.time()].map(f64::to_bits)
}

#[test]
fn a_long_step_is_integrated_in_steps_of_the_greatest_length() {
    let parameters = parameters();
    let new = || TorquePlant::new(&parameters, &Mismatch::NONE, &pose([2.2, 0.9]));
    let (mut once, mut often, mut finely) = (new(), new(), new());
    once.step([0.03, -0.02], 200.0 * GREATEST_STEP).unwrap();
    for _ in 0..200 {
        often.step([0.03, -0.02], GREATEST_STEP).unwrap();
    }
    for _ in 0..2_000 {
        finely.step([0.03, -0.02], 0.1 * GREATEST_STEP).unwrap();
    }
    assert_eq!(bits(&once), bits(&often));
    for j in Joint::ALL {
        let off = once.angle(j) - finely.angle(j);
        assert!(off.abs() < 1e-7, "{off} rad");
    }
    assert!(once.velocity(Joint::Joint1).abs() > 1.0);
}

#[test]
fn a_motion_that_is_not_finite_or_too_fast_is_refused_and_changes_nothing() {
    let parameters = parameters();
    let mut arm = TorquePlant::new(&parameters, &Mismatch::NONE, &pose([2.2, 0.9]));
    arm.step([0.05, 0.0], 0.01).unwrap();
    let before = bits(&arm);
    for (torque, time) in [
        ([1e308, 0.0], 1e-3),
        ([0.0, -1e308], 1.0),
        ([f64::NAN, 0.0], 1e-6),
        ([0.0; 2], f64::NAN),
        ([1e5, 0.0], 1e-3),
    ] {
        assert_eq!(arm.step(torque, time), Err(TooFast), "{torque:?}, {time}");
        assert_eq!(bits(&arm), before);
    }
    arm.step([0.05, 0.0], 1e-3).unwrap();
    assert!(Joint::ALL.iter().all(|&j| arm.velocity(j).is_finite()));
}

#[test]
fn an_arm_put_back_into_a_state_moves_on_with_the_same_bits() {
    let parameters = Parameters::from_settings(&Settings::BENCHTOP, 24.0).unwrap();
    let mismatch = Mismatch {
        stiction: [0.02, 0.01],
        payload: 0.05,
        ..Mismatch::NONE
    };
    let new = || TorquePlant::new(&parameters, &mismatch, &pose([2.2, 0.9]));
    let mut arm = new();
    for _ in 0..50 {
        arm.step([0.05, -0.03], 1e-3).unwrap();
    }
    let state = arm.state();
    assert!(state.drives[0].bristles != 0.0, "{state:?}");
    let numbers = state.to_numbers();
    assert_eq!(TorqueState::from_numbers(&numbers), state);
    assert_eq!(numbers[30], arm.time());
    let mut other = new();
    other.set_state(&TorqueState::from_numbers(&numbers));
    for _ in 0..50 {
        arm.step([-0.02, 0.03], 1e-3).unwrap();
        other.step([-0.02, 0.03], 1e-3).unwrap();
    }
    assert_eq!(bits(&arm), bits(&other));
    assert_eq!(arm.state(), other.state());
}

#[test]
fn an_arm_put_into_a_motion_has_its_angles_and_velocities() {
    let parameters = parameters();
    let geometry = *parameters.arm.geometry();
    let mut arm = TorquePlant::new(&parameters, &Mismatch::NONE, &pose([2.2, 0.9]));
    let there = pose([2.0, 1.1]);
    let velocities = geometry.forward_velocities(&there, 3.0, -2.0).unwrap();
    arm.set_motion(&there, velocities.omega);
    let [one, four] = Joint::ALL.map(|j| [arm.angle(j), arm.velocity(j)]);
    for (found, expected) in one.into_iter().chain(four).zip([2.0, 3.0, 1.1, -2.0]) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
    assert!((arm.tool() - there.c).norm() < 1e-12);
    // Without torques and friction it keeps its energy: it goes on as fast.
    arm.step([0.0; 2], 1e-6).unwrap();
    assert!((arm.velocity(Joint::Joint1) - 3.0).abs() < 1e-3);
}

#[test]
fn a_tolerance_bounds_the_error_and_a_smaller_one_bounds_it_more() {
    let parameters = parameters();
    let ended = |tolerance: Option<f64>, step: f64| {
        let arm = TorquePlant::new(&parameters, &Mismatch::NONE, &pose([2.2, 0.9]));
        let mut arm = match tolerance {
            Some(tolerance) => arm.with_tolerance(tolerance),
            None => arm,
        };
        for _ in 0..(0.1 / step).round() as usize {
            arm.step([0.4, -0.3], step).unwrap();
        }
        Joint::ALL.map(|j| arm.angle(j))
    };
    let exact = ended(None, 2e-5);
    let error = |found: [f64; 2]| (found[0] - exact[0]).hypot(found[1] - exact[1]);
    let [plain, coarse, fine] = [
        error(ended(None, 1e-3)),
        error(ended(Some(1e-9), 1e-3)),
        error(ended(Some(1e-12), 1e-3)),
    ];
    println!("{plain:e} {coarse:e} {fine:e}");
    // 100 steps of 1 ms whose errors add up, and grow on the way.
    assert!(
        plain > coarse && coarse > fine,
        "{plain:e} {coarse:e} {fine:e}"
    );
    assert!(coarse < 1e-7 && fine < 1e-9, "{coarse:e} {fine:e}");
}

/// Arms with unlike motions, lengths, friction, belts and one of them with a tolerance; the fast ones need shorter steps.
fn unlike_arms() -> Vec<TorquePlant> {
    let parameters = Parameters::from_settings(&Settings::BENCHTOP, 24.0).unwrap();
    let arm = |i: usize| {
        let share = 0.1 * i as f64;
        let differs = Mismatch {
            payload: 0.01 * share,
            stiction: [0.02 * f64::from(u8::from(i % 3 == 1)), 0.0],
            torque_ripple: [0.02 * f64::from(u8::from(i % 4 == 2)), 0.0],
            ..Mismatch::NONE
        };
        let start = pose([2.2 - 0.1 * share, 0.9 + 0.1 * share]);
        let mut arm = TorquePlant::new(&parameters, &differs, &start);
        let speed = if i % 5 == 4 { 300.0 } else { share };
        let geometry = *parameters.arm.geometry();
        let velocities = geometry.forward_velocities(&start, speed, speed).unwrap();
        arm.set_motion(&start, velocities.omega);
        match i {
            17 => arm.with_tolerance(1e-9),
            _ => arm,
        }
    };
    (0..29).map(arm).collect()
}

#[test]
fn arms_side_by_side_have_the_bits_of_each_by_itself() {
    let (mut many, mut singles) = (unlike_arms(), unlike_arms());
    let mut halved = 0;
    for step in 0..40 {
        let share = |i: usize| (i as f64 + f64::from(step)).sin();
        let torques: Vec<_> = (0..many.len())
            .map(|i| [0.05 * share(i), -0.03 * share(i)])
            .collect();
        let pushed = |i: usize| {
            if i.is_multiple_of(2) {
                [0.0; 2]
            } else {
                [0.1 * share(i), 0.2]
            }
        };
        let forces: Vec<_> = (0..many.len()).map(pushed).collect();
        assert_eq!(
            TorquePlant::step_many(&mut many, &torques, &forces, 1.5e-3),
            None
        );
        for (i, arm) in singles.iter_mut().enumerate() {
            let before = arm.angle(Joint::Joint1);
            arm.set_tool_force(forces[i].into());
            arm.step(torques[i], 1.5e-3).unwrap();
            halved += usize::from((arm.angle(Joint::Joint1) - before).abs() > 0.2);
            assert_eq!(arm.state(), many[i].state(), "arm {i}, step {step}");
        }
    }
    assert!(halved > 20, "{halved} steps needed shorter ones");
}

#[test]
fn of_arms_side_by_side_those_that_cannot_go_on_stay_and_the_others_move() {
    // Among those that go eight at once, four at once, and by themselves.
    for stopping in [&[6, 21, 26][..], &[26], &[28]] {
        let (mut many, mut singles) = (unlike_arms(), unlike_arms());
        let mut torques = vec![[0.01, 0.0]; many.len()];
        for &stopped in stopping {
            torques[stopped][0] = 1e9;
        }
        let forces = vec![[0.0; 2]; many.len()];
        assert_eq!(
            TorquePlant::step_many(&mut many, &torques, &forces, 3e-3),
            Some(stopping[0])
        );
        for (i, arm) in singles.iter_mut().enumerate() {
            assert_eq!(arm.step(torques[i], 3e-3).is_err(), stopping.contains(&i));
            assert_eq!(arm.state(), many[i].state(), "arm {i}");
        }
    }
}
