//! The same job with each crystal that boards of the family have.

mod bench;

use bench::{Bench, Driven, image, image_for_crystal, moves, robot, settings};
use fivebar_chip::time::MICROSECOND;
use fivebar_chip::{Arm, Options, SharedArm};
use fivebar_firmware::safety::State;
use fivebar_plant::{Mismatch, Plant};
use fivebar_sim::drive::{Drive, Homing};

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

/// What a chip with this crystal does: the duties of all ticks of homing, and the counts of the encoders after a job.
fn drawn(megahertz: u32) -> (Vec<[i32; 2]>, [i32; 2]) {
    let image = match megahertz {
        8 | 12 | 16 => image(),
        other => image_for_crystal(other),
    };
    let options = Options {
        crystal: f64::from(megahertz) * 1e6,
        ..Options::default()
    };
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
    assert_eq!(ended, (State::Stopped, None), "{megahertz} MHz");
    let arm = driven.arm.get();
    let last = arm.ticks.last().expect("ticks");
    (homing, last.sample.counts)
}

/// In the job a host's command may come a tick sooner or later, so its ticks are not compared.
fn same(crystals: &[u32]) {
    let (homing_of_8, end_of_8) = drawn(8);
    assert!(homing_of_8.len() > 10_000, "{} ticks", homing_of_8.len());
    for megahertz in crystals {
        let (homing, end) = drawn(*megahertz);
        assert!(homing == homing_of_8, "{megahertz} MHz");
        for (count, of_8) in end.into_iter().zip(end_of_8) {
            let off = (count - of_8).abs();
            assert!(off <= 2, "{megahertz} MHz: {count} for {of_8} counts");
        }
    }
}

#[test]
fn each_crystal_homes_with_the_same_bits_and_ends_a_job_at_the_same_place() {
    same(&[12, 16]);
}

#[test]
#[ignore = "it builds two more images: ./ci.sh tables"]
fn whole_table_of_crystals_that_home_with_the_same_bits() {
    same(&[24, 25]);
}
