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

/// The loops take the torque back that the simulated arm, which has no such friction, does not need; so only that it acts is
/// looked at here, and its size on the desktop.
#[test]
fn the_friction_acts_while_the_tool_is_on_and_not_while_it_is_off() {
    let torque = |friction, tool| drawing(friction, tool).torque;
    assert_ne!(torque(FRICTION, FULL_TOOL), torque(0.0, FULL_TOOL));
    assert_eq!(torque(FRICTION, 0), torque(0.0, 0));
}
