//! What the program's background loop did, and between which control ticks.

use crate::image::Image;
use crate::unicorn::{Engine, Reg};
use std::ops::Range;

/// The exception of the control tick: ADC1 to ADC3.
pub(crate) const TICK: u32 = 16 + 18;
/// The control register of the stream that sends on the serial line.
const SEND_STREAM: u32 = 0x4002_64b8;

/// What the background loop did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// It called the planner, which looks whether the controller needs more path.
    Planned,
    /// It locked the controller, so that no control tick began.
    Locked,
    /// It began a frame to the host.
    Sent,
    /// It handed the planner a point of a stream.
    Pointed,
}

/// The steps, each with the number of control ticks that had begun before it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Trace {
    /// The code of the background loop and of the planner, as far as it locks the controller.
    background: [Range<u32>; 5],
    locked: bool,
    ticks: usize,
    steps: Vec<(usize, Step)>,
}

/// Part of the name of the planner's entry, which the background loop calls in each turn.
const PLANNER: &str = "Planner$GT$3run";
/// The same of what it calls with each point of a stream.
const POINT: &str = "Planner$GT$10take_point";

/// Where the planner's code begins.
pub(crate) fn planner(image: &Image) -> Option<u32> {
    image.symbol(PLANNER).map(|(address, _)| address & !1)
}

impl Trace {
    /// None yet, of the program in this image.
    pub(crate) fn new(image: &Image) -> Self {
        let code = |part: &str| {
            let (address, size) = image.symbol(part).unwrap_or_default();
            address & !1..(address & !1) + size
        };
        Self {
            background: [
                code("3app8converse"),
                code(PLANNER),
                code(POINT),
                code("6stream52_$LT$impl$u20$fivebar_firmware..planner..Planner$GT$6splice"),
                code("Planner$GT$12watch_stream"),
            ],
            ..Self::default()
        }
    }

    /// Each step with the number of control ticks that had begun before it.
    pub(crate) fn steps(&self) -> &[(usize, Step)] {
        &self.steps
    }

    /// A block of code runs.
    #[inline]
    pub(crate) fn block(&mut self, address: u32, engine: &Engine) {
        let [_, _, point, ..] = &self.background;
        if address == point.start {
            self.note(Step::Pointed);
        }
        if self.background.iter().any(|code| code.contains(&address)) {
            let locked = engine.get(Reg::BASEPRI) != 0;
            if locked && !self.locked {
                self.note(Step::Locked);
            }
            self.locked = locked;
        }
    }

    pub(crate) fn note(&mut self, step: Step) {
        self.steps.push((self.ticks, step));
    }

    pub(crate) fn enter(&mut self, exception: u32) {
        self.ticks += usize::from(exception == TICK);
    }

    pub(crate) fn write(&mut self, address: u32, value: u32) {
        if address == SEND_STREAM && value & 1 != 0 {
            self.note(Step::Sent);
        }
    }
}
