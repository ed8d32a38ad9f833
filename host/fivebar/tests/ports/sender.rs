//! A plain client in place of a sender of G-code.

use std::io::{ErrorKind, Read as _, Write as _};
use std::net::TcpStream;
use std::time::Duration;

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
        loop {
            if let Some((line, rest)) = self.received.split_once('\n') {
                let (line, rest) = (line.trim().to_owned(), rest.to_owned());
                self.received = rest;
                if !line.is_empty() {
                    return line;
                }
                continue;
            }
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
        loop {
            let (now, position) = self.report();
            if now == state {
                return position;
            }
        }
    }

    pub(crate) fn home(&mut self) {
        assert!(self.ask("$H").ends_with("ok"));
    }
}
