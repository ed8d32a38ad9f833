//! From power-up to the end of a job on the production image.

mod bench;

use bench::{Bench, gear, moves, settings, used_flash};
use fivebar_chip::Options;
use fivebar_chip::time::MILLISECOND;
use fivebar_firmware::Request;
use fivebar_firmware::safety::{Fault, State};
use fivebar_sim::drive::{Drive, Homing};

#[test]
fn the_image_runs_from_power_up_through_a_job_to_disarm() {
    let bench = Bench::with(Options::default(), used_flash(), MILLISECOND);
    let mut driven = bench.connect();
    // The flash holds something, and no settings.
    assert_eq!(driven.status().fault, Some(Fault::SettingsCorrupt));
    driven.request(Request::ClearFault).expect("cleared");
    let client = &mut driven.client;
    let mut drive = Drive::new(client, &|| false);
    drive
        .store_settings(&settings())
        .expect("the settings are stored");
    drive.home(Homing::IfUnknown).expect("homing succeeds");
    drive
        .follow(&moves(), &settings(), &mut |_, _| ())
        .expect("the job is executed");
    drive
        .follow(&gear(), &settings(), &mut |_, _| ())
        .expect("the job is executed");
    let status = driven.status();
    assert_eq!((status.state, status.fault), (State::Stopped, None));
    assert!(driven.is_off());
    assert_eq!(driven.arm.get().samples_on_edges, 0);
}

#[test]
fn settings_beyond_the_boards_bounds_are_refused_with_key_and_bound() {
    let mut driven = Bench::with(Options::default(), Vec::new(), 0).connect();
    let mut fast = settings();
    fast.protection.over_speed = 72.0;
    let mut drive = Drive::new(&mut driven.client, &|| false);
    let refused = drive.store_settings(&fast).expect_err("too fast");
    let words = "protection.over_speed must give at most 1500000 encoder counts/s";
    assert!(refused.to_string().contains(words), "{refused}");
    fast.protection.over_speed = 71.0;
    drive.store_settings(&fast).expect("within the bounds");
}
