//! Identification: the reference regressors, ranks, simulated logs, refusals, excitations.

use fivebar::input::robot::Robot;
use fivebar_design::Noise;
use fivebar_design::identification::{
    BASE_NAMES, Bounds, Excitation, IdentificationError, Log, Observed, Regressor, base_parameters,
    identify, propose_excitation, standard_parameters,
};
use fivebar_kinematics::dynamics::Arm;
use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
use nalgebra::{DMatrix, Vector2};
use serde_json::Value;
use std::f64::consts::TAU;

const RATE: f64 = 1e4;
const MODE: WorkingMode = WorkingMode::new(Side::Right, Side::Left);

fn numbers(value: &Value) -> Vec<f64> {
    let items = value.as_array().unwrap();
    items.iter().map(|item| item.as_f64().unwrap()).collect()
}

fn pair(value: &Value, first: usize, second: usize) -> [f64; 2] {
    let numbers = numbers(value);
    [numbers[first], numbers[second]]
}

#[test]
fn the_regressor_and_the_base_parameters_are_those_of_the_reference() {
    let text = include_str!("../../data/base_parameters.json");
    let reference: Value = serde_json::from_str(text).unwrap();
    let mut states = 0;
    for case in reference["cases"].as_array().unwrap() {
        let lengths: [f64; 5] = numbers(&case["link_lengths"]).try_into().unwrap();
        let geometry = Geometry::new(lengths).unwrap();
        let gravity = Vector2::from(pair(&case["gravity"], 0, 1));
        let links = case["standard"]
            .as_array()
            .unwrap()
            .iter()
            .flat_map(numbers);
        let standard: [f64; 16] = links.collect::<Vec<_>>().try_into().unwrap();
        let base = numbers(&case["base"]);
        let own = base_parameters(lengths, &standard);
        for (index, (own, wanted)) in own.iter().zip(&base).enumerate() {
            assert!((own - wanted).abs() < 1e-14, "{}", BASE_NAMES[index]);
        }
        for state in case["states"].as_array().unwrap() {
            let [q, omega, alpha] = ["theta", "omega", "alpha"].map(|key| pair(&state[key], 0, 3));
            let theta = numbers(&state["theta"]);
            let side = Side::BOTH.into_iter().find(|side| {
                let pose = geometry.forward(q[0], q[1], *side);
                pose.is_ok_and(|pose| {
                    (pose.angles()[1] - theta[1]).sin().abs() < 1e-9
                        && (pose.angles()[1] - theta[1]).cos() > 0.0
                })
            });
            let at = Regressor::at(&geometry, side.unwrap(), gravity, [q, omega, alpha]).unwrap();
            for joint in 0..2 {
                let rows = numbers(&state["base_rows"][joint]);
                for (index, wanted) in rows.iter().enumerate() {
                    let error = (at.base(index)[joint] - wanted).abs();
                    assert!(error <= 1e-10 * wanted.abs().max(1.0), "{index}: {error:e}");
                }
                let wanted = numbers(&state["torque"])[joint];
                let whole = at
                    .standard
                    .row(joint)
                    .transpose()
                    .dot(&nalgebra::SVector::from(standard));
                assert!((at.torque(&base)[joint] - wanted).abs() < 1e-10);
                assert!((whole - wanted).abs() < 1e-10);
            }
            states += 1;
        }
    }
    assert_eq!(states, 36);
}

#[test]
fn kanes_equations_give_the_torques_of_the_base_parameters() {
    let robot = Robot::load("air_hockey").unwrap();
    for gravity in [Vector2::zeros(), Vector2::new(0.3, -9.81)] {
        let own = robot.arm().unwrap();
        let arm = Arm::new(
            robot.geometry,
            *own.links(),
            own.payload(),
            gravity,
            own.rotor_inertia(),
        );
        let arm = arm.unwrap();
        let base = base_parameters(robot.geometry.lengths(), &standard_parameters(&arm));
        let used = if gravity == Vector2::zeros() { 7 } else { 11 };
        let home = robot.home_pose().unwrap();
        let [q1, _, _, q4] = home.angles();
        let (omega, alpha) = ([3.0, -2.0], [40.0, 25.0]);
        let at = Regressor::at(
            &robot.geometry,
            home.assembly(),
            gravity,
            [[q1, q4], omega, alpha],
        );
        let velocities = robot
            .geometry
            .forward_velocities(&home, omega[0], omega[1])
            .unwrap();
        let accelerations = robot
            .geometry
            .forward_accelerations(&home, &velocities, alpha[0], alpha[1])
            .unwrap();
        let kane = arm
            .inverse_dynamics(&home, &velocities, &accelerations, Vector2::zeros())
            .unwrap();
        let own = at.unwrap().torque(&base[..used]);
        for joint in 0..2 {
            assert!(
                (own[joint] / kane[joint] - 1.0).abs() < 1e-11,
                "{own:?} {kane:?}"
            );
        }
    }
}

/// The rank of a matrix with columns of one size.
fn rank(mut matrix: DMatrix<f64>) -> usize {
    for mut column in matrix.column_iter_mut() {
        let size = column.norm();
        column /= size.max(1e-300);
    }
    let values = matrix.singular_values();
    values
        .iter()
        .filter(|&&value| value > 1e-9 * values[0])
        .count()
}

#[test]
fn seven_parameters_are_seen_on_a_level_arm_and_eleven_with_gravity() {
    let mut noise = Noise::new(1);
    for lengths in [
        [0.10, 0.16, 0.16, 0.10, 0.08],
        [0.09, 0.10, 0.11, 0.085, 0.118],
    ] {
        let geometry = Geometry::new(lengths).unwrap();
        for (gravity, wanted) in [(Vector2::zeros(), 7), (Vector2::new(1.0, -9.0), 11)] {
            let mut rows = DMatrix::zeros(1200, 16);
            let mut friction = DMatrix::zeros(1200, wanted + 6);
            let mut found = 0;
            while found < 600 {
                let mut two = |size: f64| [size * noise.normal(), size * noise.normal()];
                let motion = [two(2.0), two(5.0), two(80.0)];
                let at = Regressor::at(&geometry, Side::Left, gravity, motion);
                let Some(at) = at.ok().filter(|at| at.pose.sin32().abs() > 0.3) else {
                    continue;
                };
                for joint in 0..2 {
                    let row = 2 * found + joint;
                    rows.set_row(row, &at.standard.row(joint));
                    for index in 0..wanted {
                        friction[(row, index)] = at.base(index)[joint];
                    }
                    friction[(row, wanted + joint)] = motion[1][joint];
                    friction[(row, wanted + 2 + joint)] = motion[1][joint].signum();
                    friction[(row, wanted + 4 + joint)] = 1.0;
                }
                found += 1;
            }
            // Columns without gravity that are zero have no rank.
            assert_eq!(rank(rows), wanted);
            assert_eq!(rank(friction), wanted + 6);
        }
    }
}

/// An upright or level benchtop arm as it is, heavier than drawn, and its excitation.
struct Setup {
    arm: Arm<f64>,
    base: Vec<f64>,
    excitation: Excitation,
}

fn setup(upright: bool, which: usize) -> Setup {
    let robot = Robot::load("benchtop").unwrap();
    let drawn = robot.arm().unwrap();
    let links = drawn
        .links()
        .map(|link| fivebar_kinematics::dynamics::Link {
            mass: 1.1 * link.mass,
            inertia: 1.1 * link.inertia,
            ..link
        });
    let gravity = if upright {
        Vector2::new(0.0, -9.81)
    } else {
        Vector2::zeros()
    };
    let arm = Arm::new(robot.geometry, links, 0.05, gravity, drawn.rotor_inertia()).unwrap();
    let base = base_parameters(robot.geometry.lengths(), &standard_parameters(&arm));
    let text = if upright {
        include_str!("../../data/excitation_gravity.json")
    } else {
        include_str!("../../data/excitation_level.json")
    };
    let file: Value = serde_json::from_str(text).unwrap();
    let coefficients = numbers(&file["x"][which]).try_into().unwrap();
    let period = file["period_s"].as_f64().unwrap();
    Setup {
        arm,
        base: base[..if upright { 11 } else { 7 }].to_vec(),
        excitation: Excitation {
            period,
            coefficients,
        },
    }
}

fn observed(arm: &Arm<f64>) -> Observed<'_> {
    Observed {
        geometry: arm.geometry(),
        assembly: Side::Left,
        mode: MODE,
        gravity: arm.gravity(),
        torque_per_ampere: [8.0 * 0.0234; 2],
        current_limit: [4.0; 2],
        tick_rate: RATE,
    }
}

const VISCOUS: [f64; 2] = [1.95e-3, 1.6e-3];
const COULOMB: [f64; 2] = [11.7e-3, 9e-3];

/// A log of the excitation: the torque of each tick by Kane's equations in its middle, with
/// friction, an offset of 4 mA, and noise of the current sensors and encoders of this share.
fn log(setup: &Setup, periods: f64, noisy: f64) -> Log {
    let mut noise = Noise::new(5);
    let mut log = Log::default();
    let geometry = setup.arm.geometry();
    for tick in 0..(periods * setup.excitation.period * RATE) as u32 {
        let time = f64::from(tick) / RATE;
        let [q, ..] = setup.excitation.at(time);
        let [middle, omega, alpha] = setup.excitation.at(time - 0.5 / RATE);
        let pose = geometry.forward(middle[0], middle[1], Side::Left).unwrap();
        let velocities = geometry
            .forward_velocities(&pose, omega[0], omega[1])
            .unwrap();
        let accelerations = geometry
            .forward_accelerations(&pose, &velocities, alpha[0], alpha[1])
            .unwrap();
        let torque =
            setup
                .arm
                .inverse_dynamics(&pose, &velocities, &accelerations, Vector2::zeros());
        let torque = torque.unwrap();
        let current = |joint: usize, noise: &mut Noise| {
            let x = omega[joint] / 0.02;
            let friction =
                VISCOUS[joint] * omega[joint] + COULOMB[joint] * x / (1.0 + x * x).sqrt();
            (torque[joint] + friction) / (8.0 * 0.0234) + 4e-3 + noisy * 8e-3 * noise.normal()
        };
        let step = TAU / 131_072.0;
        let angle = |q: f64| {
            if noisy > 0.0 {
                ((q / step).floor() + 0.5) * step
            } else {
                q
            }
        };
        log.times.push(time);
        log.angles.push(q.map(angle));
        log.currents
            .push([current(0, &mut noise), current(1, &mut noise)]);
    }
    log
}

#[test]
fn heavier_arms_with_noisy_sensors_are_identified() {
    for upright in [false, true] {
        let setup = setup(upright, 0);
        let found = identify(&log(&setup, 10.0, 1.0), &observed(&setup.arm)).unwrap();
        println!("{found:?}");
        for (index, (own, wanted)) in found.base.iter().zip(&setup.base).enumerate() {
            println!(
                "{} {own:.6e} {wanted:.6e} sd {:.1e}",
                BASE_NAMES[index], found.base_sd[index]
            );
        }
        let condition = if upright { 20.0..45.0 } else { 5.0..9.0 };
        assert!(condition.contains(&found.condition), "{}", found.condition);
        let great = [0, 1, 2, 4, 7, 9];
        for (index, (own, wanted)) in found.base.iter().zip(&setup.base).enumerate() {
            let error = (own - wanted).abs();
            let bound = if great.contains(&index) {
                2e-3 * wanted.abs()
            } else {
                6.0 * found.base_sd[index] + 1e-6
            };
            assert!(
                error < bound,
                "{}: {own:e} for {wanted:e}",
                BASE_NAMES[index]
            );
        }
        for joint in 0..2 {
            assert!(
                (found.viscous[joint] / VISCOUS[joint] - 1.0).abs() < 0.01,
                "{:?}",
                found.viscous
            );
            assert!(
                (found.coulomb[joint] / COULOMB[joint] - 1.0).abs() < 0.01,
                "{:?}",
                found.coulomb
            );
            let offset = 4e-3 * 8.0 * 0.0234;
            assert!((found.offset[joint] - offset).abs() < 5.0 * found.offset_sd[joint] + 2e-5);
            assert!(found.residual_rms[joint] < 3e-4, "{:?}", found.residual_rms);
        }
    }
}

#[test]
fn bad_logs_are_refused_with_their_reason() {
    let setup = setup(false, 1);
    let observed = observed(&setup.arm);
    let whole = log(&setup, 2.0, 1.0);
    assert!(identify(&whole, &observed).is_ok());
    let refusal = |change: &dyn Fn(&mut Log)| {
        let mut log = whole.clone();
        change(&mut log);
        identify(&log, &observed).unwrap_err()
    };
    let swap = |rows: &mut Vec<[f64; 2]>| rows.iter_mut().for_each(|row| row.swap(0, 1));
    assert_eq!(
        refusal(&|log| log.angles.iter_mut().for_each(|row| row[1] = 0.8)),
        IdentificationError::Still(4, 0.0)
    );
    let saturated = refusal(&|log| {
        for row in &mut log.currents {
            row[0] = (8.0 * row[0]).clamp(-4.0, 4.0);
        }
    });
    assert!(
        matches!(saturated, IdentificationError::Saturated(1, _)),
        "{saturated}"
    );
    let gap = refusal(&|log| {
        log.times.drain(700..720);
        log.angles.drain(700..720);
        log.currents.drain(700..720);
    });
    assert!(matches!(gap, IdentificationError::Gap(700, _)), "{gap}");
    let rate = refusal(&|log| log.times.iter_mut().for_each(|time| *time *= 2.0));
    assert!(matches!(rate, IdentificationError::Rate(..)), "{rate}");
    let jump = refusal(&|log| log.angles[900..].iter_mut().for_each(|row| row[0] += 1.0));
    assert_eq!(jump, IdentificationError::Jump(1, 900));
    assert_eq!(
        refusal(&|log| swap(&mut log.angles)),
        IdentificationError::SwappedAngles
    );
    assert_eq!(
        refusal(&|log| {
            swap(&mut log.angles);
            swap(&mut log.currents);
        }),
        IdentificationError::SwappedAngles
    );
    assert_eq!(
        refusal(&|log| swap(&mut log.currents)),
        IdentificationError::SwappedCurrents
    );
    let reversed = refusal(&|log| {
        log.currents
            .iter_mut()
            .for_each(|row| *row = [-row[0], -row[1]])
    });
    assert_eq!(reversed, IdentificationError::Reversed);
    let one = refusal(&|log| log.currents.iter_mut().for_each(|row| row[1] = -row[1]));
    assert!(
        matches!(
            one,
            IdentificationError::Reversed | IdentificationError::Unexplained(..)
        ),
        "{one}"
    );
    let short = refusal(&|log| log.times.truncate(3000));
    assert!(matches!(short, IdentificationError::TooShort(_)), "{short}");
    let nan = refusal(&|log| log.currents[41][0] = f64::NAN);
    assert_eq!(nan, IdentificationError::NotFinite(42));
    // Whole turns in the angles are none of its business.
    let mut turned = whole.clone();
    turned.angles[5000..]
        .iter_mut()
        .for_each(|row| row[0] += TAU);
    let [plain, turned] = [&whole, &turned].map(|log| identify(log, &observed).unwrap());
    assert!((plain.base[0] / turned.base[0] - 1.0).abs() < 1e-6);
}

#[test]
fn a_late_current_shows_in_the_coupler() {
    // The current of a row acts before its tick. Without that half tick J3* is off by 12 %.
    let setup = setup(false, 0);
    let mut early = log(&setup, 4.0, 0.0);
    let sound = identify(&early, &observed(&setup.arm)).unwrap();
    early.currents.remove(0);
    early.currents.push([0.0; 2]);
    let shifted = identify(&early, &observed(&setup.arm)).unwrap();
    let error = |found: &fivebar_design::identification::Identification| {
        (found.base[3] / setup.base[3] - 1.0).abs()
    };
    assert!(error(&sound) < 0.01, "{}", error(&sound));
    assert!(error(&shifted) > 0.05, "{}", error(&shifted));
}

#[test]
fn proposed_excitations_keep_within_every_limit() {
    for (upright, worst) in [(false, 10.0), (true, 50.0)] {
        let setup = setup(upright, 0);
        let bounds = Bounds {
            geometry: *setup.arm.geometry(),
            assembly: Side::Left,
            mode: MODE,
            gravity: setup.arm.gravity(),
            base: base_parameters(
                setup.arm.geometry().lengths(),
                &standard_parameters(&setup.arm),
            ),
            friction: [[1.5e-3, 9e-3]; 2],
            angle: [[0.65, 3.55], [-0.41, 2.49]],
            velocity: [20.0; 2],
            acceleration: [900.0; 2],
            torque: [0.5; 2],
            torque_rms: [0.2; 2],
            margin: 0.3,
            middle: [2.2, 0.9],
        };
        for seed in [1, 2] {
            let found = propose_excitation(&bounds, seed).unwrap();
            println!("{upright} {seed}: {}", found.condition);
            assert!(
                found.condition <= worst,
                "{upright} {seed}: {}",
                found.condition
            );
            let mut squares = [0.0; 2];
            for step in 0..1000 {
                let time = 1.25e-3 * f64::from(step);
                let [q, omega, alpha] = found.excitation.at(time);
                // The derivatives are those of the angles.
                let h = 1e-5;
                let [before, ..] = found.excitation.at(time - h);
                let [behind, ..] = found.excitation.at(time + h);
                let motion = [q, omega, alpha];
                let at =
                    Regressor::at(&bounds.geometry, Side::Left, bounds.gravity, motion).unwrap();
                let used = if upright { 11 } else { 7 };
                let torque = at.torque(&bounds.base[..used]);
                for joint in 0..2 {
                    assert!(
                        ((behind[joint] - before[joint]) / (2.0 * h) - omega[joint]).abs() < 1e-5
                    );
                    let [least, greatest] = bounds.angle[joint];
                    assert!(least - 2e-3 < q[joint] && q[joint] < greatest + 2e-3);
                    assert!(omega[joint].abs() < 20.2 && alpha[joint].abs() < 905.0);
                    let friction = 1.5e-3 * omega[joint] + 9e-3 * omega[joint].signum();
                    assert!((torque[joint] + friction).abs() < 0.51);
                    squares[joint] += (torque[joint] + friction).powi(2) / 1000.0;
                }
                let pose = at.pose;
                for sine in [pose.sin21(), pose.sin34(), pose.sin32()] {
                    assert!(sine.abs() > 0.295, "{sine}");
                }
                assert_eq!(pose.working_mode(), MODE);
            }
            assert!(squares.iter().all(|square| square.sqrt() < 0.202));
        }
    }
}
