//! The emergency stop while other pages do what they can to delay it.

use crate::program::{Page, Server, number, period, time};
use serde_json::{Value, json};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use tungstenite::{Message, WebSocket};

/// From the emergency stop to the tick that switched the bridges off [s]. The stop is sent after
/// a state, so this is too long by up to the time between two states, 33 ms.
pub(crate) fn time_to_emergency_stop(page: &mut Page) -> f64 {
    let before = page.latest_state();
    page.request("emergency_stop");
    let tick = page.wait("the fault", |message| {
        let fault = message.get("fault")?;
        (fault.get("name")? == "emergency stop").then(|| number(&fault["tick"]))
    });
    let state = page.state_named("Fault");
    assert_eq!(state["duty"], json!([0.0, 0.0]), "the bridges are off");
    tick * period(&before) - time(&before)
}

/// Ends a flood, also when a test fails.
pub(crate) struct EndOnDrop<'a>(pub(crate) &'a AtomicBool);

impl Drop for EndOnDrop<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

fn send(socket: &mut WebSocket<std::net::TcpStream>, message: &Value) -> bool {
    socket.send(Message::text(message.to_string())).is_ok()
}

/// Sends a message `rate` times a second, or as fast as possible, until `ends`. A page that is
/// disconnected connects again.
pub(crate) fn flood(server: &Server, message: &Value, rate: Option<u32>, ends: &AtomicBool) {
    let Some(mut socket) = server.socket() else {
        return;
    };
    let start = Instant::now();
    let mut sent = 0;
    while !ends.load(Ordering::Relaxed) {
        if let Some(rate) = rate {
            let due = start + sent * Duration::from_secs(1) / rate;
            std::thread::sleep(due.saturating_duration_since(Instant::now()));
        }
        sent += 1;
        if !send(&mut socket, message) {
            let Some(again) = server.socket() else { return };
            socket = again;
        }
    }
}

/// A job of this size [MB] that takes long to read and to check.
pub(crate) fn large_job(megabytes: usize) -> Value {
    let line = "G1 X10.000 Y0.000\nG1 X0.000 Y0.000\n";
    let text = format!(
        "G21 G90 F6000\n{}",
        line.repeat((megabytes << 20) / line.len())
    );
    json!({ "load": { "name": "large", "text": text } })
}

#[test]
fn an_emergency_stop_takes_effect_within_100_ms_while_other_pages_flood_and_load_and_read_nothing()
{
    let server = Server::start(&[]);
    let mut page = server.page();
    page.take_control_and_arm();
    let ends = AtomicBool::new(false);
    let end = EndOnDrop(&ends);
    let mut times = Vec::new();
    std::thread::scope(|scope| {
        let end = end;
        let silent: Vec<_> = (0..10).map(|_| server.socket().expect("a place")).collect();
        scope.spawn(|| flood(&server, &json!({ "jog": [0.0, 0.0] }), Some(900), &ends));
        scope.spawn(|| flood(&server, &json!("run"), None, &ends));
        let job = large_job(10);
        for _ in 0..8 {
            page.send(&job);
        }
        for _ in 0..5 {
            times.push(time_to_emergency_stop(&mut page));
            page.take_control_and_arm();
        }
        drop(end);
        drop(silent);
    });
    // A pause of this machine may fall into one of them.
    times.sort_by(f64::total_cmp);
    eprintln!("emergency stops under load took {times:.3?} s");
    assert!(times[2] < 0.1 && times[4] < 0.5, "{times:.3?} s");
}

#[test]
fn a_page_that_reads_nothing_can_still_stop_the_arm() {
    let server = Server::start(&[]);
    let mut page = server.page();
    page.take_control_and_arm();
    let mut silent = server.socket().expect("a place");
    // By then the server can send it no more.
    let filled = Instant::now();
    while filled.elapsed() < Duration::from_millis(500) {
        page.next();
        assert!(send(&mut silent, &json!("no request")));
    }
    assert!(send(&mut silent, &json!({ "request": "emergency_stop" })));
    page.state_named("Fault");
}

#[test]
fn a_page_that_floods_stops_is_disconnected_with_a_reason_and_the_others_are_served() {
    let server = Server::start(&[]);
    let mut page = server.page();
    page.latest_state();
    let mut flooding = server.socket().expect("a place");
    for _ in 0..200 {
        if !send(&mut flooding, &json!({ "request": "stop" })) {
            break;
        }
    }
    let reason = loop {
        match flooding.read().expect("a reason, then the end") {
            Message::Close(frame) => break frame.expect("a reason").reason.to_string(),
            _ => continue,
        }
    };
    assert!(reason.contains("stops in a second"), "{reason}");
    page.take_control_and_arm();
}

#[test]
fn a_stop_drops_the_moves_that_were_asked_for_before_it() {
    let server = Server::start(&[]);
    let mut page = server.page();
    page.take_control_and_arm();
    let before = page.latest_state();
    // All arrive at once; the stop overtakes the jog.
    for message in [
        json!({ "jog": [0.0, 0.02] }),
        json!({ "request": "emergency_stop" }),
        json!({ "request": "clear_fault" }),
    ] {
        page.send(&message);
    }
    page.state_named("Stopped");
    page.request("arm");
    page.state_named("Armed");
    let start = time(&page.latest_state());
    let after = page.state("some time", |state| time(state) > start + 0.3);
    let moved = number(&after["tool"][1]) - number(&before["tool"][1]);
    assert!(moved.abs() < 1e-3, "{moved} m");
}
