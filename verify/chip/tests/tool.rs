//! The tool's output on the pin PC7, by the registers of TIM3.

mod bench;

use bench::raised::{POWER, TICK, at_the_end, moving, offer, tool_at_start, tool_is_off};
use bench::{Driven, save};
use fivebar_chip::time::{MICROSECOND, MILLISECOND, Time};
use fivebar_chip::{Options, Pulses, ResetCause};
use fivebar_firmware::protocol::Reply;
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::settings::ToolOutputSettings;
use fivebar_firmware::{FULL_TOOL, Move, MoveKind, Request};

const SERVO: ToolOutputSettings = ToolOutputSettings::Servo {
    up_width: 1e-3,
    down_width: 1.5e-3,
    frame_rate: 50.0,
    down_time: 0.06,
    up_time: 0.04,
};
const UP: Time = MILLISECOND;
const DOWN: Time = 1500 * MICROSECOND;
const FRAME: Time = 20 * MILLISECOND;

fn ready(tool_output: ToolOutputSettings) -> Driven {
    at_the_end(Options::default()).ready_with(|settings| settings.tool_output = tool_output)
}

/// Asks for lines of 3 mm, one with the tool down between two with the tool up.
fn stroke(driven: &mut Driven) {
    let [x, y] = tool_at_start();
    for (tag, tool) in [(1, 0), (2, FULL_TOOL), (3, 0)] {
        let to = [x - 3e-3 * tag as f32, y];
        let kind = MoveKind::Line { to, feed: 0.1 };
        offer(driven, Move { tag, tool, kind });
    }
}

/// Runs until the path has ended, the host giving signs of life.
fn finish(driven: &mut Driven) {
    for _ in 0..40 {
        driven.run(50 * MILLISECOND);
        let status = driven.status();
        assert_eq!(status.fault, None);
        if status.state == State::Armed && status.tag.is_none() {
            return;
        }
    }
    panic!("the path does not end");
}

#[track_caller]
fn is_pulse(pulses: Pulses, width: Time, frame: Time) {
    let Pulses::Frames { high, frame: found } = pulses else {
        panic!("{pulses:?}");
    };
    // The counter's own step is 1 µs.
    assert!(high.abs_diff(width) <= MICROSECOND, "{pulses:?}");
    assert!(found.abs_diff(frame) <= frame / 1000, "{pulses:?}");
}

fn pin(driven: &Driven) -> Pulses {
    driven.arm.get().outputs().tool
}

#[test]
fn a_servo_gets_the_widths_of_its_settings_and_whole_pulses_only() {
    let mut driven = ready(SERVO);
    is_pulse(pin(&driven), UP, FRAME);
    driven.arm();
    driven.arm.get().forget();
    stroke(&mut driven);
    finish(&mut driven);
    let changes = driven.arm.get().tool.clone();
    assert_eq!(changes.len(), 2, "{changes:?}");
    let [(down_at, down), (up_at, up)] = [changes[0], changes[1]];
    is_pulse(down, DOWN, FRAME);
    is_pulse(up, UP, FRAME);
    // Changed by whole frames, so no pulse is cut.
    let frames = (up_at - down_at) as f64 / FRAME as f64;
    assert!((frames - frames.round()).abs() < 0.01, "{frames} frames");
    assert!(up_at - down_at > 60 * MILLISECOND);
    assert_eq!(driven.request(Request::Disarm), Ok(()));
    is_pulse(pin(&driven), UP, FRAME);
}

#[test]
fn an_emergency_stop_lifts_a_servo_in_its_tick() {
    let mut driven = ready(SERVO);
    driven.arm();
    stroke(&mut driven);
    let compare = |driven: &Driven| driven.chip().register(0x4000_0438).expect("TIM3_CCR2");
    for _ in 0..2000 {
        driven.run(TICK);
        if compare(&driven) == 1500 {
            break;
        }
    }
    assert_eq!(compare(&driven), 1500);
    driven.arm.get().press_stop(true);
    driven.chip().pins_changed();
    driven.run(2 * TICK);
    assert_eq!(compare(&driven), 1000, "from the next frame on");
    driven.run(FRAME);
    is_pulse(pin(&driven), UP, FRAME);
    assert_eq!(driven.status().fault, Some(Fault::EmergencyStop));
}

#[test]
fn a_power_gets_its_share_and_is_off_in_the_tick_of_an_emergency_stop() {
    let mut driven = moving();
    is_pulse(pin(&driven), 100 * MICROSECOND, 200 * MICROSECOND);
    driven.arm.get().forget();
    let pressed = driven.chip().now();
    driven.arm.get().press_stop(true);
    driven.chip().pins_changed();
    driven.run(2 * TICK);
    let (off_at, pulses) = driven.arm.get().tool[0];
    assert_eq!(pulses, Pulses::Level(false));
    assert!(off_at - pressed <= TICK + 50 * MICROSECOND);
}

#[test]
fn a_switch_is_high_or_low_all_the_time_in_either_polarity() {
    for active_low in [false, true] {
        let mut driven = ready(ToolOutputSettings::Switch {
            active_low,
            down_time: 0.01,
            up_time: 0.01,
        });
        assert_eq!(pin(&driven), Pulses::Level(active_low));
        driven.arm();
        driven.arm.get().forget();
        stroke(&mut driven);
        finish(&mut driven);
        let levels: Vec<Pulses> = driven
            .arm
            .get()
            .tool
            .iter()
            .map(|change| change.1)
            .collect();
        assert_eq!(
            levels,
            [Pulses::Level(!active_low), Pulses::Level(active_low)]
        );
    }
}

/// An active low tool would be on if the pin were low for an instant.
#[test]
fn the_pin_floats_without_settings_and_in_reset_and_is_never_on_at_a_start() {
    let mut driven = ready(ToolOutputSettings::None);
    assert_eq!(pin(&driven), Pulses::Released);
    assert!(driven.arm.get().tool.is_empty());
    drop(driven);
    driven = ready(ToolOutputSettings::Switch {
        active_low: true,
        down_time: 0.0,
        up_time: 0.0,
    });
    assert_eq!(save(&mut driven), Reply::Done);
    driven.chip().reset(ResetCause::Pin);
    assert_eq!(pin(&driven), Pulses::Released);
    driven.run(100 * MILLISECOND);
    let low = Pulses::Level(false);
    let changes = driven.arm.get().tool.clone();
    assert!(
        changes.iter().all(|&(_, pulses)| pulses != low),
        "{changes:?}"
    );
    assert_eq!(pin(&driven), Pulses::Level(true), "by the stored settings");
}

#[test]
fn a_servo_keeps_its_pulse_without_the_crystal() {
    let mut driven = ready(SERVO);
    driven.arm();
    driven.chip().crystal_fails();
    driven.run(3 * FRAME);
    let Pulses::Frames { high, frame } = pin(&driven) else {
        panic!("no pulses");
    };
    // The internal oscillator is good to 1 %.
    assert!(high.abs_diff(UP) <= UP / 50, "{high}");
    assert!(frame.abs_diff(FRAME) <= FRAME / 50, "{frame}");
}

#[test]
fn settings_change_the_kind_of_the_output() {
    let mut driven = ready(SERVO);
    driven.arm.get().forget();
    let mut settings = bench::settings();
    settings.tool_output = POWER;
    let applied = driven.client.write_settings(&settings).expect("a line");
    applied.expect("the settings are applied");
    driven.run(2 * TICK);
    assert!(tool_is_off(&driven));
    let changes = driven.arm.get().tool.clone();
    let off =
        |&(_, pulses): &(Time, Pulses)| matches!(pulses, Pulses::Released | Pulses::Level(false));
    assert!(changes.iter().all(off), "{changes:?}");
}
