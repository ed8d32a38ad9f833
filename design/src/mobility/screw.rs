//! Screws: twists of joints and wrenches of constraints, in one pair of vectors.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3, Vector6};

/// A screw (s; m) in the base frame: a twist (ω; velocity at the origin) or a wrench
/// (force; moment about the origin).
///
/// ```
/// use fivebar_design::mobility::Screw;
/// use nalgebra::Vector3;
///
/// // A revolute joint along z through (1, 0, 0) m, and a force of 1 N along y.
/// let joint = Screw::line(Vector3::z(), Vector3::x());
/// let force_at = |x: f64| Screw::line(Vector3::y(), Vector3::x() * x);
/// // Through the axis it has no power on the joint; 0.5 m beside it, 0.5 W at 1 rad/s.
/// assert_eq!(force_at(1.0).reciprocal_product(&joint), 0.0);
/// assert_eq!(force_at(1.5).reciprocal_product(&joint), 0.5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Screw {
    /// The direction part s.
    pub direction: Vector3<f64>,
    /// The moment part m, about the origin.
    pub moment: Vector3<f64>,
}

impl Screw {
    /// Pitch zero about the line through `point` along `axis`: a revolute joint, a force.
    pub fn line(axis: Vector3<f64>, point: Vector3<f64>) -> Self {
        Self::helix(axis, point, 0.0)
    }

    /// A screw of the given `pitch` [m/rad] about a line: a helical joint, a wrench.
    pub fn helix(axis: Vector3<f64>, point: Vector3<f64>, pitch: f64) -> Self {
        Self {
            direction: axis,
            moment: point.cross(&axis) + axis * pitch,
        }
    }

    /// Infinite pitch: a prismatic joint, a couple.
    pub fn free(direction: Vector3<f64>) -> Self {
        Self {
            direction: Vector3::zeros(),
            moment: direction,
        }
    }

    /// (s; m) as six numbers.
    pub fn to_vector(self) -> Vector6<f64> {
        let (s, m) = (self.direction, self.moment);
        Vector6::new(s.x, s.y, s.z, m.x, m.y, m.z)
    }

    /// The screw of six numbers (s; m).
    pub fn from_vector(vector: &Vector6<f64>) -> Self {
        Self {
            direction: vector.fixed_rows::<3>(0).into(),
            moment: vector.fixed_rows::<3>(3).into(),
        }
    }

    /// The power of a wrench on a twist: s1·m2 + m1·s2. Zero: they are reciprocal.
    pub fn reciprocal_product(&self, other: &Self) -> f64 {
        self.direction.dot(&other.moment) + self.moment.dot(&other.direction)
    }

    /// This screw carried along by a rigid displacement.
    #[must_use]
    pub fn transformed(&self, by: &Isometry3<f64>) -> Self {
        let direction = by.rotation * self.direction;
        Self {
            direction,
            moment: by.rotation * self.moment + by.translation.vector.cross(&direction),
        }
    }

    /// h = s·m/|s|² [m/rad]; none where the direction part is zero.
    pub fn pitch(&self) -> Option<f64> {
        let square = self.direction.norm_squared();
        (square > 0.0).then(|| self.direction.dot(&self.moment) / square)
    }

    /// The axis's point nearest to the origin, s×m/|s|²; none where there is no axis.
    pub fn axis_point(&self) -> Option<Vector3<f64>> {
        let square = self.direction.norm_squared();
        (square > 0.0).then(|| self.direction.cross(&self.moment) / square)
    }

    /// The finite displacement by `amount` along this twist: exp($ q).
    pub fn exponential(&self, amount: f64) -> Isometry3<f64> {
        let (Some(point), Some(pitch)) = (self.axis_point(), self.pitch()) else {
            return Translation3::from(self.moment * amount).into();
        };
        let turn = self.direction * amount;
        let rotation = UnitQuaternion::from_scaled_axis(turn);
        let translation = point - rotation * point + turn * pitch;
        Isometry3::from_parts(translation.into(), rotation)
    }
}
