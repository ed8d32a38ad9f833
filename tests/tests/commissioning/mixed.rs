//! Calibration from distances, unknown holes and photographs.

use crate::arms::made;
use crate::calibration::{DRAWN, benchtop};
use crate::measured_arm::{Arm, arm, nothing};
use fivebar_design::Noise;
use fivebar_design::calibration::{
    CalibrationError, Criterion, HoleTouch, Measurements, MixedCalibration, Parameters, calibrate,
    calibrate_mixed, tip_error_before, tip_error_best_placed,
};
use fivebar_kinematics::five_bar::{Geometry, Side, Tool};
use nalgebra::Vector2;

/// The error of the tip over the workspace after the best placement: expected and real [m].
pub(crate) fn tip_errors(found: &MixedCalibration, truth: &Parameters) -> [f64; 2] {
    let (mut workspace, home) = benchtop();
    let p = &found.parameters;
    let geometry = Geometry::new(p.lengths).unwrap();
    workspace.tool = Tool::new(geometry, Vector2::zeros()).unwrap();
    let expected = tip_error_best_placed(p, &found.covariance, &workspace, &home).unwrap();
    let offsets = [0, 1].map(|joint| truth.offsets[joint] - p.offsets[joint]);
    let real = Parameters { offsets, ..*truth };
    let real = tip_error_before(&real, &workspace, &home).unwrap();
    [expected.rms, real.rms]
}

/// Twelve arms measured in this way: the tip errors are those expected [m].
fn assert_expected(measure: impl Fn(&mut Arm) -> Measurements, bounds: [f64; 2]) {
    let (mut expected, mut real) = (0.0, 0.0);
    for seed in 0..12 {
        let mut arm = arm(seed, 1.0);
        let measured = measure(&mut arm);
        let found = calibrate_mixed(&measured, DRAWN).unwrap();
        assert_eq!((found.rank, found.placed), (7, false));
        let [before, after] = tip_errors(&found, &arm.truth);
        expected += before * before / 12.0;
        real += after * after / 12.0;
    }
    let (expected, real) = (expected.sqrt(), real.sqrt());
    println!("expected {expected:e}, real {real:e}");
    assert!(
        (0.7..1.4).contains(&(real / expected)),
        "{real:e} for {expected:e}"
    );
    assert!((bounds[0]..bounds[1]).contains(&expected), "{expected:e}");
}

#[test]
fn distances_alone_find_lengths_and_zeros() {
    let measure = |arm: &mut Arm| Measurements {
        bars: arm.bars(24),
        ..nothing()
    };
    assert_expected(measure, [10e-6, 60e-6]);
    let found = calibrate_mixed(&measure(&mut arm(1, 1.0)), DRAWN).unwrap();
    assert!(
        (10.0..80.0).contains(&found.condition),
        "{}",
        found.condition
    );
}

#[test]
fn unknown_holes_in_several_working_modes_need_one_distance() {
    let measure = |arm: &mut Arm| Measurements {
        holes: arm.holes(20),
        bars: arm.bars(1),
        ..nothing()
    };
    assert_expected(measure, [10e-6, 100e-6]);
    let mut arm = arm(2, 1.0);
    let holes = Measurements {
        holes: arm.holes(20),
        ..nothing()
    };
    assert_eq!(
        calibrate_mixed(&holes, DRAWN),
        Err(CalibrationError::NoScale)
    );
}

#[test]
fn a_photograph_needs_one_distance() {
    let measure = |arm: &mut Arm| Measurements {
        photos: vec![arm.photo(200)],
        bars: arm.bars(1),
        ..nothing()
    };
    assert_expected(measure, [10e-6, 100e-6]);
    let mut arm = arm(2, 1.0);
    let photo = Measurements {
        photos: vec![arm.photo(200)],
        ..nothing()
    };
    assert_eq!(
        calibrate_mixed(&photo, DRAWN),
        Err(CalibrationError::NoScale)
    );
}

#[test]
fn without_noise_any_mix_finds_the_arm() {
    for seed in 0..20 {
        let mut arm = arm(seed, 0.0);
        let all = Measurements {
            bars: arm.bars(3),
            holes: arm.holes(3),
            photos: vec![arm.photo(8), arm.photo(9)],
            ..nothing()
        };
        let found = calibrate_mixed(&all, DRAWN).unwrap();
        for (own, wanted) in found.parameters.lengths.iter().zip(arm.truth.lengths) {
            assert!((own - wanted).abs() < 1e-9, "{own} for {wanted}");
        }
        for (own, wanted) in found.parameters.offsets.iter().zip(arm.truth.offsets) {
            assert!((own - wanted).abs() < 1e-8, "{own} for {wanted}");
        }
        assert!(found.kinds.iter().all(|kind| kind.rejected.is_empty()));
    }
}

#[test]
fn a_plate_alone_gives_what_the_plate_s_own_calibration_gives() {
    let mut noise = Noise::new(5);
    for _ in 0..20 {
        let made = made(&mut noise, 24, 20e-6);
        let plate = calibrate(&made.plate, made.drawn).unwrap();
        let measured = Measurements {
            plate: made.plate.touches.clone(),
            assembly: made.plate.assembly,
            ..nothing()
        };
        let mixed = calibrate_mixed(&measured, made.drawn).unwrap();
        let lengths = plate
            .parameters
            .lengths
            .iter()
            .zip(mixed.parameters.lengths);
        assert!(lengths.into_iter().all(|(a, b)| (a - b).abs() < 1e-9));
        assert!((plate.parameters.turn - mixed.parameters.turn).abs() < 1e-8);
        assert!((mixed.covariance - plate.covariance).amax() < 1e-6 * plate.covariance.amax());
        assert_eq!((mixed.rank, mixed.placed), (10, true));
        assert!((mixed.kinds[0].residual_rms / plate.residual_rms - 1.0).abs() < 1e-6);
    }
}

#[test]
fn a_photograph_beside_distances_makes_the_arm_better_known() {
    let mut arm = arm(4, 1.0);
    let bars = arm.bars(12);
    let photo = arm.photo(40);
    let sd = |measured: &Measurements| {
        let found = calibrate_mixed(measured, DRAWN).unwrap();
        found.covariance[(0, 0)].sqrt()
    };
    let few = sd(&Measurements {
        bars: bars.clone(),
        ..nothing()
    });
    let more = sd(&Measurements {
        bars,
        photos: vec![photo],
        ..nothing()
    });
    assert!(more < 0.95 * few, "{more:e} for {few:e}");
}

#[test]
fn wrong_measurements_are_named() {
    let mut arm = arm(6, 1.0);
    let mut all = Measurements {
        bars: arm.bars(24),
        holes: arm.holes(10),
        photos: vec![arm.photo(40)],
        ..nothing()
    };
    all.bars[5].length += 0.5e-3;
    all.photos[0][7].pixel.x += 3.0;
    let found = calibrate_mixed(&all, DRAWN).unwrap();
    let rejected: Vec<_> = found
        .kinds
        .iter()
        .map(|k| (k.kind.as_str(), &k.rejected[..]))
        .collect();
    assert_eq!(
        rejected,
        [("bars", &[5][..]), ("holes", &[]), ("photo 1", &[7])]
    );
    let [_, real] = tip_errors(&found, &arm.truth);
    assert!(real < 40e-6, "{real:e}");
}

#[test]
fn what_tells_too_little_or_is_of_another_mode_is_refused() {
    let mut arm = arm(7, 1.0);
    let bars = Measurements {
        bars: arm.bars(24),
        ..nothing()
    };
    let refused = |measured: &Measurements| calibrate_mixed(measured, DRAWN).unwrap_err();
    let other = Measurements {
        assembly: Side::Right,
        ..bars.clone()
    };
    assert_eq!(refused(&other), CalibrationError::OtherAssembly);
    let mut swapped = bars.clone();
    for bar in &mut swapped.bars {
        bar.encoders = bar.encoders.map(|[a, b]| [b, a]);
    }
    assert_eq!(refused(&swapped), CalibrationError::SwappedJoints);
    let four = Measurements {
        bars: bars.bars[..4].to_vec(),
        ..nothing()
    };
    assert!(
        matches!(
            refused(&four),
            CalibrationError::NotSeen { unknowns: 7, .. }
        ),
        "{:?}",
        refused(&four)
    );
    let mut lone = nothing();
    lone.holes = arm.holes(3);
    lone.holes.push(HoleTouch {
        hole: 9,
        ..lone.holes[0]
    });
    assert_eq!(refused(&lone), CalibrationError::LoneTouch(9));
    let photo = Measurements {
        photos: vec![arm.photo(4)],
        ..bars.clone()
    };
    assert_eq!(refused(&photo), CalibrationError::SmallPhoto(0, 4));
    let mut one_place = arm.photo(9);
    let encoder = one_place[0].encoder;
    one_place[1..]
        .iter_mut()
        .for_each(|point| point.encoder = encoder);
    let photo = Measurements {
        photos: vec![one_place],
        ..bars.clone()
    };
    assert_eq!(refused(&photo), CalibrationError::SmallPhoto(0, 1));
    let twice = [1, 1].map(|hole| HoleTouch { hole, encoder });
    let twice = Measurements {
        holes: twice.to_vec(),
        ..bars.clone()
    };
    assert_eq!(refused(&twice), CalibrationError::LoneTouch(1));
    let mut short = bars.clone();
    short.bars[2].length = 0.0;
    assert_eq!(refused(&short), CalibrationError::BarLength(2));
    short.bars[2].length = f64::NAN;
    assert_eq!(refused(&short), CalibrationError::BarLength(2));
    let mut nowhere = bars.clone();
    nowhere.bars[2].encoders[1][0] = f64::INFINITY;
    assert_eq!(refused(&nowhere), CalibrationError::NotFinite);
    // In millimetres.
    let mut large = bars;
    large.bars.iter_mut().for_each(|bar| bar.length *= 1e3);
    assert!(
        matches!(
            refused(&large),
            CalibrationError::MixedNoFit(_) | CalibrationError::OtherArm { .. }
        ),
        "{:?}",
        refused(&large)
    );
    assert_eq!(refused(&nothing()), CalibrationError::NoScale);
}

#[test]
fn a_table_that_contradicts_the_others_is_refused_by_name() {
    let mut arm = arm(8, 1.0);
    let sound = Measurements {
        plate: arm.plate(24),
        bars: arm.bars(24),
        holes: arm.holes(12),
        photos: vec![arm.photo(60)],
        ..nothing()
    };
    assert!(calibrate_mixed(&sound, DRAWN).is_ok());
    // From all half a metre away to all somewhat too long.
    for wrong in [0.5, 0.05, 2e-3, 0.6e-3, 0.2e-3] {
        for criterion in [Criterion::Huber, Criterion::LeastSquares] {
            let mut long = sound.clone();
            long.criterion = criterion;
            long.bars.iter_mut().for_each(|bar| bar.length += wrong);
            let refused = calibrate_mixed(&long, DRAWN).unwrap_err();
            assert!(
                matches!(
                    refused,
                    CalibrationError::Contradicts { .. }
                        | CalibrationError::MixedNoFit(_)
                        | CalibrationError::OtherArm { .. }
                ),
                "{wrong} {criterion:?}: {refused:?}"
            );
        }
    }
}
