//! The record of a motion that a hand has led: angles by the controller's ticks, and the smooth path through them.

use super::{LEAST_KNOTS, LONGEST, TaughtPath, VERSION};
use fivebar_firmware::protocol::StreamState;
use fivebar_kinematics::five_bar::{Side, Tool};
use nalgebra::Vector2;

/// Time between two knots of the path [s].
const KNOT: f64 = 0.01;
/// How far smoothing may take the path from its record [m].
const TOLERANCE: f64 = 2e-5;
/// The most passes of the smoothing filter.
const MOST_PASSES: u32 = 40;
/// A tip nearer than this to where it began has not left yet [m].
const STILL: f64 = 5e-5;
/// An arm whose tip went less far was not led [m].
const LED: f64 = 5e-4;
/// Rest that is kept before the first motion and behind the last one [s].
const REST: f64 = 0.05;

/// Why a record is no path.
#[derive(Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TeachError {
    /// The arm was not moved.
    #[error("the arm was not moved: lead its tip by hand while this runs")]
    Still,
    /// The angles close no arm.
    #[error("{0:.2} s after the beginning the angles close no arm: home it again")]
    NoPose(f64),
    /// Too long.
    #[error("the record lasts longer than {LONGEST} s: teach it in parts")]
    Long,
}

/// What a controller has told of an arm that a hand leads.
#[derive(Clone, Debug)]
pub struct Record {
    tick_rate: f64,
    /// The tick of the first state.
    begun: Option<u32>,
    /// Time [s], θ1, θ4 [rad].
    samples: Vec<(f64, [f64; 2])>,
}

impl Record {
    /// An empty record of a controller with this tick rate [Hz].
    pub fn new(tick_rate: f64) -> Self {
        Self {
            tick_rate,
            begun: None,
            samples: Vec::new(),
        }
    }

    /// Keeps a state; false once it lasts as long as a path may.
    pub fn keep(&mut self, state: &StreamState) -> bool {
        let begun = *self.begun.get_or_insert(state.tick);
        let time = f64::from(state.tick.wrapping_sub(begun)) / self.tick_rate;
        if self.samples.last().is_none_or(|(last, _)| time > *last) {
            self.samples.push((time, state.angle.map(f64::from)));
        }
        time < LONGEST
    }

    /// How long it lasts [s].
    pub fn time(&self) -> f64 {
        self.samples.last().map_or(0.0, |(time, _)| *time)
    }

    /// The path of the tip of an arm with this tool in this assembly mode.
    ///
    /// # Errors
    /// The arm was not moved, or the angles close no arm.
    pub fn path(
        &self,
        robot: &str,
        tool: &Tool<f64>,
        assembly: Side,
    ) -> Result<TaughtPath, TeachError> {
        if self.time() > LONGEST {
            return Err(TeachError::Long);
        }
        let mut tips = Vec::with_capacity(self.samples.len());
        for (time, [theta1, theta4]) in &self.samples {
            let pose = tool.geometry().forward(*theta1, *theta4, assembly);
            let pose = pose.map_err(|_| TeachError::NoPose(*time))?;
            tips.push(tool.point(&pose));
        }
        let knots = self.at_knots(&tips);
        let moving = trimmed(&knots).ok_or(TeachError::Still)?;
        let tip_m = smoothed(moving).into_iter().map(Into::into).collect();
        Ok(TaughtPath {
            version: VERSION,
            robot: robot.into(),
            knot_s: KNOT,
            tip_m,
        })
    }

    /// The tip at evenly spaced times, between samples on a straight line.
    fn at_knots(&self, tips: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
        let count = (self.time() / KNOT) as usize;
        let mut next = 0;
        let at = |k: usize| {
            let time = k as f64 * KNOT;
            while next + 2 < self.samples.len() && self.samples[next + 1].0 < time {
                next += 1;
            }
            let (Some((from, _)), Some((to, _))) =
                (self.samples.get(next), self.samples.get(next + 1))
            else {
                return tips.first().copied().unwrap_or_default();
            };
            let share = ((time - from) / (to - from)).clamp(0.0, 1.0);
            tips[next] + (tips[next + 1] - tips[next]) * share
        };
        (0..=count).map(at).collect()
    }
}

/// The knots from shortly before the tip leaves until shortly after it has arrived; none if it stays.
fn trimmed(knots: &[Vector2<f64>]) -> Option<&[Vector2<f64>]> {
    let (first, last) = (knots.first()?, knots.last()?);
    if knots.iter().all(|it| (it - first).norm() < LED) {
        return None;
    }
    let leaves = knots.iter().position(|it| (it - first).norm() > STILL)?;
    let arrives = knots.iter().rposition(|it| (it - last).norm() > STILL)?;
    let rest = (REST / KNOT) as usize;
    let from = leaves.saturating_sub(rest);
    let to = (arrives + 1 + rest).min(knots.len() - 1);
    let moving = knots.get(from..=to)?;
    (moving.len() >= LEAST_KNOTS).then_some(moving)
}

/// The knots after as many passes of ¼, ½, ¼ as leave each within the tolerance of where it was. The ends stay.
fn smoothed(knots: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
    let mut smooth = knots.to_vec();
    for _ in 0..MOST_PASSES {
        let mut next = smooth.clone();
        for (k, around) in (1..).zip(smooth.windows(3)) {
            next[k] = (around[0] + around[1] * 2.0 + around[2]) * 0.25;
        }
        let off = next.iter().zip(knots).map(|(a, b)| (a - b).norm());
        if off.fold(0.0, f64::max) > TOLERANCE {
            break;
        }
        smooth = next;
    }
    smooth
}
