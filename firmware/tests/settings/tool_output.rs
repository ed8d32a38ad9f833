//! The settings of the tool's output: their bounds, and the output at each level.

use crate::rig::{settings, with};
use fivebar_firmware::FULL_TOOL;
use fivebar_firmware::settings::{ALWAYS, EncoderTable, Field, SettingsError, ToolOutputSettings};

const SERVO: [f32; 5] = [1e-3, 1.5e-3, 50.0, 0.12, 0.08];

fn servo([up_width, down_width, frame_rate, down_time, up_time]: [f32; 5]) -> ToolOutputSettings {
    ToolOutputSettings::Servo {
        up_width,
        down_width,
        frame_rate,
        down_time,
        up_time,
    }
}

fn switch(active_low: bool) -> ToolOutputSettings {
    ToolOutputSettings::Switch {
        active_low,
        down_time: 0.0,
        up_time: 0.0,
    }
}

fn power(frequency: f32, scale_with_speed: bool) -> ToolOutputSettings {
    ToolOutputSettings::Power {
        frequency,
        scale_with_speed,
    }
}

fn refused(tool_output: ToolOutputSettings) -> Option<SettingsError> {
    with(|s| s.tool_output = tool_output).check().err()
}

#[test]
fn values_within_their_bounds_are_accepted() {
    for accepted in [
        ToolOutputSettings::None,
        servo(SERVO),
        servo([2e-3, 1e-4, 400.0, 0.0, 10.0]),
        servo([5e-3, 1e-3, 180.0, 0.0, 0.0]),
        switch(true),
        power(10.0, false),
        power(1e5, true),
    ] {
        assert_eq!(refused(accepted), None, "{accepted:?}");
    }
}

#[test]
fn each_value_out_of_its_bounds_is_refused_with_its_field() {
    for (index, value, field) in [
        (0, 0.9e-4, Field::ToolPulseWidth),
        (0, 5.1e-3, Field::ToolPulseWidth),
        (0, f32::NAN, Field::ToolPulseWidth),
        (0, SERVO[1], Field::ToolPulseWidth),
        (1, -1e-3, Field::ToolPulseWidth),
        (1, f32::INFINITY, Field::ToolPulseWidth),
        (2, 39.0, Field::ToolFrameRate),
        (2, 401.0, Field::ToolFrameRate),
        (2, f32::NAN, Field::ToolFrameRate),
        (3, -0.01, Field::ToolSettleTime),
        (3, 10.1, Field::ToolSettleTime),
        (4, f32::NAN, Field::ToolSettleTime),
    ] {
        let mut values = SERVO;
        values[index] = value;
        let error = refused(servo(values));
        assert_eq!(error, Some(SettingsError::Field(field)), "{values:?}");
    }
    // 3 ms of a frame of 3.2 ms.
    let longer = refused(servo([1e-3, 3e-3, 310.0, 0.1, 0.1]));
    assert_eq!(longer, Some(SettingsError::Field(Field::ToolPulseWidth)));
    for frequency in [9.9, 1.1e5, f32::NAN, -1.0] {
        let error = refused(power(frequency, false));
        assert_eq!(error, Some(SettingsError::Field(Field::ToolFrequency)));
    }
}

#[test]
fn levels_give_their_outputs_and_outputs_their_levels() {
    let at = |settings: ToolOutputSettings, level| settings.output(level, 0.1).at(0.1) - 0.5;
    // 5 % and 7.5 % of a frame, in 1/65536.
    assert!((at(servo(SERVO), 0) - 3276.8).abs() < 0.01);
    assert!((at(servo(SERVO), FULL_TOOL) - 4915.2).abs() < 0.01);
    assert_eq!(servo(SERVO).off(), 3277);
    assert!((servo(SERVO).level(4096) - 0.5).abs() < 1e-3);
    for (active_low, off, on) in [(false, 0, ALWAYS), (true, ALWAYS, 0)] {
        assert_eq!(switch(active_low).off(), off);
        assert_eq!(at(switch(active_low), 1), f32::from(on));
        assert_eq!(switch(active_low).level(on), 1.0);
        assert_eq!(switch(active_low).level(off), 0.0);
    }
    // All of it at the requested speed, half at half of it.
    assert_eq!(power(1e4, true).output(20_000, 0.2).at(0.1), 10_000.5);
    assert_eq!(power(1e4, false).output(20_000, 0.2).at(0.1), 20_000.5);
    assert_eq!(power(1e4, true).off(), 0);
    assert_eq!(ToolOutputSettings::None.level(FULL_TOOL), 1.0);
}

#[test]
fn the_longest_settings_fit_the_storage_with_their_number() {
    let mut settings = settings();
    settings.tool_output = servo(SERVO);
    settings.encoder_tables = [EncoderTable {
        shaft_ratio: 10.0,
        points: [[i16::MIN; 16]; 4],
    }; 2];
    let mut buffer = [0; 1024];
    let stored = postcard::to_slice(&settings, &mut buffer).unwrap();
    // The number, the key, and the padding to a word.
    assert!(stored.len() + 5 + 1 + 8 <= 1024, "{} bytes", stored.len());
}

#[test]
fn a_tool_settles_after_a_change_in_the_time_of_its_direction() {
    let (down_time, up_time) = (0.3, 0.2);
    let switch = ToolOutputSettings::Switch {
        active_low: true,
        down_time,
        up_time,
    };
    for (from, to, time) in [(0, 1, down_time), (1, 9, down_time), (9, 0, up_time)] {
        assert_eq!(switch.settle_time(from, to), time);
    }
}
