//! The console of a live page: a sender in this process.

use super::connection::{Desk, Outlet, Presence};
use crate::senders::Console;
use std::io::ErrorKind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

/// Time between two looks at whether the slot has ended the connection.
const LOOK: Duration = Duration::from_millis(100);

/// Opens a console, which asks for control as every sender does. Also returns what the slot knows it by.
pub(super) fn open(desk: Desk) -> (Console, Arc<Presence>) {
    let (input, lines) = mpsc::channel::<String>();
    let (texts, output) = mpsc::channel::<String>();
    let presence = desk.presence("the page's console");
    let closed = Arc::new(AtomicBool::new(false));
    let close = Arc::clone(&closed);
    let outlet = Outlet::start(
        Arc::clone(&presence),
        move |text| texts.send(text.into()).is_ok(),
        move || close.store(true, Ordering::SeqCst),
    );
    let connection = Arc::clone(&presence);
    thread::spawn(move || {
        if !desk.ask(outlet) {
            return;
        }
        desk.pass_on(&connection, desk.open_gate(), |bytes| {
            if closed.load(Ordering::SeqCst) {
                return Err(ErrorKind::ConnectionAborted.into());
            }
            match lines.recv_timeout(LOOK) {
                Ok(line) => {
                    let count = line.len().min(bytes.len());
                    bytes[..count].copy_from_slice(&line.as_bytes()[..count]);
                    Ok(count)
                }
                Err(RecvTimeoutError::Timeout) => Err(ErrorKind::TimedOut.into()),
                // Its page has dropped it.
                Err(RecvTimeoutError::Disconnected) => Ok(0),
            }
        });
    });
    (Console { input, output }, presence)
}
