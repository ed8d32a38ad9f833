//! A sender of G-code at the endpoint of the live page's server.

use crate::program::Server;
use crate::state::{number, speed, time};
use serde_json::{Value, json};
use std::io::{BufRead as _, BufReader, Write as _};
use std::net::TcpStream;
use std::thread::sleep;
use std::time::Duration;

/// A sender; the lines that it receives.
struct Sender {
    stream: TcpStream,
    lines: BufReader<TcpStream>,
}

impl Sender {
    fn connect(server: &Server) -> Self {
        let stream = TcpStream::connect(&server.senders).expect("an endpoint");
        let longest = Some(Duration::from_secs(30));
        stream.set_read_timeout(longest).expect("a timeout");
        let lines = BufReader::new(stream.try_clone().expect("a second handle"));
        Self { stream, lines }
    }

    fn send(&mut self, text: &[u8]) {
        self.stream.write_all(text).expect("a server that reads");
    }

    /// Waits for a line with these words.
    fn wait_for(&mut self, words: &str) {
        let mut line = String::new();
        while !line.contains(words) {
            line.clear();
            let count = self.lines.read_line(&mut line).expect("an answer in time");
            assert!(count > 0, "no {words} before the end");
        }
    }
}

#[test]
fn a_sender_moves_the_arm_while_pages_watch_and_any_page_stops_it() {
    let server = Server::start(&["--senders", "127.0.0.1:0"]);
    let mut page = server.page();
    page.latest_state();
    let mut sender = Sender::connect(&server);
    sender.wait_for("Grbl 1.1");
    sender.send(b"$H\n");
    sender.wait_for("ok");
    // Long enough for a page that is read late.
    sender.send(b"G21 G91 F1200\n");
    for _ in 0..5 {
        sender.send(b"G1 X30\nG1 X-30\n");
    }
    // A page that is read late still gets states of the homing.
    let running = |state: &Value| state["state"] == "Running" && speed(state) > 0.1;
    let state = page.state("a moving arm", running);
    assert_eq!(state["sender"], true);
    page.request("disarm");
    page.wait("a refusal", |message| {
        let text = message["notice"]["text"].as_str()?;
        text.contains("sender of G-code is in control")
            .then_some(())
    });
    page.request("stop");
    page.state("rest", |state| state["state"] == "Armed");
    sender.send(b"?");
    sender.wait_for("<Hold:0");
    sender.send(b"~");
    page.state("the way on", running);
    page.request("emergency_stop");
    sender.wait_for("ALARM:3");
    page.state_named("Fault");
    // A program that answers the stop by itself clears nothing.
    sender.send(b"$X\n");
    sender.wait_for("error:9");
    sleep(Duration::from_secs(3));
    sender.send(b"$X\n");
    sender.wait_for("ok");
    drop(sender);
    page.state("the page's turn", |state| state["sender"] == false);
    page.take_control_and_arm();
}

#[test]
fn a_sender_is_not_admitted_while_a_page_moves_the_arm() {
    let server = Server::start(&["--senders", "127.0.0.1:0"]);
    let mut page = server.page();
    page.take_control_and_arm();
    page.run_long_job();
    let mut sender = Sender::connect(&server);
    sender.wait_for("the live page moves the arm");
    let begun = time(&page.latest_state());
    let state = page.state("a second", |state| time(state) > begun + 1.0);
    assert!(state["state"] == "Running" && number(&state["left"]) > 1.0);
    page.request("stop");
    page.state_named("Armed");
    page.send(&json!("alive"));
    let mut sender = Sender::connect(&server);
    sender.wait_for("Grbl 1.1");
}

#[test]
fn an_emergency_stop_is_latched_and_confirmed_while_a_sender_is_connected_and_the_bridges_are_off()
{
    let server = Server::start(&["--senders", "127.0.0.1:0"]);
    let mut page = server.page();
    page.latest_state();
    let mut sender = Sender::connect(&server);
    sender.wait_for("Grbl 1.1");
    page.state("the sender", |state| state["sender"] == true);
    page.request("emergency_stop");
    page.stopped("emergency_stop");
    let state = page.state_named("Fault");
    assert_eq!(state["fault"], 10);
    sender.wait_for("ALARM:3");
    for line in ["$H\n", "G28\n", "$X\n"] {
        sender.send(line.as_bytes());
        sender.wait_for("error:9");
    }
    // Nor by a new connection, again and again.
    for _ in 0..5 {
        drop(sender);
        // Not one of the states that have waited since the last sender left.
        page.latest_state();
        page.state("no sender", |state| state["sender"] == false);
        sender = Sender::connect(&server);
        sender.wait_for("Grbl 1.1");
        sender.send(b"\x18$X\n$H\n");
        sender.wait_for("error:9");
        sender.wait_for("error:9");
    }
    assert_eq!(page.latest_state()["state"], "Fault");
}

#[test]
fn pages_are_warned_that_no_password_protects_the_senders_address() {
    let server = Server::start(&["--senders", "127.0.0.1:0"]);
    let mut page = server.page();
    let warning = format!("no password protects {}", server.senders);
    page.wait("a warning", |message| {
        let text = message["notice"]["text"].as_str()?;
        text.contains(&warning).then_some(())
    });
    let _sender = Sender::connect(&server);
    page.wait("a peer", |message| {
        let text = message["notice"]["text"].as_str()?;
        text.contains("a sender is connected: 127.0.0.1")
            .then_some(())
    });
}
