//! The start of the production image on QEMU, as far as QEMU emulates its board: the settings
//! and the memory that it reads, and the state that follows.

mod flash;

use fivebar_firmware::Request;
use fivebar_firmware::Settings;
use fivebar_firmware::protocol::{Board, CommandError, HostCommand, Identity, Reply};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::storage::SettingsStorage;
use fivebar_sim::link::{Client, Emulator};
use flash::Flash;
use object::{Object, ObjectSection, ObjectSymbol};
use std::io::Write;

/// Where the image keeps its settings: flash sector 8.
const SETTINGS: u32 = 0x0808_0000;

/// Boots the image with these bytes in its memory.
fn boot(address: u32, bytes: &[u8]) -> (Client<Emulator>, Identity) {
    let mut file = tempfile::NamedTempFile::new().expect("a file");
    file.write_all(bytes).expect("room");
    let image = Emulator::built_image("stm32f405");
    open(Emulator::start_with(&image, &[(address, file.path())]).expect("a board"))
}

fn open(board: Emulator) -> (Client<Emulator>, Identity) {
    let (client, identity) = Client::open(board).expect("an answer");
    assert_eq!(identity.board, Board::Stm32f405);
    (client, identity)
}

/// The flash of a board that has stored these settings.
fn stored(settings: &Settings) -> Flash {
    let mut flash = Flash::blank();
    let mut storage = SettingsStorage::new(&mut flash, Flash::RANGE).expect("four sectors");
    storage.save(settings).expect("a working flash");
    flash
}

fn other_settings() -> Settings {
    Settings {
        payload: 0.0123,
        ..Settings::BENCHTOP
    }
}

/// The settings in use, and the reason why arming is refused.
fn in_use(client: &mut Client<Emulator>) -> (Settings, CommandError) {
    let mut settings = Settings::BENCHTOP;
    client.read_settings(&mut settings).expect("answers");
    let arm = client.command(HostCommand::Request(Request::Arm));
    let refusal = arm.expect("an answer").expect_err("its clock has failed");
    let (status, _) = client.status().expect("an answer");
    assert_eq!(
        (status.state, status.fault),
        (State::Fault, Some(Fault::ClockFailure))
    );
    assert_eq!(status.duty, [0.0; 2]);
    (settings, refusal)
}

#[test]
fn stored_settings_are_used() {
    let flash = stored(&other_settings());
    let (mut client, _) = boot(SETTINGS, &flash.bytes);
    let (settings, refusal) = in_use(&mut client);
    assert_eq!(settings, other_settings());
    let fault = fivebar_firmware::controller::RequestError::State(State::Fault);
    assert_eq!(
        refusal,
        CommandError::Request(fault),
        "the clock, not the settings"
    );
}

#[test]
fn a_damaged_page_of_settings_is_not_used() {
    let mut flash = stored(&other_settings());
    // Every item of the log, the newest included.
    flash.bytes.iter_mut().for_each(|byte| *byte ^= 0x10);
    let (mut client, _) = boot(SETTINGS, &flash.bytes);
    let (settings, refusal) = in_use(&mut client);
    assert_eq!(settings, Settings::BENCHTOP);
    assert_eq!(refusal, CommandError::NoSettings);
    assert_eq!(
        client.call(HostCommand::SaveSettings).expect("an answer"),
        Reply::Refused(CommandError::Request(
            fivebar_firmware::controller::RequestError::State(State::Fault)
        ))
    );
}

/// The image with the log's channel as it is after a probe has set the blocking mode, has read
/// one byte and was removed, with the buffer full.
fn left_by_a_probe() -> Vec<u8> {
    /// Offsets in RTT's control block: where the host has read to, and the channel's mode.
    const READ: usize = 40;
    const FLAGS: usize = 44;
    const BLOCK_IF_FULL: u8 = 2;
    let mut image = std::fs::read(Emulator::built_image("stm32f405")).expect("the image");
    let file = object::File::parse(&*image).expect("an ELF image");
    let block = file
        .symbol_by_name("_SEGGER_RTT")
        .expect("the log")
        .address();
    let data = file.section_by_name(".data").expect("variables");
    let (at, _) = data.file_range().expect("initial values");
    let block = usize::try_from(at + block - data.address()).expect("a small file");
    let found = image.get(block..block + 10).expect("inside the file");
    assert_eq!(found, b"SEGGER RTT");
    // The write position starts at 0, so a read position of 1 leaves no room.
    image[block + READ] = 1;
    image[block + FLAGS] = BLOCK_IF_FULL;
    image
}

/// RTT in its blocking mode waits for the probe to take what is in its buffer.
#[test]
fn a_probe_that_goes_away_does_not_stop_the_controller() {
    let mut file = tempfile::NamedTempFile::new().expect("a file");
    file.write_all(&left_by_a_probe()).expect("room");
    let (mut client, _) = open(Emulator::start(file.path()).expect("a board"));
    let (before, _) = client.status().expect("an answer");
    // Each transition logs a line, for which the buffer has no room.
    for _ in 0..10 {
        let cleared = client.command(HostCommand::Request(Request::ClearFault));
        cleared.expect("an answer").expect("a fault is latched");
    }
    // Ten answers can come within one tick, so the ticks are waited for.
    let goes_on = (0..10_000).any(|_| {
        let (after, _) = client.status().expect("an answer");
        after.tick >= before.tick + 10
    });
    assert!(goes_on, "no ticks after {before:?}");
}
