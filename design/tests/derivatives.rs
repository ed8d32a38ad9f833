//! Derivatives by hyper-dual numbers against central differences of the kinematics.

use fivebar_design::derivatives::{QUANTITIES, State, VARIABLES, derivatives, first_derivatives};
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{Geometry, Side};
use fivebar_testkit::{Tally, geometry};
use nalgebra::Vector2;
use proptest::prelude::*;

/// The variables as a row, in the order of `VARIABLE_NAMES`.
fn row(arm: &Arm<f64>, state: &State) -> [f64; VARIABLES] {
    let [t1, t4] = state.theta;
    let [w1, w4] = state.omega;
    let [a1, a4] = state.alpha;
    let [l1, l2, l3, l4, base] = arm.geometry().lengths();
    let [m1, m2, m3, m4] = [0, 1, 2, 3].map(|link| arm.links()[link].mass);
    [t1, t4, w1, w4, a1, a4, l1, l2, l3, l4, base, m1, m2, m3, m4]
}

/// The arm and the state with other variables.
fn changed(arm: &Arm<f64>, state: &State, x: [f64; VARIABLES]) -> Option<(Arm<f64>, State)> {
    let geometry = Geometry::new([x[6], x[7], x[8], x[9], x[10]]).ok()?;
    let links = [0, 1, 2, 3].map(|link| Link {
        mass: x[11 + link],
        ..arm.links()[link]
    });
    let arm = Arm::new(
        geometry,
        links,
        arm.payload(),
        arm.gravity(),
        arm.rotor_inertia(),
    )
    .ok()?;
    let [theta, omega, alpha] = [[x[0], x[1]], [x[2], x[3]], [x[4], x[5]]];
    Some((
        arm,
        State {
            theta,
            omega,
            alpha,
            ..*state
        },
    ))
}

/// The quantities by the kinematics in `f64`.
fn values(arm: &Arm<f64>, state: &State) -> Option<[f64; QUANTITIES]> {
    let geometry = arm.geometry();
    let pose = geometry
        .forward(state.theta[0], state.theta[1], state.assembly)
        .ok()?;
    let velocities = geometry
        .forward_velocities(&pose, state.omega[0], state.omega[1])
        .ok()?;
    let [alpha1, alpha4] = state.alpha;
    let accelerations = geometry
        .forward_accelerations(&pose, &velocities, alpha1, alpha4)
        .ok()?;
    let torque = arm
        .inverse_dynamics(&pose, &velocities, &accelerations, Vector2::zeros())
        .ok()?;
    let (c, v, a) = (pose.c, velocities.c, accelerations.c);
    Some([c.x, c.y, v.x, v.y, a.x, a.y, torque[0], torque[1]])
}

/// Central differences of sixth order, of a function of one variable.
fn difference<const N: usize>(step: f64, f: impl Fn(f64) -> Option<[f64; N]>) -> Option<[f64; N]> {
    let mut sum = [0.0; N];
    for (index, weight) in [(1.0, 45.0), (2.0, -9.0), (3.0, 1.0)] {
        let [high, low] = [f(index * step)?, f(-index * step)?];
        for (sum, (high, low)) in sum.iter_mut().zip(high.into_iter().zip(low)) {
            *sum += weight * (high - low);
        }
    }
    Some(sum.map(|sum| sum / (60.0 * step)))
}

#[test]
fn both_derivatives_are_those_of_differences_for_random_arms_and_states() {
    let checked = Tally::default();
    proptest!(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(1500) }, |(
        geometry in geometry(),
        theta in [-3.1..3.1_f64, -3.1..3.1_f64],
        omega in [-3.0..3.0_f64, -3.0..3.0_f64],
        alpha in [-20.0..20.0_f64, -20.0..20.0_f64],
        left in any::<bool>(),
    )| {
        let lengths = geometry.lengths();
        // Differences of very unlike lengths are too inexact.
        let longest = lengths.iter().copied().fold(0.0, f64::max);
        if lengths.iter().any(|length| *length < 0.3 * longest) {
            return Ok(());
        }
        let links = [0, 1, 2, 3].map(|link| {
            let rod = Link::uniform_rod(0.05 + 0.01 * link as f64, lengths[link]);
            Link { com: Vector2::new(rod.com.x, 0.003), ..rod }
        });
        let gravity = Vector2::new(0.5, -9.7);
        let arm = Arm::new(geometry, links, 0.03, gravity, [2e-5, 3e-5]).unwrap();
        let assembly = if left { Side::Left } else { Side::Right };
        let state = State { theta, omega, alpha, assembly };
        let pose = geometry.forward(theta[0], theta[1], assembly);
        if !pose.is_ok_and(|pose| pose.nearest_singularity().1 > 0.5) {
            return Ok(());
        }
        let found = derivatives(&arm, &state).unwrap();
        let (value, first) = first_derivatives(&arm, &state).unwrap();
        prop_assert_eq!(value, found.value);
        for (alone, both) in first.iter().zip(&found.first) {
            let scale = both.iter().map(|d| d.abs()).fold(1e-9, f64::max);
            for (alone, both) in alone.iter().zip(both) {
                prop_assert!((alone - both).abs() < 1e-12 * scale, "{alone} {both}");
            }
        }
        let x = row(&arm, &state);
        for (found, expected) in found.value.into_iter().zip(values(&arm, &state).unwrap()) {
            prop_assert!((found - expected).abs() < 1e-11 * expected.abs().max(1e-3));
        }
        for i in 0..VARIABLES {
            let moved = |by: f64| {
                let mut x = x;
                x[i] += by;
                changed(&arm, &state, x)
            };
            let step = 3e-4 * if i < 6 { 1.0 } else { x[i].max(0.02) };
            let Some(expected) = difference(step, |by| {
                let (arm, state) = moved(by)?;
                values(&arm, &state)
            }) else { continue };
            for (k, expected) in expected.into_iter().enumerate() {
                let scale = found.first[k].iter().map(|d| d.abs()).fold(1e-9, f64::max);
                let error = (found.first[k][i] - expected).abs() / scale;
                prop_assert!(error < 1e-8, "{k} by {i}: {} {expected}", found.first[k][i]);
            }
            let Some(expected) = difference(step, |by| {
                let (arm, state) = moved(by)?;
                let first = derivatives(&arm, &state).ok()?.first;
                let flat: Vec<f64> = first.into_iter().flatten().collect();
                flat.try_into().ok() as Option<[f64; QUANTITIES * VARIABLES]>
            }) else { continue };
            for k in 0..QUANTITIES {
                let scale = found.second[k].iter().flatten().map(|d| d.abs()).fold(1e-9, f64::max);
                for j in 0..VARIABLES {
                    let error = (found.second[k][i][j] - expected[k * VARIABLES + j]).abs() / scale;
                    prop_assert!(error < 1e-8, "{k} by {i}, {j}: {error}");
                    prop_assert_eq!(found.second[k][i][j], found.second[k][j][i]);
                }
            }
        }
        checked.count(true);
    });
    assert!(checked.accepted() > 20);
}
