//! An arm that is measured by distances, holes and photographs.

use crate::calibration::DRAWN;
use crate::coverage::Case;
use fivebar_design::Noise;
use fivebar_design::calibration::{
    Bar, Criterion, Deviations, HoleTouch, Measurements, Parameters, PhotoPoint, Touch,
};
use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
use nalgebra::Vector2;

pub(crate) const DEVIATIONS: Deviations = Deviations {
    plate: 20e-6,
    bar: 20e-6,
    hole: 10e-6,
    photo: 50e-6,
};

/// An arm as made, and a noise.
pub(crate) struct Arm {
    pub(crate) truth: Parameters,
    noise: Noise,
    /// Share of the deviations that the measurements have.
    share: f64,
    /// What their errors are.
    pub(crate) case: Case,
}

/// The benchtop arm with lengths 0.3 mm and zeros 20 mrad off.
pub(crate) fn arm(seed: u64, share: f64) -> Arm {
    arm_drawn(DRAWN, seed, share)
}

/// As [`arm`], of an arm with these lengths [m]; a base of 0 is exactly 0.
pub(crate) fn arm_drawn(drawn: [f64; 5], seed: u64, share: f64) -> Arm {
    let mut noise = Noise::new(seed);
    let mut off = |size: f64| size * (2.0 * noise.uniform() - 1.0);
    let truth = Parameters {
        lengths: drawn.map(|length| match length {
            0.0 => 0.0,
            length => length + off(0.3e-3),
        }),
        offsets: [off(20e-3), off(20e-3)],
        ..Parameters::default()
    };
    Arm {
        truth,
        noise,
        share,
        case: Case::Clean,
    }
}

impl Arm {
    fn encoder(&self, c: Vector2<f64>, mode: WorkingMode) -> Option<[f64; 2]> {
        let pose = Geometry::new(self.truth.lengths)
            .ok()?
            .inverse(c, mode)
            .ok()?;
        let clear = pose.assembly() == Side::Left
            && [pose.sin32(), pose.sin21(), pose.sin34()]
                .iter()
                .all(|sin| sin.abs() >= 0.3);
        let [theta1, _, _, theta4] = pose.angles();
        let [d1, d4] = self.truth.offsets;
        clear.then_some([theta1 - d1, theta4 - d4])
    }

    fn place(&mut self) -> Vector2<f64> {
        Vector2::new(
            0.4 * self.noise.uniform() - 0.16,
            0.24 * self.noise.uniform() + 0.05,
        )
    }

    fn near(&mut self, sigma: f64) -> Vector2<f64> {
        self.case.pair(&mut self.noise) * sigma * self.share
    }

    /// Distances of 100 mm.
    pub(crate) fn bars(&mut self, count: usize) -> Vec<Bar> {
        let mode = WorkingMode::new(Side::Right, Side::Left);
        let mut bars = Vec::new();
        while bars.len() < count {
            let (a, turn) = (self.place(), 7.0 * self.noise.uniform());
            let b = a + 0.1 * Vector2::new(turn.cos(), turn.sin());
            if let (Some(a), Some(b)) = (self.encoder(a, mode), self.encoder(b, mode)) {
                let error = self.near(DEVIATIONS.bar).x;
                bars.push(Bar {
                    encoders: [a, b],
                    length: 0.1 + error,
                });
            }
        }
        bars
    }

    /// Holes that are reached in two working modes or more.
    pub(crate) fn holes(&mut self, count: i64) -> Vec<HoleTouch> {
        let mut touches = Vec::new();
        let mut hole = 0;
        while hole < count {
            let c = self.place();
            let found: Vec<_> = WorkingMode::ALL
                .into_iter()
                .filter_map(|mode| {
                    let error = self.near(DEVIATIONS.hole);
                    self.encoder(c + error, mode)
                })
                .collect();
            if found.len() > 1 {
                hole += 1;
                touches.extend(found.into_iter().map(|encoder| HoleTouch { hole, encoder }));
            }
        }
        touches
    }

    /// Holes of a plate in the arm's own frame.
    pub(crate) fn plate(&mut self, count: usize) -> Vec<Touch> {
        let mode = WorkingMode::new(Side::Right, Side::Left);
        let mut touches = Vec::new();
        while touches.len() < count {
            let c = self.place();
            if let Some(encoder) = self.encoder(c, mode) {
                let hole = c + self.near(DEVIATIONS.plate);
                touches.push(Touch { encoder, hole });
            }
        }
        touches
    }

    /// A photograph from the side, the vertical axis downwards.
    pub(crate) fn photo(&mut self, count: usize) -> Vec<PhotoPoint> {
        let mode = WorkingMode::new(Side::Right, Side::Left);
        let mut points = Vec::new();
        while points.len() < count {
            let c = self.place();
            if let Some(encoder) = self.encoder(c, mode) {
                let c = c + self.near(DEVIATIONS.photo);
                let depth = 1.0 + 0.3 * c.x - 0.8 * c.y;
                let pixel = Vector2::new(900.0 + 4000.0 * c.x + 300.0 * c.y, 1500.0 - 3500.0 * c.y);
                points.push(PhotoPoint {
                    encoder,
                    pixel: pixel / depth,
                });
            }
        }
        points
    }
}

pub(crate) fn nothing() -> Measurements {
    Measurements {
        plate: Vec::new(),
        bars: Vec::new(),
        holes: Vec::new(),
        photos: Vec::new(),
        assembly: Side::Left,
        deviations: DEVIATIONS,
        criterion: Criterion::Huber,
    }
}
