//! A pen on the output of a spindle: which S of M3 and M4 is down.
//!
//! Most programs write one S for down, and 0 or M5 for up. Those for servos on Grbl's spindle output
//! write two widths, such as `M3 S90` and `M3 S30`, and either may be down. Where a file travels with
//! the spindle on, the S with the greater share of travel is up.

use super::tool::{SpeedRule, Spindle, ToolState};
use super::{Warning, WarningKind};

/// Motions off after which a file does not travel with the spindle on: parking is one.
const MOST_OFF: u32 = 1;

/// The motions at one S.
#[derive(Clone, Copy, Debug)]
struct AtSpeed {
    speed: f64,
    feeds: u32,
    rapids: u32,
}

/// The motions of a job by S of M3 and M4.
#[derive(Clone, Debug, Default)]
pub(super) struct PenSpeeds {
    /// The first three different S above 0, in the file's order: two are a pen's.
    speeds: Vec<AtSpeed>,
    /// Motions with the spindle off after it was on.
    off: u32,
    /// The first line with an S above 0.
    line: u32,
}

impl PenSpeeds {
    /// Notes a motion.
    pub(super) fn moves(&mut self, line: u32, tool: &ToolState, is_rapid: bool) {
        let speed = tool.speed.filter(|&speed| speed > 0.0);
        let Some(speed) = speed.filter(|_| tool.spindle != Spindle::Off) else {
            self.off += u32::from(!self.speeds.is_empty());
            return;
        };
        if self.speeds.is_empty() {
            self.line = line;
        }
        let (feeds, rapids) = (u32::from(!is_rapid), u32::from(is_rapid));
        let are_three = self.speeds.len() == 3;
        match self.speeds.iter_mut().find(|at| at.speed == speed) {
            Some(at) => (at.feeds, at.rapids) = (at.feeds + feeds, at.rapids + rapids),
            None if !are_three => self.speeds.push(AtSpeed {
                speed,
                feeds,
                rapids,
            }),
            None => {}
        }
    }

    /// The rule of a job that switches the pen by S, and a note on it.
    pub(super) fn rule(&self) -> (SpeedRule, Option<Warning>) {
        let &[first, second] = &self.speeds[..] else {
            return self.above_zero();
        };
        let rapids = first.rapids + second.rapids;
        if rapids == 0 && self.off > MOST_OFF {
            return self.above_zero();
        }
        let travel = |at: AtSpeed| f64::from(at.rapids) / f64::from(at.rapids + at.feeds);
        let is_first_down = match travel(first).total_cmp(&travel(second)) {
            std::cmp::Ordering::Equal => first.feeds > second.feeds,
            order => order.is_lt(),
        };
        let [down, up] = match is_first_down {
            true => [first.speed, second.speed],
            false => [second.speed, first.speed],
        };
        let note = Warning::at(self.line, WarningKind::PenSpeeds { down, up });
        (SpeedRule::Nearer { down, up }, Some(note))
    }

    /// The rule that any S above 0 is down, and a note on it.
    pub(super) fn above_zero(&self) -> (SpeedRule, Option<Warning>) {
        let note = Warning::at(self.line, WarningKind::PenDown);
        (
            SpeedRule::AboveZero,
            Some(note).filter(|_| !self.speeds.is_empty()),
        )
    }
}
