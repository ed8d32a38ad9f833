//! Identification of random arms: shapes, modes, gravity, tick rates, excited by their own proposals.

use fivebar_design::Noise;
use fivebar_design::identification::{
    Bounds, Excitation, IdentificationError, Log, Observed, base_parameters, identify,
    propose_excitation, standard_parameters,
};
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{Geometry, Joint, Pose, Tool, WorkingMode, Workspace};
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// Rates of the logs [Hz].
const RATES: [f64; 4] = [10e3, 5e3, 2e3, 20e3];
/// The gravity in the plane of arms that stand [m/s²].
const UPRIGHT: Vector2<f64> = Vector2::new(3.0, -9.0);

/// A random arm with a pose far from singularities in the middle of a region.
fn random_arm(noise: &mut Noise, gravity: Vector2<f64>) -> Option<(Arm<f64>, Pose<f64>)> {
    let lengths =
        [0.10, 0.16, 0.16, 0.10, 0.08].map(|length| length * (0.85 + 0.3 * noise.uniform()));
    let geometry = Geometry::new(lengths).ok()?;
    let links = [0, 1, 2, 3].map(|link: usize| Link {
        mass: 0.05 + 0.05 * noise.uniform(),
        com: Vector2::new(
            lengths[link] * (0.3 + 0.3 * noise.uniform()),
            3e-3 * noise.normal(),
        ),
        inertia: 1e-4 * (1.0 + noise.uniform()),
    });
    let arm = Arm::new(geometry, links, 0.03, gravity, [6.4e-5; 2]).ok()?;
    let mode = WorkingMode::ALL[(4.0 * noise.uniform()) as usize];
    let tool = Tool::new(geometry, Vector2::zeros()).ok()?;
    let workspace = Workspace {
        tool,
        mode,
        limits: None,
        margin: 0.7,
    };
    (0..500).find_map(|_| {
        let c = Vector2::new(0.5 * noise.uniform() - 0.2, 0.5 * noise.uniform() - 0.25);
        workspace.check(c).ok()?;
        Some((arm, geometry.inverse(c, mode).ok()?))
    })
}

/// Coulomb friction may change its sign at once or within some velocity.
fn smooth_sign(omega: f64, number: usize) -> f64 {
    match number % 3 {
        0 => omega.signum(),
        1 => (omega / 0.01).tanh(),
        _ => (omega / 0.05).clamp(-1.0, 1.0),
    }
}

#[test]
fn random_level_arms_are_identified_and_their_swapped_logs_refused() {
    random_arms_are_identified(Vector2::zeros(), 9, &RATES[..2]);
}

#[test]
fn random_upright_arms_are_identified_and_their_swapped_logs_refused() {
    random_arms_are_identified(UPRIGHT, 10, &RATES[..2]);
}

#[test]
#[ignore = "ten seconds: ./ci.sh tables"]
fn whole_table_of_random_arms_that_are_identified_at_each_rate() {
    random_arms_are_identified(Vector2::zeros(), 9, &RATES);
    random_arms_are_identified(UPRIGHT, 10, &RATES);
}

/// An arm for each of these rates of its log [Hz].
fn random_arms_are_identified(gravity: Vector2<f64>, seed: u64, rates: &[f64]) {
    let mut noise = Noise::new(seed);
    let mut done = 0;
    for number in 0.. {
        let Some(&rate) = rates.get(done) else {
            break;
        };
        let Some((arm, middle)) = random_arm(&mut noise, gravity) else {
            continue;
        };
        let base = base_parameters(arm.geometry().lengths(), &standard_parameters(&arm));
        let [theta1, _, _, theta4] = middle.angles();
        let bounds = Bounds {
            geometry: *arm.geometry(),
            assembly: middle.assembly(),
            mode: middle.working_mode(),
            gravity,
            base,
            friction: [[1.5e-3, 9e-3]; 2],
            angle: [[theta1 - 2.0, theta1 + 2.0], [theta4 - 2.0, theta4 + 2.0]],
            velocity: [20.0; 2],
            acceleration: [900.0; 2],
            torque: [0.6; 2],
            torque_rms: [0.3; 2],
            margin: 0.3,
            middle: [theta1, theta4],
        };
        let Some(proposed) = propose_excitation(&bounds, number) else {
            continue;
        };
        done += 1;
        let log = recorded(
            &proposed.excitation,
            &arm,
            &middle,
            rate,
            (done, &mut noise),
        );
        let observed = Observed {
            geometry: arm.geometry(),
            assembly: middle.assembly(),
            mode: middle.working_mode(),
            gravity,
            torque_per_ampere: [0.2; 2],
            current_limit: [6.0; 2],
            tick_rate: rate,
        };
        let found = identify(&log, &observed).unwrap_or_else(|error| panic!("{number}: {error}"));
        let largest = |range: std::ops::Range<usize>| {
            base[range].iter().fold(0.0, |a: f64, b| a.max(b.abs()))
        };
        for (index, (own, wanted)) in found.base.iter().zip(&base).enumerate() {
            let size = if index < 4 {
                largest(0..4)
            } else {
                largest(4..if gravity == Vector2::zeros() { 7 } else { 11 })
            };
            let error = (own - wanted).abs();
            assert!(
                error < 0.01 * size,
                "{number} at {rate} Hz: {index}: {error:e} of {size:e}"
            );
        }
        for joint in 0..2 {
            for (own, sd, wanted) in [
                (found.viscous, found.viscous_sd, 1.5e-3),
                (found.coulomb, found.coulomb_sd, 9e-3),
            ] {
                let error = (own[joint] - wanted).abs();
                println!("{number} at {rate} Hz: {error:e}, sd {:e}", sd[joint]);
                assert!(error < (0.02 * wanted).max(6.0 * sd[joint]));
            }
        }
        swapped_logs_are_refused(&log, &observed, number);
        let other = Observed {
            assembly: middle.assembly().opposite(),
            ..observed
        };
        assert!(identify(&log, &other).is_err());
    }
}

/// The log of an excitation: whole counts of the encoders, noisy currents. The kind of friction is that of
/// this number.
fn recorded(
    excitation: &Excitation,
    arm: &Arm<f64>,
    middle: &Pose<f64>,
    rate: f64,
    (kind, noise): (usize, &mut Noise),
) -> Log {
    let mut log = Log::default();
    for tick in 0..(5.0 * rate) as u32 {
        let time = f64::from(tick) / rate;
        let [q, ..] = excitation.at(time);
        let [half, omega, alpha] = excitation.at(time - 0.5 / rate);
        let geometry = arm.geometry();
        let pose = geometry
            .forward(half[0], half[1], middle.assembly())
            .unwrap();
        let velocities = geometry
            .forward_velocities(&pose, omega[0], omega[1])
            .unwrap();
        let accelerations = geometry
            .forward_accelerations(&pose, &velocities, alpha[0], alpha[1])
            .unwrap();
        let torque = arm.inverse_dynamics(&pose, &velocities, &accelerations, Vector2::zeros());
        let torque = torque.unwrap();
        let step = TAU / 131_072.0;
        log.times.push(time);
        log.angles
            .push(q.map(|q| ((q / step).floor() + 0.5) * step));
        log.currents.push(Joint::ALL.map(|joint| {
            let friction = 1.5e-3 * omega[joint] + 9e-3 * smooth_sign(omega[joint], kind);
            (torque[joint] + friction) / 0.2 + 5e-3 * noise.normal()
        }));
    }
    log
}

/// Refuses logs with columns of the joints swapped, and names them.
fn swapped_logs_are_refused(log: &Log, observed: &Observed<'_>, number: u64) {
    for (angles, currents) in [(true, true), (true, false), (false, true)] {
        let mut swapped = log.clone();
        if angles {
            swapped.angles.iter_mut().for_each(|row| row.swap(0, 1));
        }
        if currents {
            swapped.currents.iter_mut().for_each(|row| row.swap(0, 1));
        }
        let error = identify(&swapped, observed).unwrap_err();
        let named = match error {
            IdentificationError::SwappedAngles => angles,
            IdentificationError::SwappedCurrents => !angles,
            IdentificationError::OtherMode(_) => angles,
            _ => false,
        };
        assert!(named, "{number}: {angles} {currents}: {error}");
    }
}
