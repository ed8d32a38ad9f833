//! The G-code reader: the steps of each code, the errors for unsupported text, and random texts,
//! on which it must not panic.

use crate::placed::{AS_WRITTEN, job, refusal};
use fivebar_files::job::{
    Action, GcodeError, Job, JobError, JobOptions, Placement, Step, ToolWords,
};
use proptest::prelude::*;
use std::fmt::Write as _;

fn steps(text: &str) -> Vec<Step> {
    job(text).steps
}

fn ends(text: &str) -> Vec<[f64; 2]> {
    let mut ends = Vec::new();
    for step in steps(text) {
        match step.action {
            Action::Line { to, .. } | Action::Arc { to, .. } => {
                ends.push(to.map(|metres| (metres * 1e9).round() / 1e6));
            }
            Action::Dwell { .. } | Action::ChangeMode(_) | Action::Cross { .. } => {}
        }
    }
    ends
}

fn only_arc(text: &str) -> ([f64; 2], [f64; 2], bool) {
    let arcs: Vec<_> = steps(text)
        .into_iter()
        .filter_map(|step| match step.action {
            Action::Arc {
                to,
                center,
                clockwise,
                ..
            } => Some((to, center, clockwise)),
            _ => None,
        })
        .collect();
    assert_eq!(arcs.len(), 1);
    arcs[0]
}

#[test]
fn coordinates_are_in_millimetres_or_inches_absolute_or_relative() {
    assert_eq!(
        ends("G0 F600 X10 Y5\nG91 G1 X1\nY-2\nG90 X0"),
        [[10.0, 5.0], [11.0, 5.0], [11.0, 3.0], [0.0, 3.0]]
    );
    assert_eq!(ends("G20\nG0 X1 Y-.5"), [[25.4, -12.7]]);
    assert_eq!(ends("G70\nG0 X1\nG71\nG0 X2"), [[25.4, 0.0], [2.0, 0.0]]);
}

#[test]
fn feeds_are_per_minute_in_the_current_unit_and_rapid_moves_have_none() {
    let feed = |text| match steps(text).last().unwrap().action {
        Action::Line { feed, .. } => feed,
        other => panic!("{other:?}"),
    };
    assert_eq!(feed("G1 X1 F600"), Some(0.01));
    assert_eq!(feed("F600\nG1 X1"), Some(0.01));
    assert_eq!(feed("G20 G1 X1 F60"), Some(0.0254));
    assert_eq!(feed("F600\nG0 X1"), None);
}

#[test]
fn g92_shifts_coordinates_and_g28_moves_home() {
    assert_eq!(
        ends("G0 X10 Y10\nG92 X0\nG0 X5 Y5\nG92\nG0 X1"),
        [[10.0, 10.0], [15.0, 5.0], [16.0, 5.0]]
    );
    assert_eq!(
        ends("G0 X1\nG28\nG91 G0 X1"),
        [[1.0, 0.0], [50.0, 200.0], [1.0, 0.0]]
    );
    // A slicer's purge line begins at the X0 that homing gives a printer.
    assert_eq!(
        ends("G28\nG1 Y-3 F1000\nG1 X60 E9\nG28\nG1 X5 E10"),
        [
            [50.0, 200.0],
            [0.0, -3.0],
            [60.0, -3.0],
            [50.0, 200.0],
            [0.0, 0.0],
            [5.0, 0.0]
        ]
    );
}

#[test]
fn origin_and_scale_apply_to_positions_and_not_to_feeds() {
    let placement = Placement {
        origin: [0.1, 0.2],
        scale: 2.0,
        turn: 0.0,
        home: [0.3, 0.4],
    };
    let job = Job::parse("G0 X0\nG1 X10 Y-10 F60\nG28", &placement).unwrap();
    let Action::Line { to, feed } = job.steps[1].action else {
        panic!("not a line")
    };
    assert!((to[0] - 0.12).abs() < 1e-15 && (to[1] - 0.18).abs() < 1e-15);
    assert_eq!(feed, Some(1e-3));
    assert!(matches!(job.steps[2].action, Action::Line { to, .. }
        if (to[0] - 0.3).abs() < 1e-15 && (to[1] - 0.4).abs() < 1e-15));
}

#[test]
fn arcs_by_offsets_and_by_radius_have_the_same_centre() {
    for (radius, center) in [(5.0, [5.0, 5.0]), (-5.0, [10.0, 10.0])] {
        let text = format!("G0 X10 Y5\nG3 X5 Y10 R{radius} F100");
        let (_, by_radius, clockwise) = only_arc(&text);
        let offset = [center[0] - 10.0, center[1] - 5.0];
        let text = format!("G0 X10 Y5\nG3 X5 Y10 I{} J{} F100", offset[0], offset[1]);
        let (_, by_offset, _) = only_arc(&text);
        assert!(!clockwise);
        for axis in 0..2 {
            assert!((by_radius[axis] - 1e-3 * center[axis]).abs() < 1e-12);
            assert!((by_offset[axis] - 1e-3 * center[axis]).abs() < 1e-12);
        }
    }
    let (_, center, clockwise) = only_arc("G0 X10 Y5\nG2 X5 Y10 R5 F100");
    assert!(clockwise && (center[0] - 0.01).abs() < 1e-12);
}

#[test]
fn radii_that_differ_by_rounding_are_made_equal_and_others_refused() {
    let (to, center, _) = only_arc("F100\nG3 X7.071 Y2.929 I0 J10.002");
    let radius = center[0].hypot(center[1]);
    assert!((radius - (to[0] - center[0]).hypot(to[1] - center[1])).abs() < 1e-15);
    let (line, error) = refusal("F100\nG2 X5 Y5 I0 J9");
    assert!(line == 2 && matches!(error, GcodeError::ArcEnds(..)));
}

#[test]
fn an_arc_to_its_start_is_a_full_circle_and_a_negligible_arc_is_none() {
    let (to, center, _) = only_arc("F100\nG0 X10\nG2 I-10");
    assert_eq!((to, center), ([0.01, 0.0], [0.0, 0.0]));
    let negligible = steps("F100\nG0 X10\nG3 X10 Y0.00001 I-10");
    assert_eq!(negligible.len(), 1);
    let nearly_full = steps("F100\nG0 X10\nG2 X10 Y0.00001 I-10");
    // In thirds, so that the centre stays where it is.
    assert_eq!(nearly_full.len(), 4);
}

#[test]
fn an_arc_as_first_motion_is_preceded_by_a_line_to_its_start() {
    let steps = steps("G2 X10 I5 F100");
    assert!(matches!(
        steps[0].action,
        Action::Line {
            to: [0.0, 0.0],
            feed: None
        }
    ));
    assert!(matches!(steps[1].action, Action::Arc { .. }));
    assert_eq!((steps[0].line, steps[1].line), (0, 1));
    assert!(!steps[0].draws() && steps[1].draws());
}

#[test]
fn an_unknown_m_code_is_skipped_with_its_text() {
    let text = "M117 Layer 3 (of 7)\nG0 X1\nN30 M486 A\"lid\" X9\nM118 X2 Y2\nm23 file.gco\nG0 X3";
    assert_eq!(ends(text), [[1.0, 0.0], [3.0, 0.0]]);
    let skipped = job(text).warnings;
    assert!(skipped.iter().map(|it| it.line).eq([0, 1, 3, 4, 5]));
    assert!(matches!(refusal("M3 Sfast"), (1, GcodeError::Syntax(_))));
}

#[test]
fn line_numbers_count_comments_and_blank_lines_and_ignore_n_words() {
    let text = "%\n(head\tline)\n\nN10 G21 ; units\r\nN20 g0 x1 (a) y2 f100 (b)\n";
    let steps = steps(text);
    assert_eq!((steps.len(), steps[0].line), (1, 5));
    let moves: Vec<_> = job(text).moves(0.5).collect();
    assert_eq!(moves[0].tag, 5);
}

#[test]
fn the_job_ends_at_m2_and_m30() {
    assert_eq!(ends("G0 X1\nM2\nG0 X2 garbage"), [[1.0, 0.0]]);
    assert_eq!(ends("G0 X1\nG0 X3 M30\nG0 X2"), [[1.0, 0.0], [3.0, 0.0]]);
}

#[test]
fn only_moves_of_negligible_length_are_left_out() {
    let text = "F100\nG1 X0 Y0\nG1 X1\nG1 X1\nG1 X1.0002\nG1 X1.00025\nG1 X1.0004";
    assert_eq!(ends(text).len(), 4);
}

#[test]
fn unsupported_g_code_is_refused_with_line_and_reason() {
    let unknown = |code: &str| GcodeError::UnknownGCode(code.into());
    let conflict = |a: &str, b: &str| GcodeError::Conflict(a.into(), b.into());
    for (text, line, reason) in [
        ("G0 X1\nG38.2 X1", 2, unknown("G38.2")),
        ("G68", 1, unknown("G68")),
        ("X1", 1, GcodeError::NoMode),
        ("G1 X1", 1, GcodeError::NoFeed),
        ("G1 X1 F0", 1, GcodeError::Feed),
        ("G1 X1 F-5", 1, GcodeError::Feed),
        ("M3 S-4", 1, GcodeError::Power),
        ("G1 X1 F60 S-1", 1, GcodeError::Power),
        ("G0 X1 X2", 1, GcodeError::Repeated('X')),
        ("G0 X1 I3", 1, GcodeError::StrayWord('I')),
        ("G0 X1 P3", 1, GcodeError::StrayWord('P')),
        ("G0 X1e9", 1, GcodeError::Exponent),
        ("G0 G28 X1", 1, conflict("G0", "G28")),
        ("G0 X1\n(open", 2, GcodeError::OpenComment),
        ("G2 X1 F1", 1, GcodeError::ArcForm),
        ("G2 X1 R1 I1 F1", 1, GcodeError::ArcForm),
        ("G2 X1 R0 F1", 1, GcodeError::ArcRadius),
        ("G2 X1 I0 J0 F1", 1, GcodeError::ArcRadius),
        ("G2 X9 R1 F1", 1, GcodeError::ArcChord),
        ("G2 R1 F1", 1, GcodeError::ArcChord),
    ] {
        assert_eq!(refusal(text), (line, reason), "{text}");
    }

    assert!(matches!(refusal("G0 X1000001"), (1, GcodeError::TooFar(_))));
}

#[test]
fn malformed_words_and_numbers_are_refused() {
    for text in [
        "G0 Xnan",
        "G0 Xinf",
        "G0 X",
        "G0 X--1",
        "G0 X1.2.3",
        "G0 X$5",
        "hello",
        "G",
        "GX1",
        "G0 X1 é",
        "G0 X#1",
        "\u{0}",
        "12",
        "G4294967295",
        "M99999999999",
        "G0 X.",
    ] {
        let both = format!("G0 X1\n{text}\n");
        assert_eq!(refusal(&both).0, 2, "{text:?}");
    }
}

#[test]
fn the_message_quotes_the_line_shortened() {
    let text = format!("G0 X1 \u{7}{}", "é".repeat(5_000));
    let message = Job::parse(&text, &AS_WRITTEN).unwrap_err().to_string();
    assert!(message.starts_with("line 1: \"G0 X1 \u{FFFD}éé") && message.contains('…'));
    assert!(!message.contains('\u{7}'));
}

#[test]
fn a_job_without_motion_is_refused() {
    for text in ["(only words)", "%\n%", "G21\nG90\nM3\nM5", "G4 P100"] {
        assert_eq!(Job::parse(text, &AS_WRITTEN), Err(JobError::NoMotion));
    }
}

/// A step as G-code in absolute millimetres, which all dialects understand.
fn written(step: &Step) -> String {
    let mm = |metres: f64| 1e3 * metres;
    let mut text = String::new();
    let _ = writeln!(text, "{}", if step.draws() { "M3" } else { "M5" });
    let _ = match step.action {
        Action::Line { to, feed: None } => writeln!(text, "G0 X{:.6} Y{:.6}", mm(to[0]), mm(to[1])),
        Action::Line {
            to,
            feed: Some(feed),
        } => writeln!(
            text,
            "G1 X{:.6} Y{:.6} F{:.6}",
            mm(to[0]),
            mm(to[1]),
            mm(feed) * 60.0
        ),
        Action::Dwell { duration } => writeln!(text, "G4 S{duration:.9}"),
        Action::Arc { .. } | Action::ChangeMode(_) | Action::Cross { .. } => {
            unreachable!("`any_step` makes none")
        }
    };
    text
}

fn any_step() -> impl Strategy<Value = Step> {
    let point = [-0.5..0.5, -0.5..0.5_f64];
    let line = (point, proptest::option::of(1e-3..2.0_f64))
        .prop_map(|(to, feed)| Action::Line { to, feed });
    let dwell = (1e-3..5.0).prop_map(|duration| Action::Dwell { duration });
    (prop_oneof![4 => line, 1 => dwell], any::<bool>()).prop_map(|(action, down)| Step {
        line: 0,
        tool: f64::from(u8::from(down)),
        action,
    })
}

proptest! {
    #[test]
    fn written_steps_are_read_back(expected in proptest::collection::vec(any_step(), 1..20)) {
        let text: String = expected.iter().map(written).collect();
        let moving = |step: &Step| !matches!(step.action, Action::Dwell { .. });
        prop_assume!(expected.iter().any(moving));
        // The first line goes to the start without drawing.
        let options = JobOptions { tool: Some(ToolWords::Spindle), ..JobOptions::default() };
        let read = Job::parse_with(&format!("G0 X700\n{text}"), &AS_WRITTEN, &options).unwrap();
        let read = &read.steps[1..];
        prop_assert_eq!(read.len(), expected.len());
        for (index, (read, expected)) in read.iter().zip(&expected).enumerate() {
            prop_assert_eq!(read.line as usize, 2 * index + 3);
            prop_assert_eq!(read.tool, expected.tool);
            match (read.action, expected.action) {
                (Action::Line { to: a, feed: f }, Action::Line { to: b, feed: g }) => {
                    prop_assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-9);
                    prop_assert_eq!(f.is_some(), g.is_some());
                    prop_assert!((f.unwrap_or(0.0) - g.unwrap_or(0.0)).abs() < 1e-9);
                }
                (Action::Dwell { duration: a }, Action::Dwell { duration: b }) => {
                    prop_assert!((a - b).abs() < 1e-9);
                }
                other => prop_assert!(false, "{:?}", other),
            }
        }
    }

    #[test]
    fn an_arc_by_radius_passes_both_ends_on_the_side_of_its_sign(
        start in [-200.0..200.0, -200.0..200.0_f64],
        chord in [-50.0..50.0, -50.0..50.0_f64],
        excess in 1.0..3.0_f64,
        clockwise: bool,
        major: bool,
    ) {
        let length = chord[0].hypot(chord[1]);
        prop_assume!(length > 0.1);
        let radius = 0.5 * length * excess * if major { -1.0 } else { 1.0 };
        let text = format!(
            "G0 X{} Y{}\nG{} X{} Y{} R{radius} F100",
            start[0], start[1], if clockwise { 2 } else { 3 }, start[0] + chord[0], start[1] + chord[1],
        );
        let (to, center, _) = only_arc(&text);
        let from = [1e-3 * start[0], 1e-3 * start[1]];
        let arm = |point: [f64; 2]| [point[0] - center[0], point[1] - center[1]];
        let (a, b) = (arm(from), arm(to));
        prop_assert!((a[0].hypot(a[1]) - 1e-3 * radius.abs()).abs() < 1e-9);
        prop_assert!((b[0].hypot(b[1]) - 1e-3 * radius.abs()).abs() < 1e-9);
        // The angle of the arc in its direction, compared with half a turn.
        let turned = (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1]);
        let swept = (if clockwise { -turned } else { turned }).rem_euclid(std::f64::consts::TAU);
        if excess > 1.001 {
            prop_assert_eq!(swept > std::f64::consts::PI, major);
        }
    }

    #[test]
    fn the_reader_does_not_panic_on_any_text(text in "\\PC{0,200}") {
        let _ = Job::parse(&text, &AS_WRITTEN);
    }

    #[test]
    fn the_reader_does_not_panic_on_text_like_g_code(
        text in "([GMTNXYZIJRFPSgx%/;()#+\\- .\n][-+0-9.]{0,12}){0,40}"
    ) {
        if let Ok(job) = Job::parse(&text, &AS_WRITTEN) {
            for step in job.moves(1.0) {
                let shown = format!("{step:?}");
                prop_assert!(!shown.contains("NaN") && !shown.contains("inf"));
            }
        }
    }
}
