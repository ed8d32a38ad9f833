//! An arm whose page is closed.

use crate::in_process::Server;
use serde_json::json;
use std::time::Duration;

/// The page closes in each phase of what comes after a motion: the arm rests in all of them, and no fault comes before the
/// controller switches off an arm that nobody commands.
#[test]
fn an_arm_that_rests_when_its_page_is_closed_stays_held_and_is_switched_off_after_a_minute() {
    let server = Server::start();
    let mut watcher = server.page();
    let mut page = server.page();
    page.take_control_and_arm();
    for (turn, request) in [
        json!({ "jog": [0.002, 0.0] }),
        json!({ "jog_joint": { "joint": "theta1", "by": 0.02 } }),
        json!({ "follow": [0.05, 0.16] }),
    ]
    .iter()
    .enumerate()
    {
        page.accepted(request);
        page.until_rest();
        page.pass(7 * turn as u32 * Duration::from_millis(1));
        drop(page);
        watcher.pass(Duration::from_secs(2));
        let state = watcher.latest_state();
        assert_eq!(state["state"], "Armed", "{request}: {state}");
        assert_eq!(state["alive"], false);
        page = server.page();
        page.accepted(&json!("control"));
    }
    drop(page);
    watcher.pass(Duration::from_secs(59));
    let state = watcher.latest_state();
    assert_eq!(state["state"], "Armed", "{state}");
    watcher.pass(Duration::from_secs(2));
    let state = watcher.latest_state();
    assert_eq!(
        (&state["state"], &state["fault"]),
        (&"Fault".into(), &12.into())
    );
}
