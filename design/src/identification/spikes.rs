//! Rows that wrong samples spoil.
//!
//! A single wrong current passes the filter as a pulse of some rows. A row is left out whose residual is farther
//! than [`BOUND`] deviations from the fit, with the rows about it that the same pulse reaches. The deviation is that
//! of the middle of the residuals, which few pulses cannot spoil. If more rows than [`MOST`] were to go, it is the
//! model that is wrong, not the samples: then all stay.

use crate::fit::median;
use nalgebra::DVector;

/// Normal residuals exceed this with a probability of 6e-7, so that of sound logs with 2000 rows one in a thousand
/// loses any [deviations].
const BOUND: f64 = 5.0;
/// The median size of a normal variable of deviation 1.
const MEDIAN: f64 = 0.6745;
/// Kept rows that a pulse reaches on either side: 25 ms, one and a half periods of the filter's cut-off.
const REACH: usize = 6;
/// The greatest share of the rows that may be left out.
const MOST: f64 = 0.1;

/// Whether each row is used.
pub(super) fn without_spikes(residuals: &DVector<f64>) -> Vec<bool> {
    let rows = residuals.len();
    let all = vec![true; rows];
    let Some(middle) = median(residuals.iter().map(|r| r.abs())) else {
        return all;
    };
    let bound = BOUND / MEDIAN * middle;
    let mut used = all.clone();
    for row in (0..rows).filter(|&row| residuals[row].abs() > bound) {
        used[row.saturating_sub(REACH)..(row + REACH + 1).min(rows)].fill(false);
    }
    let left_out = used.iter().filter(|used| !**used).count();
    if left_out as f64 > MOST * rows as f64 {
        return all;
    }
    used
}

#[cfg(test)]
mod tests {
    use super::without_spikes;
    use crate::Noise;
    use nalgebra::DVector;

    #[test]
    fn rows_about_a_spike_are_left_out_and_all_stay_where_many_are_far() {
        let mut noise = Noise::new(3);
        let mut residuals = DVector::from_fn(400, |_, _| noise.normal());
        assert!(without_spikes(&residuals).iter().all(|used| *used));
        residuals[200] = 40.0;
        let used = without_spikes(&residuals);
        let left_out: Vec<usize> = (0..400).filter(|&row| !used[row]).collect();
        assert_eq!(left_out, (194..=206).collect::<Vec<_>>());
        for row in (0..400).step_by(80) {
            residuals[row] = 40.0;
        }
        assert!(without_spikes(&residuals).iter().all(|used| *used));
    }
}
