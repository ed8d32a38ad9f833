//! The check of serial ports and of the user's permission to use them.

use super::State;
use std::process::Command;

/// The state of this computer's ports.
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
        State::Missing("plug the board in; this computer has no serial port".into())
    } else {
        State::Missing(format!(
            "this user has no permission for {}: join the group that owns it, on most systems with \
             `sudo usermod -aG dialout $USER`, and log in again",
            refused.join(", ")
        ))
    }
}

/// Tests the permission without opening the port, which would set its control lines and reset
/// some boards.
fn may_use(port: &str) -> bool {
    let asked = Command::new("test")
        .args(["-r", port, "-a", "-w", port])
        .status();
    // On systems without `test`, ports have no owners.
    asked.map_or(true, |status| status.success())
}

#[cfg(test)]
mod tests {
    use super::{State, judge};

    #[test]
    fn a_port_without_permission_is_distinguished_from_no_port() {
        let ports = ["/dev/ttyUSB0".to_owned(), "/dev/ttyACM0".to_owned()];
        let of = |ports: &[String], allowed: &str| judge(ports, |port| port == allowed);
        assert_eq!(
            of(&ports, "/dev/ttyACM0"),
            State::Found("/dev/ttyACM0".into())
        );
        let State::Missing(remedy) = of(&ports, "") else {
            panic!("both refuse");
        };
        assert!(remedy.contains("/dev/ttyUSB0, /dev/ttyACM0") && remedy.contains("dialout"));
        let State::Missing(remedy) = of(&[], "") else {
            panic!("there is none");
        };
        assert!(remedy.contains("plug the board in"));
    }
}
