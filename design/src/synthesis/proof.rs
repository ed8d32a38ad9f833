//! Proof by interval arithmetic that an area has no singularity: in each of the cells that cover it both
//! legs are bent and sin(θ3 − θ2) has one sign, the same in all, and the cranks are within their range; a cell where this is
//! open is halved.

use super::area::{Area, Cell, Placed};
use super::condition::ELBOWS_OUT;
use super::cranks::CrankRange;
use super::interval::Interval;

/// Cells smaller than this share of the area stay undecided.
const SMALLEST: f64 = 1e-10;
/// Cells examined at most.
const MOST_CELLS: usize = 2_000_000;

/// Whether an area is free of singularities, and within the range of the cranks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Proof {
    /// It is, at every point.
    Proved,
    /// There is one at or near this point, from the middle of the base [m]: a leg cannot reach it, or
    /// the arm is in another assembly mode there than elsewhere; or a crank is beyond its range.
    Refuted([f64; 2]),
    /// It could not be decided near this point [m].
    Undecided([f64; 2]),
}

/// What is known of a cell.
enum Verdict {
    /// Both legs are bent and the cranks within their range; whether sin(θ3 − θ2) is positive.
    Regular(bool),
    /// No point is reached, or none within the range of the cranks.
    Unreachable,
    Open,
}

/// Proves the arm, elbows out, free of singularities in an area.
pub(super) fn prove(
    lengths: [f64; 5],
    area: &Area,
    placed: Placed,
    cranks: Option<CrankRange>,
) -> Proof {
    let mut open = area.cells(placed);
    let mut sign = None;
    let mut undecided = None;
    for _ in 0..MOST_CELLS {
        let Some(cell) = open.pop() else {
            return undecided.map_or(Proof::Proved, Proof::Undecided);
        };
        let Some([x, y]) = cell.around() else {
            continue;
        };
        let middle = [x.middle(), y.middle()];
        match verdict(lengths, [x, y], cranks) {
            Verdict::Unreachable => return Proof::Refuted(middle),
            Verdict::Regular(positive) => {
                if *sign.get_or_insert(positive) != positive {
                    return Proof::Refuted(middle);
                }
            }
            Verdict::Open if x.width().max(y.width()) <= SMALLEST * placed.size => {
                undecided = Some(middle);
            }
            Verdict::Open => open.extend(cell.halves()),
        }
    }
    let next = open.last().and_then(Cell::around);
    Proof::Undecided(next.map_or(placed.place, |[x, y]| [x.middle(), y.middle()]))
}

/// v2 × v3 = (c1 c4 + σ1 σ4 h1 h4)(p1 × p4) + (σ1 h1 c4 − σ4 c1 h4)(p1 · p4), with the letters of
/// `condition`; p1 × p4 = base y, p1 · p4 = x² + y² − base²/4 from the middle of the base.
fn verdict(
    [l1, l2, l3, l4, base]: [f64; 5],
    [x, y]: [Interval; 2],
    cranks: Option<CrankRange>,
) -> Verdict {
    let half = Interval::from(0.5 * base);
    let y_squared = y.square();
    let leg1 = leg([l1, l2], x.add(half).square().add(y_squared));
    let leg4 = leg([l4, l3], x.sub(half).square().add(y_squared));
    let (Ok([c1, h1]), Ok([c4, h4])) = (&leg1, &leg4) else {
        let is_unreachable = [&leg1, &leg4].map(|leg| matches!(leg, Err(Bend::Unreachable)));
        return match is_unreachable.contains(&true) {
            true => Verdict::Unreachable,
            false => Verdict::Open,
        };
    };
    if let Some(range) = cranks {
        match range.is_kept([(x.add(half), [*c1, *h1]), (x.sub(half), [*c4, *h4])], y) {
            Some(true) => (),
            Some(false) => return Verdict::Unreachable,
            None => return Verdict::Open,
        }
    }
    let [side1, side4] = ELBOWS_OUT.map(Interval::from);
    let (h1, h4) = (h1.mul(side1), h4.mul(side4));
    let cross = Interval::from(base).mul(y);
    let dot = x.square().add(y_squared).sub(half.square());
    let sine = c1.mul(*c4).add(h1.mul(h4)).mul(cross);
    let sine = sine.add(h1.mul(*c4).sub(c1.mul(h4)).mul(dot));
    sine.sign().map_or(Verdict::Open, Verdict::Regular)
}

/// Why a leg has no c and h: it does not reach, or it may be in line.
enum Bend {
    Unreachable,
    Open,
}

/// c and h of a leg that is bent, for q = |p|².
fn leg([near, far]: [f64; 2], q: Interval) -> Result<[Interval; 2], Bend> {
    let [near, far] = [near, far].map(Interval::from);
    let (sum, difference) = (near.add(far), near.sub(far));
    let (outer, inner) = (sum.square(), difference.square());
    let gaps = [outer.sub(q), q.sub(inner)];
    if gaps.iter().any(|gap| gap.high < 0.0) {
        return Err(Bend::Unreachable);
    }
    if gaps.iter().any(|gap| gap.low <= 0.0) || q.low <= 0.0 {
        return Err(Bend::Open);
    }
    let (one, half) = (Interval::from(1.0), Interval::from(0.5));
    let along = half.mul(one.sub(sum.mul(difference).per(q)));
    let product = outer.per(q).sub(one).mul(one.sub(inner.per(q)));
    Ok([along, half.mul(product.sqrt())])
}
