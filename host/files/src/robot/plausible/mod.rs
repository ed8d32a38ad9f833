//! Whether a robot's values are plausible together.
//!
//! A value in another unit is usually wrong by a factor of a thousand. Alone it is a valid number, so it
//! is compared with what physics says of the values around it: a peak current with the stall current,
//! a mass with the length of its link, an encoder's count with the greatest following error. The ranges
//! are wide, so that real arms lie within them by a factor of three at least.

mod arm;
mod drive;
mod motion;
mod parts;
mod slider;

use super::Robot;
use super::value::rounded;
use crate::refusal::{Key, Refusal, Refusals};
use crate::source::Source;
use fivebar_design::accuracy::slider::SliderTolerance;
use fivebar_design::slider::Travel;

/// A value with its plausible range.
struct Plausible {
    key: Key,
    /// A key that decides the range, whose line is named if the file leaves the value to its default.
    decisive: Option<Key>,
    value: f64,
    unit: &'static str,
    range: [f64; 2],
    /// Whether 0 means that there is none of it.
    may_be_zero: bool,
    /// What the range follows from, as the rest of a sentence.
    reason: &'static str,
}

impl Plausible {
    fn new(
        key: Key,
        (value, unit): (f64, &'static str),
        range: [f64; 2],
        reason: &'static str,
    ) -> Self {
        Self {
            key,
            decisive: None,
            value,
            unit,
            range,
            may_be_zero: false,
            reason,
        }
    }

    fn compared_with(self, key: Key) -> Self {
        Self {
            decisive: Some(key),
            ..self
        }
    }

    fn or_zero(self) -> Self {
        Self {
            may_be_zero: true,
            ..self
        }
    }

    fn holds(&self) -> bool {
        let [least, greatest] = self.range;
        let size = self.value.abs();
        (least..=greatest).contains(&size) || (self.may_be_zero && size == 0.0)
    }

    /// Refuses a value outside its range. A default is refused only where a written value decides its range.
    fn check(&self, source: &Source<'_>) -> Result<(), Refusal> {
        let mut written = [Some(self.key), self.decisive].into_iter().flatten();
        let Some(written) = written.find(|key| source.holds(*key)) else {
            return Ok(());
        };
        if self.holds() {
            return Ok(());
        }
        let Self {
            value,
            unit,
            range: [least, greatest],
            reason,
            ..
        } = *self;
        let space = if unit.is_empty() { "" } else { " " };
        let unit = format!("{space}{unit}");
        let zero = if self.may_be_zero { "0, or " } else { "" };
        let bounds = if least == 0.0 {
            format!("{}{unit} at most", rounded(greatest))
        } else if greatest == f64::MAX {
            format!("{}{unit} at least", rounded(least))
        } else {
            format!("{zero}{} to {}{unit}", rounded(least), rounded(greatest))
        };
        let default = if written == self.key {
            ""
        } else {
            ", the default"
        };
        let reason = format!(
            "must be {bounds}: {reason}; not {value:?}{unit}{default}: is one of these values in another unit?"
        );
        Err(Refusal {
            line_of: Some(written.into()),
            ..self.key.refused(reason)
        })
    }
}

/// Refuses each value that is not plausible. Values of one link or one actuator are compared with each
/// other, so the first of them is refused alone.
pub(super) fn check_sizes(source: &Source<'_>, robot: &Robot, refusals: &mut Refusals) {
    let arm = arm::rules(robot);
    let rules = arm
        .into_iter()
        .chain(drive::rules(robot))
        .chain(motion::rules(robot))
        .chain(parts::rules(robot));
    for rule in rules {
        let is_refused = match rule.key {
            Key::Of(section, index, _) => refusals.has_of(section, index),
            key => refusals.has(key),
        };
        if !is_refused {
            refusals.note(rule.check(source));
        }
    }
}

/// Refuses the first value of a slider-driven mechanism that is not plausible: left link, right link and platform [m], travel and tolerances.
pub(super) fn check_slider(
    source: &Source<'_>,
    lengths: [f64; 3],
    travel: Option<&Travel<f64>>,
    tolerance: &SliderTolerance,
) -> Result<(), Refusal> {
    let rules = slider::rules(lengths, travel, tolerance);
    rules.into_iter().try_for_each(|rule| rule.check(source))
}

/// The longest distance from a driven joint to C [m].
fn reach(robot: &Robot) -> f64 {
    let [l1, l2, l3, l4, _] = robot.geometry.lengths();
    (l1 + l2).max(l3 + l4)
}

/// The shortest of the links and of a base that is not 0 [m].
fn shortest(robot: &Robot) -> f64 {
    let lengths = robot.geometry.lengths().into_iter();
    lengths
        .filter(|&length| length > 0.0)
        .fold(f64::MAX, f64::min)
}

fn longest(robot: &Robot) -> f64 {
    robot.geometry.lengths().into_iter().fold(0.0, f64::max)
}
