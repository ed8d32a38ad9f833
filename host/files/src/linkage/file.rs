//! The linkage file: its sections, their keys and their defaults.
//!
//! Values are in SI units; angles are in degrees if the key ends in `_deg`. Unknown keys are
//! refused.

use super::tolerance::ToleranceFile;
use fivebar_design::linkage::DriveLaw;
use fivebar_design::linkage::dyad::SlideBranch;
use fivebar_kinematics::five_bar::Side;
use serde::Deserialize;
use std::collections::BTreeMap;

/// The whole file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LinkageFile {
    pub(super) name: String,
    /// Gravity in the plane [m/s²].
    #[serde(default)]
    pub(super) gravity: [f64; 2],
    pub(super) sweep: SweepFile,
    /// Points of the frame [m].
    #[serde(default)]
    pub(super) ground: BTreeMap<String, [f64; 2]>,
    #[serde(default)]
    pub(super) element: Vec<ElementFile>,
    #[serde(default)]
    pub(super) point: Vec<PointFile>,
    #[serde(default)]
    pub(super) load: Vec<LoadFile>,
    #[serde(default)]
    pub(super) tolerance: ToleranceFile,
}

/// `[sweep]`: for how long the driven links follow their `drive`, and in how many steps.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SweepFile {
    /// [s]
    pub(super) duration: f64,
    #[serde(default = "steps")]
    pub(super) steps: usize,
}

fn steps() -> usize {
    360
}

/// `[[element]]`: a driven link or a dyad, in the order of solution.
#[derive(Debug, Deserialize)]
#[serde(tag = "kind", deny_unknown_fields)]
pub(super) enum ElementFile {
    #[serde(rename = "crank")]
    Crank {
        pivot: String,
        link: LinkFile,
        drive: CrankDrive,
    },
    #[serde(rename = "slider")]
    Slider {
        guide: GuideFile,
        link: LinkFile,
        drive: SliderDrive,
    },
    #[serde(rename = "RRR")]
    Rrr {
        ends: [String; 2],
        lengths: [f64; 2],
        joint: String,
        branch: Side,
        links: [LinkFile; 2],
    },
    #[serde(rename = "RRP")]
    Rrp {
        end: String,
        length: f64,
        guide: GuideFile,
        #[serde(default)]
        offset: f64,
        joint: String,
        branch: SlideBranch,
        links: [LinkFile; 2],
    },
    #[serde(rename = "RPR")]
    Rpr {
        ends: [String; 2],
        #[serde(default)]
        offset: f64,
        branch: SlideBranch,
        links: [LinkFile; 2],
    },
    #[serde(rename = "PRP")]
    Prp {
        guides: [GuideFile; 2],
        #[serde(default)]
        offsets: [f64; 2],
        joint: String,
        links: [LinkFile; 2],
    },
    #[serde(rename = "RPP")]
    Rpp {
        end: String,
        direction: [f64; 2],
        guide: GuideFile,
        links: [LinkFile; 2],
    },
}

/// A guide: a point and a direction in the frame of that point's link.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GuideFile {
    pub(super) through: String,
    pub(super) direction: [f64; 2],
}

/// A link: its name and, unless it is massless, its inertia in its own frame.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LinkFile {
    pub(super) name: String,
    /// [kg]
    #[serde(default)]
    pub(super) mass: f64,
    /// Centre of mass [m].
    #[serde(default)]
    pub(super) com: [f64; 2],
    /// About the centre of mass [kg·m²].
    #[serde(default)]
    pub(super) inertia: f64,
    /// Instead of these three: the section of a slender bar.
    pub(super) section: Option<SectionFile>,
}

/// `section` of a link.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SectionFile {
    /// [m²]
    pub(super) area: f64,
    /// [kg/m³]
    pub(super) density: f64,
}

/// `drive` of a crank: q = start + speed t + swing sin(2π f t + phase).
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct CrankDrive {
    pub(super) start_deg: f64,
    pub(super) speed_deg_s: f64,
    pub(super) swing_deg: f64,
    pub(super) frequency_hz: f64,
    pub(super) phase_deg: f64,
}

/// `drive` of a slider: the same in metres.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct SliderDrive {
    pub(super) start: f64,
    pub(super) speed: f64,
    pub(super) swing: f64,
    pub(super) frequency_hz: f64,
    pub(super) phase_deg: f64,
}

/// `[[point]]`: a point of interest, fixed in a link.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PointFile {
    pub(super) name: String,
    pub(super) link: String,
    /// In the link's frame [m].
    pub(super) at: [f64; 2],
}

/// `[[load]]`: a point mass or an external force at a point.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LoadFile {
    pub(super) point: String,
    /// [kg]
    #[serde(default)]
    pub(super) mass: f64,
    /// In the plane's frame [N].
    #[serde(default)]
    pub(super) force: [f64; 2],
}

impl ElementFile {
    /// The name of its inner joint.
    pub(super) fn joint(&self) -> Option<&str> {
        match self {
            Self::Rrr { joint, .. } | Self::Rrp { joint, .. } | Self::Prp { joint, .. } => {
                Some(joint)
            }
            _ => None,
        }
    }

    /// Its links, in order.
    pub(super) fn links(&self) -> &[LinkFile] {
        match self {
            Self::Crank { link, .. } | Self::Slider { link, .. } => std::slice::from_ref(link),
            Self::Rrr { links, .. }
            | Self::Rrp { links, .. }
            | Self::Rpr { links, .. }
            | Self::Prp { links, .. }
            | Self::Rpp { links, .. } => links,
        }
    }

    /// Whether it has two branches.
    pub(super) fn has_branch(&self) -> bool {
        matches!(self, Self::Rrr { .. } | Self::Rrp { .. } | Self::Rpr { .. })
    }
}

impl CrankDrive {
    pub(super) fn law(&self) -> DriveLaw {
        DriveLaw {
            start: self.start_deg.to_radians(),
            speed: self.speed_deg_s.to_radians(),
            amplitude: self.swing_deg.to_radians(),
            frequency: self.frequency_hz,
            phase: self.phase_deg.to_radians(),
        }
    }
}

impl SliderDrive {
    pub(super) fn law(&self) -> DriveLaw {
        DriveLaw {
            start: self.start,
            speed: self.speed,
            amplitude: self.swing,
            frequency: self.frequency_hz,
            phase: self.phase_deg.to_radians(),
        }
    }
}
