//! The command `fivebar flash`, with a folder in place of a board's drive.

use fivebar_testkit::program;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Output;

/// Runs it with only one folder in PATH.
fn flash(programs: &Path, arguments: &[&Path]) -> Output {
    let mut command = program(env!("CARGO_BIN_EXE_fivebar"));
    let command = command.arg("flash").args(arguments);
    command.env("PATH", programs).output().unwrap()
}

/// A file with an image's name in its second block.
fn uf2(name: &str, family: u32, first: u32) -> Vec<u8> {
    let mut file = Vec::new();
    for number in 0..3_u32 {
        let mut block = vec![0; 512];
        let mut word =
            |at: usize, word: u32| block[at..at + 4].copy_from_slice(&word.to_le_bytes());
        for (at, value) in [
            (0, 0x0a32_4655),
            (4, 0x9e5d_5157),
            (8, 0x2000),
            (12, first + 256 * number),
            (16, 256),
            (20, number),
            (24, 3),
            (28, family),
            (508, 0x0ab1_6f30),
        ] {
            word(at, value);
        }
        // It lies across the blocks.
        let image: Vec<u8> = [vec![0; 250], name.as_bytes().to_vec(), vec![0; 600]].concat();
        let from = 256 * number as usize;
        block[32..288].copy_from_slice(&image[from..from + 256]);
        file.extend(block);
    }
    file
}

const PICO_2: u32 = 0xe48b_ff59;
const START: u32 = 0x1000_0000;

fn drive(folder: &Path, board: &str) {
    std::fs::create_dir_all(folder).unwrap();
    let text = format!("UF2 Bootloader v1.0\r\nModel: Raspberry Pi\r\nBoard-ID: {board}\r\n");
    std::fs::write(folder.join("INFO_UF2.TXT"), text).unwrap();
}

fn message(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(1));
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[test]
fn a_file_goes_to_the_drive_of_its_board_alone() {
    let here = tempfile::tempdir().unwrap();
    let [board, older, empty] = ["board", "older", "empty"].map(|name| here.path().join(name));
    drive(&board, "RP2350");
    drive(&older, "RPI-RP2");
    std::fs::create_dir(&empty).unwrap();
    let file = here.path().join("mine.uf2");
    std::fs::write(&file, uf2("rp2350_servo", PICO_2, START)).unwrap();
    let option = Path::new("--drive");
    let output = flash(&empty, &[&file, option, &board]);
    assert!(output.status.success(), "{output:?}");
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.starts_with("rp2350_servo is on the board"), "{said}");
    let copied = std::fs::read(board.join("rp2350_servo.uf2")).unwrap();
    assert_eq!(copied, std::fs::read(&file).unwrap());

    let refused = message(&flash(&empty, &[&file, option, &older]));
    assert!(
        refused.contains("another board (Board-ID: RPI-RP2)"),
        "{refused}"
    );
    let refused = message(&flash(&empty, &[&file, option, &empty]));
    assert!(refused.contains("hold BOOTSEL"), "{refused}");
    assert_eq!(std::fs::read_dir(&older).unwrap().count(), 1);
    assert_eq!(std::fs::read_dir(&empty).unwrap().count(), 0);
}

#[test]
fn a_file_that_is_not_for_the_board_is_refused_before_the_board_gets_anything() {
    let here = tempfile::tempdir().unwrap();
    let board = here.path().join("board");
    drive(&board, "RP2350");
    let whole = uf2("rp2350_stepper", PICO_2, START);
    let mut damaged = whole.clone();
    damaged[512] ^= 1;
    let cases = [
        (damaged, "block 1 is damaged"),
        (whole[..600].to_vec(), "block 1 is damaged"),
        (whole[..1024].to_vec(), "2 of its 3 blocks"),
        ([&whole[..], &whole[..512]].concat(), "3 of its 3 blocks"),
        (
            uf2("rp2350_servo", 0xe48b_ff56, START),
            "an RP2040 (Pico 1)",
        ),
        (uf2("rp2350_servo", PICO_2, 0x1007_ff00), "the settings"),
        (uf2("blink", PICO_2, START), "none of the images"),
        (Vec::new(), "0 of its 0 blocks"),
    ];
    let file = here.path().join("mine.uf2");
    for (bytes, why) in cases {
        std::fs::write(&file, bytes).unwrap();
        let refused = message(&flash(here.path(), &[&file, Path::new("--drive"), &board]));
        assert!(
            refused.contains("mine.uf2") && refused.contains(why),
            "{why}: {refused}"
        );
    }
    assert_eq!(std::fs::read_dir(&board).unwrap().count(), 1);
}

#[test]
fn without_a_drive_picotool_does_it_or_the_user_learns_how() {
    let here = tempfile::tempdir().unwrap();
    let file = here.path().join("mine.uf2");
    std::fs::write(&file, uf2("rp2350_servo", PICO_2, START)).unwrap();
    let missing = message(&flash(here.path(), &[&file]));
    assert!(
        missing.contains("no Pico 2 in its boot loader; hold BOOTSEL"),
        "{missing}"
    );
    let tool = here.path().join("picotool");
    let log = here.path().join("log");
    for (status, succeeds) in [(0, true), (1, false)] {
        let script = format!(
            "#!/bin/sh\necho \"$@\" > {}\nexit {status}\n",
            log.display()
        );
        std::fs::write(&tool, script).unwrap();
        std::fs::set_permissions(&tool, std::fs::Permissions::from_mode(0o755)).unwrap();
        let output = flash(here.path(), &[&file]);
        assert_eq!(output.status.success(), succeeds, "{output:?}");
        let asked = std::fs::read_to_string(&log).unwrap();
        assert_eq!(asked.trim(), format!("load -v -x {}", file.display()));
    }
}

/// The commands for the first board are those of the document.
#[test]
fn an_image_of_the_first_board_gets_the_commands_of_its_programmers() {
    let here = tempfile::tempdir().unwrap();
    let refused = message(&flash(here.path(), &[Path::new("stm32f405_stepper")]));
    let document = include_str!("../../../../docs/use/bring-up.md");
    for command in fivebar::flash::commands_of_first_board("stm32f405_stepper") {
        assert!(refused.contains(&command), "{refused}");
        let first = command.split(" out/").next().unwrap();
        let first = first.split(" target/").next().unwrap();
        assert!(document.contains(first), "{first}");
    }
}
