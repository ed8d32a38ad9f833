//! How far the tip was from its place over a run.

use super::Sample;
use fivebar_design::calibration::rigid;
use nalgebra::Point2;
use serde::Serialize;

/// The tip error over all ticks of the job.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct TipError {
    /// Root mean square [m].
    pub rms_m: f64,
    /// Greatest value [m].
    pub max_m: f64,
}

impl TipError {
    /// Of these samples, after the shift and turn that make it least.
    pub(super) fn placed(samples: &[Sample]) -> Self {
        let pair = |sample: &Sample| (sample.reference.into(), sample.tool.into());
        let pairs: Vec<_> = samples.iter().map(pair).collect();
        let Some(placement) = rigid(&pairs) else {
            return Self::default();
        };
        let errors = pairs.iter().map(|&(reference, tool)| {
            let placed = placement * Point2::from(tool);
            (placed.coords - reference).norm()
        });
        let (squares, greatest) = errors.fold((0.0, 0.0_f64), |(squares, greatest), error| {
            (squares + error * error, greatest.max(error))
        });
        Self {
            rms_m: (squares / pairs.len() as f64).sqrt(),
            max_m: greatest,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Sample, TipError};

    #[test]
    fn a_shift_and_a_turn_are_no_error_of_a_placed_drawing() {
        let sample = |at: f64, off: f64| {
            let [x, y] = [0.05 * at.cos(), 0.2 + 0.03 * at.sin()];
            let (sin, cos) = 0.01_f64.sin_cos();
            Sample {
                reference: [x, y],
                tool: [cos * x - sin * y + 1e-3, sin * x + cos * y - 2e-3 + off],
                ..Sample::default()
            }
        };
        let placed = |off: f64| {
            let samples: Vec<Sample> = (0..200_u8)
                .map(|i| sample(f64::from(i) * 0.1, if i % 2 == 0 { off } else { -off }))
                .collect();
            assert!(samples.iter().all(|sample| sample.tip_error() > 1e-4));
            TipError::placed(&samples)
        };
        assert!(placed(0.0).max_m < 1e-12);
        let TipError { rms_m, max_m } = placed(1e-5);
        assert!((rms_m - 1e-5).abs() < 1e-7 && (1e-5..1.1e-5).contains(&max_m));
    }
}
