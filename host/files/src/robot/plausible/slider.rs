//! The slider-driven mechanism: its lengths, the sliders' travel, and its tolerances.

use super::Plausible;
use super::parts::{CLEARANCE, LENGTH};
use crate::refusal::Key;
use crate::robot::value::{LONGEST, SHORTEST};
use fivebar_design::accuracy::slider::SliderTolerance;
use fivebar_design::slider::Travel;

/// The shortest of links and platform, as a share of the longest.
const RATIO: f64 = 0.01;

/// Error of a slider's position over the shortest length.
const INPUT: f64 = 0.01;

/// The sliders' positions, as a multiple of the links' and the platform's length.
const TRAVEL: f64 = 100.0;

pub(super) fn rules(
    [left, right, platform]: [f64; 3],
    travel: Option<&Travel<f64>>,
    tolerance: &SliderTolerance,
) -> Vec<Plausible> {
    let longest = left.max(right).max(platform);
    let link = |name, length| {
        [
            Plausible::new(
                Key::Top(name),
                (length, "m"),
                [SHORTEST, LONGEST],
                "a length in metres",
            ),
            Plausible::new(
                Key::Top(name),
                (length, "m"),
                [RATIO * longest, longest],
                "a hundredth of the longest of links and platform, to the longest",
            ),
        ]
    };
    let mut rules = Vec::from(link("left_link", left));
    rules.extend(link("right_link", right));
    rules.extend(link("platform", platform).map(Plausible::or_zero));
    for (name, range) in travel
        .into_iter()
        .flat_map(|travel| [("left", travel.left), ("right", travel.right)])
    {
        rules.extend(range.map(|position| {
            Plausible::new(
                Key::In("travel", name),
                (position, "m"),
                [0.0, TRAVEL * longest],
                "100 times the longest of links and platform",
            )
        }));
    }
    let shortest = if platform > 0.0 {
        left.min(right).min(platform)
    } else {
        left.min(right)
    };
    let SliderTolerance {
        length_sd,
        input_sd,
        input_max,
        clearance_radius,
    } = tolerance;
    for (name, values, share, reason) in [
        (
            "length_sd",
            &length_sd[..],
            LENGTH,
            "1/20 of the shortest length",
        ),
        (
            "input_sd",
            &input_sd[..],
            INPUT,
            "1/100 of the shortest length",
        ),
        (
            "input_max",
            &input_max[..],
            INPUT,
            "1/100 of the shortest length",
        ),
        (
            "clearance_radius",
            &clearance_radius[..],
            CLEARANCE,
            "1/100 of the shortest length",
        ),
    ] {
        let key = Key::In("tolerance", name);
        let rule =
            |value: &f64| Plausible::new(key, (*value, "m"), [0.0, share * shortest], reason);
        rules.extend(values.iter().map(rule));
    }
    rules
}
