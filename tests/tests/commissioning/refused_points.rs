//! Points that do not calibrate an arm.

use crate::arms::{Made, made};
use crate::calibration::{DRAWN, SIGMA, benchtop};
use fivebar_design::Noise;
use fivebar_design::calibration::{CalibrationError, Criterion, Plate, Touch, calibrate};
use fivebar_kinematics::five_bar::Geometry;
use nalgebra::Vector2;

#[test]
fn what_is_not_determined_is_refused_with_its_reason() {
    refused_with_their_reason(15);
}

#[test]
#[ignore = "some seconds: ./ci.sh tables"]
fn whole_table_of_random_arms_whose_points_are_refused_with_their_reason() {
    refused_with_their_reason(60);
}

fn refused_with_their_reason(arms: u32) {
    let mut noise = Noise::new(5);
    for number in 0..arms {
        let Made { drawn, plate, .. } = made(&mut noise, 24, SIGMA);
        let with = |touches: Vec<Touch>| {
            calibrate(
                &Plate {
                    touches,
                    ..plate.clone()
                },
                drawn,
            )
        };
        let touches = &plate.touches;
        assert!(with(touches.clone()).is_ok(), "{number}");
        // Few points, also if they are repeated.
        assert_eq!(
            with(touches[..4].to_vec()),
            Err(CalibrationError::TooFew(4))
        );
        let repeated = touches[..3].iter().cycle().take(24).copied().collect();
        assert_eq!(with(repeated), Err(CalibrationError::TooFew(3)));
        assert_eq!(with(Vec::new()), Err(CalibrationError::TooFew(0)));
        // Joints exchanged: the residuals alone do not show it.
        let swapped: Vec<Touch> = touches
            .iter()
            .map(|touch| Touch {
                encoder: [touch.encoder[1], touch.encoder[0]],
                ..*touch
            })
            .collect();
        assert_eq!(
            with(swapped),
            Err(CalibrationError::SwappedJoints),
            "{number}"
        );
        // The other assembly mode.
        let other = Plate {
            assembly: plate.assembly.opposite(),
            ..plate.clone()
        };
        assert_eq!(
            calibrate(&other, drawn),
            Err(CalibrationError::OtherAssembly),
            "{number}"
        );
        // An encoder that counts the other way.
        let reversed: Vec<Touch> = touches
            .iter()
            .map(|touch| Touch {
                encoder: [-touch.encoder[0], touch.encoder[1]],
                ..*touch
            })
            .collect();
        assert!(with(reversed).is_err(), "{number}");
        // Another arm, half as large again.
        let larger = drawn.map(|length| 1.5 * length);
        let error = calibrate(&plate, larger);
        assert!(
            matches!(error, Err(CalibrationError::OtherArm { .. })),
            "{number}: {error:?}"
        );
        let mut broken = touches.clone();
        broken[3].hole.x = f64::NAN;
        assert_eq!(with(broken), Err(CalibrationError::NotFinite));
    }
}

#[test]
fn degenerate_sets_of_points_are_refused() {
    let (workspace, home) = benchtop();
    let geometry = Geometry::new(DRAWN).unwrap();
    let mut noise = Noise::new(6);
    let mut touched = |places: Vec<Vector2<f64>>| {
        let touch = |c: Vector2<f64>| {
            let [theta1, _, _, theta4] = geometry.inverse(c, workspace.mode).unwrap().angles();
            let error = Vector2::new(noise.normal(), noise.normal()) * SIGMA;
            Touch {
                encoder: [theta1, theta4],
                hole: c + error,
            }
        };
        let touches = places.into_iter().map(touch).collect();
        calibrate(
            &Plate {
                touches,
                assembly: home.assembly(),
                sigma: SIGMA,
                criterion: Criterion::Huber,
            },
            DRAWN,
        )
    };
    let steps = |count: u32| (0..count).map(move |k| f64::from(k) / f64::from(count - 1));
    let line = steps(20).map(|s| Vector2::new(-0.1 + 0.28 * s, 0.13 + 0.05 * s));
    assert_eq!(touched(line.collect()), Err(CalibrationError::Collinear));
    // All within 2 mm: the lengths are lost in the holes' errors.
    let spot = steps(20)
        .map(|s| Vector2::new(0.04, 0.18) + 1e-3 * Vector2::new((9.0 * s).cos(), (9.0 * s).sin()));
    assert!(matches!(
        touched(spot.collect()),
        Err(CalibrationError::NotSeen { .. })
    ));
    // Joint 4 at rest: nothing of leg 4 is seen alone.
    let d = geometry
        .inverse(Vector2::new(0.04, 0.2), workspace.mode)
        .unwrap()
        .d;
    let arc =
        steps(20).map(|s| d + 0.16 * Vector2::new((1.9 + 0.8 * s).cos(), (1.9 + 0.8 * s).sin()));
    assert!(matches!(
        touched(arc.collect()),
        Err(CalibrationError::NotSeen { .. })
    ));
}
