//! Robot files with `mechanism = "slider"`: the slider-driven mechanism, which is related to
//! the five-bar.

use super::sections::ToleranceFile;
use super::tolerance::each;
use super::{BuiltIn, Robot, plausible, read};
use crate::refusal::{Key, Refusal};
use crate::source::{FileError, Source};
use fivebar_design::accuracy::slider::{SliderTolerance, TolerancedSlider};
use fivebar_design::linkage::dyad::SlideBranch;
use fivebar_design::slider::{Geometry, GeometryError, Limb, Travel, WorkingMode};
use serde::Deserialize;

/// The mechanism of a robot file.
#[derive(Clone, Debug, PartialEq)]
pub enum Mechanism {
    /// The arm with four links.
    FiveBar(Box<Robot>),
    /// Two sliders on one guide.
    Slider(SliderRobot),
}

/// A slider-driven mechanism from a file, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct SliderRobot {
    /// Its name.
    pub name: String,
    /// l3, l7 and l5.
    pub geometry: Geometry<f64>,
    /// The side of the platform on which each slider is.
    pub working_mode: WorkingMode,
    /// Least and greatest position of the sliders, if the file gives them.
    pub travel: Option<Travel<f64>>,
    /// The tolerances of its parts.
    pub tolerance: SliderTolerance,
}

/// The whole file. SI units; unknown keys are refused.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct SliderFile {
    name: String,
    #[serde(rename = "mechanism")]
    _mechanism: String,
    left_link: f64,
    right_link: f64,
    #[serde(default)]
    platform: f64,
    #[serde(default = "apart")]
    working_mode: [SlideBranch; 2],
    travel: Option<TravelFile>,
    #[serde(default)]
    tolerance: ToleranceFile,
}

/// `[travel]`: least and greatest position of each slider [m].
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct TravelFile {
    left: [f64; 2],
    right: [f64; 2],
}

fn apart() -> [SlideBranch; 2] {
    let WorkingMode { left, right } = WorkingMode::APART;
    [left, right]
}

/// The key that distinguishes the mechanisms.
#[derive(Deserialize)]
struct Tag {
    mechanism: Option<String>,
}

/// Whether the file is of a slider-driven mechanism.
pub(super) fn is_slider(source: &Source<'_>) -> bool {
    source
        .parse()
        .is_ok_and(|tag: Tag| tag.mechanism.as_deref() == Some("slider"))
}

impl Mechanism {
    /// The mechanism with this name, as for `--robot`: a built-in robot, or else a file of
    /// either kind.
    ///
    /// # Errors
    /// A file that cannot be read or is not valid.
    pub fn load(name_or_path: &str) -> Result<Self, FileError> {
        let five_bar = |robot| Self::FiveBar(Box::new(robot));
        if let Some(built_in) = BuiltIn::find(name_or_path) {
            return built_in.robot().map(five_bar);
        }
        let text = read(name_or_path)?;
        let source = Source::new(name_or_path, &text);
        if is_slider(&source) {
            SliderRobot::parse(name_or_path, &text).map(Self::Slider)
        } else {
            Robot::parse(name_or_path, &text).map(five_bar)
        }
    }
}

impl SliderRobot {
    /// The mechanism with its tolerances, for the analysis of its accuracy.
    pub fn toleranced(&self) -> TolerancedSlider<'_> {
        TolerancedSlider {
            geometry: &self.geometry,
            working_mode: self.working_mode,
            travel: self.travel,
            tolerance: &self.tolerance,
        }
    }

    /// The mechanism from the text of a file called `file`.
    ///
    /// # Errors
    /// An unknown or missing key, or a value that is not valid, with its line.
    pub fn parse(file: &str, text: &str) -> Result<Self, FileError> {
        let source = Source::new(file, text);
        let file = source.parse()?;
        Self::made(file, &source).map_err(|refusal| source.error(refusal))
    }

    /// The mechanism of a file with these values.
    fn made(file: SliderFile, source: &Source<'_>) -> Result<Self, Refusal> {
        if file.name.trim().is_empty() {
            return Err(Key::Top("name").refused("must not be empty"));
        }
        let geometry = Geometry::new(file.left_link, file.right_link, file.platform);
        let geometry = geometry.map_err(|error| {
            let key = match error {
                GeometryError::Limb(Limb::Left) => "left_link",
                GeometryError::Limb(Limb::Right) => "right_link",
                // The platform, and any length that is added later.
                _ => "platform",
            };
            Key::Top(key).refused(format!("cannot make a mechanism: {error}"))
        })?;
        let travel = file.travel.map(|travel| Travel {
            left: travel.left,
            right: travel.right,
        });
        for (key, range) in [
            ("left", travel.map(|travel| travel.left)),
            ("right", travel.map(|travel| travel.right)),
        ] {
            let ordered = |[least, greatest]: [f64; 2]| {
                least.is_finite() && greatest.is_finite() && least < greatest
            };
            if range.is_some_and(|range| !ordered(range)) {
                let reason = "must be two finite numbers of metres, the smaller first";
                return Err(Key::In("travel", key).refused(reason));
            }
        }
        let given = &file.tolerance;
        let inputs = "x2 and x8";
        let pins = "each limb's slider and platform, left limb first";
        let tolerance = SliderTolerance {
            length_sd: each("length_sd", &given.length_sd, "l3, l7 and l5")?,
            input_sd: each("input_sd", &given.input_sd, inputs)?,
            input_max: each("input_max", &given.input_max, inputs)?,
            clearance_radius: each("clearance_radius", &given.clearance_radius, pins)?,
        };
        let lengths = [file.left_link, file.right_link, file.platform];
        plausible::check_slider(source, lengths, travel.as_ref(), &tolerance)?;
        let [left, right] = file.working_mode;
        Ok(Self {
            name: file.name,
            geometry,
            working_mode: WorkingMode::new(left, right),
            travel,
            tolerance,
        })
    }
}
