//! The tolerances of a linkage's parts.

use crate::linkage::{Parameter, ParameterKind};
use std::collections::BTreeMap;

/// The tolerances of a linkage's parts. Parts without an entry have no scatter.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinkageTolerance {
    /// Standard deviations of q, q̇ and q̈ of each driven link [rad or m, and per s, s²].
    pub input_sd: [Vec<f64>; 3],
    /// Greatest error of each driving coordinate [rad or m].
    pub input_max: Vec<f64>,
    /// The pins that have a clearance, in the order of the linkage's joints.
    pub pins: Vec<PinTolerance>,
    /// Standard deviation of dyads' lengths and offsets, by link [m].
    pub length_sd: BTreeMap<String, f64>,
    /// Standard deviation of points' coordinates in their links, by point [m].
    pub point_sd: BTreeMap<String, [f64; 2]>,
    /// Standard deviation of masses, by link or by the point that carries one [kg].
    pub mass_sd: BTreeMap<String, f64>,
    /// Standard deviation of sections, by link [m²].
    pub section_sd: BTreeMap<String, f64>,
}

/// A pin with clearance.
#[derive(Clone, Debug, PartialEq)]
pub struct PinTolerance {
    /// The index of its joint among the linkage's joints.
    pub joint_index: usize,
    /// Its name, such as "crank on coupler".
    pub name: String,
    /// Bearing radius less pin radius [m].
    pub radius: f64,
    /// Standard deviation of `radius` [m].
    pub radius_sd: f64,
    /// The direction in which it lies [rad]; none: in the direction of its reaction.
    pub angle: Option<f64>,
    /// Standard deviation of `angle` [rad].
    pub angle_sd: f64,
}

impl LinkageTolerance {
    /// The standard deviation of a parameter that is not a pin's, in its unit; zero if none is
    /// given.
    pub fn deviation(&self, parameter: Parameter<'_>) -> f64 {
        let Parameter { part, kind } = parameter;
        let given = match kind {
            ParameterKind::Length | ParameterKind::Offset => self.length_sd.get(part).copied(),
            ParameterKind::Mass => self.mass_sd.get(part).copied(),
            ParameterKind::Section => self.section_sd.get(part).copied(),
            ParameterKind::Local(axis) => self.point_sd.get(part).map(|sd| sd[axis]),
            _ => None,
        };
        given.unwrap_or(0.0)
    }
}
