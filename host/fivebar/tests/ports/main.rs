//! Controllers over links and serial ports.

mod arm;
#[cfg(unix)]
mod board;
#[cfg(target_os = "linux")]
mod children;
mod crossed;
mod driving;
#[cfg(unix)]
mod hil;
mod homing;
mod lines;
#[cfg(target_os = "linux")]
mod sender;
#[cfg(unix)]
mod serial;
#[cfg(unix)]
mod settings;
#[cfg(target_os = "linux")]
mod signals;
