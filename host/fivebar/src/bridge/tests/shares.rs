//! The shares of speed and power that a user chooses.

use super::rig::Rig;
use crate::bridge::events::{changed, part};
use crate::bridge::protocol::ShareChange;
use fivebar_firmware::safety::State;

#[test]
fn a_share_is_set_or_changed_by_percents() {
    assert_eq!(part(25), 0.25);
    assert_eq!(part(300), 3.0);
    assert_eq!(changed(0.5, ShareChange::To(100)), 1.0);
    assert_eq!(changed(0.5, ShareChange::By(10)), 0.6);
    assert_eq!(changed(0.5, ShareChange::By(-1)), 0.49);
}

#[test]
fn reports_show_the_shares_that_were_asked_for() {
    let mut rig = Rig::homed();
    let sender = rig.connect();
    // A connection's first line shows that it is a sender's; nothing is done before.
    rig.asked(&sender, "G91\n");
    for (byte, shares) in [
        (0x92, "90,100,100"),
        (0x94, "89,100,100"),
        (0x93, "90,100,100"),
        (0x96, "90,50,100"),
        (0x91, "100,50,100"),
        (0x92, "90,50,100"),
        (0x90, "100,50,100"),
        (0x95, "100,100,100"),
    ] {
        sender.send(&[byte]);
        let report = rig.report(&sender);
        assert!(report.contains(&format!("|Ov:{shares}>")), "{report}");
    }
    sender.say("M220 S40\n");
    rig.round();
    assert!(rig.report(&sender).contains("|Ov:40,40,100>"));
}

#[test]
fn half_the_feed_rate_takes_twice_the_time() {
    let rounds = |bytes: &[u8]| {
        let mut rig = Rig::homed();
        let sender = rig.connect();
        sender.send(bytes);
        sender.say("G91 G1 X-30 F900\n");
        rig.until(|rig| rig.state() == State::Running);
        let start = rig.status().tick;
        rig.until(|rig| rig.rests() && rig.state() == State::Armed);
        f64::from(rig.status().tick - start)
    };
    let whole = rounds(&[]);
    let half = rounds(&[0x92; 5]);
    assert!((half / whole - 2.0).abs() < 0.1, "{whole} {half}");
}
