//! Streams of set-points, as a host makes them: smooth or too fast, whole, late, with losses, or with a mistake in a point.

use crate::bytes::Bytes;
use crate::timed::Tool;
use fivebar_firmware::motion::{
    Fixture, FixtureShape, Impedance, StreamConfig, StreamMode, StreamPoint, StreamPolicy,
};

/// Ticks of a period.
const PERIOD: u16 = 20;

/// A stream: the tool goes to and fro along a line, and does not turn at its ends where the host is too fast.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StreamRun {
    config: StreamConfig,
    /// A wall that is set before.
    pub(crate) wall: Option<Fixture>,
    /// Half of the way [m].
    amplitude: [f32; 2],
    /// [rad/s].
    rate: f32,
    /// Points that are sent.
    pub(crate) points: u16,
    /// One of so many points is lost; 0: none.
    lost: u8,
    /// Bits that are changed in a number of one point.
    mistake: (u8, u32),
    /// Whether the host ends it.
    pub(crate) ends: bool,
}

/// A spring that most arms may render, or one whose bits may be anything.
fn impedance(bytes: &mut Bytes<'_>) -> Impedance {
    let [k, d] = bytes.pair(0.0, 100.0);
    let damping = 1e-3 * d;
    let (bits, any) = (bytes.word(), bytes.byte() < 32);
    let stiffness = if any { f32::from_bits(bits) } else { k };
    Impedance {
        stiffness: (stiffness, 0.0, k),
        damping: (damping, 0.0, damping),
    }
}

/// A wall somewhere in the tool's work.
fn wall(bytes: &mut Bytes<'_>) -> Fixture {
    let [x, y] = bytes.pair(-0.1, 0.2);
    Fixture {
        shape: FixtureShape::HalfPlane {
            point: (x, y),
            normal: (y, x),
        },
        stiffness: bytes.number(0.0, 60.0),
        damping: 0.0,
    }
}

impl StreamRun {
    pub(crate) fn from_bytes(bytes: &mut Bytes<'_>) -> Self {
        let mode = match bytes.byte() {
            0..=99 => StreamMode::Tip,
            100..=199 => StreamMode::Joint,
            200..=224 => StreamMode::Free,
            225..=255 => StreamMode::Impedance(impedance(bytes)),
        };
        let wall = matches!(mode, StreamMode::Impedance(_)).then(|| wall(bytes));
        let how = bytes.byte();
        Self {
            wall,
            config: StreamConfig {
                id: bytes.byte().into(),
                mode,
                period: if how < 250 { PERIOD } else { 0 },
                delay: PERIOD * (1 + u16::from(how % 30)),
                policy: [StreamPolicy::Stop, StreamPolicy::Limit][usize::from(how % 2)],
            },
            amplitude: bytes.pair(-0.03, 0.03),
            rate: [2.0, 10.0, 25.0, 60.0][usize::from(bytes.byte() % 4)],
            points: bytes.short() % 400,
            lost: bytes.byte() % 40,
            mistake: (bytes.byte(), bytes.word()),
            ends: bytes.byte() < 128,
        }
    }

    pub(crate) fn config(&self) -> &StreamConfig {
        &self.config
    }

    /// The n-th point of a stream that began in a tick with the tool and the joints [rad] there; none if it is lost.
    pub(crate) fn point(
        &self,
        n: u16,
        begun: u32,
        tool: Tool,
        joints: [f32; 2],
    ) -> Option<StreamPoint> {
        if self.lost > 0 && n % u16::from(self.lost) == 1 {
            return None;
        }
        let time = f32::from(n) * f32::from(PERIOD) * 1e-4;
        let (sine, cosine) = (self.rate * time).sin_cos();
        let (from, scale) = match self.config.mode {
            StreamMode::Tip | StreamMode::Free | StreamMode::Impedance(_) => (tool, 1.0),
            // Per metre of the tool about so many radians.
            StreamMode::Joint => (joints, 10.0),
        };
        let at = |axis: usize| from[axis] + scale * self.amplitude[axis] * (1.0 - cosine);
        let rate = |axis: usize| scale * self.amplitude[axis] * self.rate * sine;
        let mut point = StreamPoint {
            id: self.config.id,
            due: begun + u32::from(n) * u32::from(PERIOD) + u32::from(self.config.delay),
            position: (at(0), at(1)),
            velocity: (rate(0), rate(1)),
            force: (0.0, 0.0),
        };
        let (place, bits) = self.mistake;
        if u16::from(place) * 4 == n {
            let changed = |value: f32| f32::from_bits(value.to_bits() ^ bits);
            match place % 4 {
                0 => point.position.0 = changed(point.position.0),
                1 => point.velocity.1 = changed(point.velocity.1),
                2 => point.due ^= bits,
                _ => point.id = point.id.wrapping_add(1),
            }
        }
        Some(point)
    }

    /// Ticks of a period.
    pub(crate) fn period() -> u16 {
        PERIOD
    }
}
