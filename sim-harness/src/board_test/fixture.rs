//! The settings with which a bare board runs, and the wires that it needs.
//!
//! Without motors nothing answers to a duty, so the settings describe an arm whose motors could not answer
//! visibly either: windings of 36 Ω, whose current stays below what the checks of a motor can tell from
//! zero. The paths are smaller than the error that shows a stopped encoder. So the controller arms, plans
//! and follows paths as on an arm, and no check trips.

use fivebar_firmware::settings::{HomingMethod, ToolOutputSettings};
use fivebar_firmware::{Move, MoveKind, Settings};

/// What to connect before anything is measured.
pub(super) const FIXTURE: &str = "Take the motors off. Connect PC0, PC1 and PC2 to 1.65 V each (two \
     resistors of 1 kΩ, one to 3.3 V, one to ground; or the amplifiers and the divider with their supplies on), \
     PB0 and PB1 to 3.3 V (or the bridges), and PB12 to ground (or the released emergency stop)";

/// The pulse of the tool's output on PC7 while the tool is up, and from one to the next [ticks].
pub(super) const PULSE_TICKS: u32 = 20;
pub(super) const FRAME_TICKS: u32 = 200;

/// θ1, θ4 [rad]: in the middle of the workspace.
pub(super) const ANGLES: [f32; 2] = [2.2, 0.9];
/// Radius of the circle that is followed [m]. A millimetre turns a joint by 0.01 rad.
const RADIUS: f32 = 0.0005;
/// Lines of a circle, and the speed along them [m/s].
const LINES: f32 = 63.0;
const FEED: f32 = 0.02;

/// The settings.
pub fn bare_settings() -> Settings {
    let mut settings = Settings::BENCHTOP;
    // Open inputs of home switches read pressed; this method looks at none.
    settings.home_reference.method = HomingMethod::Given;
    for axis in &mut settings.axes {
        axis.resistance = 36.0;
        axis.inductance = 3.75e-3;
        axis.continuous_current = axis.peak_current;
    }
    let protection = &mut settings.protection;
    protection.following_error = 0.99;
    protection.bus_voltage = [4.0, 36.0];
    protection.bus_voltage_per_code = 9e-3;
    settings.tool_output = ToolOutputSettings::Servo {
        up_width: 2e-3,
        down_width: 1e-3,
        frame_rate: 50.0,
        down_time: 0.02,
        up_time: 0.02,
    };
    settings
}

/// The line number `tag` around a circle through `start` [m].
pub fn small_move(tag: u32, [x, y]: [f32; 2]) -> Move {
    let angle = (tag as f32 / LINES).fract() * std::f32::consts::TAU;
    let to = [x + RADIUS * (angle.cos() - 1.0), y + RADIUS * angle.sin()];
    let kind = MoveKind::Line { to, feed: FEED };
    Move { tag, tool: 0, kind }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fivebar_firmware::drives::BrushedSample;
    use fivebar_firmware::safety::State;
    use fivebar_firmware::settings::BoardLimits;
    use fivebar_firmware::{Controller, Planner, Request, SensorSample};

    /// A bare board with the wires of the fixture.
    const SAMPLE: SensorSample = SensorSample {
        counts: [0; 2],
        drives: BrushedSample {
            current: [2048; 2],
            bus_voltage: 2048,
        },
        home: [true; 2],
        index: [true; 2],
        emergency_stop: false,
        driver_fault: [false; 2],
        missed_ticks: 0,
    };

    #[test]
    fn a_board_without_motors_follows_small_paths_without_a_fault() {
        let settings = bare_settings();
        assert_eq!(BoardLimits::STM32F405.check(&settings), Ok(()));
        let settings = settings.check().expect("valid settings");
        let mut controller = Controller::new(&settings);
        let mut planner = Planner::new(&settings);
        for _ in 0..3000 {
            controller.tick(&SAMPLE);
        }
        controller
            .request(Request::SetAngles(ANGLES))
            .expect("rest");
        controller.request(Request::Arm).expect("armed");
        for _ in 0..300 {
            controller.tick(&SAMPLE);
        }
        let start = controller.status().tool.expect("a tool");
        let (mut tag, mut running) = (0, 0);
        for tick in 0..100_000_u32 {
            if tick.is_multiple_of(20) {
                controller.feed_host_timeout();
                if planner.free_slots() > 0 {
                    tag += 1;
                    let next = small_move(tag, start);
                    planner.push(&mut controller, &next).expect("accepted");
                }
                planner.run(&mut controller);
            }
            controller.tick(&SAMPLE);
            assert_eq!(controller.status().fault, None, "tick {tick}");
            running += u32::from(controller.state() == State::Running);
        }
        assert!(running > 99_000 && tag > 3000, "{running} {tag}");
    }
}
