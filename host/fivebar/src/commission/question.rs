//! What a step asks of somebody's eyes and hands: what no sensor of the arm tells.

use fivebar_kinematics::five_bar::Joint;

/// How far a joint may have turned, over how far it was to turn: micro-steps are set in powers of two.
const SHARES: [f64; 7] = [1.0, 0.125, 0.25, 0.5, 2.0, 4.0, 8.0];

/// A question.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Question {
    /// Whether a hand can turn a joint.
    IsHeld(Joint),
    /// Which way a joint turned that was to turn by this angle [rad].
    Way(Joint, f64),
    /// How far it turned.
    Far(Joint, f64),
    /// Whether a joint has moved at all.
    Moves(Joint),
}

/// An answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Answer {
    /// A hand turns it easily.
    Free,
    /// It is held.
    Held,
    /// It turned as it should, about so far.
    AsAsked,
    /// It turned the other way.
    OtherWay,
    /// The other joint turned.
    OtherJoint,
    /// It hummed or trembled, and stayed where it was.
    Hums,
    /// Nothing moved, and the motor made no sound.
    Nothing,
    /// It turned by this share of what was asked.
    Share(f64),
    /// It has moved.
    Moved,
    /// None of the others.
    Else,
}

impl Question {
    pub(super) fn text(&self) -> String {
        match *self {
            Self::IsHeld(joint) => {
                format!("Try gently to turn the crank of {joint} by hand. What do you feel")
            }
            Self::Way(joint, by) => format!(
                "{joint} was to turn {} by {:.0}°. What did you see",
                way(by),
                by.abs().to_degrees()
            ),
            Self::Far(joint, by) => format!(
                "{joint} was to turn by {:.0}°. By how much did it turn",
                by.abs().to_degrees()
            ),
            Self::Moves(joint) => format!("Has {joint} moved, if ever so little"),
        }
    }

    /// The answers, each with its words.
    pub(super) fn answers(&self) -> Vec<(Answer, String)> {
        match *self {
            Self::IsHeld(_) => vec![
                (Answer::Free, "it turns; at most it clicks softly".into()),
                (Answer::Held, "it is held".into()),
            ],
            Self::Way(joint, by) => vec![
                (Answer::AsAsked, format!("it turned {}", way(by))),
                (Answer::OtherWay, format!("it turned {}", way(-by))),
                (Answer::OtherJoint, format!("{} turned", joint.other())),
                (
                    Answer::Hums,
                    "it hummed or trembled, and stayed about where it was".into(),
                ),
                (
                    Answer::Nothing,
                    "nothing moved, and the motor made no sound".into(),
                ),
            ],
            Self::Far(_, by) => {
                let shares = SHARES.map(|share| {
                    let turned = share * by.abs().to_degrees();
                    (
                        Answer::Share(share),
                        format!("by about {}°", (10.0 * turned).round() / 10.0),
                    )
                });
                let other = (Answer::Else, "by something else".into());
                shares.into_iter().chain([other]).collect()
            }
            Self::Moves(_) => vec![
                (Answer::Nothing, "no".into()),
                (Answer::Moved, "yes".into()),
            ],
        }
    }

    /// What somebody sees who was looking while the joints turned by `turned` [rad] and whose motors took currents of
    /// `current` [A] then.
    pub(super) fn seen(&self, turned: [f64; 2], current: [f64; 2]) -> Answer {
        /// Above the noise of a current that is none [A].
        const CURRENT: f64 = 0.05;
        /// The share of a turn that is seen.
        const SEEN: f64 = 0.2;
        /// The least turn that is seen at the end of a crank [rad].
        const LEAST: f64 = 1e-3;
        match *self {
            Self::IsHeld(joint) if current[joint] > CURRENT => Answer::Held,
            Self::IsHeld(_) => Answer::Free,
            Self::Way(joint, by) => {
                let [own, other] = [turned[joint], turned[joint.other()]].map(|it| it / by);
                if other.abs() > SEEN.max(own.abs()) {
                    Answer::OtherJoint
                } else if own > SEEN {
                    Answer::AsAsked
                } else if own < -SEEN {
                    Answer::OtherWay
                } else if current[joint] > CURRENT {
                    Answer::Hums
                } else {
                    Answer::Nothing
                }
            }
            Self::Far(joint, by) => {
                let share = turned[joint] / by;
                let near = |one: &f64| (share / one - 1.0).abs() < SEEN;
                let seen = SHARES.into_iter().find(near);
                seen.map_or(Answer::Else, Answer::Share)
            }
            Self::Moves(joint) if turned[joint].abs() > LEAST => Answer::Moved,
            Self::Moves(_) => Answer::Nothing,
        }
    }
}

/// The way of an angle, seen from above the arm.
fn way(angle: f64) -> &'static str {
    match angle > 0.0 {
        true => "counter-clockwise",
        false => "clockwise",
    }
}

#[cfg(test)]
mod tests {
    use super::{Answer, Question};
    use fivebar_kinematics::five_bar::Joint;

    #[test]
    fn each_answer_that_is_seen_is_one_of_those_that_are_offered() {
        let (way, far) = (
            Question::Way(Joint::Joint4, -0.1),
            Question::Far(Joint::Joint4, 0.4),
        );
        for (question, turned, current, wanted) in [
            (
                Question::IsHeld(Joint::Joint1),
                [0.0; 2],
                [0.0, 1.0],
                Answer::Free,
            ),
            (
                Question::IsHeld(Joint::Joint4),
                [0.0; 2],
                [0.0, 1.0],
                Answer::Held,
            ),
            (way, [0.0, -0.1], [0.0; 2], Answer::AsAsked),
            (way, [0.0, 0.09], [0.0; 2], Answer::OtherWay),
            (way, [-0.1, 0.0], [0.0; 2], Answer::OtherJoint),
            (way, [0.001, 0.01], [0.0, 1.0], Answer::Hums),
            (way, [0.001, 0.01], [1.0, 0.0], Answer::Nothing),
            (far, [0.0, 0.41], [0.0; 2], Answer::Share(1.0)),
            (far, [0.0, 0.21], [0.0; 2], Answer::Share(0.5)),
            (far, [0.0, 0.3], [0.0; 2], Answer::Else),
            (
                Question::Moves(Joint::Joint1),
                [2e-3, 0.0],
                [0.0; 2],
                Answer::Moved,
            ),
            (
                Question::Moves(Joint::Joint1),
                [0.0, 2e-3],
                [0.0; 2],
                Answer::Nothing,
            ),
        ] {
            let seen = question.seen(turned, current);
            assert_eq!(seen, wanted, "{question:?}");
            let mut offered = question.answers().into_iter();
            assert!(offered.any(|(answer, _)| answer == seen), "{question:?}");
        }
    }
}
