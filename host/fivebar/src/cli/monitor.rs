//! `fivebar monitor`: the state of a controller, live on the terminal.

use super::failure::{Failure, refused};
use super::port::{PortArgs, interrupted};
use super::raw_inputs::show_inputs;
use super::say::say;
use super::value_error::ValueError;
use fivebar_firmware::protocol::{HostCommand, Reply, Section, SectionKey, StackUse, Telemetry};
use fivebar_firmware::{Status, safety::Limits};
use fivebar_sim::simulation::fault_name;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::sync::atomic::Ordering;

/// Number of reads without a sample, 0.5 s, after which the status is requested to detect a lost
/// controller.
const QUIET: u32 = 50;

/// Shows the state of a controller until Ctrl-C.
#[derive(clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    port: PortArgs,
    /// Samples per second [Hz].
    #[arg(long, default_value_t = 20.0, value_parser = rate)]
    pub(super) rate: f32,
    /// End after this number of samples.
    #[arg(long, value_name = "N")]
    pub(super) samples: Option<u64>,
    /// Show what the inputs read, before settings and homing: encoder counts, what the drives sense, switches.
    #[arg(long)]
    raw: bool,
}

fn rate(text: &str) -> Result<f32, ValueError> {
    let rate = text
        .parse()
        .ok()
        .filter(|rate| (0.2..=2000.0).contains(rate));
    rate.ok_or(ValueError::Rate)
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let interrupted = interrupted()?;
    let (mut client, identity) = args.port.open()?;
    if args.raw {
        return show_inputs(args, &mut client, identity.board, &interrupted);
    }

    let tick_rate = match client
        .call(HostCommand::GetSection(SectionKey::Control))
        .map_err(refused)?
    {
        Reply::Section(Section::Control(control)) => control.tick_rate,
        reply => {
            return Err(refused(format_args!(
                "the controller replied to a request for its settings with {reply:?}"
            )));
        }
    };
    let every = (tick_rate / args.rate).round().clamp(1.0, 65535.0) as u16;
    client
        .command(HostCommand::Telemetry { every })
        .map_err(refused)?
        .map_err(|refusal| refused(format_args!("the controller sends no telemetry: {refusal}")))?;

    let is_terminal = io::stdout().is_terminal();
    let mut losses = Losses::default();
    let mut shown = 0;
    let mut quiet = 0;
    while !interrupted.load(Ordering::Relaxed) && args.samples.is_none_or(|most| shown < most) {
        match client.take_telemetry() {
            Some(sample) => {
                losses.count(&sample);
                match show(&line(&sample.status, losses.lost), is_terminal) {
                    // The output is closed.
                    Err(error) if error.kind() == ErrorKind::BrokenPipe => break,
                    shown => {
                        shown.map_err(|error| refused(format_args!("cannot print: {error}")))?;
                    }
                }
                shown += 1;
                quiet = 0;
            }
            None => {
                client.poll().map_err(refused)?;
                quiet += 1;
                if quiet % QUIET == 0 {
                    // Samples may be rarer than this: a reply shows that the controller works.
                    client.status().map_err(refused)?;
                }
            }
        }
    }
    if is_terminal {
        say("")?;
    }
    client
        .command(HostCommand::Telemetry { every: 0 })
        .map_err(refused)?
        .map_err(refused)?;
    say(format_args!("{shown} samples, {} lost", losses.lost))?;
    if let Some(StackUse { most, size }) = client.stack().map_err(refused)? {
        say(format_args!("stack: at most {most} of {size} bytes used"))?;
    }
    Ok(())
}

/// Samples lost, by the gaps in their numbers.
#[derive(Default)]
struct Losses {
    next: u32,
    lost: u32,
}

impl Losses {
    fn count(&mut self, sample: &Telemetry) {
        self.lost += sample.number.wrapping_sub(self.next);
        self.next = sample.number.wrapping_add(1);
    }
}

/// Prints a line; on a terminal it replaces the line before.
pub(super) fn show(line: &str, is_terminal: bool) -> io::Result<()> {
    let mut out = io::stdout().lock();
    if is_terminal {
        write!(out, "\r\x1b[2K{line}")?;
    } else {
        writeln!(out, "{line}")?;
    }
    out.flush()
}

fn line(status: &Status, lost: u32) -> String {
    let Status {
        tick,
        state,
        angle: [theta1, theta4],
        current: [i1, i4],
        bus_voltage,
        ..
    } = status;
    let mut line = format!("tick {tick:>9}  {:<8}", format!("{state:?}"));
    match status.tool {
        Some([x, y]) => line += &format!("  tool {:8.3} {:8.3} mm", 1e3 * x, 1e3 * y),
        None => line += "  tool unknown",
    }
    line += &format!(
        "  joints {theta1:7.4} {theta4:7.4} rad  currents {i1:6.3} {i4:6.3} A  bus {bus_voltage:5.2} V"
    );
    if let Some(tag) = status.tag {
        line += &format!("  line {tag}");
    }
    for (limit, name) in [
        (Limits::TORQUE, "torque limited"),
        (Limits::VOLTAGE, "voltage limited"),
        (Limits::SPEED, "speed limited"),
    ] {
        if status.limits.contains(limit) {
            line += &format!("  {name}");
        }
    }
    if let Some(fault) = status.fault {
        line += &format!("  FAULT {}: {}", fault.number(), fault_name(fault));
    }
    if status.missed_ticks > 0 {
        line += &format!("  {} ticks missed", status.missed_ticks);
    }
    if lost > 0 {
        line += &format!("  {lost} samples lost");
    }
    line
}

#[cfg(test)]
mod tests {
    use super::{Losses, Telemetry};
    use fivebar_firmware::{Controller, Settings};

    #[test]
    fn gaps_in_the_numbers_are_counted_as_lost_samples() {
        let controller = Controller::new(&Settings::BENCHTOP.check().expect("valid settings"));
        let mut losses = Losses::default();
        for number in [0, 1, 4, 5, 9] {
            losses.count(&Telemetry {
                number,
                status: controller.status(),
            });
        }
        assert_eq!(losses.lost, 5);
    }
}
