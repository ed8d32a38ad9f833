//! The driven angles from a point with the tool at C, by `Tool::actuated_joints`, which the tick
//! calls, and by `Geometry::inverse`: within 5e-7 rad.
//!
//! C is a given number, so only the solution errs. Near a stretched leg the small difference
//! s² − |p|² decides, s = n + f being the sum of the lengths. It is taken from exact squares
//! to 3·2⁻²⁸ s², which moves the elbow by less than ε s/|sin|/5. Near a folded leg
//! |p|² − (n − f)² decides, whose rounding by 2 ε |p|² moves the elbow by ε |p| s²/(4 n f
//! |sin|): little for links of similar lengths, because then |p| is small. The rest of the
//! solution rounds about five times by ε at most, and the arctangent adds up to 3e-7 rad. These
//! worst cases rarely coincide. Where the elbow is bent by |sin| ≥ 0.15, the margin that the
//! controller keeps, and towards the stretched leg by ≥ 0.05, the greatest error of a driven
//! angle among 7e8 random ones was 4.5e-7 rad for legs of which no link is longer than 1.4
//! times the other, and 6.7e-7 rad for those up to 1.8 times, as in every built-in robot.
//!
//! Rates are quotients by X = n f sin, whose relative error is about ε/sin². The greatest error of
//! 4e7 random rates, times sin², was 6e-7 of the terms of which a rate is the sum.

use crate::arms::{Arms, BENCHTOP, Verdict, arms, end_of, narrow, single, wide};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::{PoseError, WorkingMode};
use fivebar_testkit::{Tally, turned};
use nalgebra::Vector2;
use proptest::prelude::*;

/// The driven angles [rad] with C at `c` [m], by both solutions; the first error of either.
fn angles(arms: &Arms, c: Vector2<f32>, mode: WorkingMode) -> Result<[[f32; 2]; 2], PoseError> {
    let pose = arms.single.geometry().inverse(c, mode)?;
    let driven = arms
        .single
        .actuated_joints(c, Vector2::zeros(), Vector2::zeros(), mode)?;
    Ok([[pose.u1, pose.u4], driven.direction].map(|pair| pair.map(Vector2::polar_angle)))
}

/// Asserts that both solutions accept `c` and give the same bits, and that the driven angle of
/// each leg that is bent within the controller's margin is within its bound. Counts these legs.
fn assert_angles(
    arms: &Arms,
    c: Vector2<f32>,
    mode: WorkingMode,
    bent: &Tally,
) -> Result<(), TestCaseError> {
    let found = angles(arms, c, mode);
    prop_assert!(found.is_ok(), "{found:?} at {c:?}");
    let [by_inverse, found] = found.unwrap();
    prop_assert_eq!(by_inverse, found);
    let [exact1, _, _, exact4] = arms.double.inverse(wide(c), mode).unwrap().angles();
    let legs = arms.legs(wide(c), wide(c));
    for ((angle, exact), leg) in found.into_iter().zip([exact1, exact4]).zip(legs) {
        if bent.count(leg.is_kept_bent()) {
            let error = turned(f64::from(angle), exact).abs();
            let bound = if leg.ratio() <= 1.4 { 5e-7 } else { 7e-7 };
            prop_assert!(error <= bound, "{error:e} rad at sine {}", leg.sine());
        }
    }
    Ok(())
}

#[test]
fn angles_of_the_benchtop_arm_are_within_their_bound_wherever_it_reaches() {
    let arms = Arms::new(BENCHTOP, Vector2::zeros()).unwrap();
    let (reached, bent) = (Tally::default(), Tally::default());
    let config = ProptestConfig::with_cases(4096);
    proptest!(config, |(x in single(-0.2..0.28), y in single(-0.26..0.26))| {
        let c = Vector2::new(x, y);
        let verdict = arms.verdict(wide(c));
        reached.count(verdict == Verdict::Reached);
        for mode in WorkingMode::ALL {
            match verdict {
                Verdict::Reached => assert_angles(&arms, c, mode, &bent)?,
                Verdict::Beyond => prop_assert!(angles(&arms, c, mode).is_err()),
                Verdict::Border => {}
            }
        }
    });
    reached.assert_accepted(0.5);
    reached.assert_refused(0.3);
    bent.assert_accepted(0.95);
}

/// Arms with C where leg 1 is bent only a little, so that each case is hard; the bend of leg 4 is
/// random.
fn hard() -> impl Strategy<Value = (Arms, Vector2<f32>)> {
    (arms(), -3.1..3.1_f64, 0.05..0.5_f64, any::<[bool; 2]>()).prop_filter_map(
        "leg 4 does not reach",
        |(arms, theta, sine, sides)| {
            let geometry = arms.double.geometry();
            let c = end_of([geometry.l1(), geometry.l2()], theta, sine, sides);
            let c = narrow(c);
            (arms.verdict(wide(c)) == Verdict::Reached).then_some((arms, c))
        },
    )
}

/// All 4096 cases of `hard` are accepted.
#[test]
fn angles_of_any_arm_are_within_their_bound() {
    let bent = Tally::default();
    proptest!(ProptestConfig::with_cases(4096), |((arms, c) in hard())| {
        for mode in WorkingMode::ALL {
            assert_angles(&arms, c, mode, &bent)?;
        }
    });
    bent.assert_accepted(0.85);
}

/// The error of each joint's rate and acceleration, times sin², is within a millionth of the terms
/// of which it is the sum.
#[test]
fn rates_of_any_arm_are_within_a_millionth() {
    let bent = Tally::default();
    let motion = [
        [single(-1.0..1.0), single(-1.0..1.0)],
        [single(-9.0..9.0), single(-9.0..9.0)],
    ];
    proptest!(ProptestConfig::with_cases(4096), |((arms, c) in hard(), motion in motion)| {
        let size = arms.single.geometry().l1();
        let [v, a] = motion.map(|[x, y]| Vector2::new(x, y) * size);
        for mode in WorkingMode::ALL {
            let found = arms.single.actuated_joints(c, v, a, mode).unwrap();
            let exact = arms.double.actuated_joints(wide(c), wide(v), wide(a), mode).unwrap();
            let pose = arms.double.inverse(wide(c), mode).unwrap();
            let rates = arms.double.inverse_velocities(&pose, wide(v)).unwrap();
            let [l1, l2, l3, l4, _] = arms.double.geometry().lengths();
            let [omega1, omega2, omega3, omega4] = rates.omega;
            let links = [[l1, l2, omega1, omega2], [l4, l3, omega4, omega3]];
            for (joint, leg) in arms.legs(wide(c), wide(c)).into_iter().enumerate() {
                if !bent.count(leg.is_kept_bent()) {
                    continue;
                }
                let [near, far, near_rate, far_rate] = links[joint];
                let least = 1e-6 / leg.sine_squared();
                let error = (f64::from(found.omega[joint]) - exact.omega[joint]).abs();
                let bound = least * wide(v).norm() / near;
                prop_assert!(error <= bound, "{error:e} rad/s, bound {bound:e}");
                // α = (a·q + ω² b·q + ω² |q|²)/X.
                let terms = wide(a).norm() * far
                    + near_rate * near_rate * near * far
                    + far_rate * far_rate * far * far;
                let error = (f64::from(found.alpha[joint]) - exact.alpha[joint]).abs();
                let bound = least * terms / (near * far * leg.sine());
                prop_assert!(error <= bound, "{error:e} rad/s², bound {bound:e}");
            }
        }
    });
    bent.assert_accepted(0.85);
}
