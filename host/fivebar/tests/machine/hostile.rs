//! Clients that try to exhaust the server.

use crate::program::{Page, Server, machine};
use serde_json::json;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// The most memory that the server may take [MB].
const MEMORY: f64 = 100.0;

/// The page is still in control, and gets states.
fn is_in_control(page: &mut Page) {
    let state = page.latest_state();
    assert_eq!(state["alive"], true);
    assert_eq!(state["state"], "Armed", "nothing has stopped the arm");
    page.send(&json!({ "jog": [0.0, 0.005] }));
    page.state("a move", |state| state["state"] == "Running");
    page.state_named("Armed");
}

/// 300 requests that are half sent, and 700 connections without a word.
fn hold_connections(server: &Server, page: &mut Page) -> Vec<TcpStream> {
    let long = "x".repeat(60_000);
    let half = |_| {
        let mut stream = server.connect();
        // The server may have closed it already.
        let _ = write!(
            stream,
            "GET / HTTP/1.1\r\nHost: {}\r\nA: {long}",
            server.host
        );
        page.keep_alive();
        stream
    };
    let mut held: Vec<_> = (0..300).map(half).collect();
    held.extend((0..700).map(|_| {
        page.keep_alive();
        server.connect()
    }));
    held
}

#[test]
fn a_request_that_stays_unfinished_is_closed() {
    let server = Server::start(&[]);
    let mut stream = server.connect();
    write!(stream, "GET / HTTP/1.1\r\nHost: {}\r\n", server.host).expect("a server");
    stream
        .set_read_timeout(Some(Duration::from_secs(15)))
        .expect("an option");
    let asked = Instant::now();
    let mut rest = Vec::new();
    let _ = stream.read_to_end(&mut rest);
    assert!(
        asked.elapsed() < Duration::from_secs(10),
        "it waits no longer"
    );
}

/// A message with a key of this size.
fn key(megabytes: usize) -> String {
    format!(r#"{{"{}":1}}"#, "k".repeat(megabytes << 20))
}

/// The header of a text frame of 60 MB, masked by zeros: longer than the page in control may send.
fn too_long() -> Vec<u8> {
    let length = (60_u64 << 20).to_be_bytes();
    [&[0x81, 0xff][..], &length, &[0; 4]].concat()
}

/// Six connections begin messages of 60 MB, and six a message that goes on in empty frames.
fn send_keys_and_empty_frames(server: &Server, page: &mut Page) {
    std::thread::scope(|scope| {
        for _ in 0..6 {
            scope.spawn(|| {
                let mut hostile = server.socket().expect("a place");
                // The server closes the connection while the message is sent.
                let _ = hostile.get_mut().write_all(&too_long());
                let _ = hostile.get_mut().write_all(key(15).as_bytes());
                while let Ok(message) = hostile.read() {
                    assert!(message.len() < 10_000, "{} bytes came back", message.len());
                }
            });
            scope.spawn(|| {
                let mut hostile = server.socket().expect("a place");
                // A text message that goes on without end in empty parts, each masked by zeros.
                let stream = hostile.get_mut();
                let mut frames = vec![0x01, 0x80, 0, 0, 0, 0];
                frames.extend([0x00, 0x80, 0, 0, 0, 0].repeat(10_000));
                let started = Instant::now();
                while stream.write_all(&frames[..]).is_ok() {
                    frames.drain(..frames.len().min(6));
                    frames.extend([0x00, 0x80, 0, 0, 0, 0]);
                    assert!(started.elapsed() < Duration::from_secs(10), "it goes on");
                }
            });
        }
        let start = Instant::now();
        while start.elapsed() < Duration::from_secs(1) {
            page.next();
        }
    });
}

#[test]
fn half_requests_and_connections_and_long_keys_and_empty_frames_at_once_leave_the_page_unharmed() {
    let server = Server::start_homed(&[]);
    let _machine = machine();
    let mut page = server.page();
    page.take_control_and_arm();
    let held = hold_connections(&server, &mut page);
    is_in_control(&mut page);
    let cookie = format!("Cookie: {}\r\n", server.cookie());
    assert_eq!(server.get("/app.js", &cookie), Some(200));
    assert!(server.open_files() < 200, "{} files", server.open_files());
    send_keys_and_empty_frames(&server, &mut page);
    // The page in control may send long messages; others hear nothing of a bad one.
    let mut watcher = server.page();
    page.send(&serde_json::from_str(&key(10)).expect("JSON"));
    let refusal = page.wait("a refusal", |message| {
        Some(message.get("notice")?["text"].as_str()?.to_owned())
    });
    assert!(refusal.contains("kkk") && refusal.len() < 1000, "{refusal}");
    let start = Instant::now();
    while start.elapsed() < Duration::from_millis(300) {
        page.next();
        if let Some(message) = watcher.next() {
            assert!(message.get("notice").is_none(), "{message}");
        }
    }
    is_in_control(&mut page);
    let peak = server.peak_memory();
    eprintln!("at once, at most {peak:.0} MB");
    assert!(peak < MEMORY, "{peak} MB");
    drop(held);
}

#[test]
fn a_second_host_and_a_missing_token_are_refused_on_the_loopback_address() {
    let server = Server::start(&[]);
    let cookie = format!("Cookie: {}\r\n", server.cookie());
    assert_eq!(server.get("/", &cookie), Some(200));
    assert_eq!(server.get("/", ""), Some(401));
    assert_eq!(server.get("/live", ""), Some(401));
    let two = format!("{cookie}Host: example.org\r\n");
    assert_eq!(server.get("/", &two), Some(400));
}

#[test]
fn a_page_that_joins_gets_the_job_without_the_others_getting_it_again() {
    let server = Server::start(&[]);
    let mut page = server.page();
    page.take_control_and_arm();
    page.send(&json!({ "load": { "name": "square", "text": "G21 F600\nG1 X20\n" } }));
    let has_job = |message: &serde_json::Value| message.get("job").is_some();
    // Its time comes behind it.
    page.wait("the job's time", |message| {
        message.get("job")?.get("time")?.as_f64()
    });
    let mut joining = server.page();
    joining.wait("the job", |message| has_job(message).then_some(()));
    let start = Instant::now();
    while start.elapsed() < Duration::from_millis(300) {
        let message = page.next();
        assert!(!message.is_some_and(|message| has_job(&message)));
    }
}

#[test]
fn the_page_in_control_loads_a_file_of_50_mb() {
    let server = Server::start(&[]);
    let mut page = server.page();
    page.take_control_and_arm();
    let comment = format!(";{}\n", "x".repeat(1000));
    let text = format!("G21 F600\nG1 X20\n{}", comment.repeat(50_000));
    page.send(&json!({ "load": { "name": "large", "text": text } }));
    let moves = page.wait("the job", |message| {
        message.get("job")?.get("moves")?.as_u64()
    });
    assert_eq!(moves, 1);
}

#[test]
fn a_page_connects_beside_300_silent_connections_although_the_system_allows_64_open_files() {
    let server = Server::start_with_files(64);
    let held: Vec<_> = (0..300).map(|_| server.connect()).collect();
    let deadline = Instant::now() + Duration::from_secs(3);
    let socket = loop {
        if let Some(socket) = server.socket() {
            break socket;
        }
        assert!(Instant::now() < deadline, "no page connects");
    };
    drop(socket);
    let pages: Vec<_> = (0..4)
        .map(|_| {
            let mut page = server.page();
            page.latest_state();
            page
        })
        .collect();
    assert!(server.open_files() < 64);
    drop((held, pages));
}
