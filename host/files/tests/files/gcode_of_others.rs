//! Words that other machines know: what cannot change the drawing is noted, what can is done, the rest refused by name.

use crate::placed::{AS_WRITTEN, job, refusal};
use fivebar_files::job::{Action, GcodeError, Job, JobOptions, WarningKind};

/// The ends of all motions [mm].
fn ends(text: &str) -> Vec<[f64; 2]> {
    let steps = job(text).steps;
    let ends = steps.iter().filter_map(|step| step.action.end());
    ends.map(|end| end.map(|metres| (1e9 * metres).round() / 1e6))
        .collect()
}

fn kinds(text: &str) -> Vec<WarningKind> {
    job(text)
        .warnings
        .into_iter()
        .map(|note| note.kind)
        .collect()
}

#[test]
fn g92_1_takes_the_shift_back_and_g92_3_sets_the_kept_one_again() {
    let start = "G21 G90\nG0 X5 Y5\nG92 X0 Y0\nG1 X20 Y0 F600\n";
    assert_eq!(
        ends(&format!("{start}G92.1\nG1 X20 Y20\nM2\n")),
        [[5.0, 5.0], [25.0, 5.0], [20.0, 20.0]]
    );
    assert_eq!(
        ends(&format!("{start}G92.2\nG1 X20 Y20\nG92.3\nG1 X20 Y20\n")),
        [[5.0, 5.0], [25.0, 5.0], [20.0, 20.0], [25.0, 25.0]]
    );
}

#[test]
fn g10_l20_gives_the_present_position_coordinates_and_other_tables_are_skipped_or_refused() {
    let line = [[0.0, 0.0], [10.0, 0.0]];
    assert_eq!(
        ends("G21 G90\nG10 L20 P1 X0 Y0\nG0 X0 Y0\nG1 X10 F600\nM2\n"),
        line
    );
    // The shift of G92 is no part of it.
    let both = "G0 X5\nG10 L20 P0 X0\nG92 X7\nG0 X8\nG92.1\nG0 X1\n";
    assert_eq!(ends(both), [[5.0, 0.0], [6.0, 0.0]]);
    let skipped = kinds("G10 L1 P1 Z5\nG0 X1\n");
    assert!(
        skipped.contains(&WarningKind::UnknownCode("G10 L1".into())),
        "{skipped:?}"
    );
    for (text, name) in [
        ("G10 L2 P1 X0 Y0", "G10 L2"),
        ("G10 L20 P2 X0 Y0", "G10 L20"),
        ("G10 P1 X0", "G10"),
    ] {
        let (line, reason) = refusal(text);
        assert!(
            line == 1 && matches!(&reason, GcodeError::ChangesDrawing(code, _) if code == name),
            "{reason:?}"
        );
    }
}

#[test]
fn slashes_blanks_in_numbers_and_axes_at_zero_are_noted() {
    let text = "/G21 G90\nG0 X0 Y0\n/G1 X99 F600\nG1 X1 0 A0\nM2\n";
    assert_eq!(ends(text), [[0.0, 0.0], [99.0, 0.0], [10.0, 0.0]]);
    let kinds = kinds(text);
    for kind in [
        WarningKind::BlockDelete,
        WarningKind::Blanks,
        WarningKind::NoAxis('A'),
    ] {
        assert!(kinds.contains(&kind), "{kind:?} is missing in {kinds:?}");
    }
    assert_eq!(refusal("G0 X1 C90"), (1, GcodeError::NoAxis('C')));
    assert_eq!(ends("G0 X1 0.5 Y 2\n"), [[10.5, 2.0]]);
}

#[test]
fn a_file_without_f_is_drawn_at_the_arms_speed_and_another_speed_takes_the_place_of_f() {
    let text = "G21\nG17\nG90\nG00 X10 Y10\nG01 X20 Y10\nG03 X20 Y20 J5\nM2\n";
    let read = |text: &str, options: JobOptions| {
        let job = Job::parse_with(text, &AS_WRITTEN, &options).unwrap();
        let feeds = job.steps.iter().filter_map(|step| match step.action {
            Action::Line { feed, .. } => feed,
            Action::Arc { feed, .. } => Some(feed),
            _ => None,
        });
        let kinds: Vec<_> = job.warnings.iter().map(|note| note.kind.clone()).collect();
        (feeds.collect::<Vec<_>>(), kinds)
    };
    assert_eq!(refusal(text), (5, GcodeError::NoFeed));
    let of_arm = JobOptions {
        speed_without_feed: Some(0.4),
        ..JobOptions::default()
    };
    let (feeds, notes) = read(text, of_arm);
    assert!(feeds == [0.4, 0.4] && notes.contains(&WarningKind::NoFeed));
    let asked = JobOptions {
        speed: Some(0.05),
        ..of_arm
    };
    let (feeds, notes) = read(text, asked);
    assert!(feeds == [0.05, 0.05] && !notes.contains(&WarningKind::NoFeed));
    let (feeds, notes) = read(&format!("F600\n{text}"), asked);
    assert!(feeds == [0.05, 0.05] && notes.contains(&WarningKind::FeedReplaced));
}
