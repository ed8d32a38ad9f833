//! A controller that is watched: a digest of what it does, and samples for the drawing.

use crc::{CRC_64_XZ, Crc, Digest, Table};
use fivebar_firmware::controller::Request;
use fivebar_firmware::drives::{BrushedDrives, Drives};
use fivebar_firmware::{ArmCommand, ArmSample, Move, Status};
use fivebar_sim::link::{Target, TargetError};

/// Numbers of a sample: time from power-up [s], θ1, θ4 [rad], x, y of the tool [m], its level 0 to 1.
pub(crate) const ROW: usize = 6;
/// Ticks between two samples.
const STRIDE: u64 = 40;
/// Samples that go to the page at once.
const ROWS: usize = 25;

static CRC: Crc<u64> = Crc::<u64>::new(&CRC_64_XZ);

/// A controller in whose every tick the bits of both duties, the enables, the brake and the state go into a digest.
pub(crate) struct Watched<'a, T> {
    target: T,
    digest: Digest<'static, u64, Table<1>>,
    ticks: u64,
    period: f64,
    rows: Vec<f32>,
    drawn: &'a mut dyn FnMut(&[f32]),
}

impl<'a, T> Watched<'a, T> {
    /// `tick_rate` in Hz. `drawn` takes rows of [`ROW`] numbers.
    pub(crate) fn new(target: T, tick_rate: f64, drawn: &'a mut dyn FnMut(&[f32])) -> Self {
        Self {
            target,
            digest: CRC.digest(),
            ticks: 0,
            period: 1.0 / tick_rate,
            rows: Vec::new(),
            drawn,
        }
    }

    /// The digest of all ticks; the last samples go to the page.
    pub(crate) fn finish(self) -> u64 {
        (self.drawn)(&self.rows);
        self.digest.finalize()
    }

    fn show(&mut self, status: &Status) {
        let Some([x, y]) = status.tool else { return };
        let [theta1, theta4] = status.angle;
        let time = (self.ticks as f64 * self.period) as f32;
        self.rows
            .extend([time, theta1, theta4, x, y, status.tool_level]);
        if self.rows.len() >= ROW * ROWS {
            (self.drawn)(&self.rows);
            self.rows.clear();
        }
    }
}

impl<T: Target> Target for Watched<'_, T> {
    fn tick(
        &mut self,
        sample: &ArmSample<<BrushedDrives as Drives>::Sample>,
    ) -> Result<(ArmCommand<<BrushedDrives as Drives>::Command>, Status), TargetError> {
        let (command, status) = self.target.tick(sample)?;
        for duty in command.drives.duty {
            self.digest.update(&duty.to_bits().to_le_bytes());
        }
        let [enable1, enable4] = command.enable;
        let flags = [enable1, enable4, command.brake].map(u8::from);
        self.digest.update(&flags);
        self.digest.update(&[status.state as u8]);
        if self.ticks.is_multiple_of(STRIDE) {
            self.show(&status);
        }
        self.ticks += 1;
        Ok((command, status))
    }

    fn request(&mut self, request: Request) -> Result<(), TargetError> {
        self.target.request(request)
    }

    fn offer(&mut self, next: &Move) -> Result<bool, TargetError> {
        self.target.offer(next)
    }

    fn is_idle(&self) -> bool {
        self.target.is_idle()
    }
}
