//! `fivebar bridge`, and a plain client in place of a sender.

use std::io::{BufRead as _, BufReader, ErrorKind, Read as _, Write as _};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Longest wait for an answer. Homing takes a few seconds.
pub(crate) const LONGEST: Duration = Duration::from_secs(30);

/// The program, which ends when this value is dropped.
pub(crate) struct Bridge {
    pub(crate) child: Child,
    pub(crate) address: String,
    pub(crate) terminal: String,
}

impl Bridge {
    pub(crate) fn start() -> Self {
        Self::start_with(&["--listen", "127.0.0.1:0"])
    }

    pub(crate) fn start_with(options: &[&str]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_fivebar"))
            .arg("bridge")
            .args(options)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let mut line = String::new();
        BufReader::new(child.stdout.take().expect("its output"))
            .read_line(&mut line)
            .expect("a line of text");
        let (address, terminal) = line.trim().split_once(' ').expect("two words");
        Self {
            child,
            address: address.into(),
            terminal: terminal.into(),
        }
    }

    pub(crate) fn connect(&self) -> Sender {
        Sender::connect(&self.address)
    }
}

impl Drop for Bridge {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

pub(crate) struct Sender {
    pub(crate) stream: TcpStream,
    received: String,
}

impl Sender {
    pub(crate) fn connect(address: &str) -> Self {
        let stream = TcpStream::connect(address).expect("a bridge");
        let timeout = Some(Duration::from_millis(20));
        stream.set_read_timeout(timeout).expect("a timeout");
        Self {
            stream,
            received: String::new(),
        }
    }

    pub(crate) fn send(&mut self, text: &str) {
        self.stream
            .write_all(text.as_bytes())
            .expect("a bridge that reads");
    }

    /// The next line that is not empty.
    pub(crate) fn line(&mut self) -> String {
        let deadline = Instant::now() + LONGEST;
        loop {
            if let Some((line, rest)) = self.received.split_once('\n') {
                let (line, rest) = (line.trim().to_owned(), rest.to_owned());
                self.received = rest;
                if !line.is_empty() {
                    return line;
                }
                continue;
            }
            assert!(
                Instant::now() < deadline,
                "no answer; received: {}",
                self.received
            );
            let mut bytes = [0; 1024];
            match self.stream.read(&mut bytes) {
                Ok(0) => panic!("the bridge has closed the connection"),
                Ok(count) => self.received += &String::from_utf8_lossy(&bytes[..count]),
                Err(error)
                    if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
                Err(error) => panic!("{error}"),
            }
        }
    }

    /// Sends a line; returns the answer with what came before it.
    pub(crate) fn ask(&mut self, text: &str) -> String {
        self.send(&format!("{text}\n"));
        let mut all = String::new();
        loop {
            let line = self.line();
            all += &line;
            if line.starts_with("ok") || line.starts_with("error:") {
                return all;
            }
            all.push(' ');
        }
    }

    /// State and machine position [mm] of a report.
    pub(crate) fn report(&mut self) -> (String, [f64; 2]) {
        self.send("?");
        loop {
            let line = self.line();
            let Some(report) = line.strip_prefix('<') else {
                continue;
            };
            let (state, rest) = report.split_once("|MPos:").expect("a position");
            let numbers: Vec<f64> = rest
                .split(['|', ','])
                .take(2)
                .map(|number| number.parse().expect("a number"))
                .collect();
            return (state.into(), [numbers[0], numbers[1]]);
        }
    }

    pub(crate) fn wait_for(&mut self, state: &str) -> [f64; 2] {
        let deadline = Instant::now() + LONGEST;
        loop {
            let (now, position) = self.report();
            if now == state {
                return position;
            }
            assert!(Instant::now() < deadline, "{now}, not {state}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    pub(crate) fn home(&mut self) {
        assert!(self.ask("$H").ends_with("ok"));
    }
}

pub(crate) fn near([x, y]: [f64; 2], [to_x, to_y]: [f64; 2], within: f64) -> bool {
    (x - to_x).hypot(y - to_y) < within
}
