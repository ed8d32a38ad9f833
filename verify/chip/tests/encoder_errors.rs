//! Encoders with a known error, on the production image.

mod bench;

use bench::raised::{at_the_end, offer, tool_at_start};
use bench::{Driven, settings};
use fivebar_chip::Options;
use fivebar_chip::time::MILLISECOND;
use fivebar_firmware::safety::State;
use fivebar_firmware::settings::{EncoderTable, ToolOutputSettings};
use fivebar_firmware::{Move, MoveKind, Settings};
use std::f64::consts::TAU;

/// An error of the shaft [rad] by its measured angle [rad].
const ERRORS: [fn(f64) -> f64; 2] = [
    |measured| 2e-2 * (measured + 0.4).sin() + 5e-3 * (2.0 * measured).sin(),
    |measured| 1.5e-2 * (measured - 1.1).sin(),
];

fn with_errors(settings: &mut Settings) {
    for (joint, error) in ERRORS.into_iter().enumerate() {
        let ratio = settings.axes[joint].gear_ratio;
        settings.encoder_tables[joint] = EncoderTable::new(ratio, error);
    }
}

/// The measured angle of the shaft whose true angle this is [rad].
fn measured(truth: f64, error: fn(f64) -> f64) -> f64 {
    (0..50).fold(truth, |measured, _| truth + error(measured))
}

/// The encoders' counts.
fn counts(driven: &mut Driven) -> [i32; 2] {
    let sample = driven.client.sample().expect("a line");
    sample.expect("the board has inputs").counts
}

#[test]
fn the_angle_is_that_of_the_counts_less_the_known_error() {
    let mut driven = at_the_end(Options::default()).ready_with(with_errors);
    let mut settings = settings();
    driven
        .client
        .read_settings(&mut settings)
        .expect("settings");
    let mut expected = settings;
    with_errors(&mut expected);
    assert_eq!(settings.encoder_tables, expected.encoder_tables);

    let origin = counts(&mut driven);
    let start = driven.arm();
    let [x, y] = tool_at_start();
    let mut corrections = [0.0_f64; 2];
    for tag in 1..4 {
        let to = [x - 15e-3 * tag as f32, y];
        let kind = MoveKind::Line { to, feed: 0.1 };
        offer(&mut driven, Move { tag, tool: 0, kind });
        // Half a second of motion and rest, with signs of life of the host.
        for _ in 0..10 {
            driven.run(50 * MILLISECOND);
            assert_eq!(driven.status().fault, None);
        }
        let (at, status) = (counts(&mut driven), driven.status());
        assert_eq!(status.state, State::Armed);
        for joint in 0..2 {
            let (axis, error) = (&settings.axes[joint], ERRORS[joint]);
            let ratio = f64::from(axis.gear_ratio);
            let per_count = TAU / f64::from(axis.encoder_counts);
            let turned = f64::from(at[joint].wrapping_sub(origin[joint])) * per_count;
            let shaft = measured(ratio * f64::from(start[joint]), error) + turned;
            let expected = (shaft - error(shaft)) / ratio;
            let off = (f64::from(status.angle[joint]) - expected).abs() * ratio.abs() / per_count;
            assert!(off < 3.0, "{off} counts, joint {joint}");
            let plain = f64::from(start[joint]) + turned / ratio;
            corrections[joint] = corrections[joint].max((expected - plain).abs());
        }
    }
    // Three counts are 0.15 mrad.
    assert!(
        corrections.iter().all(|error| *error > 4e-4),
        "{corrections:?}"
    );
}

#[test]
fn each_kind_of_tool_output_is_read_back() {
    let mut driven = Driven::new();
    for tool_output in [
        ToolOutputSettings::Servo {
            up_width: 1e-3,
            down_width: 1.5e-3,
            frame_rate: 50.0,
            down_time: 0.06,
            up_time: 0.04,
        },
        ToolOutputSettings::Switch {
            active_low: true,
            down_time: 0.1,
            up_time: 0.2,
        },
        ToolOutputSettings::Power {
            frequency: 5e3,
            scale_with_speed: true,
        },
        ToolOutputSettings::None,
    ] {
        let mut new = settings();
        new.tool_output = tool_output;
        let applied = driven.client.write_settings(&new).expect("a line");
        assert_eq!(applied, Ok(()));
        let mut found = settings();
        driven.client.read_settings(&mut found).expect("settings");
        assert_eq!(found.tool_output, tool_output);
    }
}
