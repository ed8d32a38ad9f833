//! What the joints went through in a run that watches them.

use crate::run::plant::{ContactStatistics, JOINTS};

/// Greatest forces are kept for stretches of this length [s].
const STRETCH: f64 = 1e-3;

/// The greatest force in each joint during a stretch of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// When the stretch began [s].
    pub time: f64,
    /// In A to E [N].
    pub force: [f64; JOINTS],
}

/// The joints A to E over a job.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointHistory {
    /// For how long they were watched [s].
    pub watched: f64,
    /// All in all.
    pub total: [ContactStatistics; JOINTS],
    /// The greatest forces, millisecond by millisecond.
    pub peaks: Vec<Peak>,
}

impl JointHistory {
    /// Adds what came to pass in the tick that ended at `time` [s].
    pub(super) fn record(&mut self, time: f64, statistics: [ContactStatistics; JOINTS]) {
        self.watched = time;
        let force = statistics.map(|joint| joint.peak_force);
        match self.peaks.last_mut() {
            Some(peak) if time < peak.time + STRETCH => {
                for (most, force) in peak.force.iter_mut().zip(force) {
                    *most = most.max(force);
                }
            }
            _ => self.peaks.push(Peak { time, force }),
        }
        for (total, statistics) in self.total.iter_mut().zip(statistics) {
            *total = total.with(&statistics);
        }
    }
}
