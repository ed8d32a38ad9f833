//! From power-up to the end of a job on the production image.

mod bench;

use bench::{Bench, moves, settings};
use fivebar::run::drive::{Drive, Homing};
use fivebar_chip::Options;
use fivebar_chip::time::seconds;
use fivebar_firmware::safety::State;

#[test]
fn the_image_runs_from_power_up_through_a_job_to_disarm() {
    let bench = Bench::with(Options::default(), Vec::new(), 0);
    let (mut client, _arm) = bench.client();
    let began = std::time::Instant::now();
    let mut lap = |what: &str, client: &mut fivebar::run::link::Client<fivebar_chip::HostLine>| {
        println!(
            "{what}: {:.3} s simulated, {:?}, repeats {}",
            seconds(client.line().chip.now()),
            began.elapsed(),
            client.repeats()
        );
    };
    lap("open", &mut client);
    let mut drive = Drive::new(&mut client, &|| false);
    drive
        .agree_on(&settings(), true)
        .expect("settings are stored");
    drive.clear_fault().expect("no fault stays");
    lap("settings", &mut client);
    let mut drive = Drive::new(&mut client, &|| false);
    drive.home(Homing::Switches).expect("homing succeeds");
    lap("home", &mut client);
    let mut drive = Drive::new(&mut client, &|| false);
    drive
        .follow(&moves(), &settings(), &mut |_, _| ())
        .expect("the job is executed");
    lap("job", &mut client);
    let (status, _) = client.status().expect("the link works");
    assert_eq!((status.state, status.fault), (State::Stopped, None));
}
