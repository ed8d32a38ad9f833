//! The guided page of a commissioning: `fivebar serve --commission`.
//!
//! A thread of its own does the steps of `show::commission`, one for each click. Pages send clicks as web
//! requests. Each has a standing connection, too, a websocket as the arm's page has it: the state comes over
//! it and emergency stops go over it, so that no new connection is needed for a stop. A stop passes no
//! queue: it sets a flag that ends the exchange with the controller at once, and the thread then switches the
//! bridges off and confirms it.

mod clicks;
mod page_state;
mod state;
mod web;

use super::accept;
use super::guard::Guard;
use super::wire::channels::{self, ControllerEnd};
use super::wire::updates::Updates;
use super::{ServeError, web as live};
use crate::commission::{Commissioning, Options, StepError};
use clicks::{Click, PageOutput};
use fivebar_sim::clock::Clock;
use state::Shared;
use std::net::SocketAddr;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

pub(super) use page_state::PageState;

/// How often a thread looks for the end of the program.
const LOOK: Duration = Duration::from_millis(50);
/// How often a thread looks for stops of pages.
const LOOK_FOR_STOPS: Duration = Duration::from_millis(5);
/// A state is sent at least as often, because a page without updates takes the server for lost.
const SIGN_OF_LIFE: Duration = Duration::from_millis(500);

/// Serves the guided page until `ends` returns true. Calls `ready` with the address as soon as it is
/// served.
///
/// # Errors
/// The address cannot be opened, or the arm cannot be commissioned.
pub(crate) fn serve(
    options: &Options,
    address: SocketAddr,
    guard: Guard,
    clock: Clock,
    ready: impl FnOnce(SocketAddr),
    ends: impl Fn() -> bool + Send + 'static,
) -> Result<(), ServeError> {
    let listener = accept::listen(address);
    let listener = listener.map_err(|source| ServeError::Listen { address, source })?;
    let (clicks, clicked) = channel();
    let (pages, from_pages, to_pages) = channels::channels(clock.clone());
    let shared = Arc::new(Shared::new(clicks, Updates::start(to_pages), clock));
    let clicked = Arc::new(Mutex::new(clicked));
    let output = PageOutput::new(Arc::clone(&shared), Arc::clone(&clicked));
    let stop = Arc::clone(&shared.stop);
    let commissioning = Commissioning::open(options, Box::new(output), stop);
    let commissioning = commissioning.map_err(|error| ServeError::Commission(error.to_string()))?;
    shared.change(|state| *state = PageState::new(&commissioning));
    ready(listener.local_addr()?);
    watch(Arc::clone(&shared), from_pages, ends);
    let router = web::router(Arc::clone(&shared), pages, guard);
    live::serve_until(
        listener,
        router,
        Box::new(move || {
            attend(commissioning, &shared, &clicked);
            Ok(())
        }),
    )
}

/// Stops the arm when a page asks for it and when the program ends, also in the middle of a step.
fn watch(shared: Arc<Shared>, pages: ControllerEnd, ends: impl Fn() -> bool + Send + 'static) {
    thread::spawn(move || {
        let mut shown = shared.clock.now();
        while !ends() {
            shared.clock.sleep(LOOK_FOR_STOPS);
            while pages.shared.stop.take().is_some() {
                shared.raise_stop();
            }
            // The requests of the arm's page mean nothing here.
            while pages.events.try_recv().is_ok() {}
            if shared.clock.since(shown) > SIGN_OF_LIFE {
                shown = shared.clock.now();
                shared.change(|_| ());
            }
        }
        shared.end();
    });
}

/// Does what pages click until the program ends.
fn attend(mut commissioning: Commissioning, shared: &Shared, clicked: &Mutex<Receiver<Click>>) {
    let wait = || {
        let clicked = clicked.lock().unwrap_or_else(PoisonError::into_inner);
        clicked.recv_timeout(LOOK)
    };
    while !shared.has_ended() {
        match wait() {
            Ok(Click::Begin(step)) => {
                begin(&mut commissioning, shared, clicked, step);
            }
            Ok(Click::Again(step)) => {
                let forgotten = commissioning.forget_from(step);
                shared.change(|state| {
                    state.show_steps(&commissioning);
                    state.trouble = forgotten.err().map(|error| error.to_string());
                });
            }
            // Of a task that is over.
            Ok(Click::Done { .. } | Click::Answer(_)) | Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
        }
        if shared.is_stopped() {
            stop(&mut commissioning, shared, clicked);
        }
    }
    if shared.is_stopped() {
        stop(&mut commissioning, shared, clicked);
    }
}

/// Does a step, if it is the next one.
fn begin(
    commissioning: &mut Commissioning,
    shared: &Shared,
    clicked: &Mutex<Receiver<Click>>,
    name: &str,
) {
    let Some(step) = commissioning.next().filter(|step| step.name == name) else {
        shared.change(|state| state.end(Err(format!("{name} is not the next step"))));
        return;
    };
    let outcome = commissioning
        .prepare()
        .and_then(|()| commissioning.run(step));
    // A second click on the step begins nothing.
    shared.change(|state| {
        forget(clicked);
        state.show_steps(commissioning);
        state.stopped |= shared.is_stopped();
        state.end(outcome.map_err(|error| shown(&error, shared)));
    });
}

/// Forgets what was clicked and not done yet.
fn forget(clicked: &Mutex<Receiver<Click>>) {
    let clicked = clicked.lock().unwrap_or_else(PoisonError::into_inner);
    while clicked.try_recv().is_ok() {}
}

/// What the page says of an error.
fn shown(error: &StepError, shared: &Shared) -> String {
    if shared.is_stopped() {
        return "stopped: the bridges are off. Start the step again when the arm is safe.".into();
    }
    error.to_string()
}

/// Switches the bridges off. What was clicked before begins nothing after it.
fn stop(commissioning: &mut Commissioning, shared: &Shared, clicked: &Mutex<Receiver<Click>>) {
    let outcome = commissioning.switch_off();
    let reached = outcome.is_ok();
    shared.change(|state| {
        forget(clicked);
        state.stops += 1;
        state.stopped = true;
        state.end(Err(match outcome {
            Ok(()) => "stopped: the bridges are off".into(),
            Err(error) => format!("the stop did not reach the controller: {error}"),
        }));
    });
    if reached {
        shared.confirm_stop();
    }
}
