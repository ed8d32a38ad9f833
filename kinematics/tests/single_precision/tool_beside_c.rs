//! The driven joints with the tool beside C, by `Tool::actuated_joints`.
//!
//! |BT| = r is rounded: to 3 ε r, as the square root of a sum of squares. That turns link 1 by
//! 3 ε r/(l1 |sin1|) beyond the bound with the tool at C. B so displaced turns w, from T to C,
//! about T; together with the rounding of w to 8 ε |w| and of C to ε |C| that displaces C by
//! δ = |w| (l1 δθ1/r + 8 ε) + ε |C|, which turns link 4 by δ/(l4 |sin4|). The
//! greatest error of 2e7 random arms was two thirds of the bound for joint 4.

use crate::arms::{Arms, BENCHTOP, BOUNDARY, Leg, end_of, lengths, narrow, single, wide};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::WorkingMode;
use fivebar_testkit::{Tally, mode, turned};
use nalgebra::Vector2;
use proptest::prelude::*;

const EPSILON: f64 = 1.0 / 16_777_216.0;

/// An arm with its tool anywhere, and a point that it reaches in a working mode.
#[derive(Clone, Copy, Debug)]
struct Case {
    arms: Arms,
    t: Vector2<f32>,
    mode: WorkingMode,
    /// C [m].
    c: Vector2<f64>,
}

impl Case {
    /// None where `f64` says that leg 1 is nearer to its boundary than [`BOUNDARY`], or leg 4
    /// nearer than that and the displacement of C allow.
    fn new(arms: Arms, t: Vector2<f32>, mode: WorkingMode) -> Option<Self> {
        let c = arms.double.inverse(wide(t), mode).ok()?.c;
        let case = Self { arms, t, mode, c };
        let [leg1, leg4] = arms.legs(wide(t), c);
        let margin = BOUNDARY * BOUNDARY;
        // The sine's square changes by up to 2 s/(n f) with |EC|.
        let geometry = arms.double.geometry();
        let (near, far) = (geometry.l4(), geometry.l3());
        let moved = 2.0 * (near + far) / (near * far) * case.displacement();
        let clear = leg1.sine_squared() > margin && leg4.sine_squared() > margin + moved;
        clear.then_some(case)
    }

    /// Bound of the error of θ1 [rad].
    fn bound1(&self) -> f64 {
        let [leg1, _] = self.arms.legs(wide(self.t), self.c);
        let (l1, r) = (self.arms.double.geometry().l1(), self.arms.double.reach());
        at_c(leg1.ratio()) + 3.0 * EPSILON * r / (l1 * leg1.sine())
    }

    /// Bound of the error of C [m].
    fn displacement(&self) -> f64 {
        let (l1, r) = (self.arms.double.geometry().l1(), self.arms.double.reach());
        let w = self.arms.double.offset().norm();
        w * (l1 * self.bound1() / r + 8.0 * EPSILON) + EPSILON * self.c.norm()
    }

    /// Bound of the error of θ4 [rad].
    fn bound4(&self) -> f64 {
        let [_, leg4] = self.arms.legs(wide(self.t), self.c);
        let l4 = self.arms.double.geometry().l4();
        at_c(leg4.ratio()) + self.displacement() / (l4 * leg4.sine())
    }

    /// Asserts that the point is accepted; the errors of θ1 and θ4 [rad].
    fn errors(&self) -> Result<[f64; 2], TestCaseError> {
        let zero = Vector2::zeros();
        let found = self
            .arms
            .single
            .actuated_joints(self.t, zero, zero, self.mode);
        prop_assert!(found.is_ok(), "{found:?} of {self:?}");
        let exact = self.arms.double.inverse(wide(self.t), self.mode).unwrap();
        let [u1, u4] = found.unwrap().direction.map(|u| f64::from(u.polar_angle()));
        let [exact1, _, _, exact4] = exact.angles();
        Ok([turned(u1, exact1).abs(), turned(u4, exact4).abs()])
    }
}

/// The bound with the tool at C [rad], by the ratio of a leg's links.
fn at_c(ratio: f64) -> f64 {
    if ratio <= 1.4 { 5e-7 } else { 7e-7 }
}

/// Any arm with |BT| up to 1.8 times l1 or the inverse, at any angle to link 2.
fn cases() -> impl Strategy<Value = Case> {
    let tool = (single(0.6..1.8), -3.1..3.1_f64);
    let place = (-3.1..3.1_f64, 0.05..0.7_f64, any::<[bool; 2]>());
    (lengths(), tool, place, mode()).prop_filter_map(
        "not reached",
        |(lengths, (share, lean), (theta, sine, sides), mode)| {
            let [l1, l2, ..] = lengths.map(f64::from);
            let reach = l1 * f64::from(share);
            let offset = Vector2::unit(lean) * reach - Vector2::new(l2, 0.0);
            let arms = Arms::new(lengths, narrow(offset))?;
            let t = end_of([l1, reach], theta, sine, sides);
            Case::new(arms, narrow(t), mode)
        },
    )
}

/// All 4096 cases are accepted.
#[test]
fn angles_of_any_arm_are_within_their_bound() {
    let bent = Tally::default();
    proptest!(ProptestConfig::with_cases(4096), |(case in cases())| {
        let errors = case.errors()?;
        let legs = case.arms.legs(wide(case.t), case.c);
        if bent.count(legs.iter().all(Leg::is_kept_bent)) {
            for (error, bound) in errors.into_iter().zip([case.bound1(), case.bound4()]) {
                prop_assert!(error <= bound, "{error:e} rad, bound {bound:e}, {case:?}");
            }
        }
    });
    bent.assert_accepted(0.85);
}

/// As README says, where both legs are bent by |sin| ≥ 0.15. The greatest error among 1.4e8
/// random angles was 3.5e-6 rad.
#[test]
fn angles_of_the_benchtop_arm_are_within_four_millionths() {
    let (reached, bent) = (Tally::default(), Tally::default());
    let offset = [single(-0.05..0.05), single(-0.05..0.05)];
    let point = [single(-0.2..0.28), single(-0.26..0.26)];
    proptest!(ProptestConfig::with_cases(4096), |(offset in offset, point in point, mode in mode())| {
        let [offset, t] = [offset, point].map(|[x, y]| Vector2::new(x, y));
        let case = Case::new(Arms::new(BENCHTOP, offset).unwrap(), t, mode);
        reached.count(case.is_some());
        let Some(case) = case else { return Ok(()) };
        let errors = case.errors()?;
        let legs = case.arms.legs(wide(t), case.c);
        if bent.count(legs.iter().all(|leg| leg.sine() >= 0.15)) {
            prop_assert!(errors.iter().all(|&error| error <= 4e-6), "{errors:?}");
        }
    });
    reached.assert_accepted(0.5);
    bent.assert_accepted(0.9);
}
