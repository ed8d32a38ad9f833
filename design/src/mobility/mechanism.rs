//! The mechanisms that can be analysed: limbs between a base and a platform, or any graph of
//! bodies and joints. They are checked at construction.

use super::Screw;
use core::fmt;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use std::ops::RangeInclusive;

/// The greatest number of single freedoms of a mechanism; the cost grows with its cube.
pub const MAX_FREEDOMS: usize = 200;

/// One single-freedom motion of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Freedom {
    /// A screw fixed in the two bodies: revolute, prismatic, helical.
    Screw(Screw),
    /// A parallelogram as one joint: translation along a circle, while `rod` turns about `normal`.
    Parallelogram {
        /// Axis of the four revolute joints.
        normal: Vector3<f64>,
        /// The rod from the near to the far joint [m].
        rod: Vector3<f64>,
    },
}

/// The greatest number of a twist, of a normal, of a rod: the ranks are computed from products of several.
const SIZES: RangeInclusive<f64> = 1e-6..=1e6;

impl Freedom {
    /// The instantaneous twist at home.
    pub fn twist(&self) -> Screw {
        self.twist_at(0.0)
    }

    /// The instantaneous twist when displaced by `amount` [rad or m].
    pub(super) fn twist_at(&self, amount: f64) -> Screw {
        match self {
            Self::Screw(screw) => *screw,
            Self::Parallelogram { normal, rod } => {
                let turned = UnitQuaternion::from_scaled_axis(normal * amount) * rod;
                Screw::free(normal.cross(&turned))
            }
        }
    }

    /// The finite displacement by `amount` [rad or m].
    pub(super) fn displacement(&self, amount: f64) -> Isometry3<f64> {
        match self {
            Self::Screw(screw) => screw.exponential(amount),
            Self::Parallelogram { normal, rod } => {
                let turned = UnitQuaternion::from_scaled_axis(normal * amount) * rod;
                Translation3::from(turned - rod).into()
            }
        }
    }

    fn is_valid(&self) -> bool {
        let sized = |vector: &[f64]| {
            let largest = vector.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            vector.iter().all(|x| x.is_finite()) && SIZES.contains(&largest)
        };
        let twist = self.twist().to_vector();
        let rod = match self {
            Self::Screw(_) => true,
            Self::Parallelogram { normal, rod } => {
                sized(normal.as_slice()) && sized(rod.as_slice())
            }
        };
        rod && sized(twist.as_slice())
    }
}

/// A joint between two bodies, its single freedoms in order from `from` to `to`.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// The body it starts from; 0 is the ground.
    pub from: usize,
    /// The body it carries.
    pub to: usize,
    /// Its single freedoms.
    pub freedoms: Vec<Freedom>,
    /// Whether a motor drives it.
    pub actuated: bool,
}

/// A platform on limbs, each a chain of joints from the base.
///
/// ```
/// use fivebar_design::mobility::{Freedom, Joint, ParallelMechanism, Screw, analyse_parallel};
/// use nalgebra::Vector3;
///
/// // A planar platform on three legs of three parallel hinges each.
/// let leg = |x: f64, lean: f64| {
///     let hinge = |y: f64| Joint {
///         from: 0,
///         to: 0,
///         freedoms: vec![Freedom::Screw(Screw::line(Vector3::z(), Vector3::new(x + lean * y * y, y, 0.0)))],
///         actuated: y == 0.0,
///     };
///     vec![hinge(0.0), hinge(0.3), hinge(0.5)]
/// };
/// let legs = vec![leg(-0.4, 1.0), leg(0.0, 0.0), leg(0.5, -1.0)];
/// let analysis = analyse_parallel(&ParallelMechanism::new(legs)?);
/// // Three freedoms in the plane, none when the three motors are held.
/// assert_eq!(analysis.mobility.m_eq7, 3);
/// assert_eq!(analysis.mobility.with_drives_held, Some(0));
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ParallelMechanism {
    limbs: Vec<Vec<Joint>>,
}

/// Any graph of bodies (0 is the ground) and joints.
///
/// ```
/// use fivebar_design::mobility::{Freedom, Joint, MechanismGraph, Screw, analyse_graph};
/// use nalgebra::Vector3;
///
/// // A four-bar: four parallel hinges in a closed chain of four bodies.
/// let hinges = [[0.0, 0.0], [0.1, 0.4], [0.5, 0.5], [0.6, 0.0]]; // m
/// let joints = hinges.iter().enumerate().map(|(from, &[x, y])| Joint {
///     from,
///     to: (from + 1) % 4,
///     freedoms: vec![Freedom::Screw(Screw::line(Vector3::z(), Vector3::new(x, y, 0.0)))],
///     actuated: false,
/// });
/// let analysis = analyse_graph(&MechanismGraph::new(4, 2, joints.collect())?);
/// // The spatial count gives −2; three constraints are common to all hinges.
/// assert_eq!(analysis.mobility.grubler, -2);
/// assert_eq!((analysis.mobility.m_eq7, analysis.mobility.finite), (1, 1));
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct MechanismGraph {
    bodies: usize,
    platform: usize,
    joints: Vec<Joint>,
}

/// Why a description is not a valid mechanism.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MechanismError {
    /// No limb or no joint at all.
    Empty,
    /// The limb with this number (from 1) has no joint.
    EmptyLimb(usize),
    /// The joint with this name has no freedom, or its numbers are 0, too small or too large to compute with.
    InvalidJoint(String),
    /// The joint with this name refers to a body that does not exist, or joins a body to itself.
    InvalidBodies(String),
    /// The platform is the ground or does not exist.
    InvalidPlatform,
    /// This body (0 is the ground) is not connected to the ground.
    Disconnected(usize),
    /// More single freedoms or bodies than [`MAX_FREEDOMS`].
    TooLarge,
}

impl fmt::Display for MechanismError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("there is no joint"),
            Self::EmptyLimb(number) => write!(f, "limb {number} has no joint"),
            Self::InvalidJoint(name) => write!(
                f,
                "{name}: an axis and its moment must be 1e-6 to 1e6 in size, in metres, and a joint needs a \
                 freedom: check the units"
            ),
            Self::InvalidBodies(name) => {
                write!(f, "{name}: it must join two different bodies that exist")
            }
            Self::InvalidPlatform => {
                f.write_str("the platform must be a body other than the ground")
            }
            Self::Disconnected(body) => {
                write!(f, "body {body} is not connected to the ground (body 0)")
            }
            Self::TooLarge => write!(
                f,
                "the mechanism has more than {MAX_FREEDOMS} single freedoms or bodies"
            ),
        }
    }
}

impl core::error::Error for MechanismError {}

impl ParallelMechanism {
    /// A platform on these limbs, each a list of joints from base to platform; the
    /// joints' body numbers are assigned here.
    ///
    /// # Errors
    /// The first limb or joint that is not valid.
    pub fn new(limbs: Vec<Vec<Joint>>) -> Result<Self, MechanismError> {
        if limbs.is_empty() {
            return Err(MechanismError::Empty);
        }
        if let Some(index) = limbs.iter().position(Vec::is_empty) {
            return Err(MechanismError::EmptyLimb(index + 1));
        }
        let joints = limbs.iter().flatten();
        check_size(0, joints.clone())?;
        for (l, limb) in limbs.iter().enumerate() {
            for (j, joint) in limb.iter().enumerate() {
                check_joint(joint, || format!("limb {}, joint {}", l + 1, j + 1))?;
            }
        }
        let mut next = 2;
        let limbs = limbs
            .into_iter()
            .map(|limb| {
                let last = limb.len() - 1;
                let mut from = 0;
                limb.into_iter()
                    .enumerate()
                    .map(|(index, joint)| {
                        let to = if index == last { 1 } else { next };
                        next += usize::from(index != last);
                        let numbered = Joint { from, to, ..joint };
                        from = to;
                        numbered
                    })
                    .collect()
            })
            .collect();
        Ok(Self { limbs })
    }

    /// The limbs, each a chain of joints from the base.
    pub fn limbs(&self) -> &[Vec<Joint>] {
        &self.limbs
    }

    /// The same mechanism as a graph; the platform is body 1.
    pub fn graph(&self) -> MechanismGraph {
        let joints: Vec<Joint> = self.limbs.iter().flatten().cloned().collect();
        MechanismGraph {
            bodies: 2 + joints.iter().filter(|joint| joint.to != 1).count(),
            platform: 1,
            joints,
        }
    }
}

impl MechanismGraph {
    /// A graph of `bodies` bodies, 0 being the ground.
    ///
    /// # Errors
    /// The first joint that is not valid, or the fault of the graph.
    pub fn new(bodies: usize, platform: usize, joints: Vec<Joint>) -> Result<Self, MechanismError> {
        if joints.is_empty() {
            return Err(MechanismError::Empty);
        }
        check_size(bodies, joints.iter())?;
        if platform == 0 || platform >= bodies {
            return Err(MechanismError::InvalidPlatform);
        }
        for (index, joint) in joints.iter().enumerate() {
            let name = || format!("joint {}", index + 1);
            if joint.from >= bodies || joint.to >= bodies || joint.from == joint.to {
                return Err(MechanismError::InvalidBodies(name()));
            }
            check_joint(joint, name)?;
        }
        let graph = Self {
            bodies,
            platform,
            joints,
        };
        match graph.first_disconnected() {
            Some(body) => Err(MechanismError::Disconnected(body)),
            None => Ok(graph),
        }
    }

    /// The number of bodies, with the ground.
    pub fn bodies(&self) -> usize {
        self.bodies
    }

    /// The body whose freedoms are analysed.
    pub fn platform(&self) -> usize {
        self.platform
    }

    /// The joints.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// The same graph with its actuated joints rigid, as if the motors were held.
    #[must_use]
    pub fn with_drives_held(&self) -> Self {
        let mut joints = self.joints.clone();
        for joint in &mut joints {
            if joint.actuated {
                joint.freedoms.clear();
            }
        }
        self.with_joints(joints)
    }

    /// The same bodies, joined by `joints` of the same topology.
    pub(super) fn with_joints(&self, joints: Vec<Joint>) -> Self {
        Self { joints, ..*self }
    }

    fn first_disconnected(&self) -> Option<usize> {
        let mut reached = vec![false; self.bodies];
        reached[0] = true;
        // Each pass reaches at least one more body or ends.
        loop {
            let mut grew = false;
            for joint in &self.joints {
                if reached[joint.from] != reached[joint.to] {
                    reached[joint.from] = true;
                    reached[joint.to] = true;
                    grew = true;
                }
            }
            if !grew {
                return reached.iter().position(|&is| !is);
            }
        }
    }
}

fn check_size<'a>(
    bodies: usize,
    joints: impl Iterator<Item = &'a Joint>,
) -> Result<(), MechanismError> {
    // A joint without a freedom counts too: it costs as much.
    let freedoms: usize = joints.map(|joint| joint.freedoms.len().max(1)).sum();
    if freedoms > MAX_FREEDOMS || bodies > MAX_FREEDOMS {
        return Err(MechanismError::TooLarge);
    }
    Ok(())
}

fn check_joint(joint: &Joint, name: impl Fn() -> String) -> Result<(), MechanismError> {
    if joint.freedoms.is_empty() || !joint.freedoms.iter().all(Freedom::is_valid) {
        return Err(MechanismError::InvalidJoint(name()));
    }
    Ok(())
}
