//! The arm follows moves, and stops on its path.

use crate::rig::{Rig, settings};
use fivebar_firmware::MoveKind;
use fivebar_firmware::controller::Request;
use fivebar_firmware::safety::State;

fn line(to: [f32; 2], feed: f32) -> MoveKind {
    MoveKind::Line { to, feed }
}

#[test]
fn follows_a_line_within_tens_of_micrometres_and_ends_at_rest() {
    let mut rig = Rig::armed(&settings());
    let [x, y] = rig.tool_position();
    let to = [x - 0.03, y + 0.02];
    rig.push(7, line(to, 0.1)).unwrap();
    rig.tick();
    assert_eq!(rig.controller.status().state, State::Running);
    assert_eq!(rig.controller.status().tag, Some(7));
    let mut worst = 0.0_f64;
    let mut ticks = 0;
    while rig.controller.state() == State::Running {
        let [tx, ty] = rig.bench.tool();
        rig.tick();
        let Some([rx, ry]) = rig.controller.status().reference else {
            panic!("{:?}", rig.controller.fault());
        };
        worst = worst.max((tx - f64::from(rx)).hypot(ty - f64::from(ry)));
        ticks += 1;
        assert!(ticks < 20_000);
    }
    assert_eq!(
        rig.controller.status().state,
        State::Armed,
        "{:?}",
        rig.controller.fault()
    );
    rig.run(500);
    let [tx, ty] = rig.bench.tool();
    let end = (tx - f64::from(to[0])).hypot(ty - f64::from(to[1]));
    assert!(end < 3e-5, "{end} m off the end");
    assert!(worst < 3e-5, "{worst} m off the path");
}

#[test]
fn stops_on_the_path_on_request() {
    let mut rig = Rig::armed(&settings());
    let [x, y] = rig.tool_position();
    rig.push(1, line([x - 0.06, y], 0.2)).unwrap();
    rig.run(1500);
    assert_eq!(rig.controller.state(), State::Running);
    rig.controller.request(Request::Stop).unwrap();
    assert_eq!(rig.controller.state(), State::Stopping);
    rig.run(2000);
    assert_eq!(rig.controller.state(), State::Armed);
    let [tx, ty] = rig.bench.tool();
    assert!(
        (ty - f64::from(y)).abs() < 2e-5,
        "left the line: {ty} for {y}"
    );
    assert!(tx < f64::from(x) - 0.01 && tx > f64::from(x) - 0.059);
    // The rest of the path is dropped; new moves start here.
    rig.run(2000);
    assert!((rig.bench.tool()[0] - tx).abs() < 2e-5);
    rig.push(2, line([x, y], 0.1)).unwrap();
    rig.run(12_000);
    assert!((rig.bench.tool()[0] - f64::from(x)).abs() < 2e-5);
}

/// Its gains at rest are a tenth of those in motion.
#[test]
fn an_arm_that_moves_on_after_a_rest_is_as_stiff_as_before() {
    let error_in_motion = |rest: u32| {
        let mut rig = Rig::armed(&settings());
        rig.run(rest);
        let [x, y] = rig.tool_position();
        let to = [x - 0.04, y];
        rig.push(3, MoveKind::Line { to, feed: 0.1 }).unwrap();
        rig.run(1000);
        rig.bench.push = [0.1, 0.0];
        let mut greatest = 0.0_f32;
        for _ in 0..300 {
            rig.tick();
            let status = rig.controller.status();
            assert_eq!(status.state, State::Running);
            let reference = status.joint_reference.unwrap();
            greatest = greatest.max((status.angle[0] - reference.angle[0]).abs());
        }
        greatest
    };
    let (soon, late) = (error_in_motion(0), error_in_motion(20_000));
    assert!(late < 1.2 * soon && soon > 1e-4, "{soon}, {late} rad");
}
