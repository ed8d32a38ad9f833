//! The parts of a linkage: driven links and dyads, with the points and guides that carry them.

use super::dyad::{Prp, Rpp, Rpr, Rrp, Rrr};
use nalgebra::Vector2;

/// A link of a linkage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LinkId(pub(super) usize);

impl LinkId {
    /// The frame, at rest.
    pub const GROUND: Self = Self(0);

    /// Its index in [`Linkage::links`](super::Linkage::links) and in a motion's `links`.
    pub fn index(self) -> usize {
        self.0
    }
}

/// A point of a linkage, fixed in one of its links.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PointId(pub(super) usize);

impl PointId {
    /// Its index in [`Linkage::points`](super::Linkage::points) and in a motion's `points`.
    pub fn index(self) -> usize {
        self.0
    }
}

/// A straight guide, fixed in the link to which the point `through` belongs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guide<S> {
    /// A point of the guide.
    pub through: PointId,
    /// Its direction in that link's frame, of any length:
    /// [`Linkage::add_group`](super::Linkage::add_group) makes it a unit vector.
    pub direction: Vector2<S>,
}

/// A driven link or a dyad, with the points and guides that carry it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Group<S> {
    /// A driven link that turns about a point. Its coordinate is its angle [rad], measured
    /// from the link to which the pivot belongs.
    Crank {
        /// The pivot, the origin of the crank's frame.
        pivot: PointId,
    },
    /// A driven link that slides along a guide. Its coordinate is its displacement from
    /// the guide's point [m].
    Slider {
        /// The guide, whose direction the slider's frame keeps.
        guide: Guide<S>,
    },
    /// Two bars that meet in a pin.
    Rrr {
        /// Lengths and branch.
        dyad: Rrr<S>,
        /// The two points that carry it.
        ends: [PointId; 2],
    },
    /// A bar and a slider pinned to its end.
    Rrp {
        /// Length, offset and branch.
        dyad: Rrp<S>,
        /// The point that carries the bar.
        end: PointId,
        /// The guide that carries the slider.
        guide: Guide<S>,
    },
    /// A bar that is a guide, and a slider on it.
    Rpr {
        /// Offset and branch.
        dyad: Rpr<S>,
        /// The points that carry the bar and the slider.
        ends: [PointId; 2],
    },
    /// Two sliders pinned together.
    Prp {
        /// Offsets.
        dyad: Prp<S>,
        /// The guides that carry them.
        guides: [Guide<S>; 2],
    },
    /// A bar that slides in a slider.
    Rpp {
        /// The direction of the bar in the guide's frame; it is made a unit vector.
        dyad: Rpp<S>,
        /// The point that carries the bar.
        end: PointId,
        /// The guide that carries the slider.
        guide: Guide<S>,
    },
}

impl<S> Group<S> {
    /// Whether it is a driven link, with one link and one joint. A dyad has two links and
    /// three joints.
    pub fn is_driven(&self) -> bool {
        matches!(self, Self::Crank { .. } | Self::Slider { .. })
    }

    /// For each joint whether it is a pin, in the order of
    /// [`Forces::reactions`](super::Forces).
    pub fn pins(&self) -> &'static [bool] {
        match self {
            Self::Crank { .. } => &[true],
            Self::Slider { .. } => &[false],
            Self::Rrr { .. } => &[true, true, true],
            Self::Rrp { .. } => &[true, true, false],
            Self::Rpr { .. } => &[true, false, true],
            Self::Prp { .. } => &[false, true, false],
            Self::Rpp { .. } => &[true, false, false],
        }
    }
}
