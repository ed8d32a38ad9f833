//! Random moves of every kind, for property tests.

use crate::messages::number;
use fivebar_firmware::{CrossingMove, Move, MoveKind, TimedCurve, TimedMove};
use proptest::prelude::*;

/// Any kind of move, with numbers from this strategy.
pub(crate) fn move_kind(
    number: impl Strategy<Value = f32> + Clone + 'static,
) -> impl Strategy<Value = MoveKind> {
    let pair = [number.clone(), number.clone()];
    prop_oneof![
        (pair.clone(), number.clone()).prop_map(|(to, feed)| MoveKind::Line { to, feed }),
        (pair.clone(), pair.clone(), any::<bool>(), number.clone()).prop_map(
            |(to, center, clockwise, feed)| MoveKind::Arc {
                to,
                center,
                clockwise,
                feed,
            }
        ),
        number
            .clone()
            .prop_map(|duration| MoveKind::Dwell { duration }),
        (pair.clone(), number.clone()).prop_map(|(to, speed)| MoveKind::Joint { to, speed }),
        timed_move(pair.clone(), number.clone()).prop_map(MoveKind::Timed),
        crossing_move(pair, number).prop_map(MoveKind::Crossing),
    ]
}

fn crossing_move(
    pair: impl Strategy<Value = [f32; 2]> + Clone + 'static,
    number: impl Strategy<Value = f32> + Clone + 'static,
) -> BoxedStrategy<CrossingMove> {
    let moves = (
        [pair.clone(), pair],
        [number.clone(), number.clone()],
        prop::array::uniform3(number),
    );
    let moves = moves.prop_map(|([from, to], [duration, crosses_at], law)| CrossingMove {
        from,
        to,
        duration,
        crosses_at,
        law,
    });
    moves.boxed()
}

fn timed_move(
    pair: impl Strategy<Value = [f32; 2]> + Clone + 'static,
    number: impl Strategy<Value = f32> + Clone + 'static,
) -> BoxedStrategy<TimedMove> {
    let curve = prop_oneof![
        (pair.clone(), pair.clone())
            .prop_map(|(start, tangent)| TimedCurve::Line { start, tangent }),
        (pair.clone(), pair.clone(), number.clone()).prop_map(|(start, tangent, curvature)| {
            TimedCurve::Arc {
                start,
                tangent,
                curvature,
            }
        }),
        (prop::array::uniform6(pair), number.clone()).prop_map(|(coefficients, inverse_length)| {
            TimedCurve::Blend {
                coefficients,
                inverse_length,
            }
        }),
    ];
    let law = prop::array::uniform4(number.clone());
    let moves = (curve.boxed(), law, number).prop_map(|(curve, law, duration)| TimedMove {
        curve,
        law,
        duration,
    });
    // On the heap: a test that draws many would overflow its stack.
    moves.boxed()
}

/// A move of any kind, with any tag and tool output.
pub(crate) fn a_move() -> impl Strategy<Value = Move> {
    (any::<u32>(), any::<u16>(), move_kind(number())).prop_map(|(tag, tool, kind)| Move {
        tag,
        tool,
        kind,
    })
}
