//! The arm follows a stream as it follows the same motion by timed pieces.

use crate::host::{MS, Streaming, sine};
use fivebar_firmware::motion::{StreamMode, StreamPhase};
use fivebar_firmware::safety::State;

#[test]
fn a_stream_is_followed_a_delay_later_and_ends_at_rest() {
    let mut stream = Streaming::begin(StreamMode::Tip, 25);
    let motion = sine(stream.rig.tool_position());
    let mut worst = 0.0_f64;
    for ms in 0..1000 {
        let point = stream.point(&motion, ms);
        stream.give(point);
        stream.ticks(MS);
        let status = stream.rig.controller.status();
        assert_eq!(status.fault, None, "{ms}: {:?}", stream.progress());
        if ms > 30 {
            let [x, y] = status.reference.expect("a reference");
            // The set-point of a tick leads the reference by the lag of the drives.
            let due = f64::from(ms + 1 - 25) * 1e-3 - 1.0 / 3500.0;
            let [[xd, yd], _] = motion(due);
            worst = worst.max((f64::from(x) - xd).hypot(f64::from(y) - yd));
        }
    }
    assert!(worst < 2e-6, "{worst}");
    assert_eq!(stream.phase(), StreamPhase::Follows);
    stream
        .rig
        .planner
        .end_stream(fivebar_firmware::motion::StreamReason::Asked);
    stream.ticks(1500);
    assert_eq!(stream.phase(), StreamPhase::Ended);
    assert_eq!(stream.rig.controller.state(), State::Armed);
}
