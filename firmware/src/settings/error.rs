//! Why settings are invalid, by field.

use super::row::Row;
use super::{AxisField, Field};
use core::fmt::{self, Write};
use fivebar_kinematics::dynamics::ModelError;
use fivebar_kinematics::five_bar::GeometryError;

/// Why settings are refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SettingsError {
    /// The lengths are not those of a five-bar.
    Geometry(GeometryError),
    /// A mass or an inertia is invalid.
    Inertia(ModelError),
    /// A field of joint 1 or 4.
    Axis(u8, AxisField),
    /// Another field.
    Field(Field),
    /// The board has this one tick rate [Hz].
    BoardTickRate(u32),
    /// The filters at the board's encoder inputs pass so many counts per second.
    BoardCountRate(u32),
    /// The board's bridges stand this current [A].
    BoardCurrent(u32),
    /// The board's bridges stand this bus voltage [V].
    BoardVoltage(u32),
    /// The board's counters start at 0, so its encoders are not absolute.
    BoardEncoders,
    /// The board's drives are on a bus, and the settings name none.
    BoardBus,
    /// The board makes pulses of hobby servos, and the settings are of other motors.
    BoardServos,
    /// No pose within the joint limits is on the branch and keeps the singularity margin.
    NoPose,
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Geometry(error) => error.fmt(f),
            Self::Inertia(error) => error.fmt(f),
            Self::Axis(joint, field) => {
                write!(f, "joint {joint}: ")?;
                sentence(f, &field.row())
            }
            Self::Field(field) => sentence(f, &field.row()),
            Self::BoardTickRate(rate) => {
                write!(f, "control.tick_rate must be {rate} Hz, the board's")
            }
            Self::BoardCountRate(rate) => write!(
                f,
                "protection.over_speed must give at most {rate} encoder counts/s, which the \
                 board's input filters pass"
            ),
            Self::BoardCurrent(greatest) => write!(
                f,
                "protection.over_current must be at most {greatest} A, which the board's bridges \
                 stand"
            ),
            Self::BoardVoltage(greatest) => write!(
                f,
                "protection.bus_voltage must end at {greatest} V or below, which the board's \
                 bridges stand"
            ),
            Self::BoardEncoders => f.write_str(
                "home_reference.method must not be absolute: the board's counters start at 0 with \
                 the power, wherever the arm stands; use switch, hard-stop or given",
            ),
            Self::BoardBus => f.write_str(
                "current_zero_code of both axes must name two drives on the board's CAN bus: take a robot \
                 with actuators of kind \"can-torque\"",
            ),
            Self::BoardServos => f.write_str(
                "index_counts and thermal_time_constant of both axes must say the pulses of two hobby servos: take a robot \
                 with actuators of kind \"servo\"",
            ),
            Self::NoPose => f.write_str(
                "no pose within angle_limits is on the branch of elbows_left and assembly_left \
                 and keeps singularity_margin",
            ),
        }
    }
}

/// The field and what it must be, with the unit.
fn sentence(f: &mut fmt::Formatter<'_>, row: &Row) -> fmt::Result {
    let Row {
        path, must, unit, ..
    } = row;
    let name = path.strip_prefix("axes.").unwrap_or(path);
    write!(f, "{name} ")?;
    let mut without_quotes = WithoutQuotes(f);
    write!(without_quotes, "{must}")?;
    if unit.is_empty() || must.names(unit) {
        return Ok(());
    }
    write!(f, " [{unit}]")
}

/// Leaves the backticks around the names of other fields out.
struct WithoutQuotes<'a, 'b>(&'a mut fmt::Formatter<'b>);

impl fmt::Write for WithoutQuotes<'_, '_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        text.split('`').try_for_each(|part| self.0.write_str(part))
    }
}

impl core::error::Error for SettingsError {}
