//! A log of the arm's path: a line for each status.

use fivebar_firmware::Status;
use fivebar_firmware::safety::State;
use std::fs::File;
use std::io::{self, LineWriter, Write as _};
use std::path::Path;

/// A file of comma-separated values: time [s], where the tool should be [m], its level (0…1).
pub(super) struct PathLog {
    out: LineWriter<File>,
    tick_rate: f64,
    last: Option<u32>,
}

impl PathLog {
    pub(super) fn create(path: &Path, tick_rate: f64) -> io::Result<Self> {
        let mut out = LineWriter::new(File::create(path)?);
        writeln!(out, "time_s,x_m,y_m,tool")?;
        Ok(Self {
            out,
            tick_rate,
            last: None,
        })
    }

    /// Adds a line, unless the bridges are off, the arm is homing, or no tick has passed.
    pub(super) fn add(&mut self, status: &Status) -> io::Result<()> {
        let Some([x, y]) = status.reference.filter(|_| status.state != State::Homing) else {
            return Ok(());
        };
        if self.last.replace(status.tick) == Some(status.tick) {
            return Ok(());
        }
        let time = f64::from(status.tick) / self.tick_rate;
        let tool = status.tool_level;
        writeln!(self.out, "{time:.4},{x:.7},{y:.7},{tool:.3}")
    }
}
