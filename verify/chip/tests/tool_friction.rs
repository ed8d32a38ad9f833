//! The friction of a tool that is on is fed forward by the production image.

mod bench;

use bench::raised::{POWER, at_the_end, offer, tool_at_start};
use fivebar_chip::Options;
use fivebar_chip::time::MILLISECOND;
use fivebar_firmware::{FULL_TOOL, Move, MoveKind, Status};

/// The friction that the settings state [N].
const FRICTION: f32 = 0.3;
/// [m/s].
const SPEED: f32 = 0.1;

/// A moment of a line that is drawn with the tool on or off, with settings that state this friction.
fn drawing(friction: f32, tool: u16) -> Status {
    let mut driven = at_the_end(Options::default()).ready_with(|settings| {
        settings.tool_output = POWER;
        settings.advanced.pen_friction = friction;
    });
    driven.arm();
    let [x, y] = tool_at_start();
    let (to, feed) = ([x - 0.06, y], SPEED);
    let kind = MoveKind::Line { to, feed };
    offer(&mut driven, Move { tag: 1, tool, kind });
    driven.run(60 * MILLISECOND);
    driven.status()
}

#[test]
fn the_torques_of_a_tool_that_is_on_have_the_power_that_its_friction_takes() {
    // The simulated arm has no such friction, so its loops take some of the torque back.
    let power = |friction, tool| {
        let Status {
            torque, velocity, ..
        } = drawing(friction, tool);
        torque[0] * velocity[0] + torque[1] * velocity[1]
    };
    let without = power(0.0, FULL_TOOL);
    let more = power(FRICTION, FULL_TOOL) - without;
    let taken = FRICTION * SPEED;
    assert!(
        more > 0.2 * taken && more < 1.3 * taken,
        "{more} W of {taken}"
    );
    // A tool that is off needs nothing.
    assert!((power(FRICTION, 0) - power(0.0, 0)).abs() < 1e-6);
}
