//! `fivebar serve` under load, with hostile clients and with pages that are lost. Websockets take
//! the place of pages. Times are the controller's, which a busy machine slows down, too.
#![cfg(target_os = "linux")]

mod commission;
mod console;
mod crossing;
mod held_motion;
mod hostile;
mod lost_page;
mod own_job;
mod port;
mod program;
mod senders;
mod soak;
mod stops;
mod time_optimal;
