//! From power-up to the end of a job on the production image.

mod bench;

use bench::{Bench, moves, settings};
use fivebar::run::drive::{Drive, Homing};
use fivebar_chip::Options;
use fivebar_firmware::safety::State;

#[test]
fn the_image_runs_from_power_up_through_a_job_to_disarm() {
    let bench = Bench::with(Options::default(), Vec::new(), 0);
    let mut driven = bench.connect();
    let client = &mut driven.client;
    let mut drive = Drive::new(client, &|| false);
    drive
        .agree_on(&settings(), true)
        .expect("the settings are stored");
    drive.clear_fault().expect("no fault stays");
    drive.home(Homing::Switches).expect("homing succeeds");
    drive
        .follow(&moves(), &settings(), &mut |_, _| ())
        .expect("the job is executed");
    let status = driven.status();
    assert_eq!((status.state, status.fault), (State::Stopped, None));
    assert!(driven.is_off());
    assert_eq!(driven.arm.get().samples_on_edges, 0);
}
