//! The words of Grbl 1.1.

use super::engine::{Engine, MachineState, Order, Refusal, Response, View};
use super::splitter::{at_once, command as words};
use fivebar_files::job::Dialect;
use std::fmt::Write as _;

/// Bytes that a sender which counts characters may have on their way.
const RECEIVED: usize = 128;
/// Seconds per minute times millimetres per metre.
const PER_MINUTE: f64 = 60e3;

pub(super) fn greeting(locked: bool) -> String {
    let unlock = if locked {
        "[MSG:'$H'|'$X' to unlock]\n"
    } else {
        ""
    };
    format!("\r\nGrbl 1.1h ['$' for help]\n{unlock}")
}

/// The answer to `?`: `<Idle|MPos:0.000,0.000,0.000|Bf:15,128|FS:0,0|WCO:0.000,0.000,0.000|Ov:100,100,100>`.
/// Lengths are in millimetres. The machine's zero is home.
pub(super) fn report(engine: &Engine, view: &View) -> String {
    let state = match view.state {
        MachineState::Idle => "Idle",
        MachineState::Run => "Run",
        MachineState::Hold { rests: true } => "Hold:0",
        MachineState::Hold { rests: false } => "Hold:1",
        MachineState::Jog => "Jog",
        MachineState::Home => "Home",
        MachineState::Alarm => "Alarm",
    };
    let from_home = |[x, y]: [f64; 2]| place([x - engine.home[0], y - engine.home[1]]);
    format!(
        "<{state}|MPos:{}|Bf:{},{}|FS:{:.0},{:.0}|WCO:{}|Ov:{:.0},{:.0},{:.0}>\n",
        from_home(view.tool.unwrap_or(engine.home)),
        view.free,
        RECEIVED.saturating_sub(view.waiting),
        view.speed * PER_MINUTE,
        view.level * engine.full_power,
        from_home(engine.stream.zero()),
        100.0 * view.shares.feed,
        100.0 * view.shares.rapid,
        100.0 * view.shares.power,
    )
}

/// Coordinates in millimetres, without a negative zero.
pub(super) fn place(point: [f64; 2]) -> String {
    let [x, y] = point.map(|value| (value * 1e6).round() / 1e3 + 0.0);
    format!("{x:.3},{y:.3},0.000")
}

impl Engine {
    pub(super) fn grbl(&mut self, text: &str, view: &View) -> Result<Response, Refusal> {
        let Some(command) = text.strip_prefix('$') else {
            // It has taken effect when it was received.
            if at_once(&words(text)).is_some() {
                return Ok(Response::new(String::new(), Vec::new()));
            }
            return self.gcode(Dialect::Grbl, text, view);
        };
        let command: String = command.split_whitespace().collect();
        let command = command.to_uppercase();
        let said = |text: String| Ok(Response::new(text, Vec::new()));
        if let Some(words) = command.strip_prefix("J=") {
            if !view.homed {
                return Err(Refusal::locked(
                    "the joint angles are unknown: home first, $H",
                ));
            }
            if !matches!(view.state, MachineState::Idle | MachineState::Jog) {
                return Err(Refusal::new(8, "a jog needs an arm at rest"));
            }
            let moves = self.jog(words)?;
            return Ok(Response::new(String::new(), vec![Order::Jog(moves)]));
        }
        match command.as_str() {
            "" => said("[HLP:$$ $# $G $I $N $H $X $J=line ~ ! ? ctrl-x]\n".into()),
            "$" => said(self.settings_text()),
            "#" => said(self.offsets()),
            "G" => said(format!("[GC:{}]\n", self.stream.modes())),
            "I" => said(format!(
                "[VER:1.1h.fivebar-{}:]\n[OPT:VH,15,{RECEIVED}]\n",
                env!("CARGO_PKG_VERSION")
            )),
            "N" => said("$N0=\n$N1=\n".into()),
            "H" => Ok(Response::new(String::new(), vec![Order::Home])),
            "X" => {
                let mut text = "[MSG:Caution: Unlocked]\n";
                if !view.homed {
                    text = "[MSG:the joint angles are still unknown: home first, $H]\n";
                }
                Ok(Response::new(text.into(), vec![Order::Unlock]))
            }
            _ => Err(Refusal::new(
                3,
                "no such command here; the arm's settings are in its robot file",
            )),
        }
    }

    /// The answer to `$$`: the settings that describe this arm, the others as if switched off.
    fn settings_text(&self) -> String {
        let motion = &self.settings.motion;
        // The limit has a rounding error of its own, 1e-7 of it.
        let speed = (f64::from(motion.max_speed) * PER_MINUTE * 100.0).round() / 100.0;
        let acceleration = f64::from(motion.max_acceleration) * 1e3;
        let corner = f64::from(motion.corner_tolerance) * 1e3;
        let reach = reach(self.settings.lengths).map(|metres| 1e3 * metres);
        let mut text = String::new();
        for number in [0, 1, 2, 3, 4, 5, 6, 10, 13, 20, 21, 22, 23, 26, 31, 32] {
            let value = match number {
                0 => 10,
                1 => 255,
                10 | 20 | 22 => 1,
                26 => 25,
                _ => 0,
            };
            let _ = writeln!(text, "${number}={value}");
        }
        let measured = [
            (11, corner),
            (12, corner),
            (24, speed),
            (25, speed),
            (27, 0.0),
            (30, self.full_power),
            (100, 1e3),
            (101, 1e3),
            (102, 1e3),
            (110, speed),
            (111, speed),
            (112, speed),
            (120, acceleration),
            (121, acceleration),
            (122, acceleration),
            (130, reach[0]),
            (131, reach[1]),
            (132, 0.0),
        ];
        for (number, value) in measured {
            let _ = writeln!(text, "${number}={value:.3}");
        }
        text
    }

    /// The answer to `$#`.
    fn offsets(&self) -> String {
        let [x, y] = self.stream.zero();
        let shift = place([x - self.home[0], y - self.home[1]]);
        let none = place([0.0; 2]);
        let mut text = String::new();
        for system in ["G54", "G55", "G56", "G57", "G58", "G59", "G28", "G30"] {
            let _ = writeln!(text, "[{system}:{none}]");
        }
        let _ = writeln!(text, "[G92:{shift}]\n[TLO:0.000]\n[PRB:{none}:0]");
        text
    }
}

/// Width and height of the region that both legs reach on one side of the base [m]: the part of two
/// circles about A and E that they share.
fn reach(lengths: [f32; 5]) -> [f64; 2] {
    let [l1, l2, l3, l4, base] = lengths.map(f64::from);
    let [leg1, leg4] = [l1 + l2, l3 + l4];
    let width = leg1.min(base + leg4) - (-leg1).max(base - leg4);
    // Where the circles meet, unless the top of one of them lies within the other.
    let meet = (base * base + leg1 * leg1 - leg4 * leg4) / (2.0 * base.max(1e-9));
    let height = if (0.0..=base).contains(&meet) {
        (leg1 * leg1 - meet * meet).max(0.0).sqrt()
    } else {
        leg1.min(leg4)
    };
    [width, height]
}
