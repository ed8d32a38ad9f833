//! A controller on a port that delivers its replies every 16 ms, as an FTDI adapter does.

use crate::lost_page::time_to_rest;
use crate::program::{Server, machine};
use crate::state::time;
use crate::stops::stops_under_load;
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_files::scenario::Scenario;
use fivebar_firmware::ActuatorCommand;
use fivebar_sim::link::Loopback;
use fivebar_sim::simulation::Simulate;
use serde_json::json;
use serialport::{SerialPort as _, TTYPort};
use std::io::{Read as _, Write as _};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
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
    notes: Notes,
}

/// What the board has noted.
type Notes = Arc<Mutex<Noted>>;

#[derive(Default)]
struct Noted {
    powered: bool,
    /// When the bridges went off.
    off: Vec<Instant>,
    /// Each round trip: the last look at the port before a command was there, and the delivery of
    /// its reply.
    round_trips: Vec<[Instant; 2]>,
}

/// Locks the notes, also if another test's assertion failed meanwhile.
fn note<T>(notes: &Notes, body: impl FnOnce(&mut Noted) -> T) -> T {
    body(&mut notes.lock().unwrap_or_else(PoisonError::into_inner))
}

impl Board {
    fn start() -> Self {
        let (far, near) = TTYPort::pair().expect("a pseudo-terminal");
        let port = near.name().expect("a name");
        let ends = Arc::new(AtomicBool::new(false));
        let notes = Notes::default();
        let (end, own) = (Arc::clone(&ends), Arc::clone(&notes));
        let thread = Some(std::thread::spawn(move || run(far, &near, &end, &own)));
        Self {
            ends,
            thread,
            port,
            notes,
        }
    }

    /// The time [s] from a request to the bridges' being off, and the longest round trip [s] between
    /// them.
    fn times(&self, asked: Instant) -> [f64; 2] {
        note(&self.notes, |noted| {
            let off = noted.off.iter().find(|off| **off > asked);
            let off = *off.expect("the bridges went off");
            let between = |trip: &&[Instant; 2]| trip[1] > asked && trip[0] < off;
            let trips = noted.round_trips.iter().filter(between);
            let longest = trips.map(|[from, to]| *to - *from).max();
            let longest = longest.expect("the stop arrived in a round trip");
            [off - asked, longest].map(|time| time.as_secs_f64())
        })
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
fn run(mut far: TTYPort, _near: &TTYPort, ends: &AtomicBool, notes: &Notes) {
    far.set_timeout(STEP).expect("a timeout");
    let robot = Robot::load(BuiltIn::DEFAULT).expect("the default robot");
    let settings = robot.settings().expect("masses");
    let period = 1.0 / robot.control.tick_rate;
    let mut plant = Scenario::new("port", robot, "port", String::new())
        .plant()
        .expect("masses");
    let mut due = Instant::now();
    let own = Arc::clone(notes);
    let arm = move |command: &ActuatorCommand| {
        let powered = command.enable != [false; 2];
        note(&own, |noted| {
            if noted.powered && !powered {
                noted.off.push(Instant::now());
            }
            noted.powered = powered;
        });
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
    let controller = Loopback::driving(&settings, Box::new(arm));
    let mut controller: Loopback = controller.expect("valid settings");
    let mut bytes = [0; 512];
    let mut waiting = Vec::new();
    let mut delivered = Instant::now();
    let mut looked = Instant::now();
    // Since when a command waits for the delivery of its reply.
    let mut begun = None;
    while !ends.load(Ordering::Relaxed) {
        let received = far.read(&mut bytes).unwrap_or(0);
        if received > 0 && begun.is_none() {
            begun = Some(looked);
        }
        looked = Instant::now();
        controller
            .write_all(&bytes[..received])
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
            if let Some(begun) = begun.take() {
                note(notes, |noted| noted.round_trips.push([begun, delivered]));
            }
        }
    }
}

#[test]
fn over_a_slow_port_an_emergency_stop_takes_50_ms_and_one_round_trip_at_most() {
    let board = Board::start();
    let server = Server::start_homed(&["--port", &board.port]);
    let _machine = machine();
    let stops = stops_under_load(&server, &json!({ "request": "home" }), &[0, 0, 0, 8, 8, 8]);
    let times: Vec<_> = stops.iter().map(|stop| board.times(stop.asked)).collect();
    eprintln!("emergency stops over a slow port, with their round trips: {times:.3?} s");
    let in_time = |times: &[[f64; 2]]| {
        let in_time = |[stop, round_trip]: &&[f64; 2]| *stop < 0.05 + round_trip;
        times.iter().filter(in_time).count()
    };
    // A busy machine may delay one of three. A job in the way of the stop would take seconds.
    let (flooded, loading) = times.split_at(3);
    assert!(in_time(flooded) >= 2, "{flooded:.3?} s");
    assert!(in_time(loading) >= 2, "{loading:.3?} s");
    assert!(stops.iter().all(|stop| stop.real < 2.0), "{stops:.3?}");
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
