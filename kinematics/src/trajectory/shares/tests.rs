//! The limits on blends and arcs, against samples of the motion and against times by themselves.

use super::super::blend::blend;
use super::super::curve::Curve;
use super::super::ramp::{distance, ramp};
use super::*;
use crate::PlanarVector;
use crate::trajectory::{PathSegment, Sense};
use nalgebra::Vector2;
use proptest::prelude::*;

type V = Vector2<f64>;

/// A line or an arc of `length` [m], ending or starting at the origin.
fn segment(direction: f64, radius: Option<f64>, length: f64, ends: bool) -> PathSegment<f64> {
    let tangent = V::unit(direction);
    let back = if ends { -tangent } else { tangent };
    let Some(radius) = radius else {
        let far = back * length;
        let (from, to) = if ends {
            (far, V::zeros())
        } else {
            (V::zeros(), far)
        };
        return PathSegment::line(from, to).unwrap();
    };
    // Turning left about a centre to the left.
    let centre = tangent.perpendicular() * radius;
    let angle = length / radius * if ends { -1.0 } else { 1.0 };
    let far = centre - centre * angle.cos() + tangent * (radius * angle.sin());
    let (from, to) = if ends {
        (far, V::zeros())
    } else {
        (V::zeros(), far)
    };
    PathSegment::arc(from, to, centre, Sense::CounterClockwise, 1e-9).unwrap()
}

/// The greatest shares of the tool's acceleration and jerk where the speed is greatest, over
/// all of a segment and both signs of s̈ and s⃛.
fn reached(
    segment: &PathSegment<f64>,
    limits: &BendLimits<f64>,
    tool: &MotionLimits<f64>,
) -> [f64; 2] {
    const STEPS: u32 = 2000;
    let (length, halves) = (segment.length(), &limits.halves);
    let mut greatest = [0.0_f64; 2];
    for step in 0..=STEPS {
        let s = length * f64::from(step) / f64::from(STEPS);
        let here = segment.at(s);
        let near = 1e-5 * length;
        let ends = [(s - near).max(0.0), (s + near).min(length)];
        let third =
            (segment.at(ends[1]).curvature - segment.at(ends[0]).curvature) / (ends[1] - ends[0]);
        let risen = limits.middle.powi(2) + 2.0 * halves.acceleration * (s - 0.5 * length).abs();
        let v = risen.sqrt().min(halves.speed);
        for a in [-halves.acceleration, halves.acceleration] {
            let acceleration = here.curvature * (v * v) + here.tangent * a;
            greatest[0] = greatest[0].max(acceleration.norm() / tool.acceleration);
            for j in [-halves.jerk, halves.jerk] {
                let jerk = third * v.powi(3) + here.curvature * (3.0 * v * a) + here.tangent * j;
                greatest[1] = greatest[1].max(jerk.norm() / tool.jerk);
            }
        }
    }
    greatest
}

proptest! {
    #[test]
    fn acceleration_and_jerk_stay_within_the_tools_limits_and_use_them(
        turn in 0.01..2.9_f64,
        radii in prop::array::uniform2(prop::option::of(0.002..0.1_f64)),
        lengths in prop::array::uniform2(-4.0..-2.0_f64),
        jerk in 2.0..6.0_f64,
    ) {
        let lengths = lengths.map(|exponent| 10_f64.powf(exponent));
        let lengths = [0, 1].map(|i| radii[i].map_or(lengths[i], |radius| lengths[i].min(radius)));
        let first = segment(0.3, radii[0], lengths[0], true);
        let second = segment(0.3 + turn, radii[1], lengths[1], false);
        let tool = MotionLimits { speed: 10.0, acceleration: 4.0, jerk: 10_f64.powf(jerk) };
        let corner = blend(&first, &second, 5e-5, lengths.map(|length| 0.5 * length)).unwrap();
        let limits = tool_limits(&corner, 10.0, &tool);
        let [acceleration, jerk] = reached(&corner, &limits, &tool);
        prop_assert!(acceleration <= 1.0 + 1e-6 && jerk <= 1.0 + 1e-4, "{acceleration}, {jerk}");
        prop_assert!(acceleration.max(jerk) > 0.8, "{acceleration}, {jerk}");
        for (arc, _) in [first, second].iter().zip(radii).filter(|(_, radius)| radius.is_some()) {
            let [acceleration, jerk] = reached(arc, &tool_limits(arc, 10.0, &tool), &tool);
            prop_assert!(acceleration <= 1.0 + 1e-6 && jerk <= 1.0 + 1e-4, "{acceleration}, {jerk}");
            prop_assert!(acceleration.max(jerk) > 0.7, "{acceleration}, {jerk}");
        }
    }
}

fn limits(speed: f64, acceleration: f64, jerk: f64) -> MotionLimits<f64> {
    MotionLimits {
        speed,
        acceleration,
        jerk,
    }
}

/// The bend is `second` and `third` at one of the places, across the path, and none elsewhere.
fn bent_at(place: usize, second: f64, third: f64) -> [Bend<f64>; PLACES] {
    core::array::from_fn(|index| {
        let here = if index == place { 1.0 } else { 0.0 };
        Bend {
            first: 1.0,
            second: second * here,
            third: third * here,
            second_lean: 0.0,
            third_lean: 0.0,
        }
    })
}

#[test]
fn the_loss_of_a_change_of_speed_is_its_time_less_that_of_its_way_at_the_new_speed() {
    // With and without a phase of constant acceleration.
    for (from, to, jerk) in [
        (0.0, 0.3, 1000.0),
        (0.1, 0.3, 20.0),
        (0.1, 0.3, 60.0),
        (0.2, 0.3, 1e5),
    ] {
        let limits = limits(1.0, 4.0, jerk);
        let phases = ramp(from, 0.0, to, &limits);
        let time: f64 = phases.iter().map(|phase| phase.duration).sum();
        let expected = time - distance(&phases) / to;
        let loss = loss_of_gain(from, to, &limits);
        assert!((loss - expected).abs() < 1e-9, "{loss} s, not {expected} s");
    }
    assert_eq!(loss_of_gain(0.3, 0.3, &limits(1.0, 4.0, 1e3)), 0.0);
}

#[test]
fn a_blend_loses_the_time_of_its_half_and_of_the_way_to_full_speed_behind_it() {
    // From 1 m/s to 2 m/s along 0.375 m at 4 m/s², which takes 0.25 s.
    let straight = limits(3.0, 4.0, 1e9);
    let rising = BendLimits {
        middle: 1.0,
        halves: limits(2.5, 4.0, 1e9),
    };
    assert!((rising.speed_after(0.375) - 2.0).abs() < 1e-6);
    // The change from 2 m/s to 3 m/s takes 0.25 s for a distance of 0.625 m.
    let loss = 0.25 - 0.375 / 3.0 + 0.25 - 0.625 / 3.0;
    assert!((rising.loss_behind(0.375, &straight) - loss).abs() < 1e-6);
    let even = BendLimits::even(limits(2.0, 1.0, 1e9));
    assert_eq!(even.speed_after(0.375), 2.0);
    let loss = 0.375 / 2.0 - 0.375 / 3.0 + 0.25 - 0.625 / 3.0;
    assert!((even.loss_behind(0.375, &straight) - loss).abs() < 1e-6);
    // An arc of 3 m at 2 m/s, after 2 s of 1 m/s² for a distance of 2 m.
    let loss = 3.0 / 2.0 - 3.0 / 3.0 + 2.0 - 2.0 / 2.0;
    assert!((even.loss_along(3.0, &straight) - loss).abs() < 1e-6);
}

/// The shares of the acceleration and of the jerk along a line are the greatest, for it does not
/// bend. Its parameter runs slower than its length.
#[test]
fn limits_by_the_parameter_are_those_of_the_tool_over_its_greatest_rate() {
    let zero = V::zeros();
    let line = Curve::Blend {
        coefficients: [zero, V::new(1.05, 0.0), zero, zero, zero, zero],
        inverse_length: 1.0,
    };
    let found = tool_limits(&PathSegment::new(line, 1.0), 0.6, &limits(10.0, 4.0, 100.0));
    let halves = found.halves;
    assert!((halves.speed - 0.6 / 1.05).abs() < 1e-12, "{found:?}");
    let acceleration = 4.0 / 1.05 * USABLE * ACCELERATIONS[0];
    assert!(
        (halves.acceleration - acceleration).abs() < 1e-12,
        "{found:?}"
    );
    let jerk = 100.0 / 1.05 * USABLE * JERKS[0];
    assert!((halves.jerk - jerk).abs() < 1e-12, "{found:?}");
}

#[test]
fn an_arc_is_bounded_as_much_in_its_middle_as_everywhere_and_takes_no_motion_without_acceleration()
{
    let arc = segment(0.3, Some(0.01), 0.01, false);
    let found = tool_limits(&arc, 10.0, &limits(10.0, 4.0, 1000.0));
    assert!(found.middle == found.halves.speed && found.middle > 0.1);
    let found = tool_limits(&arc, 10.0, &limits(10.0, 0.0, 1000.0));
    assert_eq!((found.middle, found.halves.speed), (0.0, 0.0));
}

proptest! {
    #[test]
    fn of_the_shares_on_a_blend_those_are_taken_that_lose_the_least_time(
        turn in 0.1..2.5_f64, length in -3.5..-1.5_f64, jerk in 2.0..5.0_f64,
    ) {
        let tool = limits(0.5, 4.0, 10_f64.powf(jerk));
        let length = 10_f64.powf(length);
        let first = segment(0.3, None, length, true);
        let second = segment(0.3 + turn, None, length, false);
        let corner = blend(&first, &second, 1e-3, [0.5 * length; 2]).unwrap();
        let found = tool_limits(&corner, 0.5, &tool);
        let bounds = CurveBounds::of(corner.curve());
        let bends = bounds.bends.unwrap();
        let [acceleration, jerk] = [tool.acceleration, tool.jerk].map(|limit| limit / bounds.first);
        let straight = limits(tool.speed / bounds.first, acceleration, jerk);
        let loss = |limits: &BendLimits<f64>| limits.loss_behind(0.5 * corner.length(), &straight);
        let mut least = f64::MAX;
        for rise in [0.0, corner.length()] {
            for along in ACCELERATIONS {
                for jerk in JERKS {
                    if let Some(limits) = with_shares(&bends, rise, &straight, [along, jerk]) {
                        least = least.min(loss(&limits));
                    }
                }
            }
        }
        prop_assert!(loss(&found) <= least + 1e-12, "{} s, not {least} s", loss(&found));
    }

    #[test]
    fn the_bend_at_a_place_bounds_the_middle_less_the_rise_to_there(
        place in 0..PLACES, second in 0.0..4.0_f64, speed in -1.0..1.5_f64, rise in 0.0..0.02_f64,
    ) {
        let (second, speed) = (10_f64.powf(second), 10_f64.powf(speed));
        let straight = limits(speed, 5.0, 1e15);
        let found = with_shares(&bent_at(place, second, 0.0), rise, &straight, [0.6, 0.5]);
        let a = 5.0 * USABLE;
        let [across, along] = [a * 0.8, a * 0.6];
        let mut middle = speed * speed;
        if second * speed * speed > across {
            let distance = rise * 0.5 * place as f64 / (PLACES - 1) as f64;
            middle = (across / second - 2.0 * along * distance).min(middle);
        }
        prop_assert_eq!(found.is_some(), middle > 0.0);
        if let Some(found) = found {
            prop_assert!((found.middle - middle.sqrt()).abs() < 1e-9 * speed);
            let ends = (middle + along * rise).sqrt().min(speed);
            prop_assert!((found.halves.speed - ends).abs() < 1e-9 * speed);
        }
    }

    /// The jerk of r‴ and of r″, at full acceleration, is what the jerk along the path leaves.
    #[test]
    fn the_jerk_of_the_bend_bounds_the_speed(
        third in 0.0..8.0_f64, second in 0.0..3.0_f64, jerk in 0.0..6.0_f64, speed in -1.0..2.0_f64,
        is_turning in any::<bool>(),
    ) {
        let [third, jerk, speed] = [third, jerk, speed].map(|exponent| 10_f64.powf(exponent));
        // Without acceleration along the path r″ asks for no jerk.
        let along = if is_turning { 1.0 } else { 0.0 };
        let second = if is_turning { 1e-6 * 10_f64.powf(second) } else { 0.0 };
        let straight = limits(speed, 5e3, jerk);
        let found = with_shares(&bent_at(0, second, third), 0.0, &straight, [0.9 * along, 0.6]);
        let across = jerk * USABLE * 0.8;
        let demand = |v: f64| third * v.powi(3) + 3.0 * second * (0.9 * along * 5e3 * USABLE) * v;
        let expected = if demand(speed) <= across {
            speed
        } else {
            let (mut low, mut high) = (0.0, speed);
            for _ in 0..200 {
                let middle = 0.5 * (low + high);
                *(if demand(middle) <= across { &mut low } else { &mut high }) = middle;
            }
            low
        };
        let found = found.unwrap().middle;
        prop_assert!((found - expected).abs() < 1e-6 * expected, "{found} m/s, not {expected} m/s");
    }
}
