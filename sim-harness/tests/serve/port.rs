//! A controller on a port that delivers its replies every 16 ms, as an FTDI adapter does.

use crate::lost_page::time_to_rest;
use crate::program::{Server, machine, time};
use crate::stops::{StopTimes, stops_under_load};
use fivebar::input::robot::{BuiltIn, Robot};
use fivebar::input::scenario::Scenario;
use fivebar::run::link::Loopback;
use fivebar_firmware::ActuatorCommand;
use serde_json::json;
use serialport::{SerialPort as _, TTYPort};
use std::io::{Read as _, Write as _};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Time between two deliveries of the adapter.
const LATENCY: Duration = Duration::from_millis(16);
/// Time between two looks of the board at its port.
const STEP: Duration = Duration::from_millis(1);

/// A controller with the simulated arm at the far end of a serial port.
struct Board {
    ends: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    port: String,
}

impl Board {
    fn start() -> Self {
        let (far, near) = TTYPort::pair().expect("a pseudo-terminal");
        let port = near.name().expect("a name");
        let ends = Arc::new(AtomicBool::new(false));
        let end = Arc::clone(&ends);
        let thread = Some(std::thread::spawn(move || run(far, &near, &end)));
        Self { ends, thread, port }
    }
}

impl Drop for Board {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Keeps the near end open: reads of the far end fail while nobody has the port open.
fn run(mut far: TTYPort, _near: &TTYPort, ends: &AtomicBool) {
    far.set_timeout(STEP).expect("a timeout");
    let robot = Robot::load(BuiltIn::DEFAULT).expect("the default robot");
    let settings = robot.settings().expect("masses");
    let period = 1.0 / robot.control.tick_rate;
    let mut plant = Scenario::new("port", robot, "port", String::new())
        .plant()
        .expect("masses");
    let mut due = Instant::now();
    let arm = move |command: &ActuatorCommand| {
        // Real time, and slower on a busy machine, which does not catch up.
        due += Duration::from_secs_f64(period);
        let now = Instant::now();
        if due > now + STEP {
            std::thread::sleep(due - now);
        } else if due + 10 * STEP < now {
            due = now;
        }
        plant.step(command, period);
        plant.sense()
    };
    let mut controller = Loopback::driving(&settings, Box::new(arm)).expect("valid settings");
    let mut bytes = [0; 512];
    let mut waiting = Vec::new();
    let mut delivered = Instant::now();
    while !ends.load(Ordering::Relaxed) {
        let heard = far.read(&mut bytes).unwrap_or(0);
        controller
            .write_all(&bytes[..heard])
            .expect("a perfect line");
        // A read passes 10 ms of the controller's time, unless a reply waits.
        while let Ok(said) = controller.read(&mut bytes) {
            waiting.extend_from_slice(&bytes[..said]);
            if said < bytes.len() {
                break;
            }
        }
        if delivered.elapsed() >= LATENCY && !waiting.is_empty() {
            delivered = Instant::now();
            // The write fails if the server has ended.
            let _ = far.write_all(&waiting);
            waiting.clear();
        }
    }
}

#[test]
fn over_a_slow_port_an_emergency_stop_waits_for_one_round_trip_at_most() {
    let board = Board::start();
    let server = Server::start_homed(&["--port", &board.port]);
    let _machine = machine();
    let times = stops_under_load(&server, &json!({ "request": "home" }), &[0, 0, 0, 8, 8, 8]);
    eprintln!("emergency stops over a slow port took {times:.3?}");
    // 50 ms and a round trip (16 ms for the reply that is awaited, 16 ms of the board's own
    // looks), and up to 50 ms between the state from which the time counts and the stop.
    let in_time = |times: &[StopTimes]| times.iter().filter(|time| time.controller < 0.13).count();
    let (flooded, loading) = times.split_at(3);
    assert!(in_time(flooded) >= 2, "{flooded:.3?} s");
    // While jobs of 10 MB are sent and read, this process's board does not always get its time: on
    // two cores it stands still for up to 0.2 s. A job in the way of the stop would take seconds.
    assert!(in_time(loading) >= 1, "{loading:.3?} s");
    assert!(times.iter().all(|time| time.real < 2.0), "{times:.3?} s");
}

#[test]
fn over_a_slow_port_the_arm_rests_within_700_ms_after_its_page_is_lost() {
    let board = Board::start();
    let server = Server::start_homed(&["--port", &board.port]);
    let _machine = machine();
    let mut watcher = server.page();
    let mut page = server.page();
    page.take_control_and_arm();
    page.run_long_job();
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(1) {
        page.send(&json!("control"));
        page.send(&json!({ "request": "clear_fault" }));
        std::thread::sleep(Duration::from_millis(5));
    }
    let lost = time(&watcher.latest_state());
    drop(page);
    let rests = time_to_rest(&mut watcher, lost);
    eprintln!("over a slow port at rest after {rests:.3} s");
    assert!(rests < 0.7, "{rests} s");
}
