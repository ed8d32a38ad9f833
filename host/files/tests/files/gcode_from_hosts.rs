//! G-code as common programs write it: with line numbers, checksums and old encodings.

use crate::placed::{AS_WRITTEN, job, refusal};
use fivebar_files::job::{self, GcodeError, Job};
use proptest::prelude::*;

/// A line with its checksum, as hosts of the RepRap family send it.
fn with_checksum(line: &str) -> String {
    let sum = line.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("{line}*{sum}")
}

#[test]
fn numbered_lines_with_checksums_equal_plain_lines() {
    // Checksums from the RepRap wiki and from Marlin's documentation of G-code.
    assert_eq!(with_checksum("N3 T0"), "N3 T0*57");
    assert_eq!(with_checksum("N4 G92 E0"), "N4 G92 E0*67");
    let plain = "M110\nG21\nG1 X10 Y5 F600\nG1 X-3\n";
    let numbered = ["N0 M110", "N1 G21", "N2 G1 X10 Y5 F600", "N3 G1 X-3"].map(with_checksum);
    assert_eq!(job(&numbered.join("\n")).steps, job(plain).steps);
    // Some programs write a space before the star or a comment after the checksum.
    let spaced = format!(
        "{}\r\n  {} ; 2*3\n",
        with_checksum("N1 G1 F60 X1 "),
        with_checksum("N2 Y2")
    );
    assert_eq!(job(&spaced).steps, job("G1 F60 X1\nY2").steps);
}

#[test]
fn a_damaged_line_is_refused_with_both_checksums() {
    let damaged = format!(
        "G1 F60 X0\n{}",
        with_checksum("N2 G1 X10").replace("X10", "X90")
    );
    let (line, reason) = refusal(&damaged);
    assert_eq!(line, 2);
    let GcodeError::Checksum { stated, found } = reason else {
        panic!("{reason}");
    };
    assert_eq!(stated ^ found, b'1' ^ b'9');
    assert!(reason.to_string().contains(&stated.to_string()));
}

#[test]
fn stars_outside_checksums_are_text_in_comments_and_errors_elsewhere() {
    // Stars are text in comments, and no G-code elsewhere.
    for harmless in [
        "N1 G1 F60 X1 ; 5*3",
        "N1 G1 F60 X1 (5*3)",
        "N1 (2*3) G1 F60 X1",
    ] {
        assert_eq!(job(harmless).steps, job("G1 F60 X1").steps);
    }
    for stray in [
        "N1 G1 F60 X1*300",
        "N1 G1 F60 X1*",
        "G1 F60 X1*2",
        "N1 G1 X1*1*2",
    ] {
        assert!(!matches!(refusal(stray).1, GcodeError::Checksum { .. }) || stray.contains("1*2"));
    }
    // Stars are text in messages, too.
    assert_eq!(job("M117 half*2\nG0 F60 X1").steps.len(), 1);
}

#[test]
fn old_encodings_are_read_in_comments_and_refused_elsewhere_with_their_line() {
    let folder = tempfile::tempdir().unwrap();
    let read = |bytes: &[u8]| {
        let path = folder.path().join("job.gcode");
        std::fs::write(&path, bytes).unwrap();
        job::read(&path).unwrap()
    };
    // Latin-1: "für" and "Größe".
    let commented = read(b"; f\xfcr\nG1 F60 X1 (Gr\xf6\xdfe)\n");
    assert_eq!(job(&commented).steps, job("\nG1 F60 X1").steps);
    let (line, _) = refusal(&read(b"G1 F60 X1\nG1 X\xb2\n"));
    assert_eq!(line, 2);
}

proptest! {
    #[test]
    fn any_single_flipped_bit_of_a_line_with_checksum_is_detected(
        number in 0..99_999_u32, x in -99.0..99.0_f64, place in any::<prop::sample::Index>(),
        bit in 0..7_u32,
    ) {
        let line = with_checksum(&format!("N{number} G1 F600 X{x:.3}"));
        prop_assert!(Job::parse(&line, &AS_WRITTEN).is_ok());
        let mut bytes = line.into_bytes();
        let star = bytes.iter().rposition(|&byte| byte == b'*').unwrap();
        // The leading N, which marks a numbered line, stays undamaged.
        let damaged = &mut bytes[1 + place.index(star - 1)];
        *damaged ^= 1 << bit;
        // A bit error that begins a comment cannot be detected.
        prop_assume!(!b";(".contains(damaged));
        let damaged = String::from_utf8(bytes).unwrap();
        prop_assert!(Job::parse(&damaged, &AS_WRITTEN).is_err(), "{damaged}");
    }
}
