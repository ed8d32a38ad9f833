//! The curves on which the tool lies where the arm is singular.
//!
//! A singular arm moves as a four-bar, because two links in line act as one, and the tool
//! is on a coupler curve. With the sign s = +1 for straight and −1 for folded:
//!
//! | singularity | in line | turns | dyad that closes |
//! |---|---|---|---|
//! | type 1, leg 1 | A–B–T, BT = s \|BT\| u1 | u1 | leg 4 to C |
//! | type 1, leg 4 | E–D–C, C = E + (l4 + s l3) u4 | u4 | leg 1 to C |
//! | type 2 | B–C–D, D = B + (l2 + s l3) u2 | u2 | link 1 from A, link 4 from E |
//!
//! In each case the line that turns ends on a circle of radius ρ about one pivot. With χ the
//! angle of that end from the line of the pivots and p the vector from it to the other pivot,
//! the dyad of the two other links, `near` and `far`, closes where
//!
//! |p|² = l5² + ρ² − 2 l5 ρ cos χ, |near − far| ≤ |p| ≤ near + far.
//!
//! That is an interval of χ and its mirror image. In the interval the dyad has two branches,
//! which coincide at the ends. χ = middle − half cos t, with one branch for t < π and the
//! other for t ≥ π, runs once along a closed, smooth curve. If l2 = l3, the folded arm has
//! B = D, and its curves are circles about the common position of the elbows.

use super::reach::angle_at_distance;
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::{Dyad, Side, Singularity, Tool, WorkingMode};
use nalgebra::Vector2;
use std::f64::consts::{PI, TAU};

/// The number of points on each closed curve before refinement.
const POINTS: u32 = 360;
/// The greatest distance between neighbouring points, as a share of the arm's reach; larger
/// steps are halved.
const CHORD: f64 = 0.004;
/// How often a step is halved at most. Where two links nearly coincide, a small angle moves
/// the tool far.
const MAX_REFINEMENTS: u32 = 12;
/// Bisections to find where a curve leaves its working mode, to 1e-12 of a turn.
const BISECTIONS: u32 = 32;

/// A curve of positions whose poses in a working mode are singular.
#[derive(Clone, Debug, PartialEq)]
pub struct SingularityCurve {
    /// Which singularity it is.
    pub singularity: Singularity,
    /// Positions of the tool along it [m]. A closed curve ends with its first position.
    pub points: Vec<Vector2<f64>>,
}

/// The singularity curves of a working mode. Curves of type 1 bound its reach, curves of
/// type 2 separate its assembly modes.
pub fn singularity_curves(tool: &Tool<f64>, mode: WorkingMode) -> Vec<SingularityCurve> {
    let singularities = [Singularity::Leg1, Singularity::Leg4, Singularity::Parallel];
    let families = singularities.into_iter().flat_map(|singularity| {
        [1.0, -1.0].map(|sign| SingularFamily::new(tool, singularity, sign))
    });
    let [_, far4] = tool.geometry().leg4_radii();
    let chord = CHORD * (tool.geometry().l1() + tool.reach()).min(far4);
    let mut curves = Vec::new();
    for family in families {
        for curve in family.curves() {
            let position = |t: f64| {
                let (position, elbows) = family.at(curve, t.rem_euclid(TAU))?;
                family.is_in(elbows, mode).then_some(position)
            };
            let pieces = connected_pieces(position, chord);
            curves.extend(pieces.into_iter().map(|points| SingularityCurve {
                singularity: family.singularity,
                points,
            }));
        }
    }
    curves
}

/// A position of the tool [m] with the sides of both elbows. The side of a singular leg is
/// arbitrary.
type ToolAndElbows = (Vector2<f64>, [Side; 2]);

/// All poses in which two given links are in line, straight or folded.
struct SingularFamily<'a> {
    tool: &'a Tool<f64>,
    singularity: Singularity,
    /// +1 straight, −1 folded.
    sign: f64,
    /// ρ [m].
    radius: f64,
    /// χ less the angle of the links in line [rad].
    lead: f64,
    /// The lengths of the dyad that closes [m]: of its link at the other pivot, and of its
    /// second link.
    near: f64,
    far: f64,
}

/// A closed curve: χ = t on one branch of the dyad, or χ = middle − half cos t, which passes
/// through both branches.
#[derive(Clone, Copy)]
enum Curve {
    Around(Side),
    Between { middle: f64, half: f64 },
}

impl<'a> SingularFamily<'a> {
    fn new(tool: &'a Tool<f64>, singularity: Singularity, sign: f64) -> Self {
        let geometry = tool.geometry();
        let [l1, l2, l3, l4, _] = geometry.lengths();
        let turned = |length: f64| if length < 0.0 { PI } else { 0.0 };
        let (radius, lead, near, far) = match singularity {
            Singularity::Leg1 => {
                let c = in_line(tool, sign, Vector2::new(1.0, 0.0));
                (c.norm(), c.polar_angle(), l4, l3)
            }
            Singularity::Leg4 => {
                let length = l4 + sign * l3;
                (length.abs(), PI + turned(length), l1, l2)
            }
            Singularity::Parallel => {
                let length = l2 + sign * l3;
                (length.abs(), turned(length), l1, l4)
            }
        };
        Self {
            tool,
            singularity,
            sign,
            radius,
            lead,
            near,
            far,
        }
    }

    /// The closed curves of the family.
    fn curves(&self) -> Vec<Curve> {
        let base = self.tool.geometry().base();
        let [low, high] = [(self.near - self.far).abs(), self.near + self.far]
            .map(|distance| angle_at_distance(self.radius, base, distance));
        let between = |from: f64, to: f64| Curve::Between {
            middle: 0.5 * (from + to),
            half: 0.5 * (to - from),
        };
        if low >= high {
            vec![]
        } else if low == 0.0 && high == PI {
            Side::BOTH.map(Curve::Around).into()
        } else if low == 0.0 {
            vec![between(-high, high)]
        } else if high == PI {
            vec![between(low, TAU - low)]
        } else {
            vec![between(low, high), between(-high, -low)]
        }
    }

    /// The tool and the elbows' sides at t ∈ 0…2π of a curve; none where the dyad does not
    /// close because of rounding.
    fn at(&self, curve: Curve, t: f64) -> Option<ToolAndElbows> {
        let (chi, side) = match curve {
            Curve::Around(side) => (t, side),
            Curve::Between { middle, half } => {
                let side = if t < PI { Side::Left } else { Side::Right };
                (middle - half * t.cos(), side)
            }
        };
        let tool = self.tool;
        let geometry = tool.geometry();
        let [l1, l2, l3, l4, _] = geometry.lengths();
        let e = geometry.e();
        let u = Vector2::unit(chi - self.lead);
        let dyad = Dyad::new(self.near, self.far);
        let close = |p| dyad.joint(p, side).ok();
        let (b, u2, d) = match self.singularity {
            Singularity::Leg1 => {
                let c = in_line(tool, self.sign, u);
                let b = u * l1;
                (b, (c - b) * (1.0 / l2), e + close(c - e)?)
            }
            Singularity::Leg4 => {
                let c = e + u * (l4 + self.sign * l3);
                let b = close(c)?;
                (b, (c - b) * (1.0 / l2), e + u * l4)
            }
            Singularity::Parallel => {
                let bd = u * (l2 + self.sign * l3);
                let b = close(e - bd)?;
                (b, u, b + bd)
            }
        };
        let c = b + u2 * l2;
        let t = c + tool.offset().to_base_frame(u2);
        let elbows = [b.cross_z(t - b), (d - e).cross_z(c - d)].map(Side::of);
        Some((t, elbows))
    }

    /// Whether an arm with these elbows is in the working mode. The side of a singular leg
    /// does not count.
    fn is_in(&self, [elbow1, elbow4]: [Side; 2], mode: WorkingMode) -> bool {
        let (is1, is4) = (elbow1 == mode.elbow1, elbow4 == mode.elbow4);
        match self.singularity {
            Singularity::Leg1 => is4,
            Singularity::Leg4 => is1,
            Singularity::Parallel => is1 && is4,
        }
    }
}

/// The position of C if link 1 has the direction `u1` and A, B and the tool are in line.
fn in_line(tool: &Tool<f64>, sign: f64, u1: Vector2<f64>) -> Vector2<f64> {
    let bt = u1 * (sign * tool.reach());
    let along = Vector2::new(tool.geometry().l2(), 0.0) + tool.offset();
    // Link 2's direction is that of B→T turned back by the angle from link 2 to B→T.
    let back = Vector2::new(along.x, -along.y) * (1.0 / along.norm_squared());
    u1 * tool.geometry().l1() + back.to_base_frame(bt) * tool.geometry().l2()
}

/// The connected parts of a closed curve, t ∈ 0…2π, on which `position` gives a position. Their ends
/// are found by bisection. Neighbouring points are at most `chord` [m] apart, within the limit
/// of [`MAX_REFINEMENTS`].
fn connected_pieces(
    position: impl Fn(f64) -> Option<Vector2<f64>>,
    chord: f64,
) -> Vec<Vec<Vector2<f64>>> {
    let step = TAU / f64::from(POINTS);
    // Half a step of offset avoids the points at which both branches coincide.
    let t = |index: u32| (f64::from(index) + 0.5) * step;
    let start = (0..POINTS).find(|&index| position(t(index)).is_none());
    let closed = start.is_none();
    let start = start.unwrap_or(0);
    let edge = |mut inside: f64, mut outside: f64| {
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (inside + outside);
            match position(middle) {
                Some(_) => inside = middle,
                None => outside = middle,
            }
        }
        inside
    };
    let (mut pieces, mut piece) = (Vec::new(), Vec::new());
    let extend = |piece: &mut Vec<(f64, Vector2<f64>)>, t: f64| {
        let Some(point) = position(t) else { return };
        if let Some(&last) = piece.last() {
            between(&position, last, (t, point), chord, MAX_REFINEMENTS, piece);
        }
        piece.push((t, point));
    };
    for index in start..=start + POINTS {
        let now = t(index);
        if position(now).is_some() {
            if piece.is_empty() && !closed {
                extend(&mut piece, edge(now, now - step));
            }
            extend(&mut piece, now);
        } else if !piece.is_empty() {
            extend(&mut piece, edge(now - step, now));
            pieces.push(core::mem::take(&mut piece));
        }
    }
    pieces.push(piece);
    pieces.retain(|piece| piece.len() > 1);
    let points =
        |piece: Vec<(f64, Vector2<f64>)>| piece.into_iter().map(|(_, point)| point).collect();
    pieces.into_iter().map(points).collect()
}

/// Adds positions between two that are more than `chord` [m] apart.
fn between(
    position: &impl Fn(f64) -> Option<Vector2<f64>>,
    from: (f64, Vector2<f64>),
    to: (f64, Vector2<f64>),
    chord: f64,
    halvings: u32,
    piece: &mut Vec<(f64, Vector2<f64>)>,
) {
    if halvings == 0 || (to.1 - from.1).norm() <= chord {
        return;
    }
    let t = 0.5 * (from.0 + to.0);
    if let Some(point) = position(t) {
        let middle = (t, point);
        between(position, from, middle, chord, halvings - 1, piece);
        piece.push(middle);
        between(position, middle, to, chord, halvings - 1, piece);
    }
}
