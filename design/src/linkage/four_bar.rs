//! Four-bars and Grashof's rule.
//!
//! With s the shortest and l the longest of the four lengths, p and q the others: a link
//! can turn fully relative to the others if and only if s + l ≤ p + q, and then it is the
//! shortest one. With equality the motion can change to another branch at a dead point.

use super::group::{Group, LinkId};
use super::model::Linkage;
use core::fmt;
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// Which links of a four-bar turn fully.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FourBarType {
    /// Shortest link the input: it turns fully, the output swings.
    CrankRocker,
    /// Shortest link the output: it turns fully, the input swings.
    RockerCrank,
    /// Shortest link the frame: both turn fully.
    DoubleCrank,
    /// Shortest link the coupler: both swing, the coupler turns fully.
    DoubleRocker,
    /// s + l = p + q: the links can come into line.
    ChangePoint,
    /// s + l > p + q: no link turns fully.
    TripleRocker,
}

/// The lengths of a four-bar [m].
///
/// ```
/// use fivebar_design::linkage::{FourBar, FourBarType};
///
/// // Lengths [m]: 0.05 + 0.20 < 0.15 + 0.18, and the input is the shortest link.
/// let four_bar = FourBar { frame: 0.20, input: 0.05, coupler: 0.18, output: 0.15 };
/// assert_eq!(four_bar.classify(), FourBarType::CrankRocker);
/// // The same lengths with the shortest link as the frame.
/// let inverted = FourBar { frame: 0.05, input: 0.20, ..four_bar };
/// assert_eq!(inverted.classify(), FourBarType::DoubleCrank);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FourBar<S> {
    /// Between the ground pivots.
    pub frame: S,
    /// The driven link.
    pub input: S,
    /// The link between input and output.
    pub coupler: S,
    /// The other link at the frame.
    pub output: S,
}

/// Relative difference below which s + l and p + q count as equal, because lengths come from
/// decimal numbers and coordinates and are rounded.
const EQUAL: f64 = 1e-12;

impl<S: Scalar> FourBar<S> {
    /// Its type by Grashof's rule.
    pub fn classify(&self) -> FourBarType {
        let lengths = [self.frame, self.input, self.coupler, self.output].map(S::to_f64);
        let shortest = lengths.iter().copied().fold(f64::INFINITY, f64::min);
        let longest = lengths.iter().copied().fold(0.0, f64::max);
        let sum: f64 = lengths.iter().sum();
        // p + q − (s + l)
        let excess = sum - 2.0 * (shortest + longest);
        if excess.abs() <= EQUAL * sum {
            return FourBarType::ChangePoint;
        }
        if excess < 0.0 {
            return FourBarType::TripleRocker;
        }
        let [frame, input, coupler, _] = lengths;
        if shortest == frame {
            FourBarType::DoubleCrank
        } else if shortest == input {
            FourBarType::CrankRocker
        } else if shortest == coupler {
            FourBarType::DoubleRocker
        } else {
            FourBarType::RockerCrank
        }
    }
}

impl fmt::Display for FourBarType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::CrankRocker => "crank-rocker: the input turns fully, the output swings",
            Self::RockerCrank => "rocker-crank: the output turns fully, the input swings",
            Self::DoubleCrank => "double crank: input and output both turn fully",
            Self::DoubleRocker => "double rocker: input and output swing, the coupler turns fully",
            Self::ChangePoint => "change point: its links can come into line",
            Self::TripleRocker => "triple rocker: no link turns fully",
        })
    }
}

impl<S: Scalar> Linkage<S> {
    /// The four-bar at the beginning of the linkage: the first RRR dyad between a point of a
    /// crank on the frame and a point of the frame; none if there is no such dyad.
    pub fn four_bar(&self) -> Option<FourBar<S>> {
        self.elements().iter().find_map(|element| {
            let Group::Rrr { dyad, ends } = element.group else {
                return None;
            };
            let [crank_end, frame_end] = ends.map(|end| &self.points[end.0]);
            if frame_end.link != LinkId::GROUND {
                return None;
            }
            let crank = self.elements().iter().find_map(|element| {
                let Group::Crank { pivot } = element.group else {
                    return None;
                };
                (element.first_link == crank_end.link).then_some(&self.points[pivot.0])
            })?;
            let from = |a: Option<Vector2<S>>, b: Vector2<S>| Some((a? - b).length());
            Some(FourBar {
                frame: from(frame_end.local, crank.local?)?,
                input: from(crank_end.local, Vector2::zeros())?,
                coupler: dyad.lengths[0],
                output: dyad.lengths[1],
            })
            .filter(|_| crank.link == LinkId::GROUND)
        })
    }
}
