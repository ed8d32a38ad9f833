//! Why a dyad cannot be solved.

use core::fmt;

/// Why a dyad has no position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unreachable {
    /// RRR: the ends are farther apart than the sum of the lengths.
    EndsTooFar,
    /// RRR: the ends are nearer than the difference of the lengths.
    EndsTooNear,
    /// RRP: the distance from the end to the guide exceeds the bar's length.
    GuideTooFar,
    /// RPR: the ends are nearer than the guide's offset.
    InsideOffset,
}

/// Which singularity leaves a dyad's position or rates undetermined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Singular {
    /// RRR with equal lengths, RPR without offset: the ends coincide, so every direction is a
    /// solution.
    EndsMeet,
    /// RRR: the two bars are in line.
    BarsInLine,
    /// RRP: the bar is perpendicular to the guide.
    BarPerpendicularToGuide,
    /// RPR: the slider is at the foot of the offset, s = 0.
    SliderAtPivot,
    /// PRP, RPP: the two sliding directions are parallel.
    GuidesParallel,
    /// Any dyad: the loads do not determine the reactions.
    Reactions,
}

/// Why a dyad cannot be solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DyadError {
    /// No position exists.
    Unreachable(Unreachable),
    /// The position or the rates are not determined.
    Singular(Singular),
    /// A number given is infinite or not a number.
    NotFinite,
}

impl fmt::Display for DyadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unreachable(why) => match why {
                Unreachable::EndsTooFar => {
                    "cannot close: its ends are farther apart than its two lengths together"
                }
                Unreachable::EndsTooNear => {
                    "cannot close: its ends are nearer than the difference of its lengths"
                }
                Unreachable::GuideTooFar => "cannot close: the bar does not reach its guide",
                Unreachable::InsideOffset => {
                    "cannot close: its ends are nearer than the offset of its guide"
                }
            },
            Self::Singular(which) => match which {
                Singular::EndsMeet => "is singular: its two ends coincide",
                Singular::BarsInLine => "is singular: its two bars are in line",
                Singular::BarPerpendicularToGuide => {
                    "is singular: its bar is perpendicular to the guide"
                }
                Singular::SliderAtPivot => "is singular: its slider is level with the pivot",
                Singular::GuidesParallel => "is singular: its two sliding directions are parallel",
                Singular::Reactions => "is singular: its loads do not determine its reactions",
            },
            Self::NotFinite => "got a number that is infinite or not a number",
        })
    }
}

impl core::error::Error for DyadError {}
