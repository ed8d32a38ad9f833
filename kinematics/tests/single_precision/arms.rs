//! Arms in both precisions, and whether a point is in reach by their exact lengths.

use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::{Geometry, Tool};
use nalgebra::Vector2;
use proptest::prelude::*;

/// Below this sine `f32` and `f64` may differ in what they refuse: legs that are nearly in line,
/// or a point that is out of reach by as little.
///
/// Within reach, velocities need sin² ≥ 128 ε. Rounding adds to that at most 3 ε s²/(n f) for
/// the sum s of the links' lengths n and f, as |BT| is rounded to 3 ε, and 4 ε for the rest:
/// 146 ε for links that differ by a factor of up to 1.8. Out of reach, a position is given
/// up to 16 ε s beyond it, and three roundings by ε s: that is sin² = −38 ε s²/(n f), or −166 ε.
pub(crate) const BOUNDARY: f64 = 3.2e-3;

/// The benchtop arm's lengths [m].
pub(crate) const BENCHTOP: [f32; 5] = [0.1, 0.16, 0.16, 0.1, 0.08];

/// The same arm in both precisions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arms {
    pub(crate) single: Tool<f32>,
    pub(crate) double: Tool<f64>,
}

/// Whether a point is in reach, by the exact lengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Both legs reach it, bent by more than [`BOUNDARY`].
    Reached,
    /// A leg is nearer to its boundary than that.
    Border,
    /// It is out of a leg's reach by more than that.
    Beyond,
}

/// A leg whose far end is at a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leg {
    near: f64,
    far: f64,
    /// |p|², p being the point from the leg's pivot [m²].
    distance_squared: f64,
}

impl Leg {
    /// sin² of the angle between the links, by Heron's product; negative out of reach.
    pub(crate) fn sine_squared(&self) -> f64 {
        let (sum, difference) = (self.near + self.far, self.near - self.far);
        let outer = sum * sum - self.distance_squared;
        let inner = self.distance_squared - difference * difference;
        outer * inner / (2.0 * self.near * self.far).powi(2)
    }

    pub(crate) fn sine(&self) -> f64 {
        self.sine_squared().sqrt()
    }

    /// Whether it is bent within the controller's margin: |sin| ≥ 0.15, towards the stretched leg
    /// 0.05.
    pub(crate) fn is_kept_bent(&self) -> bool {
        let opens = self.distance_squared > self.near * self.near + self.far * self.far;
        self.sine_squared() >= if opens { 0.05_f64 } else { 0.15 }.powi(2)
    }

    /// The longer link by the shorter one.
    pub(crate) fn ratio(&self) -> f64 {
        self.near.max(self.far) / self.near.min(self.far)
    }
}

impl Arms {
    /// None where no such arm exists.
    pub(crate) fn new(lengths: [f32; 5], offset: Vector2<f32>) -> Option<Self> {
        let single = Geometry::new(lengths).ok()?;
        let double = Geometry::new(lengths.map(f64::from)).ok()?;
        Some(Self {
            single: Tool::new(single, offset).ok()?,
            double: Tool::new(double, wide(offset)).ok()?,
        })
    }

    /// A–B–T with T at `t`, and E–D–C with C at `c`.
    pub(crate) fn legs(&self, t: Vector2<f64>, c: Vector2<f64>) -> [Leg; 2] {
        let geometry = self.double.geometry();
        let leg = |near, far, p: Vector2<f64>| Leg {
            near,
            far,
            distance_squared: p.norm_squared(),
        };
        [
            leg(geometry.l1(), self.double.reach(), t),
            leg(geometry.l4(), geometry.l3(), c - geometry.e()),
        ]
    }

    /// Of the point `c`, the tool being at C.
    pub(crate) fn verdict(&self, c: Vector2<f64>) -> Verdict {
        let margin = BOUNDARY * BOUNDARY;
        let sines = self.legs(c, c).each_ref().map(Leg::sine_squared);
        if sines.iter().any(|&it| it.abs() <= margin) {
            Verdict::Border
        } else if sines.iter().all(|&it| it > 0.0) {
            Verdict::Reached
        } else {
            Verdict::Beyond
        }
    }
}

pub(crate) fn wide(v: Vector2<f32>) -> Vector2<f64> {
    Vector2::new(f64::from(v.x), f64::from(v.y))
}

pub(crate) fn narrow(v: Vector2<f64>) -> Vector2<f32> {
    Vector2::new(v.x as f32, v.y as f32)
}

/// Numbers of a range, in single precision. (The strategy for ranges of `f32` sometimes exceeds a
/// bound and panics.)
pub(crate) fn single(range: core::ops::Range<f64>) -> impl Strategy<Value = f32> {
    range.prop_map(|number| number as f32)
}

/// Lengths l1…l4 and base of an arm from millimetres to metres [m], the longer link of either
/// leg up to 1.8 times the shorter one; of four arms one is coaxial.
pub(crate) fn lengths() -> impl Strategy<Value = [f32; 5]> {
    let ratio = || single(1.0 / 1.8..1.8);
    (
        single(-5.0..3.0),
        [ratio(), ratio()],
        prop_oneof![3 => single(0.1..1.5), 1 => Just(0.0)],
        single(0.7..1.4),
    )
        .prop_map(|(size, [ratio1, ratio4], base, l4)| {
            [1.0, ratio1, l4 * ratio4, l4, base].map(|it| it * size.exp())
        })
}

/// Any arm of these lengths, its tool at C.
pub(crate) fn arms() -> impl Strategy<Value = Arms> {
    lengths().prop_filter_map("does not close", |lengths| {
        Arms::new(lengths, Vector2::zeros())
    })
}

/// The end of two links from the origin: the first at angle `theta`, the second turned from it by
/// the angle whose sine is `sine`, or by π less that.
pub(crate) fn end_of(
    [near, far]: [f64; 2],
    theta: f64,
    sine: f64,
    [left, folded]: [bool; 2],
) -> Vector2<f64> {
    let bend = if folded {
        std::f64::consts::PI - sine.asin()
    } else {
        sine.asin()
    };
    let turn = if left { bend } else { -bend };
    Vector2::unit(theta) * near + Vector2::unit(theta + turn) * far
}
