//! The corrected angle against the true one.

use super::*;
use crate::settings::Settings;

/// A gear of 10 and 4096 counts, and an error of two harmonics [rad].
const RATIO: f64 = 10.0;

fn axis() -> AxisSettings {
    let [axis, _] = Settings::BENCHTOP.axes;
    AxisSettings {
        gear_ratio: RATIO as f32,
        encoder_counts: 4096,
        home_angle: 2.3,
        ..axis
    }
}

fn error(shaft: f64) -> f64 {
    8.7e-3 * f64::sin(shaft + 1.0) + 2e-3 * f64::sin(2.0 * shaft)
}

fn encoder() -> Encoder {
    let table = EncoderTable::new(RATIO as f32, |measured| {
        let shaft = (0..50).fold(measured, |shaft, _| measured - error(shaft));
        measured - shaft
    });
    Encoder::new(&table, &axis()).expect("an error")
}

/// The counts between two angles of the joint [rad].
fn counts(from: f64, to: f64) -> i32 {
    let measured = |angle: f64| RATIO * angle + error(RATIO * angle);
    ((measured(to) - measured(from)) * 4096.0 / f64::from(TAU)).round() as i32
}

#[test]
fn a_known_joint_shows_its_true_angle_everywhere() {
    let count = f64::from(TAU) / (RATIO * 4096.0);
    for home in [2.3, -0.7] {
        let mut encoder = encoder();
        encoder.set_origin(home as f32, encoder.shown_at(home as f32));
        let mut worst = [0.0_f64; 2];
        for step in -500..500 {
            let angle = 6e-3 * f64::from(step);
            let turned = counts(home, angle);
            let Some(scale) = encoder.scale(turned) else {
                continue;
            };
            assert_eq!(encoder.scale(turned), None, "it is in use");
            let corrected = f64::from(scale.at_origin + scale.per_count * turned as f32);
            let plain = home + count * f64::from(turned);
            for (worst, shown) in worst.iter_mut().zip([corrected, plain]) {
                *worst = worst.max((shown - angle).abs());
            }
        }
        // Half a count, a straight line in place of the harmonics, and the unit of the table.
        assert!(worst[0] < 0.5 * count + 8e-6, "{worst:?}");
        assert!(worst[1] > 1e-3, "{worst:?}");
    }
}

#[test]
fn an_unknown_joint_is_not_corrected() {
    let mut encoder = encoder();
    for turned in [-20_000, 0, 300, 20_000] {
        let scale = encoder.scale(turned).expect("an interval");
        assert_eq!((scale.at_origin, scale.per_count), (0.0, TAU / 40_960.0));
    }
}

#[test]
fn an_encoder_without_a_known_error_needs_no_correction() {
    assert!(Encoder::new(&EncoderTable::NONE, &axis()).is_none());
}

#[test]
fn the_error_between_two_points_is_on_the_line_between_them() {
    let mut encoder = encoder();
    encoder.points = [[0; 16]; ENCODER_POINTS / 16];
    encoder.points[0][2] = 100;
    for (shown, error) in [
        (1.0, 0.0),
        (1.25, 25.0),
        (1.75, 75.0),
        (2.0, 100.0),
        (2.5, 50.0),
    ] {
        assert_eq!(encoder.error(shown), error, "at {shown}");
    }
    assert_eq!(encoder.error(3.5), 0.0);
}
