//! Which of the ten unknowns measurements can show; the others are held at zero.
//!
//! An arm with a base has ten over a plate, l1…l5, δ1, δ4, x, y, φ, and without a plate the first seven.
//!
//! With both hips about one axis, l5 = 0, the tip turns with its joints: C(θ1 + α, θ4 + α) = R(α) C(θ1, θ4). On the plate
//!
//! T = R(φ) C(θ1 + δ1, θ4 + δ4) + (x, y)
//!
//! is then the same with φ = 0, δ1 + φ, δ4 + φ: a turn of the plate is a turn of both joints' zeros. The base has no length
//! and no direction, so l5 and φ are held at zero, and the plate's x axis is the arm's. Eight are left. Without a plate
//! nothing has a direction but the zero of joint 1 as drawn: δ1 is held, and l1…l4 and δ4 are left.

use super::parameters::{PARAMETER_NAMES, Parameters, Vector10};
use nalgebra::{DMatrix, DVector, SMatrix};

const L5: usize = 4;
const DELTA1: usize = 5;
const PHI: usize = 9;

/// The unknowns that are free, in the order of [`PARAMETER_NAMES`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unknowns(&'static [usize]);

impl Unknowns {
    /// Of an arm with these lengths as drawn [m] over a plate: ten, or eight where the base is exactly 0.
    pub fn of(nominal: [f64; 5]) -> Self {
        Self(match nominal[L5] {
            0.0 => &[0, 1, 2, 3, DELTA1, 6, 7, 8],
            _ => &[0, 1, 2, 3, L5, DELTA1, 6, 7, 8, PHI],
        })
    }

    /// Of the same arm without a plate: seven, or five where the base is 0.
    pub(super) fn without_plate(self) -> Self {
        Self(match self.has_base() {
            false => &[0, 1, 2, 3, 6],
            true => &[0, 1, 2, 3, L5, DELTA1, 6],
        })
    }

    /// Their indices among the ten, in rising order.
    pub fn free(self) -> &'static [usize] {
        self.0
    }

    /// Whether the unknown with this index among the ten is free.
    pub fn is_free(self, index: usize) -> bool {
        self.0.contains(&index)
    }

    /// How many there are.
    pub(super) fn count(self) -> usize {
        self.0.len()
    }

    /// Whether the base has a length, and with it a direction.
    pub(super) fn has_base(self) -> bool {
        self.is_free(L5)
    }

    /// Their names.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        self.0.iter().map(|&index| PARAMETER_NAMES[index])
    }

    /// The arm that measures the same, turned so that what is held is zero.
    pub(super) fn turned(self, p: &Parameters) -> Parameters {
        if self.has_base() {
            return *p;
        }
        let by = match self.is_free(DELTA1) {
            true => p.turn,
            false => -p.offsets[0],
        };
        Parameters {
            offsets: p.offsets.map(|offset| offset + by),
            turn: 0.0,
            ..*p
        }
    }

    /// Their values in the arm [`turned`](Self::turned).
    pub(super) fn vector(self, p: &Parameters) -> DVector<f64> {
        let all = self.turned(p).vector();
        DVector::from_iterator(self.count(), self.0.iter().map(|&index| all[index]))
    }

    /// The arm with these values of them, the first of `x`.
    pub(super) fn parameters(self, x: &DVector<f64>) -> Parameters {
        let mut all = Vector10::zeros();
        for (&index, &value) in self.0.iter().zip(x.iter()) {
            all[index] = value;
        }
        Parameters::of(&all)
    }

    /// The columns of a Jacobian by all ten, or by the first seven, that belong to them.
    pub(super) fn columns(self, jacobian: &DMatrix<f64>) -> DMatrix<f64> {
        let seen = self.0.partition_point(|&index| index < jacobian.ncols());
        jacobian.select_columns(&self.0[..seen])
    }

    /// Their covariance among the ten: rows and columns of what is held are zero.
    pub(super) fn among_ten(self, covariance: &DMatrix<f64>) -> SMatrix<f64, 10, 10> {
        let mut all = SMatrix::zeros();
        for (row, &i) in self.0.iter().enumerate() {
            for (column, &j) in self.0.iter().enumerate() {
                all[(i, j)] = covariance[(row, column)];
            }
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::{DELTA1, L5, PHI, Unknowns};
    use crate::Noise;
    use crate::calibration::{Parameters, tip};
    use fivebar_kinematics::five_bar::Side;
    use nalgebra::{DMatrix, Vector2};

    /// A random arm anywhere over a plate, and encoder angles at which it is far from a singularity.
    fn coaxial(noise: &mut Noise) -> (Parameters, [f64; 2]) {
        loop {
            let p = Parameters {
                lengths: [0.09, 0.16, 0.16, 0.09, 0.0].map(|l| l * (0.8 + 0.4 * noise.uniform())),
                offsets: [noise.normal(), noise.normal()],
                origin: [noise.normal(), noise.normal()],
                turn: 3.0 * noise.normal(),
            };
            let encoder = [6.0 * noise.uniform(), 6.0 * noise.uniform()];
            if tip(&p, encoder, Side::Left).is_some_and(|tip| tip.jacobian.amax() < 3.0) {
                return (p, encoder);
            }
        }
    }

    #[test]
    fn only_a_base_of_exactly_zero_is_held() {
        let count = |base| Unknowns::of([0.1, 0.16, 0.16, 0.1, base]).count();
        assert_eq!([0.08, 1e-9, 0.0, -0.0].map(count), [10, 10, 8, 8]);
        let names: Vec<_> = Unknowns::of([0.1, 0.16, 0.16, 0.1, 0.0]).names().collect();
        assert_eq!(names.join(" "), "l1 l2 l3 l4 δ1 δ4 x y");
    }

    #[test]
    fn without_a_base_a_turn_of_the_plate_is_one_of_both_zeros() {
        let mut noise = Noise::new(12);
        for _ in 0..100 {
            let (p, encoder) = coaxial(&mut noise);
            let turned = Unknowns::of(p.lengths).turned(&p);
            assert_eq!(
                (turned.turn, turned.lengths, turned.origin),
                (0.0, p.lengths, p.origin)
            );
            let at = |p: &Parameters| tip(p, encoder, Side::Left).unwrap();
            let (as_made, found) = (at(&p), at(&turned));
            assert!((as_made.position - found.position).norm() < 1e-14);
            let by = |index: usize| as_made.jacobian.column(index).into_owned();
            assert!((by(PHI) - by(DELTA1) - by(DELTA1 + 1)).norm() < 1e-14);
        }
    }

    #[test]
    fn the_derivatives_by_what_is_free_equal_central_differences() {
        let mut noise = Noise::new(13);
        for _ in 0..100 {
            let (p, encoder) = coaxial(&mut noise);
            let unknowns = Unknowns::of(p.lengths);
            let x = unknowns.vector(&p);
            let at = |x: &nalgebra::DVector<f64>| {
                tip(&unknowns.parameters(x), encoder, Side::Left).unwrap()
            };
            let all = DMatrix::from_column_slice(2, 10, at(&x).jacobian.as_slice());
            let jacobian = unknowns.columns(&all);
            assert_eq!(jacobian.shape(), (2, 8));
            for column in 0..unknowns.count() {
                let moved = |step: f64| {
                    let mut x = x.clone();
                    x[column] += step;
                    at(&x).position
                };
                let difference = |h: f64| (moved(h) - moved(-h)) / (2.0 * h);
                let wanted: Vector2<f64> = (difference(5e-5) * 4.0 - difference(1e-4)) / 3.0;
                let error = (jacobian.column(column) - wanted).norm();
                assert!(error < 1e-8, "{column}: {error:e}");
            }
        }
    }

    #[test]
    fn what_is_held_has_no_covariance() {
        let unknowns = Unknowns::of([0.1, 0.16, 0.16, 0.1, 0.0]);
        let all = unknowns.among_ten(&DMatrix::from_element(8, 8, 1.0));
        for i in 0..10 {
            let wanted = f64::from(i != L5 && i != PHI);
            assert_eq!((all[(i, i)], all.row(i).sum()), (wanted, 8.0 * wanted));
        }
    }
}
