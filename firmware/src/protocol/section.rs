//! The settings in sections, each small enough for a frame.

use crate::settings::{
    AdvancedSettings, AxisSettings, BeltSettings, BrakeSettings, ControlSettings, ENCODER_POINTS,
    FieldLag, HomeReference, HomingSettings, LinkSettings, MotionSettings, ProtectionSettings,
    Settings, ToolOutputSettings,
};
use serde::{Deserialize, Serialize};

/// Sections that the points of an encoder's table take.
const QUARTERS: usize = ENCODER_POINTS / 16;

/// The key of a section.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SectionKey {
    /// l1…l4 and the base.
    Lengths,
    /// Inertia of a link: 0…3 are links 1…4.
    Link(u8),
    /// The point mass at C.
    Payload,
    /// In-plane gravity.
    Gravity,
    /// The tool's position from C.
    ToolOffset,
    /// The working mode.
    Elbows,
    /// A driven joint: 0 is joint 1, 1 is joint 4.
    Axis(u8),
    /// The control loops.
    Control,
    /// The tool's limits.
    Motion,
    /// The trip points.
    Protection,
    /// The assembly mode.
    Assembly,
    /// The search for the home switches.
    Homing,
    /// The output for a tool.
    ToolOutput,
    /// The ratio of the shaft of an encoder with a known error: 0 is joint 1, 1 is joint 4.
    EncoderShaft(u8),
    /// A quarter of an encoder's known error: 0…3 are joint 1's, 4…7 joint 4's.
    EncoderPoints(u8),
    /// The source of the joints' angles.
    HomeReference,
    /// Whether crossings are allowed.
    Crossing,
    /// The holding brakes.
    Brake,
    /// Numbers that fit most arms.
    Advanced,
    /// What stretches before a joint: 0 is joint 1, 1 is joint 4.
    Belt(u8),
    /// How far the rotor of a stepper lags: 0 is joint 1, 1 is joint 4.
    FieldLag(u8),
}

/// A section with its value; units as in [`Settings`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Section {
    /// [`Settings::lengths`].
    Lengths([f32; 5]),
    /// One of [`Settings::links`].
    Link(u8, LinkSettings),
    /// [`Settings::payload`].
    Payload(f32),
    /// [`Settings::gravity`].
    Gravity([f32; 2]),
    /// [`Settings::tool_offset`].
    ToolOffset([f32; 2]),
    /// [`Settings::elbows_left`].
    Elbows([bool; 2]),
    /// One of [`Settings::axes`].
    Axis(u8, AxisSettings),
    /// [`Settings::control`].
    Control(ControlSettings),
    /// [`Settings::motion`].
    Motion(MotionSettings),
    /// [`Settings::protection`].
    Protection(ProtectionSettings),
    /// [`Settings::assembly_left`].
    Assembly(bool),
    /// [`Settings::homing`].
    Homing(HomingSettings),
    /// [`Settings::tool_output`].
    ToolOutput(ToolOutputSettings),
    /// The ratio of one of [`Settings::encoder_tables`].
    EncoderShaft(u8, f32),
    /// A quarter of the points of one of [`Settings::encoder_tables`]: small, because the interrupt
    /// that receives it moves it.
    EncoderPoints(u8, [i16; 16]),
    /// [`Settings::home_reference`].
    HomeReference(HomeReference),
    /// [`Settings::crossing_allowed`].
    Crossing(bool),
    /// [`Settings::brake`].
    Brake(BrakeSettings),
    /// [`Settings::advanced`].
    Advanced(AdvancedSettings),
    /// One of [`Settings::belts`].
    Belt(u8, BeltSettings),
    /// One of [`Settings::field_lags`].
    FieldLag(u8, FieldLag),
}

impl SectionKey {
    /// Every section. Together they are the whole settings.
    pub const ALL: [Self; 35] = [
        Self::Lengths,
        Self::Link(0),
        Self::Link(1),
        Self::Link(2),
        Self::Link(3),
        Self::Payload,
        Self::Gravity,
        Self::ToolOffset,
        Self::Elbows,
        Self::Axis(0),
        Self::Axis(1),
        Self::Control,
        Self::Motion,
        Self::Protection,
        Self::Assembly,
        Self::Homing,
        Self::ToolOutput,
        Self::EncoderShaft(0),
        Self::EncoderShaft(1),
        Self::EncoderPoints(0),
        Self::EncoderPoints(1),
        Self::EncoderPoints(2),
        Self::EncoderPoints(3),
        Self::EncoderPoints(4),
        Self::EncoderPoints(5),
        Self::EncoderPoints(6),
        Self::EncoderPoints(7),
        Self::HomeReference,
        Self::Crossing,
        Self::Brake,
        Self::Advanced,
        Self::Belt(0),
        Self::Belt(1),
        Self::FieldLag(0),
        Self::FieldLag(1),
    ];

    /// This section of `settings`; `None` if there is no such link or axis.
    pub fn of(self, settings: &Settings) -> Option<Section> {
        Some(match self {
            Self::Lengths => Section::Lengths(settings.lengths),
            Self::Link(index) => Section::Link(index, *settings.links.get(usize::from(index))?),
            Self::Payload => Section::Payload(settings.payload),
            Self::Gravity => Section::Gravity(settings.gravity),
            Self::ToolOffset => Section::ToolOffset(settings.tool_offset),
            Self::Elbows => Section::Elbows(settings.elbows_left),
            Self::Axis(index) => Section::Axis(index, *settings.axes.get(usize::from(index))?),
            Self::Control => Section::Control(settings.control),
            Self::Motion => Section::Motion(settings.motion),
            Self::Protection => Section::Protection(settings.protection),
            Self::Assembly => Section::Assembly(settings.assembly_left),
            Self::Homing => Section::Homing(settings.homing),
            Self::ToolOutput => Section::ToolOutput(settings.tool_output),
            Self::EncoderShaft(index) => {
                let table = settings.encoder_tables.get(usize::from(index))?;
                Section::EncoderShaft(index, table.shaft_ratio)
            }
            Self::EncoderPoints(index) => {
                let table = settings.encoder_tables.get(usize::from(index) / QUARTERS)?;
                let points = table.points.get(usize::from(index) % QUARTERS)?;
                Section::EncoderPoints(index, *points)
            }
            Self::HomeReference => Section::HomeReference(settings.home_reference),
            Self::Crossing => Section::Crossing(settings.crossing_allowed),
            Self::Brake => Section::Brake(settings.brake),
            Self::Advanced => Section::Advanced(settings.advanced),
            Self::Belt(index) => Section::Belt(index, *settings.belts.get(usize::from(index))?),
            Self::FieldLag(index) => {
                Section::FieldLag(index, *settings.field_lags.get(usize::from(index))?)
            }
        })
    }
}

impl Section {
    /// Puts this section into `settings`. `None`, without a change, if there is no such link or
    /// axis.
    #[must_use]
    pub fn put(self, settings: &mut Settings) -> Option<()> {
        match self {
            Self::Lengths(value) => settings.lengths = value,
            Self::Link(index, value) => *settings.links.get_mut(usize::from(index))? = value,
            Self::Payload(value) => settings.payload = value,
            Self::Gravity(value) => settings.gravity = value,
            Self::ToolOffset(value) => settings.tool_offset = value,
            Self::Elbows(value) => settings.elbows_left = value,
            Self::Axis(index, value) => *settings.axes.get_mut(usize::from(index))? = value,
            Self::Control(value) => settings.control = value,
            Self::Motion(value) => settings.motion = value,
            Self::Protection(value) => settings.protection = value,
            Self::Assembly(value) => settings.assembly_left = value,
            Self::Homing(value) => settings.homing = value,
            Self::ToolOutput(value) => settings.tool_output = value,
            Self::EncoderShaft(index, value) => {
                let table = settings.encoder_tables.get_mut(usize::from(index))?;
                table.shaft_ratio = value;
            }
            Self::EncoderPoints(index, value) => {
                let table = settings
                    .encoder_tables
                    .get_mut(usize::from(index) / QUARTERS)?;
                *table.points.get_mut(usize::from(index) % QUARTERS)? = value;
            }
            Self::HomeReference(value) => settings.home_reference = value,
            Self::Crossing(value) => settings.crossing_allowed = value,
            Self::Brake(value) => settings.brake = value,
            Self::Advanced(value) => settings.advanced = value,
            Self::Belt(index, value) => *settings.belts.get_mut(usize::from(index))? = value,
            Self::FieldLag(index, value) => {
                *settings.field_lags.get_mut(usize::from(index))? = value;
            }
        }
        Some(())
    }
}
