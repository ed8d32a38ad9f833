//! The emergency stop while other pages do what they can to delay it.

use crate::program::{Page, Server, machine};
use serde_json::{Value, json};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::time::{Duration, Instant};
use tungstenite::{Message, WebSocket};

/// An emergency stop.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stopped {
    pub(crate) asked: Instant,
    /// From its sending to its message [s].
    pub(crate) real: f64,
}

/// Stops the arm at once.
pub(crate) fn emergency_stop(page: &mut Page) -> Stopped {
    // A server that hangs sends no states: the stop must not wait for one.
    while page.next().is_some() {}
    let asked = Instant::now();
    page.request("emergency_stop");
    page.wait("the fault", |message| {
        (message.get("fault")?.get("name")? == "emergency stop").then_some(())
    });
    let real = asked.elapsed().as_secs_f64();
    let state = page.state_named("Fault");
    assert_eq!(state["duty"], json!([0.0, 0.0]), "the bridges are off");
    Stopped { asked, real }
}

/// Runs `body` while ten pages read nothing and two flood: one with 900 requests a second, one with
/// this message as fast as it can.
pub(crate) fn under_load<T>(server: &Server, message: &Value, body: impl FnOnce() -> T) -> T {
    let ends = AtomicBool::new(false);
    let silent: Vec<_> = (0..10).map(|_| server.socket().expect("a place")).collect();
    let result = std::thread::scope(|scope| {
        let _end = EndOnDrop(&ends);
        let ends = &ends;
        scope.spawn(|| flood(server, &json!({ "jog": [0.0, 0.0] }), Some(900), ends));
        scope.spawn(|| flood(server, message, None, ends));
        body()
    });
    drop(silent);
    result
}

/// Emergency stops of a page under this load, while another page takes control and loads so many jobs
/// of 10 MB.
pub(crate) fn stops_under_load(server: &Server, message: &Value, jobs: &[usize]) -> Vec<Stopped> {
    let job = large_job(10).to_string();
    let mut page = server.page();
    // Without a page in control a flooding one would get it.
    page.take_control_and_arm();
    emergency_stop(&mut page);
    let stop_while_loading = |&count: &usize| {
        page.take_control_and_arm();
        let ends = AtomicBool::new(false);
        std::thread::scope(|scope| {
            let _end = EndOnDrop(&ends);
            let mut loading = server.socket().expect("a place");
            let (job, ends) = (&job, &ends);
            let (begun, begins) = mpsc::channel();
            scope.spawn(move || {
                send(&mut loading, &json!("control"));
                for _ in 0..count {
                    let _ = loading.send(Message::text(job.clone()));
                    let _ = begun.send(());
                }
                drop(begun);
                while !ends.load(Ordering::Relaxed) && loading.read().is_ok() {}
            });
            // The first job has arrived; the others are on their way.
            while let Err(mpsc::TryRecvError::Empty) = begins.try_recv() {
                page.next();
            }
            let begun = Instant::now();
            while begun.elapsed() < Duration::from_millis(50) {
                page.next();
            }
            emergency_stop(&mut page)
        })
    };
    under_load(server, message, || {
        jobs.iter().map(stop_while_loading).collect()
    })
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
    let server = Server::start_homed(&[]);
    let _machine = machine();
    let times = stops_under_load(&server, &json!("run"), &[8, 8, 8]);
    eprintln!("emergency stops under load took {times:.3?}");
    let mut real: Vec<f64> = times.iter().map(|time| time.real).collect();
    real.sort_by(f64::total_cmp);
    // A busy machine may delay one of them, by far less than a queue or a job would.
    assert!(real[1] < 0.1 && real[2] < 1.0, "{times:.3?}");
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
    for _ in 0..2000 {
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
    assert!(
        reason.contains("messages or frames in a second"),
        "{reason}"
    );
    page.take_control_and_arm();
}
