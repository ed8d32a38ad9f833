//! Controllers over links and serial ports, and senders of G-code.

mod arm;
#[cfg(unix)]
mod board;
mod bridge;
mod crossed;
mod driving;
#[cfg(unix)]
mod hil;
#[cfg(target_os = "linux")]
mod intruders;
mod lines;
mod senders;
#[cfg(unix)]
mod serial;
#[cfg(unix)]
mod settings;
#[cfg(target_os = "linux")]
mod signals;
