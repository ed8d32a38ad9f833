//! The kinds of strokes that a picture becomes.

use serde::{Deserialize, Serialize};

/// How a picture becomes strokes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Trace {
    /// Along the edges of what is dark.
    #[default]
    Outline,
    /// Along the middle of dark lines.
    CentreLine,
    /// Parallel lines, the denser the darker.
    Tone,
    /// Dots, the denser the darker.
    Stipple,
    /// One line without lifting the pen, the denser the darker.
    OneLine,
}

impl Trace {
    /// All kinds.
    pub const ALL: [Self; 5] = [
        Self::Outline,
        Self::CentreLine,
        Self::Tone,
        Self::Stipple,
        Self::OneLine,
    ];

    /// Its name in options and messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Outline => "outline",
            Self::CentreLine => "centre-line",
            Self::Tone => "tone",
            Self::Stipple => "stipple",
            Self::OneLine => "one-line",
        }
    }
}
