//! Residuals and derivatives of all measurements of an arm, each divided by its σ.
//!
//! The unknowns are those of the arm, l1…l5, δ1, δ4 and with a plate x, y, φ, less what is held ([`Unknowns`]); then x, y of each
//! hole; then eight of each photograph. The residuals are, in the order of the measurements,
//!
//! plate: T − P, bar: |C − C′| − L, hole: C − H, photograph: C − q(pixel).

use super::photo::{self, in_plane, normalised};
use crate::calibration::measurements::{Measurements, PhotoPoint};
use crate::calibration::parameters::Parameters;
use crate::calibration::tip::{on_plate, posed};
use crate::calibration::unknowns::Unknowns;
use crate::fit::Rows;
use fivebar_kinematics::five_bar::Side;
use nalgebra::{DMatrix, DVector, SMatrix, Vector2};

/// Derivatives of C: by l1…l5, δ1, δ4.
const BARE: usize = 7;

/// The measurements, as seen in one assembly mode.
pub(super) struct Problem<'a> {
    measured: &'a Measurements,
    /// Those of the arm.
    unknowns: Unknowns,
    side: Side,
    holes: Vec<i64>,
    photos: Vec<Vec<Vector2<f64>>>,
}

/// C and its derivatives by l1…l5, δ1, δ4.
type Tip = (Vector2<f64>, SMatrix<f64, 2, BARE>);

impl<'a> Problem<'a> {
    /// `unknowns` are those of the arm over a plate.
    pub(super) fn new(measured: &'a Measurements, unknowns: Unknowns, side: Side) -> Self {
        let pixels = |photo: &Vec<PhotoPoint>| {
            normalised(&photo.iter().map(|point| point.pixel).collect::<Vec<_>>())
        };
        Self {
            measured,
            unknowns: match measured.plate.is_empty() {
                true => unknowns.without_plate(),
                false => unknowns,
            },
            side,
            holes: measured.hole_numbers(),
            photos: measured.photos.iter().map(pixels).collect(),
        }
    }

    /// The unknowns of the arm.
    pub(super) fn arm_unknowns(&self) -> Unknowns {
        self.unknowns
    }

    fn hole_at(&self, index: usize) -> usize {
        self.unknowns.count() + 2 * index
    }

    fn photo_at(&self, index: usize) -> usize {
        self.hole_at(self.holes.len()) + photo::UNKNOWNS * index
    }

    pub(super) fn unknowns(&self) -> usize {
        self.photo_at(self.photos.len())
    }

    /// The arm among the unknowns.
    pub(super) fn arm(&self, x: &DVector<f64>) -> Parameters {
        self.unknowns.parameters(x)
    }

    fn tip(&self, p: &Parameters, encoder: [f64; 2]) -> Option<Tip> {
        let bare = Parameters {
            lengths: p.lengths,
            offsets: p.offsets,
            ..Parameters::default()
        };
        let tip = on_plate(&bare, &posed(&bare, encoder, self.side)?);
        Some((tip.position, tip.jacobian.fixed_columns::<BARE>(0).into()))
    }

    /// The unknowns with this arm, and holes and photographs where they fit it best; none if the
    /// arm has too few of the poses.
    pub(super) fn start(&self, arm: &Parameters) -> Option<DVector<f64>> {
        let arm = &self.unknowns.turned(arm);
        let mut x = DVector::zeros(self.unknowns());
        x.rows_mut(0, self.unknowns.count())
            .copy_from(&self.unknowns.vector(arm));
        for (index, number) in self.holes.iter().enumerate() {
            let touches = self.measured.holes.iter().filter(|t| t.hole == *number);
            let tips = touches.filter_map(|touch| Some(self.tip(arm, touch.encoder)?.0));
            let tips: Vec<_> = tips.collect();
            let middle = tips.iter().sum::<Vector2<f64>>() / tips.len().max(1) as f64;
            x.fixed_rows_mut::<2>(self.hole_at(index))
                .copy_from(&middle);
        }
        for (index, (points, w)) in self.measured.photos.iter().zip(&self.photos).enumerate() {
            let pairs = points.iter().zip(w);
            let pairs = pairs.filter_map(|(point, w)| Some((*w, self.tip(arm, point.encoder)?.0)));
            let found = photo::start(&pairs.collect::<Vec<_>>())?;
            let at = self.photo_at(index);
            x.fixed_rows_mut::<{ photo::UNKNOWNS }>(at)
                .copy_from(&found);
        }
        Some(x)
    }

    /// Residuals over σ and their derivatives. A measurement without a pose counts as far away,
    /// and its derivatives as zero.
    pub(super) fn rows(&self, x: &DVector<f64>) -> Option<Rows> {
        let measured = self.measured;
        let sigma = measured.deviations;
        let p = self.arm(x);
        fivebar_kinematics::five_bar::Geometry::new(p.lengths).ok()?;
        let reach: f64 = p.lengths.iter().sum();
        let far = Vector2::new(reach, reach);
        let mut rows = Builder::new(measured, self.unknowns, self.unknowns());
        for touch in &measured.plate {
            let tip = posed(&p, touch.encoder, self.side).map(|pose| on_plate(&p, &pose));
            let position = tip.map_or(far, |tip| tip.position - touch.hole);
            let parts = tip.map(|tip| {
                let j = DMatrix::from_column_slice(2, 10, tip.jacobian.as_slice());
                (0, self.unknowns.columns(&j))
            });
            rows.pair(position, parts, sigma.plate);
        }
        for bar in &measured.bars {
            let [a, b] = bar.encoders.map(|encoder| self.tip(&p, encoder));
            let between = a.zip(b).map(|((a, ja), (b, jb))| (a - b, ja - jb));
            match between.filter(|(apart, _)| apart.norm() > 0.0) {
                Some((apart, j)) => {
                    let distance = apart.norm();
                    let slope = apart.transpose() / distance * j;
                    rows.single(distance - bar.length, slope.as_slice(), sigma.bar);
                }
                None => rows.single(reach, &[], sigma.bar),
            }
        }
        for touch in &measured.holes {
            let at = self.hole_at(self.holes.binary_search(&touch.hole).ok()?);
            let hole: Vector2<f64> = x.fixed_rows::<2>(at).into();
            let own = DMatrix::from_diagonal_element(2, 2, -1.0);
            rows.tip_less(
                self.tip(&p, touch.encoder),
                hole,
                (at, own),
                far,
                sigma.hole,
            );
        }
        for (index, (points, w)) in measured.photos.iter().zip(&self.photos).enumerate() {
            let at = self.photo_at(index);
            let unknowns = &x.as_slice()[at..at + photo::UNKNOWNS];
            for (point, &w) in points.iter().zip(w) {
                let tip = self.tip(&p, point.encoder);
                let (position, own) = in_plane(unknowns, w)?;
                let own = DMatrix::from_column_slice(2, photo::UNKNOWNS, (-own).as_slice());
                rows.tip_less(tip, position, (at, own), far, sigma.photo);
            }
        }
        Some((rows.residuals, rows.jacobian))
    }
}

/// Rows that are filled from the top.
struct Builder {
    /// Those of the arm.
    arm: Unknowns,
    residuals: DVector<f64>,
    jacobian: DMatrix<f64>,
    filled: usize,
}

/// Derivatives by the unknowns from a column on.
type Part = (usize, DMatrix<f64>);

impl Builder {
    fn new(measured: &Measurements, arm: Unknowns, unknowns: usize) -> Self {
        let photographed: usize = measured.photos.iter().map(Vec::len).sum();
        let pairs = measured.plate.len() + measured.holes.len() + photographed;
        let count = measured.bars.len() + 2 * pairs;
        Self {
            arm,
            residuals: DVector::zeros(count),
            jacobian: DMatrix::zeros(count, unknowns),
            filled: 0,
        }
    }

    /// `slope` are the derivatives by l1…l5, δ1, δ4.
    fn single(&mut self, residual: f64, slope: &[f64], sigma: f64) {
        self.residuals[self.filled] = residual / sigma;
        for (column, &index) in self.arm.free().iter().enumerate() {
            if let Some(slope) = slope.get(index) {
                self.jacobian[(self.filled, column)] = slope / sigma;
            }
        }
        self.filled += 1;
    }

    fn pair(&mut self, residual: Vector2<f64>, parts: impl IntoIterator<Item = Part>, sigma: f64) {
        let at = self.filled;
        self.residuals
            .fixed_rows_mut::<2>(at)
            .copy_from(&(residual / sigma));
        for (column, part) in parts {
            let size = (2, part.ncols());
            self.jacobian
                .view_mut((at, column), size)
                .copy_from(&(part / sigma));
        }
        self.filled += 2;
    }

    /// C − `position`; `own` are the derivatives of −`position`.
    fn tip_less(
        &mut self,
        tip: Option<Tip>,
        position: Vector2<f64>,
        own: Part,
        far: Vector2<f64>,
        sigma: f64,
    ) {
        match tip {
            Some((c, j)) => {
                let j = DMatrix::from_column_slice(2, BARE, j.as_slice());
                self.pair(c - position, [(0, self.arm.columns(&j)), own], sigma);
            }
            None => self.pair(far, [], sigma),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Problem;
    use crate::Noise;
    use crate::calibration::measurements::{
        Bar, Criterion, Deviations, HoleTouch, Measurements, PhotoPoint,
    };
    use crate::calibration::{Parameters, Touch, Unknowns};
    use fivebar_kinematics::five_bar::Side;
    use nalgebra::Vector2;

    /// Some measurements of each kind.
    fn of_every_kind() -> Measurements {
        let mut noise = Noise::new(3);
        let mut off = |middle: f64, size: f64| middle + size * (2.0 * noise.uniform() - 1.0);
        let mut encoder = || [off(2.4, 0.3), off(0.8, 0.3)];
        let pixels = [
            [0, 0],
            [900, 10],
            [40, 700],
            [880, 720],
            [420, 390],
            [600, 100],
        ];
        let photo = pixels.map(|pixel| PhotoPoint {
            encoder: encoder(),
            pixel: Vector2::from(pixel.map(f64::from)),
        });
        Measurements {
            plate: (0..4)
                .map(|_| Touch {
                    encoder: encoder(),
                    hole: Vector2::new(0.1, 0.2),
                })
                .collect(),
            bars: (0..3)
                .map(|_| Bar {
                    encoders: [encoder(), encoder()],
                    length: 0.1,
                })
                .collect(),
            holes: [4, 7, 4, 7]
                .map(|hole| HoleTouch {
                    hole,
                    encoder: encoder(),
                })
                .to_vec(),
            photos: vec![photo.to_vec()],
            assembly: Side::Left,
            deviations: Deviations {
                plate: 1e-3,
                bar: 2e-3,
                hole: 3e-3,
                photo: 4e-3,
            },
            criterion: Criterion::LeastSquares,
        }
    }

    #[test]
    fn the_derivatives_of_every_kind_equal_central_differences() {
        let measured = of_every_kind();
        let arm = |base: f64| Parameters {
            lengths: [0.10, 0.16, 0.17, 0.11, base],
            offsets: [0.02, -0.01],
            origin: [0.05, -0.03],
            turn: 0.4,
        };
        let with_plate = [
            (0.08, true, 10),
            (0.08, false, 7),
            (0.0, true, 8),
            (0.0, false, 5),
        ];
        for (base, with_plate, count) in with_plate {
            let measured = Measurements {
                plate: match with_plate {
                    true => measured.plate.clone(),
                    false => Vec::new(),
                },
                ..measured.clone()
            };
            let arm = arm(base);
            let problem = Problem::new(&measured, Unknowns::of(arm.lengths), Side::Left);
            assert_eq!(problem.arm_unknowns().count(), count);
            let mut x = problem.start(&arm).unwrap();
            let photo = [0.10, 0.02, -0.01, 0.12, 0.05, 0.20, 0.05, -0.04];
            x.rows_mut(problem.photo_at(0), 8).copy_from_slice(&photo);
            let (_, jacobian) = problem.rows(&x).unwrap();
            for column in 0..problem.unknowns() {
                let at = |step: f64| {
                    let mut x = x.clone();
                    x[column] += step;
                    problem.rows(&x).unwrap().0
                };
                let slope = (at(1e-6) - at(-1e-6)) / 2e-6;
                let error = (&slope - jacobian.column(column)).amax();
                assert!(error < 1e-7 * (1.0 + slope.amax()), "{column}: {error:e}");
                assert!(slope.amax() > 0.0, "{column} changes nothing");
            }
        }
    }
}
