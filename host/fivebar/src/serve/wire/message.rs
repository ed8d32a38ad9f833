//! The JSON messages between pages and server; docs/use/live-page.md describes them.

use super::lease::PageId;
use super::stop_signal::Stop;
use crate::serve::commission::PageState;
use fivebar_files::job::Trace;
use fivebar_firmware::Status;
use fivebar_firmware::controller::{Request, Snapshot};
use fivebar_kinematics::five_bar::Side;
use serde::{Deserialize, Serialize};
use tokio_tungstenite::tungstenite::Utf8Bytes;

/// Longest text of a notice or a refusal, in characters. Texts may quote what a page has sent.
const MAX_TEXT: usize = 300;

/// A request of a page. Positions are of the tool [m], in the frame of the base. Numbers
/// are read as `f64`: one too large for the controller's `f32` is a position out of reach
/// and is refused as such.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(in crate::serve) enum ClientRequest {
    /// A sign of life.
    Alive,
    /// Take control. Any page gets it while the arm rests; while the arm moves, only if the
    /// page in control is lost.
    Control,
    /// A request for the controller.
    Request(ControllerRequest),
    /// Move the tool by this much, in a straight line.
    Jog([f64; 2]),
    /// Move the tool to this point. A later one replaces it.
    Follow([f64; 2]),
    /// Turn a joint by an angle.
    JogJoint {
        /// The joint.
        joint: DrivenJoint,
        /// The change of θ1 or θ4 [rad].
        by: f64,
    },
    /// Turn a joint to an angle. A later one replaces it.
    Turn {
        /// The joint.
        joint: DrivenJoint,
        /// θ1 or θ4, up to whole turns [rad].
        to: f64,
    },
    /// Move the tool with this velocity [m/s], in a straight line as far as it goes, while the page renews it.
    Hold([f64; 2]),
    /// Turn a joint as far as it goes, while the page renews it.
    HoldJoint {
        /// The joint.
        joint: DrivenJoint,
        /// The velocity of θ1 or θ4 [rad/s].
        rate: f64,
    },
    /// Whatever began the held motion of the request with this number is still held.
    Renew(u64),
    /// Put the pen down or lift it, where the arm rests.
    Pen(PenPosition),
    /// Let a hand lead the arm; false: hold it, and take what was taught as the job.
    Teach(bool),
    /// Hold the pen's servo at another width of its pulse while the motors are off.
    PenHeight {
        /// The height that is tried.
        pen: PenPosition,
        /// The width [s].
        width: f64,
    },
    /// Keep the pen's heights that were tried.
    KeepPen,
    /// Do the lines of the robot file with this name.
    Macro(String),
    /// Send a line of G-code, or a command of Grbl.
    Console(String),
    /// Change to this working mode (the sides of elbows 1 and 4) with the same position of
    /// the tool.
    Mode([Side; 2]),
    /// Load a job and show its path.
    Load {
        /// Its name.
        name: String,
        /// The G-code.
        text: String,
    },
    /// Read the loaded file again, and later ones, in this way.
    Read(Reading),
    /// Place the loaded drawing elsewhere.
    Place(Shift),
    /// Place the drawing of the loaded file where the arm can draw it largest, turned as it fits best.
    Fit,
    /// Move the tool, lifted, along the rectangle around what the loaded job draws.
    Frame,
    /// Run the loaded job.
    Run,
    /// Say at which line the loaded job draws nearest to this point [m].
    LineAt([f64; 2]),
    /// Run it from this line on.
    RunFrom(u32),
    /// Go on with the job at the place where it was stopped.
    Resume,
    /// Whether the job runs on when no page is in control.
    RunOn(bool),
    /// The share of the job's feed rates.
    Feed(f64),
}

/// How a drawing is placed anew: scaled and turned about a point, then moved.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::serve) struct Shift {
    /// The point [m].
    pub(in crate::serve) about: [f64; 2],
    /// How far it moves [m].
    pub(in crate::serve) by: [f64; 2],
    /// The factor of all lengths.
    pub(in crate::serve) scale: f64,
    /// The angle, counter-clockwise [rad].
    pub(in crate::serve) turn: f64,
}

/// How files are read where they leave it open.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(in crate::serve) struct Reading {
    /// Distance of the lines that fill the areas of an SVG [m]; none: outlines only.
    pub(in crate::serve) hatch: Option<f64>,
    /// Speed along what is drawn [m/s]; none: the file's, or the arm's greatest.
    pub(in crate::serve) speed: Option<f64>,
    /// Z at or below which the pen is down [m]; none: 0, or the middle of the file's heights.
    pub(in crate::serve) pen_height: Option<f64>,
    /// How a picture becomes strokes; none: by its outlines.
    pub(in crate::serve) trace: Option<Trace>,
    /// The darkness of a picture that becomes ink; none: what divides it best.
    pub(in crate::serve) level: Option<f64>,
    /// How often a drawing is drawn, in columns and rows; none: once.
    pub(in crate::serve) copies: Option<[u32; 2]>,
    /// The distance between copies [m]; none: 5 mm.
    pub(in crate::serve) gap: Option<f64>,
    /// How far inside what the arm reaches a drawing is fitted [m]; none: 0.
    pub(in crate::serve) margin: Option<f64>,
}

/// A driven joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(in crate::serve) enum DrivenJoint {
    Theta1,
    Theta4,
}

/// Where a pen is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(in crate::serve) enum PenPosition {
    Up,
    Down,
}

/// The controller's requests, by the names that pages use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(in crate::serve) enum ControllerRequest {
    Arm,
    Disarm,
    Home,
    Stop,
    EmergencyStop,
    ClearFault,
}

impl ControllerRequest {
    /// The stop that this is, or else the controller's request.
    pub(in crate::serve) fn kind(self) -> Result<Stop, Request> {
        match self {
            Self::Stop => Ok(Stop::OnPath),
            Self::EmergencyStop => Ok(Stop::Emergency),
            Self::Arm => Err(Request::Arm),
            Self::Disarm => Err(Request::Disarm),
            Self::Home => Err(Request::Home),
            Self::ClearFault => Err(Request::ClearFault),
        }
    }
}

impl From<Stop> for Request {
    fn from(stop: Stop) -> Self {
        match stop {
            Stop::OnPath => Self::Stop,
            Stop::Emergency => Self::EmergencyStop,
        }
    }
}

/// A message of the server to the pages.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub(in crate::serve) enum ServerMessage<'a> {
    /// The controller's state, about 30 times a second.
    State(StateMessage<'a>),
    /// A sentence for one page, or for all.
    Notice {
        /// The page that it is for; none: all pages.
        to: Option<PageId>,
        /// Whether something was refused.
        refused: bool,
        /// The sentence.
        text: String,
    },
    /// A request that had a number is handled. What follows from it may take time.
    Answer {
        /// The page that made it.
        to: PageId,
        /// Its number.
        number: u64,
        /// The tick of the last state that does not show it; none for a sign of life.
        tick: Option<u32>,
        /// Why it was refused; none: it was accepted.
        refused: Option<String>,
    },
    /// The line of the job that draws nearest to a point.
    Line {
        /// The page that asked.
        to: PageId,
        /// The line.
        line: u32,
        /// Where the tool comes down to begin there [m].
        at: [f32; 2],
    },
    /// Answers to the lines of a page's console.
    Console {
        /// The page.
        to: PageId,
        /// The answers.
        text: String,
    },
    /// The controller has accepted a stop.
    Stopped(Stop),
    /// The state of a guided commissioning.
    Guide(&'a PageState),
    /// The latched fault; none: no fault is latched.
    Fault(Option<FaultMessage>),
    /// The loaded job.
    Job(&'a JobMessage),
}

/// The state of the controller and its job.
#[derive(Clone, Debug, Serialize)]
pub(in crate::serve) struct StateMessage<'a> {
    #[serde(flatten)]
    pub(in crate::serve) status: &'a Status,
    /// Time since the controller's start [s].
    pub(in crate::serve) time: f64,
    /// Seconds of the controller per real second; none in the first second.
    pub(in crate::serve) speed: Option<f32>,
    /// Values of both joints' drives, as `/arm.json` names them; none while they have no power.
    pub(in crate::serve) drives: Vec<Option<[f64; 2]>>,
    /// Positions of B, C, D [m]; none until the arm is homed.
    pub(in crate::serve) joints: Option<[[f32; 2]; 3]>,
    /// The arm's working mode; none until the arm is homed.
    pub(in crate::serve) elbows: Option<[Side; 2]>,
    /// The working modes to which the arm can change from where it rests; none while it moves and
    /// until the paths are planned.
    pub(in crate::serve) modes: Option<Vec<[Side; 2]>>,
    /// Where the tool was since the state before [m], its level there, its error [m] and speed [m/s].
    pub(in crate::serve) trail: &'a [[f32; 5]],
    /// Whether a sender of G-code is in control; pages watch then.
    pub(in crate::serve) sender: bool,
    /// The page whose console is the sender in control.
    pub(in crate::serve) console: Option<PageId>,
    /// Whether a target of the pages waits, or the arm is on its way to it.
    pub(in crate::serve) pending: bool,
    /// The page in control.
    pub(in crate::serve) control: Option<PageId>,
    /// Whether that page is alive.
    pub(in crate::serve) alive: bool,
    /// The time of the begun job that has passed, and its whole time, by its plan [s].
    pub(in crate::serve) progress: Option<[f64; 2]>,
    /// The time that the running job still takes [s]: by its plan, or estimated at another speed than the job's.
    pub(in crate::serve) left: Option<f64>,
    /// The line at which a stopped job can go on.
    pub(in crate::serve) held: Option<u32>,
    /// The pause at which the job waits for its user.
    pub(in crate::serve) pause: Option<&'a str>,
    /// The widths of the servo's pulse with the pen up and down, those that are tried if there are some [s]; none without
    /// a servo.
    pub(in crate::serve) pen: Option<[f32; 2]>,
    /// Whether the job runs on when no page is in control.
    pub(in crate::serve) run_on: bool,
    /// The share of the job's feed rates.
    pub(in crate::serve) feed: f32,
}

/// A fault by name, with what to do and the snapshot of the tick that raised it.
#[derive(Clone, Debug, Serialize)]
pub(in crate::serve) struct FaultMessage {
    pub(in crate::serve) name: String,
    pub(in crate::serve) advice: &'static str,
    #[serde(flatten)]
    pub(in crate::serve) snapshot: Snapshot,
}

/// A job and its path, to be drawn before it runs.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(in crate::serve) struct JobMessage {
    pub(in crate::serve) name: String,
    /// The number of its moves.
    pub(in crate::serve) moves: usize,
    /// The time that it takes by the controller's plan [s]; none while that is not known.
    pub(in crate::serve) time: Option<f64>,
    /// Its parts between pen changes and other pauses; empty if there is one.
    pub(in crate::serve) layers: Vec<Layer>,
    /// Its path.
    pub(in crate::serve) strokes: Vec<Stroke>,
    /// What of it is skipped, and how it is read where that is not certain.
    pub(in crate::serve) notes: Vec<String>,
    /// Its size as a share of its file's.
    pub(in crate::serve) scale: f64,
    /// How far it is turned, counter-clockwise [rad].
    pub(in crate::serve) turn: f64,
    /// How its file was read.
    pub(in crate::serve) reading: Reading,
    /// Whether it was checked from home, because the arm's position is unknown until it is homed.
    pub(in crate::serve) is_from_home: bool,
    /// Why it cannot be done.
    pub(in crate::serve) refusal: Option<String>,
    /// The position at which it is refused [m].
    pub(in crate::serve) at: Option<[f32; 2]>,
}

/// A part of a job between two pauses.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(in crate::serve) struct Layer {
    /// What its user is to do before it, such as the layer or the colour of a pen.
    pub(in crate::serve) name: String,
    /// The number of its strokes.
    pub(in crate::serve) strokes: usize,
    /// Their length [m].
    pub(in crate::serve) length: f64,
}

/// A part of the path.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(in crate::serve) struct Stroke {
    /// Whether the pen is down.
    pub(in crate::serve) down: bool,
    /// Its points [m].
    pub(in crate::serve) points: Vec<[f32; 2]>,
}

impl ServerMessage<'_> {
    /// The message as JSON.
    pub(in crate::serve) fn json(&self) -> Utf8Bytes {
        // Strings, numbers and lists of them always have a form in JSON.
        serde_json::to_string(self).unwrap_or_default().into()
    }
}

/// A text cut to [`MAX_TEXT`] characters.
pub(in crate::serve) fn brief(mut text: String) -> String {
    if let Some((end, _)) = text.char_indices().nth(MAX_TEXT) {
        text.truncate(end);
        text.push('…');
        text.shrink_to_fit();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::{ClientRequest, MAX_TEXT, StateMessage, brief};
    use crate::serve::wire::numbered::NumberedRequest;
    use fivebar_firmware::{Controller, Settings};
    use std::collections::BTreeSet;

    const DOCUMENT: &str = include_str!("../../../../../docs/use/live-page.md");

    #[test]
    fn every_request_in_the_document_is_read_and_every_kind_has_an_example() {
        let (_, rest) = DOCUMENT.split_once("```json\n").unwrap();
        let (examples, _) = rest.split_once("```").unwrap();
        let mut seen = [false; 26];
        for example in examples.lines() {
            let read: NumberedRequest = serde_json::from_str(example).expect(example);
            let kind = match read.request {
                ClientRequest::Alive => 0,
                ClientRequest::Control => 1,
                ClientRequest::Request(_) => 2,
                ClientRequest::Jog(_) => 3,
                ClientRequest::Follow(_) => 4,
                ClientRequest::JogJoint { .. } | ClientRequest::Turn { .. } => 5,
                ClientRequest::Mode(_) => 6,
                ClientRequest::Load { .. } => 7,
                ClientRequest::Run => 8,
                ClientRequest::RunFrom(_) => 9,
                ClientRequest::Resume => 10,
                ClientRequest::RunOn(_) => 11,
                ClientRequest::Feed(_) => 12,
                ClientRequest::Place(_) => 13,
                ClientRequest::Pen(_) => 14,
                ClientRequest::Console(_) => 16,
                ClientRequest::Hold(_) | ClientRequest::HoldJoint { .. } => 15,
                ClientRequest::Renew(_) => 17,
                ClientRequest::Fit => 18,
                ClientRequest::Frame => 19,
                ClientRequest::Read(_) => 20,
                ClientRequest::PenHeight { .. } => 21,
                ClientRequest::KeepPen => 22,
                ClientRequest::Macro(_) => 23,
                ClientRequest::LineAt(_) => 24,
                ClientRequest::Teach(_) => 25,
            };
            seen[kind] = true;
        }
        assert_eq!(seen, [true; 26]);
    }

    #[test]
    fn every_key_of_a_state_is_in_the_document() {
        let controller = Controller::new(&Settings::BENCHTOP.check().expect("valid settings"));
        let status = &controller.status();
        let state = StateMessage {
            status,
            time: 0.0,
            speed: None,
            drives: vec![Some([0.1, -0.2])],
            joints: None,
            elbows: None,
            modes: None,
            trail: &[],
            sender: false,
            console: None,
            pending: false,
            control: None,
            alive: false,
            progress: None,
            left: None,
            held: None,
            pause: None,
            pen: None,
            run_on: false,
            feed: 1.0,
        };
        let table = include_str!("../../../../../docs/use/live_state.csv");
        let rows = table.lines().skip(1);
        let documented: BTreeSet<_> = rows.map(|row| row.split(',').next().unwrap()).collect();
        let state = serde_json::to_value(state).unwrap();
        let keys: BTreeSet<_> = state
            .as_object()
            .unwrap()
            .keys()
            .map(String::as_str)
            .collect();
        assert_eq!(documented, keys);
    }

    #[test]
    fn malformed_requests_are_refused() {
        for text in [
            r#"{"request": "set_angles"}"#,
            r#"{"turn": {"joint": "theta2", "to": 0.5}}"#,
            r#"{"turn": {"joint": "theta1", "to": 0.5, "by": 1}}"#,
            r#"{"jog": [0.001]}"#,
            r#""emergency""#,
            "",
        ] {
            assert!(
                serde_json::from_str::<NumberedRequest>(text).is_err(),
                "{text}"
            );
        }
    }

    #[test]
    fn an_unknown_key_of_any_length_is_quoted_cut_short() {
        let key = "ü".repeat(100_000);
        let request = format!(r#"{{"{key}": 1}}"#);
        let error = serde_json::from_str::<NumberedRequest>(&request).unwrap_err();
        let text = brief(error.to_string());
        assert!(text.contains("ü") && text.chars().count() == MAX_TEXT + 1);
        assert_eq!(brief("short".into()), "short");
    }
}
