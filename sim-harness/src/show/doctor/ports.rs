//! Serial ports, and whether this user may use them.

use super::State;
use std::process::Command;

/// The ports of this machine.
pub(super) fn state() -> State {
    let ports = serialport::available_ports().unwrap_or_default();
    let names: Vec<String> = ports.into_iter().map(|port| port.port_name).collect();
    judge(&names, may_use)
}

fn judge(ports: &[String], may_use: impl Fn(&str) -> bool) -> State {
    let (usable, refused): (Vec<&str>, Vec<&str>) = ports
        .iter()
        .map(String::as_str)
        .partition(|port| may_use(port));
    if !usable.is_empty() {
        State::Found(usable.join(", "))
    } else if refused.is_empty() {
        State::Missing("plug the board in; this machine has no serial port".into())
    } else {
        State::Missing(format!(
            "{} refuses this user: join the group that owns it, on most systems by `sudo \
             usermod -aG dialout $USER`, and log in anew",
            refused.join(", ")
        ))
    }
}

/// Asks without opening the port: that would set its control lines, to which some boards
/// answer with a reset.
fn may_use(port: &str) -> bool {
    let asked = Command::new("test")
        .args(["-r", port, "-a", "-w", port])
        .status();
    // Where there is no `test`, ports have no owners.
    asked.map_or(true, |status| status.success())
}

#[cfg(test)]
mod tests {
    use super::{State, judge};

    #[test]
    fn a_port_that_refuses_is_told_from_none() {
        let ports = ["/dev/ttyUSB0".to_owned(), "/dev/ttyACM0".to_owned()];
        let of = |ports: &[String], allowed: &str| judge(ports, |port| port == allowed);
        assert_eq!(
            of(&ports, "/dev/ttyACM0"),
            State::Found("/dev/ttyACM0".into())
        );
        let State::Missing(way) = of(&ports, "") else {
            panic!("both refuse");
        };
        assert!(way.contains("/dev/ttyUSB0, /dev/ttyACM0") && way.contains("dialout"));
        let State::Missing(way) = of(&[], "") else {
            panic!("there is none");
        };
        assert!(way.contains("plug the board in"));
    }
}
