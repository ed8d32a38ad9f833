//! `[tolerance]` of a linkage file: the tolerances of its parts.

use super::names::{driven_links, reaction_names};
use crate::refusal::Key;
use crate::source::{FileError, Source};
use fivebar_design::accuracy::linkage::{LinkageTolerance, PinTolerance};
use fivebar_design::linkage::Linkage;
use serde::Deserialize;
use std::collections::BTreeMap;

/// `[tolerance]` as written: each key has one number for all, or a table with one for each
/// name. Keys that end in `_sd` are standard deviations.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct ToleranceFile {
    /// Of dyads' lengths and offsets, by link [m].
    length_sd: ForAllOrEach<f64>,
    /// Of points' coordinates in their links, by point: [x, y] [m].
    point_sd: ForAllOrEach<[f64; 2]>,
    /// Of masses, by link or by the point that carries one [kg].
    mass_sd: ForAllOrEach<f64>,
    /// Of sections, by link [m²].
    section_sd: ForAllOrEach<f64>,
    /// Of driving coordinates, by driven link [rad or m].
    input_sd: ForAllOrEach<f64>,
    /// Of their rates [rad/s or m/s].
    input_rate_sd: ForAllOrEach<f64>,
    /// Of their accelerations [rad/s² or m/s²].
    input_acceleration_sd: ForAllOrEach<f64>,
    /// The greatest error of driving coordinates [rad or m].
    input_max: ForAllOrEach<f64>,
    /// Bearing radius less pin radius, by pin [m].
    clearance_radius: ForAllOrEach<f64>,
    clearance_radius_sd: ForAllOrEach<f64>,
    /// The direction in which a pin lies in its bearing, by pin [rad].
    clearance_angle: ForAllOrEach<f64>,
    clearance_angle_sd: ForAllOrEach<f64>,
}

/// One number for all, or one for each name.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a number, or a table with a value for each name"
)]
enum ForAllOrEach<T> {
    All(f64),
    Each(BTreeMap<String, T>),
}

impl<T> Default for ForAllOrEach<T> {
    fn default() -> Self {
        Self::Each(BTreeMap::new())
    }
}

impl ForAllOrEach<f64> {
    fn of(&self, name: &str) -> Option<f64> {
        match self {
            Self::All(value) => Some(*value),
            Self::Each(values) => values.get(name).copied(),
        }
    }
}

impl<T> ForAllOrEach<T> {
    /// The value of each of these names that has one; `value` makes it from the number for all.
    fn by_name(self, names: &[&str], value: fn(f64) -> T) -> BTreeMap<String, T> {
        match self {
            Self::All(number) => {
                let names = names.iter();
                names.map(|name| ((*name).into(), value(number))).collect()
            }
            Self::Each(values) => values,
        }
    }
}

impl ToleranceFile {
    /// Checks all names and numbers against this linkage.
    pub(super) fn checked(
        self,
        source: &Source<'_>,
        linkage: &Linkage<f64>,
    ) -> Result<LinkageTolerance, FileError> {
        let links: Vec<&str> = linkage.links().iter().map(|l| l.name.as_str()).collect();
        let points: Vec<&str> = linkage.points().iter().map(|p| p.name.as_str()).collect();
        let either = [links.clone(), points.clone()].concat();
        let driven: Vec<&str> = driven_links(linkage).map(|(name, _)| name).collect();
        let joints = reaction_names(linkage);
        let is_pin: Vec<bool> = linkage.pins().collect();
        let joints: Vec<(usize, &str)> = joints
            .iter()
            .map(String::as_str)
            .enumerate()
            .filter(|&(joint, _)| is_pin[joint])
            .collect();
        let pins: Vec<&str> = joints.iter().map(|&(_, name)| name).collect();
        let deviation = |key, given: &ForAllOrEach<f64>, names: &[&str]| {
            check(
                source,
                key,
                given,
                names,
                std::slice::from_ref,
                not_negative,
            )
        };
        deviation("length_sd", &self.length_sd, &links)?;
        deviation("mass_sd", &self.mass_sd, &either)?;
        deviation("section_sd", &self.section_sd, &links)?;
        deviation("input_sd", &self.input_sd, &driven)?;
        deviation("input_rate_sd", &self.input_rate_sd, &driven)?;
        deviation(
            "input_acceleration_sd",
            &self.input_acceleration_sd,
            &driven,
        )?;
        deviation("input_max", &self.input_max, &driven)?;
        deviation("clearance_radius", &self.clearance_radius, &pins)?;
        deviation("clearance_radius_sd", &self.clearance_radius_sd, &pins)?;
        deviation("clearance_angle_sd", &self.clearance_angle_sd, &pins)?;
        let (angle, one) = (&self.clearance_angle, std::slice::from_ref);
        check(source, "clearance_angle", angle, &pins, one, f64::is_finite)?;
        let both = <[f64; 2]>::as_slice;
        check(
            source,
            "point_sd",
            &self.point_sd,
            &points,
            both,
            not_negative,
        )?;
        let of_driven = |given: &ForAllOrEach<f64>| -> Vec<f64> {
            let values = driven.iter().map(|name| given.of(name).unwrap_or(0.0));
            values.collect()
        };
        let pin = |&(joint_index, name): &(usize, &str)| {
            let radius = self.clearance_radius.of(name).unwrap_or(0.0);
            (radius > 0.0).then(|| PinTolerance {
                joint_index,
                name: name.into(),
                radius,
                radius_sd: self.clearance_radius_sd.of(name).unwrap_or(0.0),
                angle: self.clearance_angle.of(name),
                angle_sd: self.clearance_angle_sd.of(name).unwrap_or(0.0),
            })
        };
        Ok(LinkageTolerance {
            input_sd: [
                of_driven(&self.input_sd),
                of_driven(&self.input_rate_sd),
                of_driven(&self.input_acceleration_sd),
            ],
            input_max: of_driven(&self.input_max),
            pins: joints.iter().filter_map(pin).collect(),
            length_sd: self.length_sd.by_name(&links, |sd| sd),
            point_sd: self.point_sd.by_name(&points, |sd| [sd; 2]),
            mass_sd: self.mass_sd.by_name(&either, |sd| sd),
            section_sd: self.section_sd.by_name(&links, |sd| sd),
        })
    }
}

fn not_negative(value: f64) -> bool {
    value >= 0.0 && value.is_finite()
}

/// Refuses unknown names and numbers that are not valid.
fn check<T>(
    source: &Source<'_>,
    key: &'static str,
    given: &ForAllOrEach<T>,
    names: &[&str],
    numbers: fn(&T) -> &[f64],
    is_valid: fn(f64) -> bool,
) -> Result<(), FileError> {
    let key = Key::In("tolerance", key);
    let invalid = |value: f64| source.refuse(key, format!("cannot be {value:?}"));
    let values = match given {
        ForAllOrEach::All(value) if is_valid(*value) => return Ok(()),
        ForAllOrEach::All(value) => return Err(invalid(*value)),
        ForAllOrEach::Each(values) => values,
    };
    for (name, value) in values {
        if !names.contains(&name.as_str()) {
            let reason = format!(
                "names `{name}`, which does not exist; there are {}",
                names.join(", ")
            );
            return Err(source.refuse(key, reason));
        }
        if let Some(&wrong) = numbers(value).iter().find(|value| !is_valid(**value)) {
            return Err(invalid(wrong));
        }
    }
    Ok(())
}
