//! The emulated board over recorded commands: its replies have the bits of the recorded ones.

use fivebar_firmware::protocol::{
    ControllerMessage, Decoder, Frame, Reply, Sequence, StepResult, encode,
};
use fivebar_firmware::{ActuatorCommand, Controller, Settings};
use fivebar_sim::link::{Emulator, Loopback};
use std::io::{self, Read, Write};
use std::process::Command;

/// A controller in this process, behind bytes that are kept.
pub(crate) struct Recorded {
    line: Loopback,
    commands: Vec<u8>,
    replies: Vec<u8>,
}

impl Recorded {
    /// A controller in lockstep that begins as the board does.
    pub(crate) fn new() -> Self {
        Self {
            line: Loopback::lockstep(&Settings::BENCHTOP).expect("valid settings"),
            commands: Vec::new(),
            replies: Vec::new(),
        }
    }
}

impl Read for Recorded {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let count = self.line.read(bytes)?;
        self.replies.extend(&bytes[..count]);
        Ok(count)
    }
}

impl Write for Recorded {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.commands.extend(bytes);
        self.line.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// What the board did.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Replayed {
    /// Ticks, and the other commands.
    pub(crate) ticks: u64,
    pub(crate) others: u64,
    /// The most instructions in a tick.
    pub(crate) most: u32,
}

/// Gives the recorded commands to the emulated board, and compares its replies bit by bit.
///
/// # Errors
/// The first difference.
pub(crate) fn replay(recorded: &Recorded) -> Result<Replayed, String> {
    compare(&recorded.replies, &on_board(&recorded.commands))
}

/// The board's replies.
fn on_board(commands: &[u8]) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("commands"), commands).expect("a file");
    let image = Emulator::built_image("replay");
    let output = Command::new("qemu-system-arm")
        .args(["-machine", "netduinoplus2", "-icount", "shift=0"])
        .args(["-display", "none", "-monitor", "none", "-serial", "none"])
        .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
        .arg(image.canonicalize().expect("an image"))
        .current_dir(folder.path())
        .output()
        .expect("qemu-system-arm starts");
    assert!(output.status.success(), "{output:?}");
    std::fs::read(folder.path().join("replies")).expect("the replies")
}

fn replies(bytes: &[u8]) -> Vec<(Sequence, Reply)> {
    let mut decoder = Decoder::new();
    let frames = bytes.iter().filter_map(|&byte| decoder.feed(byte));
    frames
        .map(|frame| match frame.expect("a whole frame") {
            ControllerMessage::Reply { sequence, reply } => (sequence, reply),
            ControllerMessage::Telemetry(_) | ControllerMessage::Stream(_) => {
                panic!("nobody asked for telemetry or streams")
            }
        })
        .collect()
}

fn frame((sequence, reply): (Sequence, Reply)) -> Frame {
    encode(&ControllerMessage::Reply { sequence, reply }).expect("a frame")
}

/// Compares replies; only the boards' names and the counts of instructions may differ.
fn compare(here: &[u8], there: &[u8]) -> Result<Replayed, String> {
    let [here, there] = [here, there].map(replies);
    if here.len() != there.len() {
        return Err(format!("{} replies, and {} there", here.len(), there.len()));
    }
    let mut replayed = Replayed::default();
    for (number, (ours, mut theirs)) in here.into_iter().zip(there).enumerate() {
        match (ours.1, &mut theirs.1) {
            (Reply::StepResult(ours), Reply::StepResult(theirs)) => {
                replayed.ticks += 1;
                replayed.most = replayed.most.max(theirs.instructions);
                theirs.instructions = ours.instructions;
            }
            (Reply::Hello(_), Reply::Hello(_)) => continue,
            _ => replayed.others += 1,
        }
        // The bytes: of equal numbers, zero may have two signs.
        if frame(ours) != frame(theirs) {
            return Err(format!("reply {number}: {ours:?}, and there {theirs:?}"));
        }
    }
    Ok(replayed)
}

#[test]
fn a_reply_that_differs_in_one_bit_is_found() {
    let settings = Settings::BENCHTOP.check().expect("valid settings");
    let status = Controller::new(&settings).status();
    let bytes = |change: &dyn Fn(&mut StepResult)| {
        let mut result = StepResult::new(ActuatorCommand::default(), &status, 0);
        change(&mut result);
        frame((Sequence(1), Reply::StepResult(result)))
    };
    let same = bytes(&|_| ());
    let counted = compare(&same, &bytes(&|result| result.instructions = 800));
    let expected = Replayed {
        ticks: 1,
        others: 0,
        most: 800,
    };
    assert_eq!(counted, Ok(expected));
    let changes: [&dyn Fn(&mut StepResult); 5] = [
        &|result| result.command.drives.duty[1] = -0.0,
        &|result| result.angle[0] = f32::from_bits(result.angle[0].to_bits() ^ 1),
        &|result| result.velocity[1] = -0.0,
        &|result| result.current_demand[0] = f32::from_bits(1),
        &|result| result.tick += 1,
    ];
    for (number, change) in changes.into_iter().enumerate() {
        assert!(compare(&same, &bytes(change)).is_err(), "change {number}");
    }
    assert!(compare(&same, &[]).is_err());
}
