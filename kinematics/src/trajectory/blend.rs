//! Rounded corners: a quintic that takes over from one segment ½ℓ before the corner and
//! hands over to the next ½ℓ after it.
//!
//! Position, tangent and curvature agree at both ends, so that any motion s(t) with
//! continuous acceleration has a continuous acceleration through the corner too. With
//! u = s/ℓ, h = u³ − ½u⁴ and two lines that meet at V with tangents t₀, t₁,
//!
//! r = V + t₀ (s − ½ℓ) + (t₁ − t₀) ℓ h(u),
//!
//! h″ = 6u(1−u), so |r″| ≤ 1.5 |Δt|/ℓ and |r‴| ≤ 6 |Δt|/ℓ², and it misses the corner by
//! ℓ|Δt| 3/32, which is also the farthest it leaves the path.
//!
//! In general the blend is the Hermite interpolant of the cornered path p(s), linear in
//! p. Write p as the first segment carried on plus, from the corner on, the difference
//! Δt x + ½Δκ x² + O(x³), x = s − ½ℓ, whose third derivative is below κ₀² + κ₁². The
//! interpolant of x₊ errs by 3/32, that of ½x₊² by less than 0.0028, that of x₊³/6 by
//! less than 0.0014, and what remains is less than half as much again while ℓκ ≤ 1. So
//!
//! |r − p| ≤ ℓ (3/32 |Δt| + 0.0028 ℓ|Δκ| + 0.0022 ℓ² (κ₀² + κ₁²)).

use super::curve::Curve;
use super::number::{max, min};
use super::path_segment::PathSegment;
use super::ramp::{MotionLimits, distance, greatest_entry_speed, ramp};
use super::shares::BendLimits;
use crate::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// How far the blend over length ℓ leaves the path, at most [m].
struct Deviation<S> {
    turn: S,
    curvature_step: S,
    curvature_squared: S,
}

impl<S: Scalar> Deviation<S> {
    fn over(&self, length: S) -> S {
        let by_turn = S::from_f64(3.0 / 32.0) * self.turn;
        let by_step = S::from_f64(0.0028) * self.curvature_step;
        let by_curve = S::from_f64(0.0022) * self.curvature_squared;
        length * (by_turn + length * (by_step + length * by_curve))
    }
}

/// The longest blend from `first` to `second` that stays within `tolerance` [m] of their
/// path and takes no more than `reach` [m] of each; `None` if no length is left.
pub(super) fn blend<S: Scalar>(
    first: &PathSegment<S>,
    second: &PathSegment<S>,
    tolerance: S,
    reach: [S; 2],
) -> Option<PathSegment<S>> {
    let before = first.at(first.length());
    let after = second.at(S::ZERO);
    let [k0, k1] = [before.curvature, after.curvature].map(Vector2::length);
    let deviation = Deviation {
        turn: (after.tangent - before.tangent).length(),
        curvature_step: (after.curvature - before.curvature).length(),
        curvature_squared: k0 * k0 + k1 * k1,
    };
    let mut longest = S::TWO * min(reach[0], reach[1]);
    if longest * max(k0, k1) > S::ONE {
        longest = S::ONE / max(k0, k1);
    }
    let length = longest_within(&deviation, longest, tolerance);
    // A blend too short for the numbers at hand is a corner.
    let some = length > S::from_f64(1e-7);
    some.then(|| hermite(first, second, length))
}

/// The greatest length up to `longest` whose deviation is within `tolerance`.
fn longest_within<S: Scalar>(deviation: &Deviation<S>, longest: S, tolerance: S) -> S {
    if deviation.over(longest) <= tolerance {
        return longest;
    }
    let (mut low, mut high) = (S::ZERO, longest);
    for _ in 0..24 {
        let middle = (low + high) * S::HALF;
        if deviation.over(middle) <= tolerance {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// The quintic over u ∈ [0, 1] that leaves `first` ½ℓ before its end and joins `second`
/// ½ℓ after its start, with their tangents and curvatures.
fn hermite<S: Scalar>(
    first: &PathSegment<S>,
    second: &PathSegment<S>,
    length: S,
) -> PathSegment<S> {
    let half = length * S::HALF;
    let from = first.at(first.length() - half);
    let to = second.at(half);
    let [v0, v1] = [from.tangent * length, to.tangent * length];
    let [a0, a1] = [from, to].map(|point| point.curvature * (length * length));
    // What the Taylor polynomial from the start leaves over at the end: in position,
    // velocity and acceleration. The positions are taken relative to the corner, since
    // in single precision a short blend far from the origin would be mostly rounding.
    let displacement = first
        .part(first.length() - half, first.length())
        .displacement(half)
        + second.displacement(half);
    let e = displacement - v0 - a0 * S::HALF;
    let f = v1 - v0 - a0;
    let g = a1 - a0;
    let c = S::from_f64;
    PathSegment::new(
        Curve::Blend {
            coefficients: [
                from.position,
                v0,
                a0 * S::HALF,
                e * c(10.0) - f * c(4.0) + g * S::HALF,
                f * c(7.0) - e * c(15.0) - g,
                e * c(6.0) - f * c(3.0) + g * S::HALF,
            ],
            inverse_length: S::ONE / length,
        },
        length,
    )
}

/// The time [s] from `middle` [m] before the middle of a corner to that, or from there: at rest
/// there, or, with the limits of a blend of which one half is `half` [m] long, in motion.
pub(super) fn time_to_corner<S: Scalar>(
    rounded: Option<(&BendLimits<S>, S)>,
    middle: S,
    straight: &MotionLimits<S>,
) -> S {
    let time = |speed: S, length: S| {
        let fast = min(
            greatest_entry_speed(speed, length, straight),
            straight.speed,
        );
        let slowing = ramp(fast, S::ZERO, speed, straight);
        let rest = max(length - distance(&slowing), S::ZERO) / fast;
        slowing.iter().fold(rest, |sum, phase| sum + phase.duration)
    };
    match rounded {
        None => time(S::ZERO, middle),
        Some((limits, half)) => {
            let out = limits.speed_after(half);
            half * S::TWO / (limits.middle + out) + time(out, middle - half)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::bounds::{Bend, CurveBounds, PLACES};
    use super::*;
    use crate::trajectory::Sense;
    use proptest::prelude::*;

    type V = Vector2<f64>;

    /// The greatest |interpolant − f| of a function of x = u − ½ that is 0 before the
    /// corner, from its value, slope and second derivative at u = 1.
    fn interpolation_error(f: fn(f64) -> f64, [value, slope, second]: [f64; 3]) -> f64 {
        let c3 = 10.0 * value - 4.0 * slope + 0.5 * second;
        let c4 = -15.0 * value + 7.0 * slope - second;
        let c5 = 6.0 * value - 3.0 * slope + 0.5 * second;
        (0..=1000)
            .map(|i| {
                let u = f64::from(i) / 1000.0;
                let x = if u > 0.5 { u - 0.5 } else { 0.0 };
                (((c5 * u + c4) * u + c3) * u * u * u - f(x)).abs()
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn the_interpolants_err_by_no_more_than_stated() {
        let ramp = interpolation_error(|x| x, [0.5, 1.0, 0.0]);
        assert!((ramp - 3.0 / 32.0).abs() < 1e-9, "{ramp}");
        let square = interpolation_error(|x| 0.5 * x * x, [0.125, 0.5, 1.0]);
        assert!(square < 0.0028 && square > 0.0026, "{square}");
        let cube = interpolation_error(|x| x * x * x / 6.0, [1.0 / 48.0, 0.125, 0.5]);
        assert!(cube < 0.0014 && cube > 0.0010, "{cube}");
    }

    /// A line or an arc of 0.1 m, ending or starting at the origin.
    fn segment(direction: f64, curvature: f64, ends: bool) -> PathSegment<f64> {
        let tangent = V::unit(direction);
        let curve = if curvature.abs() < 2.0 {
            Curve::Line {
                start: V::zeros(),
                tangent,
            }
        } else {
            Curve::Arc {
                start: V::zeros(),
                tangent,
                curvature,
            }
        };
        let length = 0.1;
        if ends {
            // Backwards from the origin: the same curve in the other direction.
            let back = PathSegment::new(curve, length);
            let from = back.at(length);
            let start = from.position;
            let tangent = -from.tangent;
            let curve = match curve {
                Curve::Arc { .. } => Curve::Arc {
                    start,
                    tangent,
                    curvature: -curvature,
                },
                _ => Curve::Line { start, tangent },
            };
            PathSegment::new(curve, length)
        } else {
            PathSegment::new(curve, length)
        }
    }

    proptest! {
        #[test]
        fn a_blend_joins_smoothly_and_stays_within_its_tolerance(
            directions in prop::array::uniform2(-3.1..3.1_f64),
            curvatures in prop::array::uniform2(-60.0..60.0_f64),
            exponent in -6.0..-2.0_f64,
        ) {
            let tolerance = 10_f64.powf(exponent);
            let first = segment(directions[0], curvatures[0], true);
            let second = segment(directions[1], curvatures[1], false);
            // The sharpest corner leaves a micrometre's tolerance a blend of 5 µm.
            let corner = blend(&first, &second, tolerance, [0.05, 0.05]).unwrap();
            let length = corner.length();
            let path = |s: f64| if s < 0.5 * length {
                first.at(first.length() - 0.5 * length + s)
            } else {
                second.at(s - 0.5 * length)
            };
            for s in [0.0, length] {
                let (here, there) = (corner.at(s), path(s));
                prop_assert!((here.position - there.position).length() < 1e-12);
                prop_assert!((here.tangent - there.tangent).length() < 1e-10);
                let scale = 1.0 / length;
                prop_assert!((here.curvature - there.curvature).length() < 1e-9 * scale);
            }
            let bounds = CurveBounds::of(corner.curve());
            let bends = bounds.bends.unwrap();
            let mut greatest = [0.0_f64; 2];
            for i in 0..=500 {
                let s = length * f64::from(i) / 500.0;
                let (here, there) = (corner.at(s), path(s));
                prop_assert!((here.position - there.position).length() <= tolerance * (1.0 + 1e-9));
                let ahead = corner.at(s + 1e-6 * length).curvature;
                let third = (ahead - here.curvature) * (1e6 / length);
                // The bounds hold between the places on either side.
                let place = ((2.0 * s / length - 1.0).abs() * (PLACES - 1) as f64).min(7.999) as usize;
                let stated = |of: fn(&Bend<f64>) -> f64| of(&bends[place]).max(of(&bends[place + 1]));
                let second = here.curvature.length();
                prop_assert!(here.tangent.length() <= bounds.first * (1.0 + 1e-9));
                prop_assert!(here.tangent.length() <= stated(|bend| bend.first) * (1.0 + 1e-9));
                prop_assert!(second <= stated(|bend| bend.second) * (1.0 + 1e-9));
                prop_assert!(third.length() <= stated(|bend| bend.third) * (1.0 + 1e-4));
                greatest = [greatest[0].max(second), greatest[1].max(third.length())];
            }
            // They are not far above what they bound.
            for (second, found) in [true, false].into_iter().zip(greatest) {
                let of = |bend: &Bend<f64>| if second { bend.second } else { bend.third };
                let most = bends.iter().map(of).fold(0.0, f64::max);
                prop_assert!(most <= 1.1 * found + 1e-3 / length, "{most} for {found}");
            }
        }
    }

    #[test]
    fn tolerance_is_used_up_where_there_is_room() {
        let first = PathSegment::line(V::new(-0.1, 0.0), V::zeros()).unwrap();
        let second = PathSegment::line(V::zeros(), V::new(0.0, 0.1)).unwrap();
        let corner = blend(&first, &second, 1e-3, [0.05, 0.05]).unwrap();
        let missed = corner.at(0.5 * corner.length()).position.length();
        assert!((missed / 1e-3 - 1.0).abs() < 1e-6, "{missed}");
        // From a line onto its tangent arc there is nothing to turn, only to bend.
        let centre = V::new(0.0, 0.02);
        let onto = PathSegment::arc(
            V::zeros(),
            centre,
            V::new(0.0, 0.01),
            Sense::CounterClockwise,
            1e-9,
        );
        let eased = blend(&first, &onto.unwrap(), 1e-4, [0.05, 0.015]).unwrap();
        assert!(eased.length() > 5e-3, "{}", eased.length());
    }
}
