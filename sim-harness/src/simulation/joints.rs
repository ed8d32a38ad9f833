//! Forces and contacts of the joints over a run with worn joints.

use fivebar_plant::{ContactStatistics, JOINTS};

/// Length of the intervals over which the greatest forces are kept [s].
const INTERVAL: f64 = 1e-3;

/// The greatest force in each joint during an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeakForce {
    /// Beginning of the interval [s].
    pub time: f64,
    /// The forces in A to E [N].
    pub force: [f64; JOINTS],
}

/// The joints A to E over a job.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointHistory {
    /// Length of the record [s].
    pub duration: f64,
    /// Statistics of the whole time.
    pub total: [ContactStatistics; JOINTS],
    /// The greatest forces of each millisecond.
    pub peaks: Vec<PeakForce>,
}

impl JointHistory {
    /// Adds the statistics of the tick that ended at `time` [s].
    pub(super) fn record(&mut self, time: f64, statistics: [ContactStatistics; JOINTS]) {
        self.duration = time;
        let force = statistics.map(|joint| joint.peak_force);
        match self.peaks.last_mut() {
            Some(peak) if time < peak.time + INTERVAL => {
                for (most, force) in peak.force.iter_mut().zip(force) {
                    *most = most.max(force);
                }
            }
            _ => self.peaks.push(PeakForce { time, force }),
        }
        for (total, statistics) in self.total.iter_mut().zip(statistics) {
            *total = total.combined(&statistics);
        }
    }
}
