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
/// steps are divided.
const CHORD: f64 = 0.004;
/// How often a step is divided at most. Where two links nearly coincide, a small angle moves
/// the tool far.
const MAX_REFINEMENTS: u32 = 20;
/// Where a step is divided. Not in its middle: both branches can coincide there, where the dyad does not
/// close because of rounding.
const DIVISION: f64 = 0.45;
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
            let at = |t: f64| family.at(curve, t.rem_euclid(TAU));
            let parameters = refined(|t| at(t).map(|(position, _)| position), chord);
            let position = |t: f64| {
                let (position, elbows) = at(t)?;
                family.is_in(elbows, mode).then_some(position)
            };
            let pieces = connected_pieces(position, &parameters);
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

/// Parameters t of a closed curve, once around, whose positions are at most `chord` [m] apart, within
/// the limit of [`MAX_REFINEMENTS`]. All working modes are refined: where the tool moves far within a
/// small angle, it can pass through a mode between two steps.
fn refined(position: impl Fn(f64) -> Option<Vector2<f64>>, chord: f64) -> Vec<f64> {
    let step = TAU / f64::from(POINTS);
    // Half a step of offset avoids the points at which both branches coincide.
    let sample = |index: u32| {
        let t = (f64::from(index) + 0.5) * step;
        (t, position(t))
    };
    let mut parameters = Vec::new();
    for index in 0..POINTS {
        let ends = [sample(index), sample(index + 1)];
        parameters.push(ends[0].0);
        divide(&position, ends, chord, MAX_REFINEMENTS, &mut parameters);
    }
    parameters
}

/// Adds parameters between two whose positions are more than `chord` [m] apart.
fn divide(
    position: &impl Fn(f64) -> Option<Vector2<f64>>,
    [from, to]: [(f64, Option<Vector2<f64>>); 2],
    chord: f64,
    divisions: u32,
    parameters: &mut Vec<f64>,
) {
    let are_near = |(from, to): (Vector2<f64>, Vector2<f64>)| (to - from).norm() <= chord;
    if divisions == 0 || from.1.zip(to.1).is_none_or(are_near) {
        return;
    }
    let t = from.0 + DIVISION * (to.0 - from.0);
    let middle = (t, position(t));
    divide(position, [from, middle], chord, divisions - 1, parameters);
    parameters.push(t);
    divide(position, [middle, to], chord, divisions - 1, parameters);
}

/// The connected parts of a closed curve, where `position` gives a position, at these parameters.
/// Their ends are found by bisection.
fn connected_pieces(
    position: impl Fn(f64) -> Option<Vector2<f64>>,
    parameters: &[f64],
) -> Vec<Vec<Vector2<f64>>> {
    let edge = |mut inside: f64, mut outside: f64| {
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (inside + outside);
            match position(middle) {
                Some(_) => inside = middle,
                None => outside = middle,
            }
        }
        position(inside)
    };
    let start = parameters.iter().position(|&t| position(t).is_none());
    let (before, after) = parameters.split_at(start.unwrap_or(0));
    let again = before.iter().chain(after.first()).map(|t| t + TAU);
    let (mut pieces, mut piece) = (Vec::new(), Vec::new());
    let mut last = None;
    for now in after.iter().copied().chain(again) {
        if let Some(point) = position(now) {
            let outside = last.filter(|_| piece.is_empty());
            piece.extend(outside.and_then(|outside| edge(now, outside)));
            piece.push(point);
        } else if let Some(inside) = last.filter(|_| !piece.is_empty()) {
            piece.extend(edge(inside, now));
            pieces.push(core::mem::take(&mut piece));
        }
        last = Some(now);
    }
    pieces.push(piece);
    pieces.retain(|piece| piece.len() > 1);
    pieces
}
