//! Controllers over links and serial ports.

mod arm;
#[cfg(unix)]
mod board;
mod driving;
#[cfg(unix)]
mod hil;
mod lines;
#[cfg(unix)]
mod serial;
#[cfg(unix)]
mod settings;
