//! Random arms over plates.

use fivebar_design::Noise;
use fivebar_design::calibration::{Criterion, Parameters, Plate, Touch};
use fivebar_kinematics::five_bar::{Geometry, Side, Tool, WorkingMode, Workspace};
use nalgebra::{Rotation2, Vector2};
use std::f64::consts::TAU;

/// A random arm as it was made and as it was drawn, and what was measured.
pub(crate) struct Made {
    pub(crate) truth: Parameters,
    pub(crate) drawn: [f64; 5],
    pub(crate) plate: Plate,
}

/// An arm of random shape in a random working mode, with lengths 0.3 mm, zeros 20 mrad off and
/// the plate anywhere, touched in holes of this deviation [m]; counts are wrapped by whole turns.
pub(crate) fn made(noise: &mut Noise, holes: usize, sigma: f64) -> Made {
    made_with(0.08, noise, holes, sigma)
}

/// As [`made`], of an arm with a base of about this length [m]. A base of 0 is exactly 0, and the truth is then said with
/// the plate's x axis as the arm's.
pub(crate) fn made_with(base: f64, noise: &mut Noise, holes: usize, sigma: f64) -> Made {
    const COUNTS: f64 = 131_072.0;
    loop {
        let mut about = |length: f64| length * (0.85 + 0.3 * noise.uniform());
        let drawn = [0.10, 0.16, 0.16, 0.10, base].map(&mut about);
        let mut off = |size: f64| size * (2.0 * noise.uniform() - 1.0);
        let mut truth = Parameters {
            lengths: drawn.map(|length| match length {
                0.0 => 0.0,
                length => length + off(0.3e-3),
            }),
            offsets: [off(20e-3), off(20e-3)],
            origin: [off(0.3), off(0.3)],
            turn: off(3.0),
        };
        let mode = WorkingMode::ALL[(4.0 * noise.uniform()) as usize];
        // With coaxial hips and both knees on one side, leg over leg, the reach hardly changes and tells little.
        if base == 0.0 && mode.elbow1 == mode.elbow4 {
            continue;
        }
        let geometry = Geometry::new(truth.lengths).unwrap();
        let tool = Tool::new(geometry, Vector2::zeros()).unwrap();
        let workspace = Workspace {
            tool,
            mode,
            limits: None,
            margin: 0.3,
        };
        let assembly = Side::BOTH[(2.0 * noise.uniform()) as usize];
        let mut touches = Vec::new();
        for _ in 0..4000 {
            let c = Vector2::new(0.6 * noise.uniform() - 0.26, 0.56 * noise.uniform() - 0.28);
            let Ok(pose) = geometry.inverse(c, mode) else {
                continue;
            };
            if workspace.check(c).is_err() || pose.assembly() != assembly || touches.len() == holes
            {
                continue;
            }
            let [theta1, _, _, theta4] = pose.angles();
            let mut encoder = |theta: f64, offset: f64| {
                let count = ((theta - offset) * COUNTS / TAU).floor();
                let turns = (7.0 * noise.uniform()).floor() - 3.0;
                (count + turns * COUNTS + 0.5) * TAU / COUNTS
            };
            let encoder = [
                encoder(theta1, truth.offsets[0]),
                encoder(theta4, truth.offsets[1]),
            ];
            let error = Vector2::new(noise.normal(), noise.normal()) * sigma;
            let hole = Rotation2::new(truth.turn) * c + Vector2::from(truth.origin) + error;
            touches.push(Touch { encoder, hole });
        }
        if touches.len() == holes {
            if base == 0.0 {
                truth.offsets = truth.offsets.map(|offset| offset + truth.turn);
                truth.turn = 0.0;
            }
            let plate = Plate {
                touches,
                assembly,
                sigma,
                criterion: Criterion::Huber,
            };
            return Made {
                truth,
                drawn,
                plate,
            };
        }
    }
}
