//! Distances, unknown holes and photographs of one arm.

use super::{Case, Tally};
use crate::calibration::DRAWN;
use crate::measured_arm::{Arm, DEVIATIONS, arm, nothing};
use crate::mixed::tip_errors;
use fivebar_design::calibration::{Measurements, calibrate_mixed};

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Tables {
    Bars,
    HolesAndBars,
    PhotoAndBars,
}

impl Tables {
    pub(super) const ALL: [Self; 3] = [Self::Bars, Self::HolesAndBars, Self::PhotoAndBars];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Bars => "24 distances",
            Self::HolesAndBars => "12 unknown holes and 24 distances",
            Self::PhotoAndBars => "photograph of 40 points and 24 distances",
        }
    }

    fn measured(self, arm: &mut Arm) -> Measurements {
        let bars = arm.bars(24);
        match self {
            Self::Bars => Measurements { bars, ..nothing() },
            Self::HolesAndBars => Measurements {
                holes: arm.holes(12),
                bars,
                ..nothing()
            },
            Self::PhotoAndBars => Measurements {
                photos: vec![arm.photo(40)],
                bars,
                ..nothing()
            },
        }
    }
}

pub(super) fn tally(tables: Tables, case: Case, repetitions: u32) -> Tally {
    let mut tally = Tally::default();
    for seed in 0..repetitions {
        let mut arm = arm(100 + u64::from(seed), 1.0);
        arm.case = case;
        let mut measured = tables.measured(&mut arm);
        let wrong: &[usize] = if case == Case::Wrong {
            &[3, 11, 19]
        } else {
            &[]
        };
        for &row in wrong {
            measured.bars[row].length += 25.0 * DEVIATIONS.bar;
        }
        let Ok(found) = calibrate_mixed(&measured, DRAWN) else {
            tally.refused += 1;
            continue;
        };
        tally.accepted += 1;
        let (p, truth) = (&found.parameters, &arm.truth);
        let values = p.lengths.iter().chain(&p.offsets);
        let wanted = truth.lengths.iter().chain(&truth.offsets);
        for (index, (value, wanted)) in values.zip(wanted).enumerate() {
            let sd = found.covariance[(index, index)].sqrt();
            tally.interval(value - wanted, sd, found.coverage_factor);
        }
        let rejected: usize = found.kinds.iter().map(|kind| kind.rejected.len()).sum();
        let bars = found.kinds.iter().find(|kind| kind.kind == "bars").unwrap();
        let named = wrong
            .iter()
            .filter(|row| bars.rejected.contains(row))
            .count();
        tally.good_left_out += (rejected - named) as u32;
        tally.wrong_kept += (wrong.len() - named) as u32;
        let [stated, real] = tip_errors(&found, truth);
        tally.stated += stated * stated;
        tally.real += real * real;
    }
    tally
}

#[test]
fn the_intervals_of_distances_hold_95_percent_in_every_case() {
    for case in Case::ALL {
        let tally = tally(Tables::Bars, case, 20);
        println!(
            "{case:?}: {:.3} {:.2} {tally:?}",
            tally.share(),
            tally.rms()
        );
        // The seven unknowns are correlated: about as much as three independent ones.
        tally.assert_covers("distances", case, 3.0);
        assert_eq!(tally.wrong_kept, 0, "{case:?}");
        // The mean square of the tip's error has some three degrees of freedom in each arm.
        assert!((tally.tip() - 1.0).abs() < 0.28, "{case:?}: {tally:?}");
    }
}
