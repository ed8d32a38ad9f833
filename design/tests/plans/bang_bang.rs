//! The phase plane integrated: full acceleration from the start, full deceleration into the end.
//!
//! On short lines the optimum switches once. The bounds of s̈ are found from the mass matrix and
//! the nonlinear effects at each state, x = ṡ² is integrated by Runge and Kutta in s, and the
//! time is that of the lower of the two curves. Neither the coefficients nor the passes are used.

use super::shared::{OUTWARDS, arm, driven, factors, line, point, torque_limits};
use fivebar_design::time_optimal::plan;
use fivebar_kinematics::dynamics::Arm;
use nalgebra::Vector2;
use proptest::prelude::*;

const VISCOUS: f64 = 2e-3;
const COULOMB: f64 = 1e-2;
const STEPS: usize = 2000;

/// The least and the greatest s̈ at a state; none where no s̈ is within the torque.
fn bounds(
    arm: &Arm<f64>,
    [from, to]: [Vector2<f64>; 2],
    torque: f64,
    s: f64,
    x: f64,
) -> Option<[f64; 2]> {
    let (length, geometry) = ((to - from).norm(), arm.geometry());
    let u = (to - from) / length;
    let pose = geometry.inverse(from + u * s, OUTWARDS).ok()?;
    let unit = geometry.inverse_velocities(&pose, u).ok()?;
    let velocities = geometry.inverse_velocities(&pose, u * x.sqrt()).ok()?;
    let still = geometry
        .inverse_accelerations(&pose, &velocities, Vector2::zeros())
        .ok()?;
    let mass = arm.mass_matrix(&pose).ok()?;
    let [h1, h4] = arm
        .nonlinear_effects(&pose, &velocities, Vector2::zeros())
        .ok()?;
    let q1 = Vector2::new(unit.omega[0], unit.omega[3]);
    let turning = Vector2::new(still.alpha[0], still.alpha[3]);
    let per = mass * q1;
    let constant = mass * turning + Vector2::new(h1, h4);
    let (mut least, mut greatest) = (f64::NEG_INFINITY, f64::INFINITY);
    for j in 0..2 {
        let friction = COULOMB * q1[j].signum() + VISCOUS * q1[j] * x.sqrt();
        let ends = [-torque, torque].map(|limit| (limit - constant[j] - friction) / per[j]);
        least = least.max(ends[0].min(ends[1]));
        greatest = greatest.min(ends[0].max(ends[1]));
    }
    (least < greatest).then_some([least, greatest])
}

/// x at even places from rest, at full acceleration; backward from the end if `end`.
fn curve(arm: &Arm<f64>, ends: [Vector2<f64>; 2], torque: f64, end: bool) -> Option<Vec<f64>> {
    let length = (ends[1] - ends[0]).norm();
    let h = length / STEPS as f64;
    let slope = |way: f64, x: f64| {
        let s = if end { length - way } else { way };
        let [least, greatest] = bounds(arm, ends, torque, s.clamp(0.0, length), x.max(0.0))?;
        Some(if end { -2.0 * least } else { 2.0 * greatest })
    };
    let mut x = vec![0.0];
    for k in 0..STEPS {
        let (way, now) = (k as f64 * h, x[k]);
        let k1 = slope(way, now)?;
        let k2 = slope(way + 0.5 * h, now + 0.5 * h * k1)?;
        let k3 = slope(way + 0.5 * h, now + 0.5 * h * k2)?;
        let k4 = slope(way + h, now + h * k3)?;
        x.push(now + h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0);
    }
    if end {
        x.reverse();
    }
    Some(x)
}

/// The time of the optimum that switches once; none if it does not.
fn time(arm: &Arm<f64>, ends: [Vector2<f64>; 2], torque: f64) -> Option<f64> {
    let faster = curve(arm, ends, torque, false)?;
    let slower = curve(arm, ends, torque, true)?;
    let x: Vec<f64> = faster.iter().zip(&slower).map(|(a, b)| a.min(*b)).collect();
    let crossings = faster.windows(2).zip(slower.windows(2));
    let changes = crossings
        .filter(|(f, s)| (f[0] > s[0]) != (f[1] > s[1]))
        .count();
    if changes != 1 || x[1..STEPS].iter().any(|x| *x <= 0.0) {
        return None;
    }
    let h = (ends[1] - ends[0]).norm() / STEPS as f64;
    Some(
        x.windows(2)
            .map(|pair| 2.0 * h / (pair[0].sqrt() + pair[1].sqrt()))
            .sum(),
    )
}

#[test]
fn the_time_is_that_of_the_integrated_phase_plane() {
    let compared = std::cell::Cell::new(0);
    let tested = (
        factors::<5>(),
        factors::<4>(),
        point(),
        0.0..std::f64::consts::TAU,
        0.01..0.04_f64,
    );
    proptest!(ProptestConfig::with_cases(60), |((lengths, masses, from, angle, length) in tested)| {
        let to = from + Vector2::new(angle.cos(), angle.sin()) * length;
        for gravity in [[0.0; 2], [0.0, -9.81]] {
            let arm = arm(lengths, masses, gravity);
            let Some(expected) = time(&arm, [from, to], 0.8) else { continue };
            let driven = driven(&arm, [VISCOUS, COULOMB]);
            let run = plan(&driven, &torque_limits(0.8), &line(from, to), None);
            let found = run.unwrap().time;
            compared.set(compared.get() + 1);
            prop_assert!((found / expected - 1.0).abs() < 1e-3, "{found} s, not {expected} s");
        }
    });
    assert!(
        compared.get() > 40,
        "only {} lines switch once",
        compared.get()
    );
}
