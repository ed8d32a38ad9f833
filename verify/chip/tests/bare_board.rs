//! `fivebar board-test` on the simulated chip: every row is filled, and each mistake of a board is named by
//! its row.

mod bench;

use bench::image;
use fivebar_chip::time::{MICROSECOND, MILLISECOND, Time};
use fivebar_chip::{BareBoard, BoardMistake, Chip, Defect, HostLine, Options, SharedBareBoard};
use fivebar_sim::board_test::{BoardReport, Hands, Verdict, run};
use fivebar_sim::link::{Client, FaultInjector, FaultRates};
use std::io::{self, Read, Write};
use std::time::Duration;

/// A hand at the board, which connects nothing if it is absent.
struct Hand {
    board: SharedBareBoard,
    present: bool,
}

impl Hands for Hand {
    fn connect(&mut self, task: &str) -> bool {
        assert!(
            !self.present || self.board.execute(task),
            "no hand can do this: {task}"
        );
        self.present
    }

    fn report(&mut self, _: &str) {}
}

fn line(options: Options, board: &SharedBareBoard) -> HostLine {
    let chip = Chip::new(image(), options, Vec::new(), Box::new(board.clone()));
    HostLine::new(chip.expect("an emulator"))
}

/// The report of a board that follows a path for so long.
fn report(
    options: Options,
    mistake: Option<BoardMistake>,
    present: bool,
    seconds: f64,
) -> BoardReport {
    let board = SharedBareBoard::new(BareBoard::new(mistake));
    let opened = Client::open_with_clock(line(options, &board), |line| {
        Duration::from_micros(line.chip().now() / MICROSECOND)
    });
    let (mut client, identity) = opened.expect("the controller answers");
    let mut hand = Hand { board, present };
    run(&mut client, &identity, &mut hand, seconds).expect("a report")
}

fn wired(options: Options, mistake: Option<BoardMistake>) -> BoardReport {
    report(options, mistake, true, 0.1)
}

/// Each row stands in docs/use/board_test.csv with its bound.
fn assert_documented(report: &BoardReport) {
    let table = include_str!("../../../docs/use/board_test.csv");
    let lines: Vec<_> = table.lines().skip(1).collect();
    assert_eq!(lines.len(), report.rows.len());
    for row in &report.rows {
        let (name, bound) = (format!("{},", row.name), format!(",\"{}\"", row.bound));
        let line = lines.iter().find(|line| line.starts_with(&name));
        assert!(line.is_some_and(|it| it.ends_with(&bound)), "{row:?}");
    }
}

#[test]
fn every_row_of_a_sound_board_is_filled_and_passes() {
    let report = report(Options::default(), None, true, 0.5);
    for row in &report.rows {
        assert_eq!(row.verdict, Verdict::Passed, "{row:?}");
        assert!(!row.measured.is_empty() && !row.bound.is_empty(), "{row:?}");
    }
    assert_eq!(report.rows.len(), 29);
    assert_documented(&report);
    assert!(report.simulated && report.unit.contains("instructions, not cycles"));
    // While it plans, the idle task sees one tick in twelve.
    let times = report.times.expect("the board followed a path");
    assert!(times.interrupt.ticks > 300, "{times:?}");
    assert!(times.interrupt.least > 500 && times.response.least > times.interrupt.least + 437);
}

/// A line from a host that is late: before each of some frames, the board goes on alone.
struct LateLine {
    line: HostLine,
    /// The generator's state.
    random: u64,
    /// The longest wait before a frame [ms], and the share of frames that wait for up to 60 ms.
    wait: f64,
    stalls: f64,
}

impl LateLine {
    /// A number from 0 to 1, by Knuth's linear generator.
    fn uniform(&mut self) -> f64 {
        let next = self.random.wrapping_mul(6_364_136_223_846_793_005);
        self.random = next.wrapping_add(1_442_695_040_888_963_407);
        (self.random >> 33) as f64 / f64::from(1_u32 << 31)
    }
}

impl Read for LateLine {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.line.read(bytes)
    }
}

impl Write for LateLine {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let stall = self.uniform() < self.stalls;
        let longest = if stall { 60.0 } else { self.wait };
        let wait = longest * self.uniform() * MILLISECOND as f64;
        self.line
            .chip()
            .run(wait as Time)
            .map_err(io::Error::other)?;
        self.line.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A host that is late, or gives 400 lines a second about as fast as the arm draws them, has a slower arm and no fault:
/// the planner hands out path in time, though a plan over a full queue takes it some milliseconds.
#[test]
fn a_late_host_slows_the_arm_and_leaves_no_fault() {
    for (seed, wait, stalls) in [(5, 0.0, 0.0), (6, 3.0, 0.0), (7, 3.0, 0.02), (8, 6.0, 0.02)] {
        let board = SharedBareBoard::new(BareBoard::new(None));
        let late = LateLine {
            line: line(Options::default(), &board),
            random: seed,
            wait,
            stalls,
        };
        let opened = Client::open_with_clock(late, |late| {
            Duration::from_micros(late.line.chip().now() / MICROSECOND)
        });
        let (mut client, identity) = opened.expect("the controller answers");
        let mut hand = Hand {
            board,
            present: true,
        };
        let report = run(&mut client, &identity, &mut hand, 1.5).expect("a report");
        let failed: Vec<_> = report
            .failed()
            .map(|row| (&row.name, &row.verdict))
            .collect();
        assert!(failed.is_empty(), "{seed}: {failed:?}");
        assert!(report.times.is_some(), "{seed}: {:?}", report.rows);
    }
}

#[test]
fn a_board_without_wires_names_what_to_connect() {
    let report = report(Options::default(), None, false, 0.1);
    assert_eq!(report.failed().count(), 0);
    assert_eq!(report.rows.len(), 29);
    for row in &report.rows {
        let alone = [
            "crystal",
            "flash erase",
            "watchdog",
            "brown-out",
            "tick period",
        ];
        if alone.contains(&row.name) {
            assert_eq!(row.verdict, Verdict::Passed, "{row:?}");
        }
        if let Some((why, remedy)) = row.verdict.reason() {
            assert!(why == "not connected" && !remedy.is_empty(), "{row:?}");
        }
    }
}

/// A mistake of the board, the row that names it, and words of its reason.
const MISTAKES: [(BoardMistake, &str, &str); 7] = [
    (
        BoardMistake::AnalogExchanged,
        "current 1 input",
        "moves the code of current 4",
    ),
    (
        BoardMistake::LowReference,
        "current 1 offset",
        "reads code 2276",
    ),
    (BoardMistake::NoisyAnalog, "current 4 noise", "noise of"),
    (
        BoardMistake::PhasesExchanged,
        "encoder 1 A",
        "A and B of this encoder are exchanged",
    ),
    (
        BoardMistake::EncodersExchanged,
        "encoder 4 A",
        "the encoders are exchanged",
    ),
    (BoardMistake::DeadPhase, "encoder 4 B", "this phase is dead"),
    (BoardMistake::StopStuck, "emergency stop", "it is stuck"),
];

#[test]
fn each_mistake_of_a_boards_wires_is_named_by_its_row() {
    for (mistake, row, words) in MISTAKES {
        names(&wired(Options::default(), Some(mistake)), row, words);
    }
}

const DEFECTS: [(Defect, &str, &str); 5] = [
    (Defect::NoWatchdog, "watchdog", "does not bite"),
    (
        Defect::NoAccelerator,
        "flash accelerator",
        "without its accelerator",
    ),
    (Defect::FixedOptionBytes, "brown-out", "do not hold"),
    (Defect::HalfFlash, "flash size", "no sectors"),
    (Defect::WornFlash, "flash erase", "the flash is slow: 3000"),
];

#[test]
fn each_defect_of_a_chip_is_named_by_its_row() {
    for (defect, row, words) in DEFECTS {
        let options = Options {
            defect: Some(defect),
            ..Options::default()
        };
        names(&wired(options, None), row, words);
    }
}

#[test]
fn a_crystal_of_another_frequency_and_a_noisy_line_are_named() {
    let options = Options {
        crystal: 10e6,
        ..Options::default()
    };
    let wrong = wired(options, None);
    names(
        &wrong,
        "crystal",
        "10.0 MHz, from which the image does not make its clock",
    );
    let mut found: Vec<_> = wrong.rows.iter().map(|row| row.name).collect();
    let all = wired(Options::default(), None);
    let mut expected: Vec<_> = all.rows.iter().map(|row| row.name).collect();
    found.sort_unstable();
    expected.sort_unstable();
    assert_eq!(found, expected, "a row is never missing");

    let rates = FaultRates {
        corrupt: 0.01,
        ..FaultRates::default()
    };
    let board = SharedBareBoard::new(BareBoard::new(None));
    let noisy = FaultInjector::new(line(Options::default(), &board), rates, 5);
    let (mut client, identity) = Client::open(noisy).expect("the controller answers");
    let mut hand = Hand {
        board,
        present: true,
    };
    let noisy = run(&mut client, &identity, &mut hand, 0.5).expect("a report");
    names(&noisy, "serial line", "frames were damaged");
}

/// The row has failed for this reason.
#[track_caller]
fn names(report: &BoardReport, row: &str, words: &str) {
    let failed: Vec<_> = report.failed().collect();
    let named = failed.iter().find(|failed| failed.name == row);
    let named = named.unwrap_or_else(|| panic!("{row} is not named: {failed:?}"));
    let (why, remedy) = named.verdict.reason().expect("it has failed");
    assert!(why.contains(words) && !remedy.is_empty(), "{row}: {why}");
}
