//! A host that streams set-points to a bench arm.

use crate::rig::{Rig, settings};
use fivebar_firmware::motion::{StreamConfig, StreamMode, StreamPoint, StreamPolicy};
use fivebar_firmware::planner::{StreamPhase, StreamProgress};
use fivebar_firmware::settings::Settings;
use std::collections::VecDeque;

/// The ticks of a millisecond.
pub(crate) const MS: u32 = 10;
/// The number of the streams.
pub(crate) const ID: u32 = 3;

/// A motion of a host: position and velocity at a time [s], from rest at 0.
pub(crate) type Motion<'a> = &'a dyn Fn(f64) -> [[f64; 2]; 2];

/// An arm with a stream, and the points on their way to it.
pub(crate) struct Streaming {
    pub(crate) rig: Rig,
    /// The tick in which the stream began.
    pub(crate) begun: u32,
    config: StreamConfig,
    /// Points by the tick in which they arrive.
    line: VecDeque<(u32, u16, StreamPoint)>,
    /// Of the next point.
    pub(crate) n: u16,
}

impl Streaming {
    /// The benchtop arm with a stream of a point each millisecond.
    pub(crate) fn begin(mode: StreamMode, delay_ms: u32) -> Self {
        Self::with(&settings(), mode, delay_ms)
    }

    /// As [`Self::begin`], of an arm with these settings.
    pub(crate) fn with(settings: &Settings, mode: StreamMode, delay_ms: u32) -> Self {
        Self::over(Rig::armed(settings), mode, 1, delay_ms)
    }

    /// As [`Self::begin`], with a point each `period` milliseconds.
    pub(crate) fn paced(mode: StreamMode, period: u32, delay_ms: u32) -> Self {
        Self::over(Rig::armed(&settings()), mode, period, delay_ms)
    }

    /// As [`Self::with`], where limits do not end the stream.
    pub(crate) fn limited(settings: &Settings, mode: StreamMode, delay_ms: u32) -> Self {
        Self::begun(
            Rig::armed(settings),
            mode,
            (1, delay_ms),
            StreamPolicy::Limit,
        )
    }

    fn over(rig: Rig, mode: StreamMode, period: u32, delay_ms: u32) -> Self {
        Self::begun(rig, mode, (period, delay_ms), StreamPolicy::Stop)
    }

    fn begun(
        mut rig: Rig,
        mode: StreamMode,
        (period, delay_ms): (u32, u32),
        policy: StreamPolicy,
    ) -> Self {
        let config = StreamConfig {
            id: ID,
            mode,
            period: (period * MS) as u16,
            delay: (delay_ms * MS) as u16,
            policy,
        };
        let begun = rig.planner.begin_stream(&mut rig.controller, &config);
        assert_eq!(begun, Ok(()));
        let begun = rig.controller.ticks();
        Self {
            rig,
            begun,
            config,
            line: VecDeque::new(),
            n: 0,
        }
    }

    /// The point of a motion at its millisecond `ms`, and the number it has.
    pub(crate) fn point(&mut self, motion: Motion<'_>, ms: u32) -> (u16, StreamPoint) {
        let [position, velocity] = motion(f64::from(ms) * 1e-3);
        let point = StreamPoint {
            id: ID,
            due: self.begun + ms * MS + u32::from(self.config.delay),
            position: position.map(|value| value as f32).into(),
            velocity: velocity.map(|value| value as f32).into(),
            force: (0.0, 0.0),
        };
        self.n = self.n.wrapping_add(1);
        (self.n, point)
    }

    /// Sends a point that arrives so many ticks later, behind those sent before.
    pub(crate) fn send(&mut self, (n, point): (u16, StreamPoint), after: u32) {
        let arrives = self.rig.controller.ticks() + after;
        let last = self.line.back().map_or(arrives, |(last, ..)| *last);
        self.line.push_back((arrives.max(last), n, point));
    }

    /// Gives the controller a point now.
    pub(crate) fn give(&mut self, (n, point): (u16, StreamPoint)) {
        let Rig {
            controller,
            planner,
            ..
        } = &mut self.rig;
        controller.feed_host_timeout();
        planner.take_point(controller, n, &point);
    }

    /// One tick, before which the points that have arrived are given.
    pub(crate) fn tick(&mut self) {
        let now = self.rig.controller.ticks();
        while let Some(&(arrives, n, point)) = self.line.front() {
            if arrives > now {
                break;
            }
            self.line.pop_front();
            self.give((n, point));
        }
        self.rig.planner.run(&mut self.rig.controller);
        self.rig.tick_alone();
    }

    pub(crate) fn ticks(&mut self, count: u32) {
        (0..count).for_each(|_| self.tick());
    }

    pub(crate) fn progress(&self) -> StreamProgress {
        *self.rig.planner.stream().expect("a stream")
    }

    pub(crate) fn phase(&self) -> StreamPhase {
        self.progress().phase
    }

    /// The milliseconds since the stream began.
    pub(crate) fn now(&self) -> u32 {
        (self.rig.controller.ticks() - self.begun) / MS
    }
}

/// 10 mm to and fro at 2 Hz about where the tool is, beginning smoothly from rest.
pub(crate) fn sine(from: [f32; 2]) -> impl Fn(f64) -> [[f64; 2]; 2] {
    let [x, y] = from.map(f64::from);
    let w = std::f64::consts::TAU * 2.0;
    move |t| {
        // 10 mm (1 − cos ωt)/2.
        let (sine, cosine) = (w * t).sin_cos();
        [[x + 5e-3 * (1.0 - cosine), y], [5e-3 * w * sine, 0.0]]
    }
}
