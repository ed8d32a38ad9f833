//! The page's server in this process, by a clock that the test passes: what a test finds does not depend on how busy the
//! machine is.
//!
//! A page has a number for each request. The server's threads that read pages answer numbered signs of life at once, so
//! a page knows what has been read; the thread of the controller answers all else when it is handled.

use fivebar::bridge::for_pages;
use fivebar::serve::{Guard, ServeError, ServeOptions, serve};
use fivebar_files::job::JobReader;
use fivebar_files::robot::Robot;
use fivebar_sim::clock::Clock;
use fivebar_sim::controller::{ControllerSource, Hand};
use serde_json::{Value, json};
use std::collections::VecDeque;
use std::io::Read as _;
use std::net::{SocketAddr, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;
use tungstenite::client::IntoClientRequest as _;
use tungstenite::http::HeaderValue;
use tungstenite::{Message, WebSocket};

/// Time between two signs of life of a page.
const ALIVE: Duration = Duration::from_millis(50);
/// Time within which the thread of the controller has handled what pages have sent.
pub(crate) const HANDLED: Duration = Duration::from_millis(30);
/// Time within which the arm is sampled for a state.
const SAMPLED: Duration = Duration::from_millis(40);
/// Messages and turns of 40 ms after which a wait is in vain. Other threads read and plan jobs meanwhile, for which no
/// time passes.
const TURNS: usize = 5000;

fn built_in(name: &str) -> Robot {
    Robot::load(name).expect("a robot")
}

/// A server of a simulated arm, which ends when this value is dropped.
pub(crate) struct Server {
    pub(crate) clock: Clock,
    address: SocketAddr,
    token: String,
    ends: Arc<AtomicBool>,
    thread: Option<JoinHandle<Result<(), ServeError>>>,
    /// What pages have kept in the robot file.
    pub(crate) kept: Arc<Mutex<Vec<String>>>,
}

impl Server {
    /// A server of the benchtop arm.
    pub(crate) fn start() -> Self {
        Self::of("benchtop", None)
    }

    /// A server of this built-in robot, whose jobs are time-optimal with a share of the torque if one is given.
    pub(crate) fn of(robot: &str, time_optimal: Option<f64>) -> Self {
        Self::with(built_in(robot), time_optimal, JobReader::default(), None)
    }

    /// A server of any robot.
    pub(crate) fn of_robot(robot: Robot) -> Self {
        Self::with(robot, None, JobReader::default(), None)
    }

    /// A server of the benchtop arm whose jobs this reader reads.
    pub(crate) fn reading_by(jobs: JobReader) -> Self {
        Self::with(built_in("benchtop"), None, jobs, None)
    }

    /// A server of a robot whose tip this hand leads when it grips.
    pub(crate) fn led(robot: Robot, hand: &Hand) -> Self {
        Self::with(robot, None, JobReader::default(), Some(hand.clone()))
    }

    fn with(robot: Robot, time_optimal: Option<f64>, jobs: JobReader, hand: Option<Hand>) -> Self {
        let clock = Clock::simulated();
        let guard = Guard::with_new_token().expect("random numbers");
        let token = guard.token().to_owned();
        let ends = Arc::new(AtomicBool::new(false));
        let (ready, at) = mpsc::channel();
        let (time, end) = (clock.clone(), Arc::clone(&ends));
        let kept = Arc::<Mutex<Vec<String>>>::default();
        let keeps = Arc::clone(&kept);
        let thread = std::thread::spawn(move || {
            let options = ServeOptions {
                address: "127.0.0.1:0".parse().expect("an address"),
                guard,
                senders: for_pages(None),
                time_optimal,
                keep: Box::new(move |values| {
                    let lines = values
                        .iter()
                        .map(|one| format!("{:?} = {}", one.key, one.value));
                    keeps.lock().expect("no panic").extend(lines);
                    Ok(())
                }),
                jobs,
                clock: time.clone(),
            };
            let ready = |address, _: Option<&_>| {
                // From now on the test passes the time.
                time.hold();
                ready.send(address).expect("a test that waits");
            };
            let ends = move || end.load(Ordering::Relaxed);
            let source = match &hand {
                Some(hand) => ControllerSource::Led(hand),
                None => ControllerSource::Simulated,
            };
            serve(&robot, source, options, ready, ends)
        });
        Self {
            clock,
            address: at.recv().expect("a server"),
            token,
            ends,
            thread: Some(thread),
            kept,
        }
    }

    pub(crate) fn page(&self) -> Page {
        let address = self.address;
        let stream = TcpStream::connect(address).expect("a server");
        stream.set_nodelay(true).expect("an option");
        let mut request = format!("ws://{address}/live")
            .into_client_request()
            .expect("an address");
        let cookie = format!("fivebar{}={}", address.port(), self.token);
        let cookie = HeaderValue::from_str(&cookie).expect("text");
        request.headers_mut().insert("Cookie", cookie);
        let (socket, _) = tungstenite::client(request, stream).expect("a websocket");
        let mut page = Page {
            socket,
            clock: self.clock.clone(),
            number: 0,
            unread: VecDeque::new(),
            tick: 0,
            renews: None,
        };
        page.take("hello", |_| Some(()));
        page
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Relaxed);
        self.clock.release();
        let ended = self.thread.take().map(JoinHandle::join);
        if !std::thread::panicking() {
            ended
                .expect("a thread")
                .expect("no panic")
                .expect("no error");
        }
    }
}

/// A page. Time passes by its methods only.
pub(crate) struct Page {
    socket: WebSocket<TcpStream>,
    clock: Clock,
    /// The number of the last request.
    number: u64,
    /// Messages that were read while another one was awaited.
    unread: VecDeque<Value>,
    /// The tick of the latest state that was read.
    tick: u64,
    /// The held motion that it renews as long as time passes.
    pub(crate) renews: Option<u64>,
}

/// What the server made of a request.
#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) number: u64,
    pub(crate) refused: Option<String>,
    /// The tick of the last state that does not show it.
    pub(crate) tick: u64,
}

impl Page {
    /// Sends a request, whose number is returned.
    pub(crate) fn begin(&mut self, request: &Value) -> u64 {
        self.number += 1;
        let mut numbered = match request {
            Value::String(name) => json!({ name: null }),
            object => object.clone(),
        };
        numbered["number"] = self.number.into();
        self.write(&numbered);
        self.number
    }

    fn write(&mut self, message: &Value) {
        let message = Message::text(message.to_string());
        self.socket.send(message).expect("the server listens");
    }

    /// The next message that the server has sent.
    fn read(&mut self) -> Value {
        loop {
            match self.socket.read().expect("a message") {
                Message::Text(text) => {
                    let message: Value = serde_json::from_str(&text).expect("JSON");
                    if let Some(tick) = message["state"]["tick"].as_u64() {
                        self.tick = tick;
                    }
                    return message;
                }
                _ => continue,
            }
        }
    }

    /// The next message. If none waits, time passes until the arm has been sampled.
    pub(crate) fn next(&mut self) -> Value {
        if self.unread.is_empty() {
            let before = self.tick;
            self.pass(SAMPLED);
            // New settings make the controller count its ticks anew.
            while self.tick == before {
                let message = self.read();
                self.unread.push_back(message);
            }
        }
        self.unread.pop_front().expect("a state")
    }

    /// The next message for which `wanted` returns a value.
    pub(crate) fn wait<T>(&mut self, what: &str, wanted: impl Fn(&Value) -> Option<T>) -> T {
        let mut last = [Value::Null, Value::Null];
        for _ in 0..TURNS {
            let message = self.next();
            if let Some(found) = wanted(&message) {
                return found;
            }
            let kind = usize::from(message.get("notice").is_some());
            last[kind] = message;
        }
        panic!("waited in vain for {what}; the last messages were {last:?}");
    }

    /// The content of the next message with this key for which `wanted` returns a value.
    fn take<T>(&mut self, key: &str, wanted: impl Fn(&Value) -> Option<T>) -> T {
        let found = |message: &Value| message.get(key).and_then(&wanted);
        let mut index = 0;
        while let Some(message) = self.unread.get(index) {
            if let Some(found) = found(message) {
                self.unread.remove(index);
                return found;
            }
            index += 1;
        }
        loop {
            let message = self.read();
            if let Some(found) = found(&message) {
                return found;
            }
            self.unread.push_back(message);
        }
    }

    pub(crate) fn take_answer(&mut self, number: u64) -> Value {
        self.take("answer", |answer| {
            (answer["number"] == number).then(|| answer.clone())
        })
    }

    /// All that it has sent has been read when this returns; no time passes.
    pub(crate) fn be_read(&mut self) {
        let alive = self.begin(&json!("alive"));
        self.take_answer(alive);
    }

    /// Passes time, and shows signs of life meanwhile.
    pub(crate) fn pass(&mut self, mut time: Duration) {
        while !time.is_zero() {
            if let Some(renew) = self.renews {
                self.write(&json!({ "renew": renew }));
            }
            self.be_read();
            let part = time.min(ALIVE);
            self.clock.advance(part);
            time -= part;
        }
    }

    /// Makes a request, accepted or not. States that are older than its answer are forgotten.
    pub(crate) fn send(&mut self, request: &Value) {
        let tick = self.ask(request).tick;
        self.unread
            .retain(|message| message["state"]["tick"].as_u64().is_none_or(|it| it > tick));
    }

    /// Makes a request and waits for its answer.
    pub(crate) fn ask(&mut self, request: &Value) -> Answer {
        let number = self.begin(request);
        self.pass(HANDLED);
        let answer = self.take_answer(number);
        Answer {
            number,
            refused: answer["refused"].as_str().map(str::to_owned),
            tick: answer["tick"].as_u64().expect("a tick"),
        }
    }

    /// Makes a request that the server accepts.
    pub(crate) fn accepted(&mut self, request: &Value) -> Answer {
        let answer = self.ask(request);
        assert_eq!(answer.refused, None, "{request}");
        answer
    }

    /// Makes a request of the controller.
    pub(crate) fn request(&mut self, name: &str) -> Answer {
        self.accepted(&json!({ "request": name }))
    }

    /// A state that is newer than all that pages have asked for.
    pub(crate) fn latest_state(&mut self) -> Value {
        // It renews nothing and is answered in its turn.
        self.send(&json!({ "renew": 0 }));
        self.state("a state", |_| true)
    }

    /// The next state for which `wanted` holds.
    pub(crate) fn state(&mut self, what: &str, wanted: impl Fn(&Value) -> bool) -> Value {
        self.wait(what, |message| {
            let state = message.get("state")?;
            wanted(state).then(|| state.clone())
        })
    }

    pub(crate) fn state_named(&mut self, name: &str) -> Value {
        self.state(name, |state| state["state"] == name)
    }

    /// Waits until the server confirms a stop of this name.
    pub(crate) fn stopped(&mut self, name: &str) {
        self.wait("a confirmation", |message| {
            (message.get("stopped")? == name).then_some(())
        });
    }

    /// Waits for a refusal with these words.
    pub(crate) fn refused(&mut self, words: &str) {
        self.wait(words, |message| {
            let notice = message.get("notice")?;
            let text = notice["text"].as_str()?;
            (notice["refused"] == true && text.contains(words)).then_some(())
        });
    }

    /// Waits until the arm rests with its motors on, and nothing that a page has asked for is pending.
    pub(crate) fn until_rest(&mut self) -> Value {
        self.latest_state();
        self.state("rest", |state| {
            state["state"] == "Armed" && state["pending"] == false
        })
    }

    /// Takes control of an arm that rests, and switches its motors on.
    pub(crate) fn take_control_and_arm(&mut self) {
        loop {
            self.send(&json!("control"));
            let state = self.latest_state();
            match state["state"].as_str() {
                Some("Armed") => return,
                // The fault of an arm that still swings cannot be cleared yet.
                Some("Fault") => self.send(&json!({ "request": "clear_fault" })),
                // Both are refused in the first second after a fault is cleared.
                Some("Stopped") if state["homed"] == true => {
                    self.send(&json!({ "request": "arm" }));
                }
                Some("Stopped") => self.send(&json!({ "request": "home" })),
                _ => {}
            }
        }
    }
}

impl Drop for Page {
    /// Closes the connection; the server knows when this returns.
    fn drop(&mut self) {
        let _ = self.socket.close(None);
        let mut bytes = [0; 1024];
        while self
            .socket
            .get_mut()
            .read(&mut bytes)
            .is_ok_and(|count| count > 0)
        {}
    }
}
