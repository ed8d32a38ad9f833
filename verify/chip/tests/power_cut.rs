//! The power fails while the real driver saves settings: afterwards the old settings or the new
//! ones are there, complete.

mod bench;

use bench::{Bench, Driven, settings, used_flash};
use fivebar_chip::{FlashEvent, Options};
use fivebar_firmware::protocol::{HostCommand, Reply};
use fivebar_firmware::{Request, Settings};

/// Other settings than the arm's.
fn others() -> Settings {
    let mut settings = settings();
    settings.motion.singularity_margin *= 0.5;
    settings
}

fn boot(flash: Vec<u8>) -> Driven {
    Bench::with(Options::default(), flash, 0).connect()
}

/// Boots with this flash and saves settings: the flash afterwards, and how it came about.
fn save(flash: Vec<u8>, settings: &Settings) -> (Vec<u8>, Vec<FlashEvent>) {
    let mut driven = boot(flash);
    if driven.status().fault.is_some() {
        driven.request(Request::ClearFault).expect("cleared");
    }
    let applied = driven.client.write_settings(settings).expect("a line");
    applied.expect("valid settings");
    driven.chip().flash_events();
    let reply = driven.client.call(HostCommand::SaveSettings);
    assert!(matches!(reply, Ok(Reply::Done)), "{reply:?}");
    let events = driven.chip().flash_events();
    let flash = driven.chip().settings().to_vec();
    (flash, events)
}

/// Cuts the power in each operation of a save.
fn cut(before: &[u8], events: &[FlashEvent]) {
    let mut flash = before.to_vec();
    let mut found_new = 0;
    for (number, event) in events.iter().enumerate() {
        let mut cut = flash.clone();
        event.happen(&mut cut, false);
        let mut driven = boot(cut);
        assert_eq!(driven.status().fault, None, "operation {number}");
        let mut found = settings();
        driven.client.read_settings(&mut found).expect("settings");
        assert!(
            found == settings() || found == others(),
            "operation {number}"
        );
        found_new += usize::from(found == others());
        event.happen(&mut flash, true);
    }
    // The new settings count from the last operations on.
    assert!(found_new < 3, "{found_new} of {}", events.len());
}

#[test]
fn settings_are_old_or_new_after_a_power_cut_at_every_operation() {
    let (flash, _) = save(Vec::new(), &settings());
    let (_, events) = save(flash.clone(), &others());
    assert!(events.len() > 50, "{}", events.len());
    cut(&flash, &events);
}

#[test]
fn the_same_where_the_other_half_has_to_be_erased() {
    // The settings are in the first half; the second one holds something else.
    let (mut flash, _) = save(Vec::new(), &settings());
    let middle = flash.len() / 2;
    flash[middle..].copy_from_slice(&used_flash()[middle..]);
    let (_, events) = save(flash.clone(), &others());
    let erases = |event: &FlashEvent| matches!(event, FlashEvent::Erase { .. });
    assert!(events.iter().filter(|event| erases(event)).count() >= 2);
    cut(&flash, &events);
}
