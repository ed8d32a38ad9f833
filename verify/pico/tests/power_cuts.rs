//! The power fails while the image stores settings: at the next start the old ones or the new ones are there, complete.

mod bench;

use bench::Bench;
use fivebar_firmware::Settings;
use fivebar_firmware::protocol::Reset;
use fivebar_pico::{FlashEvent, Share};

/// The middle and the end of the settings in the flash [bytes].
const MIDDLE: usize = 768 * 1024;
const END: usize = 1024 * 1024;

fn changed(settings: &Settings) -> Settings {
    let mut changed = *settings;
    changed.motion.singularity_margin *= 0.5;
    changed
}

/// Stores settings: what that does to the flash.
fn save(bench: &mut Bench, settings: &Settings) -> Vec<FlashEvent> {
    let applied = bench.client.write_settings(settings).expect("a line");
    applied.expect("valid settings");
    bench.line.chip().flash_events();
    bench.save();
    bench.line.chip().flash_events()
}

/// The settings that a chip with this flash starts with, and what the start does to the flash.
fn start(bench: &mut Bench, flash: &[u8]) -> (Settings, Vec<FlashEvent>) {
    assert_eq!(bench.start_with(flash).reset, Reset::Power);
    assert_eq!(bench.status().fault, None);
    let mut found = bench.settings;
    bench.client.read_settings(&mut found).expect("settings");
    (found, bench.line.chip().flash_events())
}

/// Cuts the power in each change of a flash, and in each change of the start behind that. Returns how many cuts there were.
fn cut(bench: &mut Bench, before: &[u8], events: &[FlashEvent]) -> usize {
    let (old, new) = (bench.settings, changed(&bench.settings));
    let mut flash = before.to_vec();
    let mut found_new = false;
    let mut cuts = 0;
    for (number, event) in events.iter().enumerate() {
        for share in [Share::Bits, Share::FirstHalf, Share::Whole] {
            let mut cut = flash.clone();
            event.happen(&mut cut, share);
            let (found, repairs) = start(bench, &cut);
            assert!(
                found == old || found == new,
                "operation {number}, {share:?}"
            );
            assert!(found == new || !found_new, "operation {number}, {share:?}");
            found_new |= share == Share::Whole && found == new;
            for repair in repairs {
                for share in [Share::Bits, Share::FirstHalf] {
                    let mut again = cut.clone();
                    repair.happen(&mut again, share);
                    let (refound, _) = start(bench, &again);
                    assert!(refound == found, "the start after operation {number}");
                    cuts += 1;
                }
                repair.happen(&mut cut, Share::Whole);
            }
            cuts += 1;
        }
        event.happen(&mut flash, Share::Whole);
    }
    assert!(found_new, "they are stored");
    cuts
}

#[test]
fn settings_are_old_or_new_after_a_power_cut_in_every_operation() {
    let mut bench = Bench::new();
    let settings = bench.settings;
    save(&mut bench, &settings);
    let before = bench.line.chip().flash().to_vec();
    let events = save(&mut bench, &changed(&settings));
    let cuts = cut(&mut bench, &before, &events);
    println!("{cuts} cuts of {} operations", events.len());
    assert!(events.len() >= 3);
}

#[test]
fn the_same_where_the_other_half_has_to_be_erased() {
    let mut bench = Bench::new();
    let settings = bench.settings;
    save(&mut bench, &settings);
    // The settings are in the first half; the second one holds something else.
    let mut before = bench.line.chip().flash().to_vec();
    for (at, byte) in (MIDDLE as u32..).zip(&mut before[MIDDLE..END]) {
        *byte = (at.wrapping_mul(2_654_435_761) >> 24) as u8;
    }
    bench.start_with(&before);
    let events = save(&mut bench, &changed(&settings));
    let erases = |event: &&FlashEvent| matches!(event, FlashEvent::Erase { .. });
    assert!(events.iter().filter(erases).count() >= 2);
    let cuts = cut(&mut bench, &before, &events);
    println!("{cuts} cuts of {} operations", events.len());
}
