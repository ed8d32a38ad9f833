//! Virtual walls and guides: springs and dampers that act on the tool where a coordinate leaves an interval.
//!
//! | fixture | coordinate c, its direction n | interval |
//! |---|---|---|
//! | half plane | along its normal | from the wall on |
//! | line | along its normal | the line |
//! | box | along each of its sides | the box |
//! | circle, its inside or its outside | distance from the centre, away from it | up to the radius, from the radius on, the radius |
//!
//! With the depth δ from c to the interval the force is n (k δ − d ċ). A wall pushes and never pulls: where an interval has a width,
//! the damper takes at most what the spring gives. A guide, whose interval is one value, pulls from both sides.

use crate::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// Nearer to a circle's centre [m] no direction leads away from it, and nothing acts.
const CENTRE: f64 = 1e-4;

/// The coordinates of a fixture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FixtureAxis<S> {
    /// Along this unit vector, and to its left.
    Along(Vector2<S>),
    /// The distance from the origin.
    Radial,
}

/// A wall or a guide.
///
/// ```
/// use fivebar_kinematics::control::{FixtureAxis, VirtualFixture};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// // A floor at y = 0.1 m with 500 N/m.
/// let floor = VirtualFixture {
///     origin: Vector2::new(0.0, 0.1),
///     axis: FixtureAxis::Along(Vector2::new(0.0, 1.0)),
///     bounds: [[0.0, f64::INFINITY], [f64::NEG_INFINITY, f64::INFINITY]],
///     stiffness: 500.0,
///     damping: 1.0,
/// };
/// let push = |y: f64| floor.push(Vector2::new(0.3, y), Vector2::zeros()).spring.y;
/// assert!((push(0.098) - 1.0).abs() < 1e-9); // 2 mm deep
/// assert_eq!(push(0.102), 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VirtualFixture<S> {
    /// From where the coordinates count [m].
    pub origin: Vector2<S>,
    /// Their directions.
    pub axis: FixtureAxis<S>,
    /// The least and the greatest value of each that is free [m]; the second is not used with a distance.
    pub bounds: [[S; 2]; 2],
    /// k [N/m].
    pub stiffness: S,
    /// d [N·s/m].
    pub damping: S,
}

/// What a fixture does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixturePush<S> {
    /// Force of the spring [N].
    pub spring: Vector2<S>,
    /// Force of the damper [N].
    pub damper: Vector2<S>,
    /// Energy in the spring [J].
    pub energy: S,
}

impl<S: Scalar> FixturePush<S> {
    /// Nothing.
    #[inline(always)]
    pub fn none() -> Self {
        Self {
            spring: Vector2::zeros(),
            damper: Vector2::zeros(),
            energy: S::ZERO,
        }
    }
}

impl<S: Scalar> VirtualFixture<S> {
    /// What it does to a tool at this place [m] with this velocity [m/s].
    #[inline(always)]
    pub fn push(&self, place: Vector2<S>, velocity: Vector2<S>) -> FixturePush<S> {
        let from = place - self.origin;
        let [first, second] = self.bounds;
        match self.axis {
            FixtureAxis::Along(axis) => {
                let left = axis.perpendicular();
                let along = self.pushed(from.dot(&axis), velocity.dot(&axis), first);
                let across = self.pushed(from.dot(&left), velocity.dot(&left), second);
                FixturePush {
                    spring: axis * along.spring + left * across.spring,
                    damper: axis * along.damper + left * across.damper,
                    energy: along.energy + across.energy,
                }
            }
            FixtureAxis::Radial => {
                let distance = from.length();
                if distance <= S::from_f64(CENTRE) {
                    return FixturePush::none();
                }
                let axis = from * (S::ONE / distance);
                let away = self.pushed(distance, velocity.dot(&axis), first);
                FixturePush {
                    spring: axis * away.spring,
                    damper: axis * away.damper,
                    energy: away.energy,
                }
            }
        }
    }

    /// What acts along a coordinate there [m] that changes so fast [m/s].
    // Few branches: a processor with wait states waits at each of them.
    #[inline(always)]
    fn pushed(&self, coordinate: S, rate: S, [low, high]: [S; 2]) -> AlongAxis<S> {
        let (below, above) = (low - coordinate, high - coordinate);
        let mut depth = if below > S::ZERO { below } else { S::ZERO };
        if above < S::ZERO {
            depth = above;
        }
        let spring = self.stiffness * depth;
        let mut damper = if depth == S::ZERO {
            S::ZERO
        } else {
            -self.damping * rate
        };
        if low < high && (spring + damper) * depth < S::ZERO {
            damper = -spring;
        }
        AlongAxis {
            spring,
            damper,
            energy: S::HALF * spring * depth,
        }
    }
}

/// What acts along one coordinate.
struct AlongAxis<S> {
    spring: S,
    damper: S,
    energy: S,
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const INFINITE: f64 = f64::INFINITY;

    fn fixture(radial: bool, angle: f64, bounds: [[f64; 2]; 2]) -> VirtualFixture<f64> {
        VirtualFixture {
            origin: Vector2::new(0.02, 0.1),
            axis: if radial {
                FixtureAxis::Radial
            } else {
                FixtureAxis::Along(Vector2::unit(angle))
            },
            bounds,
            stiffness: 300.0,
            damping: 0.8,
        }
    }

    fn shapes(angle: f64, size: f64) -> [VirtualFixture<f64>; 6] {
        let free = [-INFINITE, INFINITE];
        [
            fixture(false, angle, [[0.0, INFINITE], free]),
            fixture(false, angle, [[0.0, 0.0], free]),
            fixture(false, angle, [[-size, size], [-0.5 * size, size]]),
            fixture(true, 0.0, [[-INFINITE, size], free]),
            fixture(true, 0.0, [[size, INFINITE], free]),
            fixture(true, 0.0, [[size, size], free]),
        ]
    }

    proptest! {
        /// The spring's force is the slope of its energy, by differences.
        #[test]
        fn the_force_is_the_slope_of_the_energy(
            place in prop::array::uniform2(-0.1..0.3_f64), angle in 0.0..6.3_f64, size in 0.01..0.1_f64,
        ) {
            let [x, y] = place;
            for shape in shapes(angle, size) {
                let from = Vector2::new(x, y) - shape.origin;
                prop_assume!(from.norm() > 1e-3);
                let energy = |dx: f64, dy: f64| shape.push(Vector2::new(x + dx, y + dy), Vector2::zeros()).energy;
                let h = 1e-6;
                let slope = Vector2::new(energy(h, 0.0) - energy(-h, 0.0), energy(0.0, h) - energy(0.0, -h)) / (2.0 * h);
                let force = shape.push(Vector2::new(x, y), Vector2::zeros()).spring;
                prop_assert!((force + slope).norm() < 1e-3 * (1.0 + force.norm()), "{shape:?} {force} {slope}");
            }
        }

        /// Walls push out of what they keep free of the tool, however it moves; nothing acts inside.
        #[test]
        fn a_wall_never_pulls(
            place in prop::array::uniform2(-0.1..0.3_f64), velocity in prop::array::uniform2(-1.0..1.0_f64),
            angle in 0.0..6.3_f64, size in 0.01..0.1_f64,
        ) {
            let [place, velocity] = [place, velocity].map(|[x, y]| Vector2::new(x, y));
            for (k, shape) in shapes(angle, size).into_iter().enumerate() {
                let push = shape.push(place, velocity);
                let force = push.spring + push.damper;
                let is_guide = k == 1 || k == 5;
                if !is_guide {
                    prop_assert!(force.dot(&push.spring) >= -1e-12);
                }
                // The damper takes energy, or gives back what the spring keeps for a wall.
                let taken = push.damper.dot(&velocity);
                prop_assert!(taken <= 1e-12, "{taken}");
                if push.energy == 0.0 {
                    prop_assert_eq!(force, Vector2::zeros());
                }
            }
        }
    }

    #[test]
    fn a_guide_pulls_onto_its_line_and_its_circle_from_both_sides() {
        let [_, line, _, _, _, circle] = shapes(0.0, 0.05);
        for side in [-1.0, 1.0] {
            let off = Vector2::new(0.01 * side, 0.03);
            let force = line.push(line.origin + off, Vector2::zeros()).spring;
            assert!((force - Vector2::new(-3.0 * side, 0.0)).norm() < 1e-9);
            let off = Vector2::new(0.0, 0.05 + 0.01 * side);
            let force = circle.push(circle.origin + off, Vector2::zeros()).spring;
            assert!((force - Vector2::new(0.0, -3.0 * side)).norm() < 1e-9);
        }
        assert_eq!(circle.push(circle.origin, Vector2::zeros()).energy, 0.0);
    }
}
