//! The server's memory over many clients.

use crate::program::Server;
use crate::stops::large_job;
use serde_json::json;
use std::time::{Duration, Instant};
use tungstenite::Message;

/// Clients come and go for `SOAK_MINUTES` (60 by default). The memory is printed every tenth of
/// that time; after the first tenth it may grow by 5 MB.
///
/// `SOAK_MINUTES=3 cargo test -p fivebar --test serve -- --ignored --nocapture memory`
#[test]
#[ignore = "takes an hour"]
fn memory_stays_flat_while_clients_come_and_go() {
    let minutes = std::env::var("SOAK_MINUTES").map_or(60.0, |text| {
        text.parse().expect("SOAK_MINUTES is a number of minutes")
    });
    let server = Server::start(&[]);
    let mut page = server.page();
    let part = Duration::from_secs_f64(6.0 * minutes);
    let mut clients = 0;
    let mut after_first = 0.0;
    for tenth in 1..=10 {
        let end = Instant::now() + part;
        while Instant::now() < end {
            come_and_go(&server, clients);
            clients += 1;
            while page.next().is_some() {}
        }
        let memory = server.memory();
        println!(
            "{:.1} min: {clients} clients, {memory:.1} MB, {} open files",
            f64::from(tenth) * minutes / 10.0,
            server.open_files()
        );
        if tenth == 1 {
            after_first = memory;
        }
        assert!(
            memory < after_first + 5.0,
            "it grows: {after_first:.1} MB, {memory:.1} MB"
        );
    }
}

/// One of several kinds of clients.
fn come_and_go(server: &Server, number: usize) {
    let cookie = format!("Cookie: {}\r\n", server.cookie());
    match number % 6 {
        0 => assert_eq!(server.get("/maps.json", &cookie), Some(200)),
        1 => drop(server.connect()),
        2 => assert_eq!(server.get("/", ""), Some(401)),
        kind => {
            let mut socket = server.socket().expect("a place");
            let message = match kind {
                3 => json!("control"),
                4 => json!({ "no such request": "x".repeat(3000) }),
                _ if number % 60 == 5 => large_job(1),
                _ => json!({ "load": { "name": "small", "text": "G21 F600\nG1 X20\n" } }),
            };
            socket.send(Message::text("\"control\"")).expect("a server");
            socket
                .send(Message::text(message.to_string()))
                .expect("a server");
            for _ in 0..5 {
                let _ = socket.read();
            }
            if number.is_multiple_of(2) {
                let _ = socket.close(None);
                let _ = socket.read();
            }
        }
    }
}
