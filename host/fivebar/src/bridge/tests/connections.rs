//! A connection's two threads, without a slot.

use super::rig::until;
use crate::bridge::connection::{Connections, Event, Outlet, Presence, desk, listen};
use crate::bridge::{BridgeOptions, bridge, log_of};
use crate::senders::Endpoints;
use crate::test_session;
use fivebar_sim::clock::Clock;
use fivebar_sim::controller::ControllerSource;
use std::cell::RefCell;
use std::io::{self, BufRead as _, BufReader, ErrorKind};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, mpsc};
use std::thread;

/// Why a connection ends whose reads give this, then the end.
fn ends(mut reads: Vec<io::Result<usize>>) -> String {
    let (desk, _connections) = desk(None, Clock::simulated());
    let presence = Presence::new("a test".into(), &Clock::simulated());
    reads.reverse();
    desk.pass_on(&presence, desk.guarded_gate(), |bytes| {
        bytes.fill(b'\n');
        reads.pop().unwrap_or(Ok(0))
    });
    presence.ended().unwrap().into()
}

#[test]
fn a_connection_ends_with_the_reason() {
    let closed = "the sender has closed the connection";
    assert_eq!(ends(vec![]), closed);
    assert_eq!(ends(vec![Ok(3), Err(ErrorKind::TimedOut.into())]), closed);
    assert_eq!(ends(vec![Err(ErrorKind::BrokenPipe.into())]), closed);
    let failed = ends(vec![Err(io::Error::other("no line")), Ok(1)]);
    assert_eq!(failed, "the connection to the sender failed: no line");
}

/// An outlet that notes what it writes and how often it is closed; `works` says whether a write succeeds.
fn outlet(works: bool) -> (Outlet, Arc<Mutex<String>>, Arc<AtomicUsize>) {
    let (text, closed) = (
        Arc::<Mutex<String>>::default(),
        Arc::<AtomicUsize>::default(),
    );
    let (written, ends) = (Arc::clone(&text), Arc::clone(&closed));
    let write = move |answer: &str| {
        written.lock().unwrap().push_str(answer);
        works
    };
    let close = move || {
        ends.fetch_add(1, Ordering::SeqCst);
    };
    (
        Outlet::start(
            Presence::new("a test".into(), &Clock::simulated()),
            write,
            close,
        ),
        text,
        closed,
    )
}

#[test]
fn answers_are_written_in_order_and_the_end_comes_last() {
    let (outlet, text, closed) = outlet(true);
    for answer in ["a", "", "b"] {
        outlet.send(answer);
    }
    outlet.end();
    until(|| closed.load(Ordering::SeqCst) == 1);
    assert_eq!(*text.lock().unwrap(), "ab");
}

#[test]
fn nothing_is_written_after_a_write_has_failed() {
    let (outlet, text, closed) = outlet(false);
    outlet.send("a");
    until(|| !text.lock().unwrap().is_empty());
    // The writing thread has ended: this closes the connection instead.
    until(|| {
        outlet.send("b");
        closed.load(Ordering::SeqCst) > 0
    });
    outlet.end();
    assert!(closed.load(Ordering::SeqCst) > 1);
    assert_eq!(*text.lock().unwrap(), "a");
}

#[test]
fn a_sender_that_reads_nothing_is_disconnected_when_too_many_answers_wait() {
    let (stuck, closed) = (Arc::new(Mutex::new(())), Arc::<AtomicBool>::default());
    let guard = stuck.lock().unwrap();
    let (wait, end) = (Arc::clone(&stuck), Arc::clone(&closed));
    let write = move |_: &str| wait.lock().is_ok();
    let outlet = Outlet::start(
        Presence::new("a test".into(), &Clock::simulated()),
        write,
        move || {
            end.store(true, Ordering::SeqCst);
        },
    );
    for _ in 0..4096 {
        outlet.send("ok\n");
    }
    assert!(!closed.load(Ordering::SeqCst));
    outlet.send("ok\n");
    outlet.send("ok\n");
    assert!(closed.load(Ordering::SeqCst));
    drop(guard);
}

/// Nothing of it is read either.
#[test]
fn who_is_refused_or_finds_nobody_gets_no_control() {
    let (desk, Connections { events, .. }) = desk(None, Clock::simulated());
    let answered = thread::spawn(move || {
        for admits in [false, true] {
            let Ok(Event::Asks(visitor)) = events.recv() else {
                panic!("a visitor");
            };
            match admits {
                true => drop(visitor.admit()),
                false => visitor.refuse("no"),
            }
        }
    });
    let ((one, text, closed), (two, ..), (three, ..)) = (outlet(true), outlet(true), outlet(true));
    assert!(!desk.ask(one));
    until(|| closed.load(Ordering::SeqCst) == 1);
    assert_eq!(*text.lock().unwrap(), "no");
    assert!(desk.ask(two));
    answered.join().unwrap();
    assert!(!desk.ask(three), "the slot is gone");
}

#[test]
#[cfg(unix)]
fn senders_reach_the_terminal_without_an_address() {
    let (desk, _connections) = desk(None, Clock::simulated());
    let reached = |address| listen(address, &desk).unwrap().endpoints("here");
    let terminal = reached(None);
    assert!(terminal.address.is_none() && terminal.terminal.is_some());
    let both = reached(Some("127.0.0.1:0".parse().unwrap()));
    assert!(both.address.unwrap().port() != 0);
}

#[test]
fn the_bridge_greets_a_sender_over_tcp() {
    let (greeted, greeting) = mpsc::channel();
    let ready = move |endpoints: &Endpoints| {
        let stream = TcpStream::connect(endpoints.address.unwrap()).unwrap();
        thread::spawn(move || {
            let mut lines = BufReader::new(stream).lines().map_while(Result::ok);
            let greeting = lines.find(|line| !line.is_empty());
            greeted.send(greeting.unwrap_or_default())
        });
    };
    let received = RefCell::new(None);
    let ends = || {
        *received.borrow_mut() = greeting.try_recv().ok();
        received.borrow().is_some()
    };
    let options = BridgeOptions::at(Some("127.0.0.1:0".parse().unwrap()));
    let source = ControllerSource::Simulated;
    let note = Box::new(|_: &str| ());
    bridge(&test_session::robot(), source, &options, ready, note, &ends).unwrap();
    let received = received.into_inner();
    assert_eq!(received.as_deref(), Some("Grbl 1.1h ['$' for help]"));
}

#[test]
fn the_path_is_logged_where_that_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("path.csv");
    let settings = test_session::robot().settings().unwrap().check().unwrap();
    let options = BridgeOptions {
        log: Some(path.clone()),
        ..BridgeOptions::at(None)
    };
    assert!(log_of(&options, &settings).unwrap().is_some() && path.exists());
    assert!(
        log_of(&BridgeOptions::at(None), &settings)
            .unwrap()
            .is_none()
    );
}
