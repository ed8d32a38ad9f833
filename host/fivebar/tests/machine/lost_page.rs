//! The arm rests soon after the page in control is lost.

use crate::program::{Page, Server, machine};
use crate::state::{speed, time};
use crate::stops::{self, EndOnDrop, large_job, under_load};
use serde_json::json;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Joints slower than this rest [rad/s].
const REST: f64 = 0.05;

/// The time [s] from `lost` until the arm moves no more, as the watcher sees it.
pub(crate) fn time_to_rest(watcher: &mut Page, lost: f64) -> f64 {
    let mut moved = lost;
    loop {
        let state = watcher.state("a state", |state| time(state) > lost);
        if speed(&state) > REST {
            moved = time(&state);
        }
        // The path has corners, in which the arm is slow for a moment.
        if time(&state) > moved + 0.2 {
            assert_eq!(state["state"], "Fault");
            return moved - lost;
        }
        assert!(moved < lost + 5.0, "the arm does not stop");
    }
}

/// Sends 900 harmless requests a second for this long.
fn flood(page: &mut Page, duration: Duration) {
    let start = Instant::now();
    let mut sent = 0;
    while start.elapsed() < duration {
        let due = start + sent * Duration::from_micros(1_000_000 / 900);
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
        page.send(&json!("control"));
        sent += 1;
    }
}

#[test]
fn the_arm_rests_within_700_ms_after_a_flooding_page_is_lost_while_others_flood_and_load_too() {
    let server = Server::start_homed(&[]);
    let _machine = machine();
    let mut watcher = server.page();
    let ends = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let _end = EndOnDrop(&ends);
        for closes in [true, false] {
            let mut page = server.page();
            page.take_control_and_arm();
            page.run_long_job();
            flood(&mut page, Duration::from_secs(1));
            if closes {
                // A page that is not in control: its jobs are read, and refused.
                scope.spawn(|| stops::flood(&server, &large_job(10), None, &ends));
            }
            let rests = under_load(&server, &json!("run"), || {
                flood(&mut page, Duration::from_millis(500));
                let lost = time(&watcher.latest_state());
                page.lively = false;
                let page = (!closes).then_some(page);
                let rests = time_to_rest(&mut watcher, lost);
                drop(page);
                rests
            });
            eprintln!("closed: {closes}; at rest under load after {rests:.3} s");
            assert!(rests < 0.7, "{rests} s");
        }
    });
}
