//! The program, and its pages.

use crate::state::speed;
use fivebar_testkit::{Running, program};
use serde_json::{Value, json};
use std::io::{BufRead as _, BufReader, ErrorKind, Read as _, Write as _};
use std::net::TcpStream;
use std::process::{Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tungstenite::client::IntoClientRequest as _;
use tungstenite::http::HeaderValue;
use tungstenite::{Error, Message, WebSocket};

/// `fivebar serve`, which ends when this value is dropped.
pub(crate) struct Server {
    child: Running,
    pub(crate) host: String,
    /// Where senders of G-code connect, if the options ask for it.
    pub(crate) senders: String,
    token: String,
}

/// The machine, for as long as the guard lives. Tests take it that load the machine or measure
/// times: one at a time, while tests that mostly wait run beside them.
pub(crate) fn machine() -> MutexGuard<'static, ()> {
    static MACHINE: Mutex<()> = Mutex::new(());
    MACHINE.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Server {
    pub(crate) fn start(options: &[&str]) -> Self {
        Self::run(&mut program(env!("CARGO_BIN_EXE_fivebar")), options)
    }

    /// Starts it with at most so many open files.
    pub(crate) fn start_with_files(most: u32) -> Self {
        let limited = format!("ulimit -n {most}; exec \"$0\" \"$@\"");
        let mut shell = program("sh");
        Self::run(
            shell.args(["-c", &limited, env!("CARGO_BIN_EXE_fivebar")]),
            &[],
        )
    }

    fn run(program: &mut Command, options: &[&str]) -> Self {
        let mut child = Running::start(
            program
                .args(["serve", "--listen", "127.0.0.1:0"])
                .args(options)
                .stdout(Stdio::piped()),
        );
        let output = child.stdout.take().expect("its output");
        let mut output = BufReader::new(output);
        let mut line = String::new();
        output.read_line(&mut line).expect("a line of text");
        let mut senders = String::new();
        if options.contains(&"--senders") {
            output.read_line(&mut senders).expect("a line of text");
        }
        let senders = senders.split_whitespace().nth(1).unwrap_or_default();
        let (_, link) = line.trim().split_once("http://").expect("a link");
        let (host, token) = link.split_once("/?token=").expect("a token in the link");
        Self {
            child,
            host: host.into(),
            senders: senders.into(),
            token: token.into(),
        }
    }

    /// Starts it and homes its arm.
    pub(crate) fn start_homed(options: &[&str]) -> Self {
        let server = Self::start(options);
        let mut page = server.page();
        page.take_control_and_arm();
        page.request("disarm");
        page.state_named("Stopped");
        server
    }

    /// The cookie of a page that has shown the token.
    pub(crate) fn cookie(&self) -> String {
        let port = self.host.rsplit(':').next().expect("a port");
        format!("fivebar{port}={}", self.token)
    }

    /// The memory of the process [MB].
    pub(crate) fn memory(&self) -> f64 {
        self.megabytes("VmRSS:")
    }

    /// The most memory that the process has had [MB].
    pub(crate) fn peak_memory(&self) -> f64 {
        self.megabytes("VmHWM:")
    }

    fn megabytes(&self, key: &str) -> f64 {
        let path = format!("/proc/{}/status", self.child.id());
        let status = std::fs::read_to_string(path).expect("a process");
        let line = status.lines().find(|line| line.starts_with(key));
        let number = line.and_then(|line| line.split_whitespace().nth(1));
        number.expect("a number").parse::<f64>().expect("kB") / 1024.0
    }

    /// The processes that it has started and that run.
    pub(crate) fn children(&self) -> impl Iterator<Item = u32> {
        let parent = format!("PPid:\t{}\n", self.child.id());
        let processes = std::fs::read_dir("/proc").expect("a list of processes");
        processes.filter_map(move |entry| {
            let entry = entry.ok()?;
            let status = std::fs::read_to_string(entry.path().join("status")).ok()?;
            let number = entry.file_name().to_str()?.parse().ok()?;
            status.contains(&parent).then_some(number)
        })
    }

    pub(crate) fn open_files(&self) -> usize {
        let path = format!("/proc/{}/fd", self.child.id());
        std::fs::read_dir(path).expect("a process").count()
    }

    /// A connection, without a word.
    pub(crate) fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(&self.host).expect("a server");
        stream.set_nodelay(true).expect("an option");
        stream
            .set_write_timeout(Some(Duration::from_secs(10)))
            .expect("an option");
        stream
    }

    /// The status of the reply to a request.
    pub(crate) fn get(&self, path: &str, headers: &str) -> Option<u16> {
        let mut stream = self.connect();
        stream
            .set_read_timeout(Some(Duration::from_secs(10)))
            .ok()?;
        let request = format!(
            "GET {path} HTTP/1.1\r\nHost: {}\r\n{headers}Connection: close\r\n\r\n",
            self.host
        );
        stream.write_all(request.as_bytes()).ok()?;
        let mut reply = [0; 12];
        stream.read_exact(&mut reply).ok()?;
        std::str::from_utf8(&reply).ok()?.get(9..)?.parse().ok()
    }

    /// A page's websocket; none if the server refuses one.
    pub(crate) fn socket(&self) -> Option<WebSocket<TcpStream>> {
        let mut request = format!("ws://{}/live", self.host)
            .into_client_request()
            .expect("an address");
        let cookie = HeaderValue::from_str(&self.cookie()).expect("text");
        request.headers_mut().insert("Cookie", cookie);
        let stream = TcpStream::connect(&self.host).ok()?;
        stream.set_nodelay(true).ok()?;
        stream
            .set_write_timeout(Some(Duration::from_secs(10)))
            .ok()?;
        stream
            .set_read_timeout(Some(Duration::from_secs(10)))
            .ok()?;
        Some(tungstenite::client(request, stream).ok()?.0)
    }

    pub(crate) fn page(&self) -> Page {
        let socket = self.socket().expect("a websocket");
        socket
            .get_ref()
            .set_read_timeout(Some(Duration::from_millis(5)))
            .expect("a timeout");
        Page {
            socket,
            spoke: Instant::now(),
            lively: true,
            last_state: Value::Null,
        }
    }
}

/// A page that gives signs of life while it waits.
pub(crate) struct Page {
    pub(crate) socket: WebSocket<TcpStream>,
    spoke: Instant,
    pub(crate) lively: bool,
    /// The last state that was read.
    pub(crate) last_state: Value,
}

impl Page {
    pub(crate) fn send(&mut self, message: &Value) {
        self.spoke = Instant::now();
        let message = Message::text(message.to_string());
        self.socket.send(message).expect("the server listens");
    }

    pub(crate) fn request(&mut self, name: &str) {
        self.send(&json!({ "request": name }));
    }

    /// Gives a sign of life, if one is due.
    pub(crate) fn keep_alive(&mut self) {
        if self.lively && self.spoke.elapsed() > Duration::from_millis(50) {
            self.send(&json!("alive"));
        }
    }

    /// The next message, if one arrives soon.
    pub(crate) fn next(&mut self) -> Option<Value> {
        self.keep_alive();
        match self.socket.read() {
            Ok(Message::Text(text)) => {
                let message: Value = serde_json::from_str(&text).expect("JSON");
                if let Some(state) = message.get("state") {
                    self.last_state = state.clone();
                }
                Some(message)
            }
            Ok(_) => None,
            Err(Error::Io(error))
                if matches!(
                    error.kind(),
                    ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
                ) =>
            {
                None
            }
            Err(error) => panic!("the connection is lost: {error}"),
        }
    }

    /// The next message for which `wanted` returns a value.
    pub(crate) fn wait<T>(&mut self, what: &str, wanted: impl Fn(&Value) -> Option<T>) -> T {
        let deadline = Instant::now() + Duration::from_secs(180);
        let mut last = [Value::Null, Value::Null];
        while Instant::now() < deadline {
            let Some(message) = self.next() else { continue };
            if let Some(found) = wanted(&message) {
                return found;
            }
            let kind = usize::from(message.get("notice").is_some());
            last[kind] = message;
        }
        panic!("waited in vain for {what}; the last messages were {last:?}");
    }

    /// Waits until the server confirms a stop of this name.
    pub(crate) fn stopped(&mut self, name: &str) {
        self.wait("a confirmation", |message| {
            (message.get("stopped")? == name).then_some(())
        });
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

    /// The latest state: those that have arrived already are read, then one more is awaited.
    pub(crate) fn latest_state(&mut self) -> Value {
        while self.next().is_some() {}
        self.state("a state", |_| true)
    }

    /// Takes control of an arm that rests, and arms it.
    pub(crate) fn take_control_and_arm(&mut self) {
        let deadline = Instant::now() + Duration::from_secs(30);
        loop {
            // Again, because a page that floods gets control if this one is silent for a while.
            self.send(&json!("control"));
            let state = self.latest_state();
            match state["state"].as_str() {
                Some("Armed") => return,
                // The fault of an arm that still swings cannot be cleared yet.
                Some("Fault") => self.request("clear_fault"),
                // Both are refused in the first second after a fault is cleared.
                Some("Stopped") if state["homed"] == true => self.request("arm"),
                Some("Stopped") => self.request("home"),
                _ => {}
            }
            assert!(Instant::now() < deadline, "it cannot be armed: {state}");
            let asked = Instant::now();
            while asked.elapsed() < Duration::from_millis(50) {
                self.next();
            }
        }
    }

    /// Runs a job of lines to and fro, about half a minute long.
    pub(crate) fn run_long_job(&mut self) {
        let text = format!("G21 G90 F18000\nM3\n{}", "G1 X40\nG1 X0\n".repeat(60));
        self.send(&json!({ "load": { "name": "long", "text": text } }));
        self.send(&json!("run"));
        self.state("full speed", |state| {
            state["state"] == "Running" && speed(state) > 0.5
        });
    }
}
