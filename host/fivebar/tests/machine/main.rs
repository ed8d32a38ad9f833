//! `fivebar serve` as a program on a machine: under load, with hostile clients, with pages that are lost, over a slow port,
//! and its guided page; and `fivebar bridge` with its senders and who else finds its port. Websockets take the place of
//! pages, plain clients that of senders.
//!
//! These tests measure times of the machine or wait for it, so `cargo test` does not run them beside others: they are a
//! step of CI, alone (`./ci.sh machine`). What does not need a machine is tested in process, by virtual time.
#![cfg(target_os = "linux")]

#[path = "../arms/mod.rs"]
mod arms;
mod bridge;
mod bridge_senders;
mod commission;
mod hostile;
mod hostile_files;
mod intruders;
mod lost_page;
mod port;
mod program;
#[path = "../ports/sender.rs"]
mod sender;
mod senders;
mod soak;
#[path = "../serve/state.rs"]
mod state;
mod stops;
