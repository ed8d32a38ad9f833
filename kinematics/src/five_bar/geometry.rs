//! The five lengths, checked at construction.

use super::GeometryError;
use super::dyad::Dyad;
use crate::Scalar;
use nalgebra::Vector2;

/// The lengths of a five-bar [m], checked to close: the links' are positive, the base may be 0
/// (coaxial cranks).
///
/// ```
/// use fivebar_kinematics::five_bar::{Geometry, Side};
/// use core::f64::consts::FRAC_PI_2;
///
/// // l1 to l4 and the base [m].
/// let geometry = Geometry::new([0.10_f64, 0.17, 0.17, 0.10, 0.16])?;
/// // Both driven links point up: C is in the middle, 0.15 m above the elbows.
/// let pose = geometry.forward(FRAC_PI_2, FRAC_PI_2, Side::Left)?;
/// assert!((pose.c.x - 0.08).abs() < 1e-15);
/// assert!((pose.c.y - 0.25).abs() < 1e-15);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry<S> {
    lengths: [S; 5],
    /// 1/l1…1/l4 [1/m]: a multiplication costs a fourteenth of a division on the target.
    per_length: [S; 4],
    /// A–B–C.
    leg1: Dyad<S>,
    /// E–D–C.
    leg4: Dyad<S>,
    /// B–C–D.
    tip: Dyad<S>,
}

impl Geometry<f32> {
    /// Without links.
    pub(super) const NONE: Self = Self {
        lengths: [0.0; 5],
        per_length: [0.0; 4],
        leg1: Dyad::<f32>::NONE,
        leg4: Dyad::<f32>::NONE,
        tip: Dyad::<f32>::NONE,
    };
}

impl<S: Scalar> Geometry<S> {
    /// The arm with links `lengths[0..4]` = l1…l4 and base `lengths[4]` = l5 = |AE| [m].
    ///
    /// # Errors
    /// A link's length that is not positive and finite, a base that is not finite or negative,
    /// or a longest length that exceeds the sum of the others.
    pub fn new(lengths: [S; 5]) -> Result<Self, GeometryError> {
        let mut sum = S::ZERO;
        let mut longest = S::ZERO;
        for (index, &length) in lengths.iter().enumerate() {
            let is_coaxial = index == 4 && length == S::ZERO;
            if !((length > S::ZERO || is_coaxial) && length.is_finite()) {
                return Err(GeometryError::NotPositive(index));
            }
            sum += length;
            if length > longest {
                longest = length;
            }
        }
        if longest > sum - longest {
            return Err(GeometryError::CannotAssemble);
        }
        let [l1, l2, l3, l4, base] = lengths;
        Ok(Self {
            lengths,
            per_length: [l1, l2, l3, l4].map(|length| S::ONE / length),
            leg1: Dyad::new(l1, l2),
            leg4: Dyad::at(base, l4, l3),
            tip: Dyad::new(l2, l3),
        })
    }

    /// Link 1, A to B [m].
    #[inline]
    pub fn l1(&self) -> S {
        self.lengths[0]
    }
    /// Link 2, B to C [m].
    #[inline]
    pub fn l2(&self) -> S {
        self.lengths[1]
    }
    /// Link 3, D to C [m].
    #[inline]
    pub fn l3(&self) -> S {
        self.lengths[2]
    }
    /// Link 4, E to D [m].
    #[inline]
    pub fn l4(&self) -> S {
        self.lengths[3]
    }
    /// The base, A to E [m].
    #[inline]
    pub fn base(&self) -> S {
        self.lengths[4]
    }
    /// l1…l4 and the base [m].
    #[inline]
    pub fn lengths(&self) -> [S; 5] {
        self.lengths
    }
    /// 1/l1…1/l4 [1/m].
    #[inline]
    pub(crate) fn per_length(&self) -> [S; 4] {
        self.per_length
    }
    /// A–B–C.
    #[inline]
    pub(super) fn leg1(&self) -> &Dyad<S> {
        &self.leg1
    }
    /// E–D–C.
    #[inline]
    pub(super) fn leg4(&self) -> &Dyad<S> {
        &self.leg4
    }
    /// B–C–D.
    #[inline]
    pub(super) fn tip(&self) -> &Dyad<S> {
        &self.tip
    }
    /// The ground pivot E = (l5, 0) [m]; A is the origin.
    #[inline]
    pub fn e(&self) -> Vector2<S> {
        Vector2::new(self.base(), S::ZERO)
    }
}
