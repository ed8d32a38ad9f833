//! What the motors of a leg need, by `Geometry::drive_foot`: angles within 7e-7 rad and rates within a millionth, as
//! those of the tick, on the same poses.
//!
//! A torque is F×q3 X1/(q2×q3). Its error is that of q2 and q3, ε over the sine of their legs, over sin(θ3−θ2), and that
//! of X1: within a millionth of |F| l/(sin² sin²(θ3−θ2)), with the lesser sine of both elbows.

use crate::arms::{Leg, Verdict, arms, single, wide};
use fivebar_kinematics::five_bar::WorkingMode;
use fivebar_testkit::{Tally, turned};
use nalgebra::Vector2;
use proptest::prelude::*;

#[test]
fn what_the_motors_of_any_leg_need_is_within_its_bounds() {
    let kept = Tally::default();
    let pair = || [single(-1.0..1.0), single(-1.0..1.0)];
    proptest!(ProptestConfig::with_cases(4096), |(arms in arms(), inputs in [pair(), pair(), pair()])| {
        let leg = arms.single.geometry();
        let size = leg.l1();
        let [c, v, f] = inputs.map(|[x, y]| Vector2::new(x, y));
        let (c, v) = (c * (2.0 * size), v * size);
        if arms.verdict(wide(c)) != Verdict::Reached {
            kept.count(false);
            return Ok(());
        }
        let exact_leg = arms.double.geometry();
        let lengths = exact_leg.lengths();
        let sines = arms.legs(wide(c), wide(c));
        for mode in WorkingMode::ALL {
            let pose = exact_leg.inverse(wide(c), mode).unwrap();
            let bent = sines.iter().all(Leg::is_kept_bent) && pose.sin32().abs() >= 0.15;
            if !kept.count(bent) {
                continue;
            }
            let found = leg.drive_foot(c, v, f, mode).unwrap();
            let exact = exact_leg.drive_foot(wide(c), wide(v), wide(f), mode).unwrap();
            let least = sines.iter().map(Leg::sine_squared).fold(1.0, f64::min);
            for joint in 0..2 {
                let near = [lengths[0], lengths[3]][joint];
                let error = turned(f64::from(found.angle[joint]), exact.angle[joint]).abs();
                prop_assert!(error <= 7e-7, "{error:e} rad");
                let error = (f64::from(found.rate[joint]) - exact.rate[joint]).abs();
                let bound = 1e-6 / sines[joint].sine_squared() * wide(v).norm() / near;
                prop_assert!(error <= bound, "{error:e} rad/s, bound {bound:e}");
                let error = (f64::from(found.torque[joint]) - exact.torque[joint]).abs();
                let bound = 1e-6 * wide(f).norm() * near / (least * pose.sin32() * pose.sin32());
                prop_assert!(error <= bound, "{error:e} N·m, bound {bound:e}");
            }
        }
    });
    kept.assert_accepted(0.2);
}
