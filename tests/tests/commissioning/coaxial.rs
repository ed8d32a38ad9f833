//! Arms with both hips about one axis: a base of zero has no direction.

use crate::arms::{Made, made_with};
use crate::calibration::{SIGMA, deviations};
use crate::measured_arm::{Arm, arm_drawn, nothing};
use fivebar_design::Noise;
use fivebar_design::calibration::{
    Calibration, CalibrationError, Criterion, Measurements, Parameters, Plate, Touch, Unknowns,
    calibrate, calibrate_mixed, propose, tip_error,
};
use fivebar_files::robot::Robot;
use fivebar_kinematics::five_bar::{Tool, Workspace};
use nalgebra::{DMatrix, DVector, Vector2};

/// Of no symmetry, so that each length has its own part in what is measured.
const LEG: [f64; 5] = [0.09, 0.16, 0.15, 0.10, 0.0];

/// The errors of the free unknowns with their deviations.
fn free_errors(found: &Calibration, truth: &Parameters) -> Vec<(f64, f64)> {
    let all: Vec<(f64, f64)> = deviations(found, truth).collect();
    let free = Unknowns::of(truth.lengths).free().iter();
    free.map(|&index| all[index]).collect()
}

/// Every free unknown is within so many of its deviations, and what is held is zero.
#[track_caller]
fn assert_found(found: &Calibration, truth: &Parameters, most: f64) {
    assert_eq!(found.rank, 8);
    assert_eq!(
        (found.parameters.lengths[4], found.parameters.turn),
        (0.0, 0.0)
    );
    for held in [4, 9] {
        assert_eq!(found.covariance.row(held).amax(), 0.0);
    }
    let errors = free_errors(found, truth);
    assert_eq!(errors.len(), 8);
    for (error, sd) in errors {
        assert!(error.abs() < most * sd, "{error:e} ± {sd:e}");
    }
}

/// eᵀ Σ⁻¹ e of the errors e: 8 in the mean.
fn squares(found: &Calibration, truth: &Parameters) -> f64 {
    let free = Unknowns::of(truth.lengths).free();
    let errors = free_errors(found, truth);
    let correlation = DMatrix::from_fn(8, 8, |i, j| {
        found.covariance[(free[i], free[j])] / (errors[i].1 * errors[j].1)
    });
    let errors = DVector::from_iterator(8, errors.into_iter().map(|(error, sd)| error / sd));
    errors.dot(&correlation.cholesky().unwrap().solve(&errors))
}

#[test]
fn random_coaxial_arms_are_found_from_their_drawing() {
    let mut noise = Noise::new(61);
    let mut sum = 0.0;
    for number in 0..60 {
        let sigma = SIGMA * (0.25 + 4.0 * noise.uniform());
        let Made {
            truth,
            drawn,
            plate,
        } = made_with(0.0, &mut noise, 24, sigma);
        let criterion = match number % 2 {
            0 => Criterion::Huber,
            _ => Criterion::LeastSquares,
        };
        let found = calibrate(&Plate { criterion, ..plate }, drawn)
            .unwrap_or_else(|error| panic!("{number}: {error} {truth:?} {drawn:?}"));
        assert_found(&found, &truth, 5.0);
        sum += squares(&found, &truth);
    }
    // The stated deviations are those of the errors, within three deviations of 480 independent draws.
    let ratio = sum / (8.0 * 60.0);
    println!("mean square {ratio:.2} deviations");
    assert!((0.8..1.2).contains(&ratio), "{ratio}");
}

#[test]
fn few_holes_suffice_for_eight_unknowns_and_wrong_ones_are_named() {
    let mut noise = Noise::new(62);
    let mut refused = 0;
    for number in 0..30 {
        let Made {
            truth,
            drawn,
            mut plate,
        } = made_with(0.0, &mut noise, [6, 9, 24][number % 3], SIGMA);
        if plate.touches.len() == 24 {
            for row in [2, 11] {
                plate.touches[row].hole += Vector2::new(0.5e-3, -0.5e-3);
            }
        }
        match calibrate(&plate, drawn) {
            Ok(found) => {
                assert_found(&found, &truth, 8.0);
                if plate.touches.len() == 24 {
                    assert!(
                        [2, 11].iter().all(|row| found.rejected.contains(row)),
                        "{number}"
                    );
                }
            }
            Err(CalibrationError::NotSeen {
                names, unknowns, ..
            }) if plate.touches.len() < 9 => {
                assert!(
                    unknowns == 8 && !names.contains(&"l5") && !names.contains(&"φ"),
                    "{names:?}"
                );
                refused += 1;
            }
            Err(error) => panic!("{number}: {error}"),
        }
    }
    assert!(refused <= 3, "{refused}");
}

#[test]
fn points_of_the_other_assembly_mode_and_exchanged_columns_are_refused_together() {
    let mut noise = Noise::new(63);
    for number in 0..20 {
        let Made { drawn, plate, .. } = made_with(0.0, &mut noise, 24, SIGMA);
        let exchange = |touch: &Touch| Touch {
            encoder: [touch.encoder[1], touch.encoder[0]],
            ..*touch
        };
        let swapped = Plate {
            touches: plate.touches.iter().map(exchange).collect(),
            ..plate.clone()
        };
        let other = Plate {
            assembly: plate.assembly.opposite(),
            ..plate
        };
        for points in [swapped, other] {
            assert_eq!(
                calibrate(&points, drawn),
                Err(CalibrationError::OtherAssemblyOrSwappedJoints),
                "{number}"
            );
        }
    }
    let mut leg = arm_drawn(LEG, 1, 1.0);
    let bars = Measurements {
        bars: leg.bars(24),
        ..nothing()
    };
    let mut swapped = bars.clone();
    for bar in &mut swapped.bars {
        bar.encoders = bar.encoders.map(|[a, b]| [b, a]);
    }
    let other = Measurements {
        assembly: bars.assembly.opposite(),
        ..bars
    };
    for measured in [swapped, other] {
        assert_eq!(
            calibrate_mixed(&measured, LEG),
            Err(CalibrationError::OtherAssemblyOrSwappedJoints)
        );
    }
}

/// Ways of measuring, by the errors' share of the stated ones.
fn mixes(arm: &mut Arm) -> [Measurements; 4] {
    let bars = arm.bars(24);
    let with_bars = |other: Measurements| Measurements {
        bars: bars.clone(),
        ..other
    };
    [
        with_bars(nothing()),
        with_bars(Measurements {
            photos: vec![arm.photo(40)],
            ..nothing()
        }),
        with_bars(Measurements {
            plate: arm.plate(12),
            ..nothing()
        }),
        Measurements {
            plate: arm.plate(12),
            photos: vec![arm.photo(40), arm.photo(9)],
            ..nothing()
        },
    ]
}

#[test]
fn distances_photographs_and_plates_together_find_a_coaxial_arm() {
    let (mut squares, mut count) = (0.0, 0.0);
    for seed in 0..12 {
        for share in [0.0, 1.0] {
            let mut arm = arm_drawn(LEG, seed, share);
            for measured in mixes(&mut arm) {
                let found = calibrate_mixed(&measured, LEG).unwrap();
                let (p, truth) = (&found.parameters, &arm.truth);
                let wanted = if found.placed {
                    truth.offsets
                } else {
                    // Without a plate the zero of joint 1 as drawn says where x points.
                    assert_eq!(p.offsets[0], 0.0);
                    [0.0, truth.offsets[1] - truth.offsets[0]]
                };
                assert_eq!(found.rank, if found.placed { 8 } else { 5 });
                assert_eq!((p.lengths[4], p.turn), (0.0, 0.0));
                let own = p.lengths.iter().chain(&p.offsets);
                for (index, (own, wanted)) in
                    own.zip(truth.lengths.iter().chain(&wanted)).enumerate()
                {
                    let sd = found.covariance[(index, index)].sqrt();
                    let error = own - wanted;
                    if share == 0.0 || sd == 0.0 {
                        assert!(error.abs() < 1e-8, "{seed}: {index}: {error:e}");
                    } else {
                        assert!(
                            error.abs() < 5.0 * sd,
                            "{seed}: {index}: {error:e} ± {sd:e}"
                        );
                        squares += (error / sd).powi(2);
                        count += 1.0;
                    }
                }
            }
        }
    }
    let ratio: f64 = squares / count;
    println!("mean square {ratio:.2} deviations of {count}");
    assert!((0.7..1.35).contains(&ratio), "{ratio}");
}

#[test]
fn a_plate_alone_gives_what_its_own_calibration_gives() {
    let mut noise = Noise::new(64);
    for _ in 0..10 {
        let made = made_with(0.0, &mut noise, 24, SIGMA);
        let plate = calibrate(&made.plate, made.drawn).unwrap();
        let measured = Measurements {
            plate: made.plate.touches.clone(),
            assembly: made.plate.assembly,
            ..nothing()
        };
        let mixed = calibrate_mixed(&measured, made.drawn).unwrap();
        assert!((mixed.covariance - plate.covariance).amax() < 1e-6 * plate.covariance.amax());
        for joint in 0..2 {
            let off = mixed.parameters.offsets[joint] - plate.parameters.offsets[joint];
            assert!(off.abs() < 1e-8, "{off:e}");
        }
    }
}

/// Expected of so many proposed holes: O1, and the tip's error over the workspace, RMS and worst [m].
fn expected(name: &str, count: usize) -> [f64; 3] {
    let robot = Robot::load(name).unwrap();
    let lengths = robot.geometry.lengths();
    let workspace = Workspace {
        tool: Tool::new(robot.geometry, Vector2::zeros()).unwrap(),
        margin: 0.3,
        ..robot.workspace(robot.elbows).unwrap()
    };
    let home = robot.home_pose().unwrap();
    let found = propose(&workspace, &home, count).unwrap();
    for index in 0..10 {
        let is_free = found.covariance[(index, index)] > 0.0;
        assert_eq!(is_free, Unknowns::of(lengths).is_free(index), "{index}");
    }
    let nominal = Parameters {
        lengths,
        ..Parameters::default()
    };
    let covariance = found.covariance * (SIGMA * SIGMA);
    let error = tip_error(&nominal, &covariance, &workspace, &home).unwrap();
    [found.observability, error.rms, error.worst]
}

#[test]
fn proposed_poses_determine_a_leg_better_than_an_arm_with_a_base() {
    let document = include_str!("../../../docs/use/calibration.md");
    for count in [8, 12, 24, 40] {
        let [benchtop, leg] = ["benchtop", "leg"].map(|name| expected(name, count));
        assert!(leg[1] < benchtop[1] && leg[2] < benchtop[2], "{leg:?}");
        let cells = |[o1, rms, worst]: [f64; 3]| {
            format!("{o1:.4} | {:.1} µm | {:.1} µm |", 1e6 * rms, 1e6 * worst)
        };
        let row = format!("| {count} | {} {}", cells(benchtop), cells(leg));
        assert!(document.contains(&row), "missing: {row}");
    }
}
