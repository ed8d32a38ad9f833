//! What a dyad cannot do, by name.

use core::fmt;

/// Why a dyad has no position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unreachable {
    /// RRR: the ends are farther apart than the sum of the lengths.
    EndsTooFar,
    /// RRR: the ends are nearer than the difference of the lengths.
    EndsTooNear,
    /// RRP: the guide passes farther from the end than the bar is long.
    GuideTooFar,
    /// RPR: the ends are nearer than the guide's offset.
    InsideOffset,
}

/// Where a dyad's position or rates are not determined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Singular {
    /// RRR with equal lengths, RPR without offset: the ends meet, any direction will do.
    EndsMeet,
    /// RRR: the two bars are in line.
    BarsInLine,
    /// RRP: the bar stands square to the guide.
    BarSquareToGuide,
    /// RPR: the slider is level with the pivot, at the foot of the offset.
    SliderAtPivot,
    /// PRP, RPP: the two sliding directions are parallel.
    GuidesParallel,
    /// Any: the loads do not determine the reactions.
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
                Singular::EndsMeet => "is singular: its two ends meet",
                Singular::BarsInLine => "is singular: its two bars are in line",
                Singular::BarSquareToGuide => "is singular: its bar stands square to the guide",
                Singular::SliderAtPivot => "is singular: its slider is level with the pivot",
                Singular::GuidesParallel => "is singular: its two sliding directions are parallel",
                Singular::Reactions => "is singular: its loads do not determine its reactions",
            },
            Self::NotFinite => "was given a number that is infinite or not a number",
        })
    }
}

impl core::error::Error for DyadError {}
