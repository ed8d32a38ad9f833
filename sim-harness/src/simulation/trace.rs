//! The trace of a run: its samples over time.

use fivebar_firmware::Status;
use fivebar_firmware::safety::Limits;

/// One instant of a run. Pairs are of joint 1 and joint 4; positions are in the frame of
/// the base.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Time since the start [s].
    pub time: f64,
    /// Tag of the move in progress: the line of the job.
    pub line: u32,
    /// The tool's reference [m].
    pub reference: [f64; 2],
    /// The tool's true position [m].
    pub tool: [f64; 2],
    /// The true joint angles θ1, θ4 [rad].
    pub angle: [f64; 2],
    /// θ1, θ4 of the reference [rad].
    pub reference_angle: [f64; 2],
    /// ω1, ω4 of the reference [rad/s].
    pub reference_velocity: [f64; 2],
    /// α1, α4 of the reference [rad/s²].
    pub reference_acceleration: [f64; 2],
    /// Torque of the motors at the joints [N·m].
    pub torque: [f64; 2],
    /// Current set-points of the motors [A].
    pub current_set_point: [f64; 2],
    /// Currents in the motors [A].
    pub current: [f64; 2],
    /// Duties of the bridges, −1…1.
    pub duty: [f64; 2],
    /// The tool's level as the controller sets it: 0 is up or off, 1 is down or full power.
    pub tool_level: f64,
    /// Whether the torques were limited.
    pub saturated: bool,
}

impl Sample {
    /// A sample from the controller's status `time` [s] after the start: tool and joints as
    /// measured by the encoders, torques as demanded. None while the bridges are off.
    pub fn reported(status: &Status, time: f64) -> Option<Self> {
        let double = |[a, b]: [f32; 2]| [f64::from(a), f64::from(b)];
        let joints = status.joint_reference?;
        Some(Self {
            time,
            line: status.tag.unwrap_or_default(),
            reference: double(status.reference?),
            tool: double(status.tool?),
            angle: double(status.angle),
            reference_angle: double(joints.angle),
            reference_velocity: double(joints.velocity),
            reference_acceleration: double(joints.acceleration),
            torque: double(status.torque),
            current_set_point: double(status.current_demand),
            current: double(status.current),
            duty: double(status.duty),
            tool_level: f64::from(status.tool_level),
            saturated: status.limits.contains(Limits::TORQUE)
                || status.limits.contains(Limits::VOLTAGE),
        })
    }

    /// Distance of the tool from its reference [m].
    pub fn tip_error(&self) -> f64 {
        (self.tool[0] - self.reference[0]).hypot(self.tool[1] - self.reference[1])
    }
}

/// The samples of a run. A long run keeps every second, fourth, … sample, so that the memory
/// is bounded.
#[derive(Clone, Debug)]
pub struct Trace {
    samples: Vec<Sample>,
    stride: u64,
    seen: u64,
}

/// Most samples kept.
const MAX_SAMPLES: usize = 50_000;

impl Default for Trace {
    fn default() -> Self {
        Self {
            samples: Vec::new(),
            stride: 1,
            seen: 0,
        }
    }
}

impl Trace {
    /// Adds the next sample of the run.
    pub fn push(&mut self, sample: Sample) {
        if self.seen.is_multiple_of(self.stride) {
            if self.samples.len() == MAX_SAMPLES {
                let mut keep = false;
                self.samples.retain(|_| {
                    keep = !keep;
                    keep
                });
                self.stride *= 2;
            }
            // Only every second sample at the old stride is one at the new stride.
            if self.seen.is_multiple_of(self.stride) {
                self.samples.push(sample);
            }
        }
        self.seen += 1;
    }

    /// The samples kept, evenly spaced in time.
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// Ticks from one kept sample to the next.
    pub fn stride(&self) -> u64 {
        self.stride
    }
}

#[cfg(test)]
mod tests {
    use super::{MAX_SAMPLES, Sample, Trace};

    #[test]
    fn thins_a_long_run_evenly() {
        let mut trace = Trace::default();
        for tick in 0..5 * MAX_SAMPLES as u64 + 3 {
            trace.push(Sample {
                time: tick as f64,
                ..Sample::default()
            });
        }
        assert_eq!(trace.stride(), 8);
        assert!(trace.samples().len() <= MAX_SAMPLES && trace.samples().len() > MAX_SAMPLES / 2);
        for pair in trace.samples().windows(2) {
            assert_eq!(pair[1].time - pair[0].time, 8.0);
        }
    }
}
