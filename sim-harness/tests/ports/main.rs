//! Controllers over links and serial ports, and senders of G-code.

mod arm;
#[cfg(unix)]
mod board;
mod crossed;
mod driving;
#[cfg(unix)]
mod hil;
mod lines;
mod senders;
#[cfg(unix)]
mod serial;
#[cfg(unix)]
mod settings;
