//! The plate's problem as two legs, each with a start that needs no guess.
//!
//! On the plate, leg 1 is (A, l1, l2, ψ1 = φ + δ1) and leg 4 is (E, l4, l3, ψ4 = φ + δ4); these
//! ten numbers are in one-to-one relation with the ten unknowns. Of an arm without a base A and E are one point. For a leg from G with crank la
//! and coupler lb, |P − G − la u(θ+ψ)| = lb. Squared, this is linear in seven numbers
//! (G, k, c, s, e, f), with c = la cos ψ, s = la sin ψ, k = |G|² + la² − lb²:
//!
//! |P|² = 2 P·G − k + 2c P·u(θ) + 2s P·n(θ) − 2e cos θ − 2f sin θ.

use super::measurements::Touch;
use super::parameters::{Parameters, within_a_turn};
use super::unknowns::Unknowns;
use crate::fit::{Loss, Rows, median, minimise};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::Joint;
use nalgebra::{DMatrix, DVector, Vector2};

/// One leg on the plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Leg {
    /// G, its base pivot [m].
    pivot: Vector2<f64>,
    /// la [m].
    crank: f64,
    /// lb [m].
    coupler: f64,
    /// ψ [rad].
    turn: f64,
}

/// The least number of holes for the linear start of a leg.
pub(super) const LEAST_FOR_LEGS: usize = 7;

impl Leg {
    /// From the linear equations of at least seven holes; none if they do not give a leg.
    fn linear(touches: &[Touch], joint: Joint) -> Option<Self> {
        let middle = middle(touches);
        let mut a = DMatrix::zeros(touches.len(), 7);
        let mut b = DVector::zeros(touches.len());
        for (row, touch) in touches.iter().enumerate() {
            let u = Vector2::unit(touch.encoder[joint]);
            let p = touch.hole - middle;
            let values = [
                2.0 * p.x,
                2.0 * p.y,
                -1.0,
                2.0 * p.dot(&u),
                2.0 * p.dot(&u.perpendicular()),
                -2.0 * u.x,
                -2.0 * u.y,
            ];
            a.row_mut(row).copy_from_slice(&values);
            b[row] = p.norm_squared();
        }
        // Columns of one size: they are metres, and metres times radians, and ones.
        let sizes: Vec<f64> = a.column_iter().map(|column| column.norm()).collect();
        for (mut column, &size) in a.column_iter_mut().zip(&sizes) {
            column /= size.max(1e-12);
        }
        let solution = a.svd(true, true).solve(&b, 1e-10).ok()?;
        let x: Vec<f64> = solution
            .iter()
            .zip(&sizes)
            .map(|(value, size)| value / size.max(1e-12))
            .collect();
        let g = Vector2::new(x[0], x[1]);
        let crank = x[3].hypot(x[4]);
        let squared = g.norm_squared() + crank * crank - x[2];
        let coupler = squared.max(0.25 * crank * crank).sqrt();
        let leg = Self {
            pivot: g + middle,
            crank,
            coupler,
            turn: x[4].atan2(x[3]),
        };
        [crank, coupler, leg.pivot.norm()]
            .iter()
            .all(|value| value.is_finite() && *value < 1e3)
            .then_some(leg)
    }

    /// The elbow at this encoder angle [m].
    pub(super) fn elbow(&self, encoder: f64) -> Vector2<f64> {
        self.pivot + Vector2::unit(encoder + self.turn) * self.crank
    }

    /// ρ = |P − G − la u(θ+ψ)| − lb [m].
    fn residual(&self, touch: &Touch, joint: Joint) -> f64 {
        (touch.hole - self.elbow(touch.encoder[joint])).norm() - self.coupler
    }

    /// The leg with the least loss of ρ near this one.
    fn refined(&self, touches: &[Touch], joint: Joint, loss: Loss) -> (Self, f64) {
        let rows = |x: &DVector<f64>| -> Option<Rows> {
            let leg = Self::of(x);
            let mut residuals = DVector::zeros(touches.len());
            let mut jacobian = DMatrix::zeros(touches.len(), 5);
            for (row, touch) in touches.iter().enumerate() {
                let u = Vector2::unit(touch.encoder[joint] + leg.turn);
                let across = touch.hole - leg.pivot - u * leg.crank;
                let w = across / across.norm().max(1e-12);
                residuals[row] = across.norm() - leg.coupler;
                let turned = -leg.crank * w.dot(&u.perpendicular());
                jacobian
                    .row_mut(row)
                    .copy_from_slice(&[-w.x, -w.y, -w.dot(&u), -1.0, turned]);
            }
            Some((residuals, jacobian))
        };
        let start = DVector::from_column_slice(&[
            self.pivot.x,
            self.pivot.y,
            self.crank,
            self.coupler,
            self.turn,
        ]);
        match minimise(&start, &rows, loss) {
            Some((x, cost)) => (Self::of(&x), cost),
            None => (*self, f64::INFINITY),
        }
    }

    fn of(x: &DVector<f64>) -> Self {
        Self {
            pivot: Vector2::new(x[0], x[1]),
            crank: x[2],
            coupler: x[3],
            turn: x[4],
        }
    }
}

/// The middle of the holes [m].
pub(super) fn middle(touches: &[Touch]) -> Vector2<f64> {
    let sum: Vector2<f64> = touches.iter().map(|touch| touch.hole).sum();
    sum / (touches.len().max(1) as f64)
}

/// The leg of a joint that fits the holes. The linear start is made of
/// all holes and of samples of them, so that a few wrong holes do not spoil it.
pub(super) fn leg(
    touches: &[Touch],
    samples: &[Vec<Touch>],
    joint: Joint,
    loss: Loss,
) -> Option<Leg> {
    let typical = |leg: &Leg| {
        let sizes = touches.iter().map(|touch| leg.residual(touch, joint).abs());
        median(sizes).unwrap_or(f64::INFINITY)
    };
    let sampled = samples
        .iter()
        .filter_map(|sample| Leg::linear(sample, joint))
        .min_by(|a, b| typical(a).total_cmp(&typical(b)));
    [Leg::linear(touches, joint), sampled]
        .into_iter()
        .flatten()
        .map(|start| start.refined(touches, joint, loss))
        .min_by(|(_, a), (_, b)| a.total_cmp(b))
        .map(|(leg, _)| leg)
}

/// The unknowns of the arm with these legs.
pub(super) fn joined(leg1: &Leg, leg4: &Leg, unknowns: Unknowns) -> Parameters {
    let (pivot, base) = match unknowns.has_base() {
        true => (leg1.pivot, leg4.pivot - leg1.pivot),
        false => (0.5 * (leg1.pivot + leg4.pivot), Vector2::zeros()),
    };
    let turn = base.polar_angle();
    // A crank of negative length points in the opposite direction.
    let crank = |leg: &Leg| {
        let reversed = if leg.crank < 0.0 {
            core::f64::consts::PI
        } else {
            0.0
        };
        (leg.crank.abs(), within_a_turn(leg.turn + reversed - turn))
    };
    let ((l1, offset1), (l4, offset4)) = (crank(leg1), crank(leg4));
    Parameters {
        lengths: [l1, leg1.coupler, leg4.coupler, l4, base.norm()],
        offsets: [offset1, offset4],
        origin: pivot.into(),
        turn,
    }
}
