//! Random arms over plates of 24 holes.

use super::{Case, Tally};
use crate::arms::{Made, made_with};
use crate::calibration::{SIGMA, deviations};
use fivebar_design::Noise;
use fivebar_design::calibration::{
    Calibration, CalibrationError, Unknowns, calibrate, tip, tip_error,
};
use fivebar_kinematics::five_bar::{Geometry, Tool, Workspace};
use nalgebra::Vector2;

const HOLES: usize = 24;
/// The base of the random arms, about [m].
const BASE: f64 = 0.08;

/// An arm with about this base [m] and its plate with the errors of a case, and the holes that are wrong.
fn drawn(base: f64, noise: &mut Noise, case: Case, wrong: usize) -> (Made, Vec<usize>) {
    let mut made = made_with(base, noise, HOLES, 0.0);
    made.plate.sigma = SIGMA;
    for touch in &mut made.plate.touches {
        touch.hole += SIGMA * case.pair(noise);
    }
    let mut order: Vec<usize> = (0..HOLES).collect();
    for i in 0..wrong {
        let other = i + (noise.uniform() * (HOLES - i) as f64) as usize;
        order.swap(i, other);
        let direction = std::f64::consts::TAU * noise.uniform();
        made.plate.touches[order[i]].hole +=
            0.5e-3 * Vector2::new(direction.cos(), direction.sin());
    }
    order.truncate(wrong);
    (made, order)
}

pub(super) fn tally(case: Case, repetitions: u32) -> Tally {
    tally_with(BASE, case, repetitions)
}

fn tally_with(base: f64, case: Case, repetitions: u32) -> Tally {
    let mut noise = Noise::new(46);
    let mut tally = Tally::default();
    for _ in 0..repetitions {
        let wrong = if case == Case::Wrong { 3 } else { 0 };
        let (made, wrong) = drawn(base, &mut noise, case, wrong);
        let Ok(found) = calibrate(&made.plate, made.drawn) else {
            tally.refused += 1;
            continue;
        };
        tally.accepted += 1;
        let free = Unknowns::of(made.drawn).free();
        let all: Vec<(f64, f64)> = deviations(&found, &made.truth).collect();
        let errors: Vec<(f64, f64)> = free.iter().map(|&index| all[index]).collect();
        for &(error, sd) in &errors {
            tally.interval(error, sd, found.coverage_factor);
        }
        let errors: Vec<f64> = errors.into_iter().map(|(error, _)| error).collect();
        let covariance = |row: usize, column: usize| found.covariance[(free[row], free[column])];
        tally.independent(&errors, covariance, found.coverage_factor);
        let good = found.rejected.iter().filter(|row| !wrong.contains(row));
        tally.good_left_out += good.count() as u32;
        let kept = wrong.iter().filter(|row| !found.rejected.contains(row));
        tally.wrong_kept += kept.count() as u32;
        let [stated, real] = tip_errors(&made, &found);
        tally.stated += stated;
        tally.real += real;
    }
    tally
}

/// Mean square of the tip's error over the workspace: as stated and as it is [m²].
fn tip_errors(made: &Made, found: &Calibration) -> [f64; 2] {
    let p = &found.parameters;
    let geometry = Geometry::new(p.lengths).unwrap();
    let [e1, e4] = made.plate.touches[0].encoder;
    let home = geometry.forward(e1 + p.offsets[0], e4 + p.offsets[1], made.plate.assembly);
    let home = home.unwrap();
    let workspace = Workspace {
        tool: Tool::new(geometry, Vector2::zeros()).unwrap(),
        mode: home.working_mode(),
        limits: None,
        margin: 0.3,
    };
    let stated = tip_error(p, &found.covariance, &workspace, &home).unwrap();
    let real = stated.points.iter().map(|(c, _)| {
        let [theta1, _, _, theta4] = geometry.inverse(*c, workspace.mode).unwrap().angles();
        let encoder = [theta1 - p.offsets[0], theta4 - p.offsets[1]];
        let at = |p| tip(p, encoder, made.plate.assembly).unwrap().position;
        (at(p) - at(&made.truth)).norm_squared()
    });
    let real = real.sum::<f64>() / stated.points.len() as f64;
    [stated.rms.powi(2), real]
}

#[test]
fn the_intervals_of_a_plate_hold_95_percent_in_every_case() {
    assert_plates_cover("plate", BASE);
}

#[test]
fn the_intervals_of_a_plate_under_coaxial_arms_hold_95_percent_in_every_case() {
    assert_plates_cover("plate, coaxial", 0.0);
}

fn assert_plates_cover(what: &str, base: f64) {
    for case in Case::ALL {
        let tally = tally_with(base, case, 24);
        assert_eq!(tally.refused, 0, "{case:?}");
        tally.assert_independent_covers(what, case);
        println!(
            "{what} {case:?}: the tip errs {:.2} times what is stated",
            tally.tip()
        );
        assert_eq!(tally.wrong_kept, 0, "{case:?}");
        if case != Case::HeavyTails {
            assert!(tally.good_left_out <= 3, "{case:?}: {tally:?}");
        }
    }
}

#[test]
fn at_most_one_sound_plate_in_a_hundred_loses_a_hole() {
    let mut noise = Noise::new(47);
    for case in [Case::Clean, Case::Worse] {
        let lost = (0..60).filter(|_| {
            let (made, _) = drawn(BASE, &mut noise, case, 0);
            !calibrate(&made.plate, made.drawn)
                .unwrap()
                .rejected
                .is_empty()
        });
        // Of 60 with 1 % each, more than three in 0.3 % of the cases.
        let lost = lost.count();
        println!("{case:?}: {lost} of 60 lose a hole");
        assert!(lost <= 3, "{case:?}: {lost}");
    }
}

#[test]
fn more_wrong_holes_than_a_fit_can_bear_are_refused_with_their_rows() {
    let mut noise = Noise::new(48);
    for _ in 0..10 {
        let (made, mut wrong) = drawn(BASE, &mut noise, Case::Clean, 8);
        wrong.sort_unstable();
        let refused = calibrate(&made.plate, made.drawn).unwrap_err();
        let CalibrationError::TooManyWrong { rows, of, .. } = &refused else {
            panic!("{refused:?}");
        };
        assert_eq!((rows, *of), (&wrong, HOLES));
        let named = format!("plate: rows {}, ", wrong[0] + 1);
        assert!(refused.to_string().starts_with(&named), "{refused}");
    }
}
