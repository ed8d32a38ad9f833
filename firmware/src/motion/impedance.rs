//! What an arm that renders springs is told: its impedance, and before that its walls and its guides.

use serde::{Deserialize, Serialize};

/// The most walls and guides of a stream.
pub const FIXTURES: usize = 3;

/// The springs and dampers of a stream of the mode Impedance, in the frame of the base.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Impedance {
    /// kxx, kxy, kyy [N/m]: of the spring between the tool and the points.
    pub stiffness: (f32, f32, f32),
    /// dxx, dxy, dyy [N·s/m]: of the damper between them.
    pub damping: (f32, f32, f32),
}

/// A wall or a guide.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Fixture {
    /// What it is.
    pub shape: FixtureShape,
    /// Its spring [N/m].
    pub stiffness: f32,
    /// Its damper [N·s/m].
    pub damping: f32,
}

/// The shapes of walls and guides. Walls push and never pull; guides pull onto their line.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FixtureShape {
    /// A wall: the tool is free on the side to which the normal points.
    HalfPlane {
        /// A point of the wall [m].
        point: (f32, f32),
        /// Its normal, of any length.
        normal: (f32, f32),
    },
    /// A wall: the tool is free inside.
    Box {
        /// Its centre [m].
        centre: (f32, f32),
        /// The direction of its first side, of any length.
        axis: (f32, f32),
        /// Half of its sides [m].
        half: (f32, f32),
    },
    /// A wall: the tool is free inside a circle.
    Inside {
        /// Its centre [m].
        centre: (f32, f32),
        /// [m].
        radius: f32,
    },
    /// A wall: the tool is free outside of a circle.
    Outside {
        /// Its centre [m].
        centre: (f32, f32),
        /// [m].
        radius: f32,
    },
    /// A guide along a line.
    Line {
        /// A point of the line [m].
        point: (f32, f32),
        /// Its normal, of any length.
        normal: (f32, f32),
    },
    /// A guide along a circle.
    Circle {
        /// Its centre [m].
        centre: (f32, f32),
        /// [m].
        radius: f32,
    },
}
