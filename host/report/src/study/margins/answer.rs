//! The study as JSON.

use super::MarginsStudy;
use serde_json::{Value, json};

impl MarginsStudy<'_> {
    /// One JSON object, of the worst pose. Gain margins are factors, `null` where no factor makes
    /// the loop oscillate; all margins are `null` where the loop is unstable.
    pub fn answer(&self) -> Value {
        let worst = self.worst();
        let finite = |value: f64| value.is_finite().then_some(value);
        let margin = |of: fn(&fivebar_design::servo::Margins) -> f64| {
            worst.margins.as_ref().map(of).and_then(finite)
        };
        let gains = self.robot.gains();
        json!({
            "robot": self.robot.name,
            "stable": worst.margins.is_some(),
            "modulus_margin": margin(|m| m.modulus),
            "gain_margin_up": margin(|m| m.gain_up),
            "gain_margin_down": margin(|m| m.gain_down),
            "phase_margin_deg": margin(|m| m.phase.to_degrees()),
            "delay_margin_s": margin(|m| m.delay),
            "worst_pose": {"theta1": worst.theta[0], "theta4": worst.theta[1]},
            "modulus_margin_range": self.modulus_range,
            "disturbance_peak": self.disturbance_peak.and_then(finite),
            "passive_stiffness_home": self.passive_stiffness.map(|it| it.home),
            "passive_stiffness_range": self.passive_stiffness.map(|it| it.range),
            "resonance_hz": self.resonance,
            "modes_hz": self.modes,
            "torque_noise_share": self.noise,
            "tick_rate_hz": self.robot.control.tick_rate,
            "both_sides_of_belts": gains.belts.is_some(),
            "bandwidth_rad_s": gains.feedback_bandwidth(),
            "damping": gains.damping,
            "integral_rate_rad_s": gains.integral_rate,
            "observer_bandwidth_rad_s": gains.observer_bandwidth,
            "current_bandwidth_rad_s": self.current_bandwidth(),
            "poses": self.poses.len(),
        })
    }
}
