//! `fivebar monitor --raw`: what the inputs of a board read, before settings and homing.

use super::failure::{Failure, refused};
use super::monitor::{Args, show};
use super::port::PortClient;
use fivebar_files::robot::DriveKind;
use fivebar_firmware::drives::words::{SensedWords, torque_of};
use fivebar_firmware::protocol::Board;
use fivebar_firmware::{Settings, ToldSample};
use fivebar_sim::boards::Facts;
use std::io::{ErrorKind, IsTerminal};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Shows raw samples of this board, one request for each.
pub(super) fn show_inputs(
    args: &Args,
    client: &mut PortClient,
    board: Board,
    interrupted: &AtomicBool,
) -> Result<(), Failure> {
    let is_terminal = std::io::stdout().is_terminal();
    let period = Duration::from_secs_f32(1.0 / args.rate);
    let mut settings = Settings::BENCHTOP;
    client.read_settings(&mut settings).map_err(refused)?;
    let mut shown = 0;
    while !interrupted.load(Ordering::Relaxed) && args.samples.is_none_or(|most| shown < most) {
        let Some(sample) = client.sample().map_err(refused)? else {
            return Err(Failure::Refused(
                "this board has no inputs of its own: its samples come from the host".into(),
            ));
        };
        let drives = sensed(board, &sample.drives, settings.peak_torque());
        match show(&inputs(&sample, &drives), is_terminal) {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => return Ok(()),
            done => done.map_err(|error| refused(format_args!("cannot print: {error}")))?,
        }
        shown += 1;
        let due = Instant::now() + period;
        while Instant::now() < due && !interrupted.load(Ordering::Relaxed) {
            client.poll().map_err(refused)?;
        }
    }
    if is_terminal {
        super::say::say("")?;
    }
    Ok(())
}

/// What the drives of this board sense, with names and units; peak torques in N·m.
fn sensed(board: Board, words: &SensedWords, [peak1, peak4]: [f32; 2]) -> String {
    let SensedWords {
        joints: [word1, word4],
        both,
    } = *words;
    match Facts::of(board).drives {
        Some(DriveKind::Stepper) => {
            format!("micro-steps {:6} {:6}", word1 as i16, word4 as i16)
        }
        Some(DriveKind::Servo) => {
            format!("pulse units {:6} {:6}", word1 as i16, word4 as i16)
        }
        Some(DriveKind::CanTorque) => {
            let (torque1, torque4) = (torque_of(word1, peak1), torque_of(word4, peak4));
            let [age1, age4] = both.to_le_bytes();
            format!("torques {torque1:8.4} {torque4:8.4} N·m  ages {age1:3} {age4:3} ticks")
        }
        Some(DriveKind::Brushed) | None => {
            format!("currents {word1:4} {word4:4} codes  bus {both:4} codes")
        }
    }
}

fn inputs(sample: &ToldSample, drives: &str) -> String {
    let ToldSample {
        counts: [counts1, counts4],
        drives: _,
        home: [home1, home4],
        index: [index1, index4],
        emergency_stop,
        driver_fault: [fault1, fault4],
        missed_ticks: _,
    } = sample;
    let word = |is: &bool, yes: &'static str| if *is { yes } else { "-" };
    format!(
        "counts {counts1:>11} {counts4:>11}  {drives}  home {:7} {:7}  index {:4} {:4}  emergency stop {:7}  \
         bridges {:5} {:5}",
        word(home1, "pressed"),
        word(home4, "pressed"),
        word(index1, "high"),
        word(index4, "high"),
        word(emergency_stop, "pressed"),
        word(fault1, "fault"),
        word(fault4, "fault"),
    )
}

#[cfg(test)]
mod tests {
    use super::{DriveKind, SensedWords, sensed};
    use fivebar_sim::boards::IMAGES;

    #[test]
    fn each_kind_of_drive_shows_what_it_senses_with_its_unit() {
        let words = SensedWords {
            joints: [8192, (-4096_i16) as u16],
            both: 0x0201,
        };
        for image in IMAGES {
            let wanted = match image.drives {
                DriveKind::Brushed => "currents 8192 61440 codes bus 513 codes",
                DriveKind::Stepper => "micro-steps 8192 -4096",
                DriveKind::Servo => "pulse units 8192 -4096",
                DriveKind::CanTorque => "torques 1.0000 -0.7500 N·m ages 1 2 ticks",
            };
            let shown = sensed(image.board, &words, [2.0, 3.0]);
            assert_eq!(
                shown.split_whitespace().collect::<Vec<_>>().join(" "),
                wanted
            );
        }
    }
}
