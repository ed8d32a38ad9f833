//! How fast a stretch of path may be passed.
//!
//! Along a path r̈ = r″ ṡ² + r′ s̈ and r⃛ = r‴ ṡ³ + 3 r″ ṡ s̈ + r′ s⃛. Where a path is
//! straight all of the tool's acceleration and jerk is for s̈ and s⃛. Where it bends they
//! are shared out beforehand, so that s(t) has constant limits on a segment:
//!
//! - s̈ gets 0.8 of the acceleration, r″ṡ² what that leaves: 0.6 at right angles to it,
//!   less as r″ leans along the path;
//! - r‴ṡ³ gets half of the jerk, s⃛ 0.3 and 3 r″ṡs̈ 0.2.

use super::curve::CurveBounds;
use super::envelope::Envelope;
use super::number::{cube_root, max, min};
use super::ramp::Caps;
use super::refusal::{Obstacle, Refusal};
use super::segment::Segment;
use crate::Scalar;

impl<S: Scalar> Envelope<S> {
    /// The caps that keep the tool's own limits on a segment, moved along at no more than
    /// `speed` [m/s].
    fn tool_caps(&self, segment: &Segment<S>, speed: S) -> Caps<S> {
        let bounds = segment.curve().bounds();
        let tool = &self.tool;
        let first = max(bounds.first, S::ONE);
        let straight = Caps {
            speed: min(speed, tool.speed) / first,
            acceleration: tool.acceleration / first,
            jerk: tool.jerk / first,
        };
        if bounds.second == S::ZERO {
            return straight;
        }
        share_out(&straight, &bounds)
    }
}

fn share_out<S: Scalar>(straight: &Caps<S>, bounds: &CurveBounds<S>) -> Caps<S> {
    let c = S::from_f64;
    let (a, j) = (straight.acceleration, straight.jerk);
    let along = c(0.8);
    // |r″ṡ² + r′s̈|² = aₙ² + aₜ² + 2 aₙ aₜ cos; with aₜ = 0.8 a, aₙ = (√(1 − 0.64 sin²) − 0.8 cos) a.
    let cos = min(bounds.lean / bounds.second, S::ONE);
    let across = (S::ONE - along * along * (S::ONE - cos * cos)).sqrt() - along * cos;
    let by_acceleration = (across * a / bounds.second).sqrt();
    let by_jerk = cube_root(c(0.5) * j / bounds.third);
    let speed = min(straight.speed, min(by_acceleration, by_jerk));
    // 3 |r″| ṡ s̈ within its share of the jerk: first less s̈, below a tenth less ṡ.
    let turning = c(0.2) * j / (c(3.0) * bounds.second);
    let acceleration = max(min(along * a, turning / speed), c(0.1) * a);
    Caps {
        speed: min(speed, turning / acceleration),
        acceleration,
        jerk: c(0.3) * j,
    }
}
impl<S: Scalar> Envelope<S> {
    /// Hold the whole of a segment against the envelope, and say how fast it may be moved
    /// along, `speed` [m/s] at most.
    ///
    /// # Errors
    /// The first place that cannot be passed, and why.
    pub fn admit(&self, segment: &Segment<S>, speed: S) -> Result<Caps<S>, Refusal<S>> {
        let caps = self.tool_caps(segment, speed);
        if !caps.are_sound() {
            return Err(Refusal {
                fraction: S::ZERO,
                point: segment.start(),
                obstacle: Obstacle::Limits,
            });
        }
        Ok(caps)
    }
}
