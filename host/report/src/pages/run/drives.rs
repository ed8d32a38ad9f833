//! What a run takes of its drives, in the words of their kind.

use super::RunReport;
use crate::text::quantity;
use fivebar_kinematics::five_bar::Joint;
use fivebar_sim::machine::{Machine, Signal};
use fivebar_sim::simulation::ServoLimits;

impl RunReport<'_> {
    fn machine(&self) -> Machine {
        Machine::of(self.robot.drive_kind())
    }

    /// Whether its status shows this.
    pub(super) fn shows(&self, signal: Signal) -> bool {
        self.machine().shows.contains(&signal)
    }

    /// Whether the controller limits torques; that of drives which follow a motion knows of none.
    pub(super) fn limits_torques(&self) -> bool {
        self.shows(Signal::Current)
    }

    /// Key figures of the drives, by name.
    pub(super) fn drive_figures(&self) -> Vec<(String, String)> {
        let mut figures = vec![(
            format!("of the {} at most", self.machine().torque_limit),
            share(self.summary.torque_share),
        )];
        if self.shows(Signal::Current) {
            let figure = share(self.current_used());
            figures.push(("of the peak current at most".into(), figure));
        }
        if let Some([lost1, lost4]) = self.summary.lost_steps {
            figures.push(("full steps lost".into(), format!("{lost1} and {lost4}")));
        }
        if let Some(ServoLimits {
            dead_band_m,
            late_s,
        }) = self.summary.hobby_servos
        {
            let [dead_band, late] = [quantity(dead_band_m, "m"), quantity(late_s, "s")];
            figures.push(("dead band with a straight leg".into(), dead_band));
            figures.push(("late by up to".into(), late));
        }
        figures
    }

    /// The greatest current as a share of the peak current of its motor.
    fn current_used(&self) -> Option<f64> {
        let drives = self.robot.drives().ok()?;
        let samples = self.trace.samples().iter();
        let shares = samples.flat_map(|sample| {
            Joint::ALL.map(|joint| (sample.current[joint] / drives[joint].peak_current).abs())
        });
        shares.reduce(f64::max)
    }
}

/// In per cent; "–" where there is none.
fn share(share: Option<f64>) -> String {
    match share.filter(|share| share.is_finite()) {
        Some(share) => format!("{:.0} %", 100.0 * share),
        None => "–".into(),
    }
}
