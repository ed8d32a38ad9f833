//! The same job with each crystal that boards of the family have, and on each board.

mod bench;

use bench::{Bench, Driven, image, image_for, moves, robot, settings};
use fivebar_chip::time::MICROSECOND;
use fivebar_chip::{Arm, Image, Options, SharedArm};
use fivebar_firmware::drivers::boards::{BOARDS, Board};
use fivebar_firmware::safety::State;
use fivebar_plant::{Mismatch, Plant};
use fivebar_sim::drive::{Drive, Homing};
use std::sync::Arc;

/// The arm as its file says, at home. Its sensors have no noise: a start takes more or fewer ticks with another crystal, and
/// would meet other noise.
fn arm() -> SharedArm {
    let robot = robot();
    let home = robot.home_pose().expect("a home pose");
    let parameters = robot.plant_parameters().expect("masses");
    SharedArm::new(Arm::new(
        Plant::new(&parameters, &Mismatch::NONE, &home, 1),
        0,
    ))
}

/// Lets the host wait for a tick whose number has these work shares, so that all commands behind come in the same ones.
fn await_tick(driven: &mut Driven) {
    let ticks = |driven: &Driven| driven.arm.get().ticks.len();
    loop {
        let before = ticks(driven);
        driven.run(MICROSECOND);
        let now = ticks(driven);
        if now > before && now.is_multiple_of(1600) {
            return;
        }
    }
}

/// An image, and the board that it is built for.
type Built = (Arc<Image>, Options);

/// The first board with this crystal.
fn with_crystal(megahertz: u32) -> Built {
    let image = match megahertz {
        8 | 12 | 16 => image(),
        other => image_for("FIVEBAR_CRYSTAL", &other.to_string(), "stm32f405"),
    };
    let options = Options {
        crystal: f64::from(megahertz) * 1e6,
        ..Options::default()
    };
    (image, options)
}

/// Another board.
fn with_board(board: &'static Board) -> Built {
    let options = Options {
        crystal: f64::from(board.crystal) * 1e6,
        board,
        ..Options::default()
    };
    (image_for("FIVEBAR_BOARD", board.name, "stm32f405"), options)
}

/// What a chip does: the duties of all ticks of homing, and the counts of the encoders after a job.
fn drawn((image, options): Built) -> (Vec<[i32; 2]>, [i32; 2]) {
    let name = (options.crystal, options.board.name);
    let mut driven = Bench::on(image, arm(), options, Vec::new()).connect();
    let mut drive = Drive::new(&mut driven.client, &|| false);
    drive
        .store_settings(&settings())
        .expect("the settings are stored");
    await_tick(&mut driven);
    let mut drive = Drive::new(&mut driven.client, &|| false);
    drive.home(Homing::IfUnknown).expect("homing succeeds");
    let homing = {
        let arm = driven.arm.get();
        let powered = arm.ticks.iter().filter(|tick| tick.enabled);
        powered.map(|tick| tick.duty).collect()
    };
    let mut drive = Drive::new(&mut driven.client, &|| false);
    drive
        .follow(&moves(), &settings(), &mut |_, _| ())
        .expect("the job is executed");
    let status = driven.status();
    let ended = (status.state, status.fault);
    assert_eq!(ended, (State::Stopped, None), "{name:?}");
    let arm = driven.arm.get();
    let last = arm.ticks.last().expect("ticks");
    (homing, last.sample.counts)
}

/// In the job a host's command may come a tick sooner or later, so its ticks are not compared.
fn same(others: impl IntoIterator<Item = Built>) {
    let (homing_of_8, end_of_8) = drawn(with_crystal(8));
    assert!(homing_of_8.len() > 10_000, "{} ticks", homing_of_8.len());
    for (image, options) in others {
        let name = (options.crystal, options.board.name);
        let (homing, end) = drawn((image, options));
        assert!(homing == homing_of_8, "{name:?}");
        for (count, of_8) in end.into_iter().zip(end_of_8) {
            let off = (count - of_8).abs();
            assert!(off <= 2, "{name:?}: {count} for {of_8} counts");
        }
    }
}

#[test]
fn each_crystal_homes_with_the_same_bits_and_ends_a_job_at_the_same_place() {
    same([12, 16].map(with_crystal));
}

#[test]
#[ignore = "it builds two more images: ./ci.sh tables"]
fn whole_table_of_crystals_that_home_with_the_same_bits() {
    same([24, 25].map(with_crystal));
}

#[test]
#[ignore = "it builds an image of each board: ./ci.sh tables"]
fn whole_table_of_boards_that_home_with_the_same_bits() {
    let others = BOARDS.iter().skip(1).filter(|board| board.brushed.is_ok());
    same(others.map(with_board));
}
