//! Single precision refuses the same points as double precision, for the same reason, except
//! points so near to the boundary of reach that its rounding decides.

use crate::arms::{Arms, Verdict, arms, narrow, wide};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::WorkingMode;
use fivebar_testkit::Tally;
use nalgebra::Vector2;
use proptest::prelude::*;

/// Arms, and points of which half lie beside one of the four circles that bound the reach, from
/// a ten-millionth to a tenth of their radius off, on either side.
fn places() -> impl Strategy<Value = (Arms, Vector2<f32>)> {
    let beside = (0..4_usize, -7.0..-1.0_f64, any::<bool>());
    (
        arms(),
        -3.1..3.1_f64,
        0.0..1.2_f64,
        prop::option::of(beside),
    )
        .prop_map(|(arms, direction, share, beside)| {
            let geometry = arms.double.geometry();
            let ([near1, far1], [near4, far4]) = (geometry.leg1_radii(), geometry.leg4_radii());
            let circles = [
                (Vector2::zeros(), near1),
                (Vector2::zeros(), far1),
                (geometry.e(), near4),
                (geometry.e(), far4),
            ];
            let (pivot, radius) = match beside {
                None => (Vector2::zeros(), far1 * share),
                Some((which, exponent, outside)) => {
                    let off = if outside { 1.0 } else { -1.0 } * 10_f64.powf(exponent);
                    let (pivot, radius) = circles[which];
                    (pivot, radius * (1.0 + off))
                }
            };
            (arms, narrow(pivot + Vector2::unit(direction) * radius))
        })
}

#[test]
fn points_are_refused_alike_but_at_the_border() {
    let (reached, clear) = (Tally::default(), Tally::default());
    proptest!(ProptestConfig::with_cases(8192), |((arms, c) in places())| {
        let verdict = arms.verdict(wide(c));
        if !clear.count(verdict != Verdict::Border) {
            return Ok(());
        }
        reached.count(verdict == Verdict::Reached);
        for mode in WorkingMode::ALL {
            let exact = arms.double.geometry().inverse(wide(c), mode).err();
            prop_assert_eq!(exact.is_none(), verdict == Verdict::Reached);
            let inverse = arms.single.geometry().inverse(c, mode).err();
            prop_assert_eq!(inverse, exact, "inverse at {:?}", c);
            let driven = arms.single.actuated_joints(c, Vector2::zeros(), Vector2::zeros(), mode).err();
            prop_assert_eq!(driven, exact, "driven at {:?}", c);
        }
    });
    clear.assert_accepted(0.75);
    reached.assert_accepted(0.35);
    reached.assert_refused(0.4);
}
