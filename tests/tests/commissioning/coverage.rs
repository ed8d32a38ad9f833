//! Whether intervals hold what they state: 95 % of them the true value, in clean sets and in bad ones.

mod data;
mod identified;
mod plates;
mod tables;

use fivebar_design::Noise;
use nalgebra::{DMatrix, DVector, Vector2};

/// What is wrong with what was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Case {
    /// Normal errors of the stated deviation.
    Clean,
    /// As `Clean`, but three points are 0.5 mm off.
    Wrong,
    /// Errors with Student's distribution of three degrees of freedom, of the stated scale.
    HeavyTails,
    /// Normal errors of three times the stated deviation.
    Worse,
    /// Normal errors of half the stated deviation.
    Better,
}

impl Case {
    pub(crate) const ALL: [Self; 5] = [
        Self::Clean,
        Self::Wrong,
        Self::HeavyTails,
        Self::Worse,
        Self::Better,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Clean => "clean",
            Self::Wrong => "three wrong",
            Self::HeavyTails => "heavy tails",
            Self::Worse => "σ × 3",
            Self::Better => "σ ÷ 2",
        }
    }

    /// An error in units of the stated deviation.
    pub(crate) fn error(self, noise: &mut Noise) -> f64 {
        match self {
            Self::Clean | Self::Wrong => noise.normal(),
            Self::Worse => 3.0 * noise.normal(),
            Self::Better => 0.5 * noise.normal(),
            Self::HeavyTails => {
                let normal = noise.normal();
                let square: f64 = (0..3).map(|_| noise.normal().powi(2)).sum();
                normal / (square / 3.0).sqrt()
            }
        }
    }

    pub(crate) fn pair(self, noise: &mut Noise) -> Vector2<f64> {
        Vector2::new(self.error(noise), self.error(noise))
    }
}

/// Counts of intervals, and squares of errors.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    /// Repetitions that were accepted, and refused.
    accepted: u32,
    refused: u32,
    intervals: u32,
    /// Intervals that hold the true value.
    hold: u32,
    /// Sum of ((found − true)/deviation)².
    squares: f64,
    /// As `intervals`, `hold` and `squares`, but of combinations of the values that are independent of one another.
    directions: u32,
    directions_hold: u32,
    direction_squares: f64,
    /// Good points that were left out, and wrong ones that were not.
    good_left_out: u32,
    wrong_kept: u32,
    /// Sums of squares of the tip's error, as stated and as it is [m²].
    stated: f64,
    real: f64,
}

impl Tally {
    pub(crate) fn interval(&mut self, error: f64, sd: f64, factor: f64) {
        self.intervals += 1;
        self.hold += u32::from(error.abs() <= factor * sd);
        self.squares += (error / sd).powi(2);
    }

    /// The errors of one repetition with their covariance, along directions in which they are independent.
    pub(crate) fn independent(
        &mut self,
        errors: &[f64],
        covariance: impl Fn(usize, usize) -> f64,
        factor: f64,
    ) {
        let sd = |index| covariance(index, index).sqrt();
        let correlation = DMatrix::from_fn(errors.len(), errors.len(), |row, column| {
            covariance(row, column) / (sd(row) * sd(column))
        });
        let errors = DVector::from_fn(errors.len(), |index, _| errors[index] / sd(index));
        let root = correlation.cholesky().expect("a covariance").unpack();
        let directions = root.solve_lower_triangular(&errors).expect("a covariance");
        self.directions += directions.len() as u32;
        self.directions_hold += directions.iter().filter(|e| e.abs() <= factor).count() as u32;
        self.direction_squares += directions.norm_squared();
    }

    fn share(&self) -> f64 {
        f64::from(self.hold) / f64::from(self.intervals)
    }

    /// Rms of the errors in units of their deviations.
    fn rms(&self) -> f64 {
        (self.squares / f64::from(self.intervals)).sqrt()
    }

    /// The real error of the tip over the stated one.
    fn tip(&self) -> f64 {
        (self.real / self.stated).sqrt()
    }

    /// The intervals of one repetition are correlated: as if this many were independent, the share that
    /// holds lies within three deviations of the binomial distribution about 95 %, and 1 % for what is approximate.
    #[track_caller]
    fn assert_covers(&self, what: &str, case: Case, independent: f64) {
        let sd = (0.95 * 0.05 / (f64::from(self.accepted) * independent)).sqrt();
        let off = self.share() - 0.95;
        assert!(off.abs() <= 3.0 * sd + 0.01, "{what} {case:?}: {self:?}");
    }

    /// The independent directions hold 95 %, and their errors are of one deviation in the mean, each within three deviations
    /// of so many draws. 1 % and 3 % more are for what is approximate: Student's distribution of 38 degrees of freedom
    /// is wider than the normal one by 2.7 %.
    #[track_caller]
    fn assert_independent_covers(&self, what: &str, case: Case) {
        let draws = f64::from(self.directions);
        let (share, rms) = (
            f64::from(self.directions_hold) / draws,
            (self.direction_squares / draws).sqrt(),
        );
        println!("{what} {case:?}: {share:.3} hold, {rms:.3} deviations");
        let most = 3.0 * (0.95 * 0.05 / draws).sqrt() + 0.01;
        assert!((share - 0.95).abs() <= most, "{what} {case:?}: {self:?}");
        let most = 3.0 / (2.0 * draws).sqrt() + 0.03;
        assert!((rms - 1.0).abs() <= most, "{what} {case:?}: {self:?}");
    }
}

#[test]
fn intervals_of_which_85_percent_hold_are_found() {
    let repetitions = 24;
    let mut noise = Noise::new(50);
    // 1.96 deviations that hold 85 % are 1.44 of the real ones.
    let too_narrow = 1.44 / 1.96;
    let mut tally = Tally::default();
    for _ in 0..repetitions {
        let errors: Vec<f64> = (0..10).map(|_| noise.normal()).collect();
        let covariance = |row: usize, column: usize| {
            f64::from(u8::from(row == column)) * too_narrow * too_narrow
        };
        tally.independent(&errors, covariance, 1.96);
    }
    let judged =
        std::panic::catch_unwind(|| tally.assert_independent_covers("narrow", Case::Clean));
    assert!(judged.is_err(), "{tally:?}");
}
