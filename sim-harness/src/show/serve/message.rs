//! What pages and server say to each other, as JSON; docs/live-page.md tells it to others.

use super::lease::PageId;
use axum::extract::ws::Utf8Bytes;
use fivebar_firmware::Status;
use fivebar_firmware::controller::{Request, Snapshot};
use fivebar_kinematics::five_bar::Side;
use serde::{Deserialize, Serialize};
use std::sync::mpsc;
use tokio::sync::broadcast;

/// Messages to pages that may wait for a slow one before it misses the oldest.
const WAITING: usize = 64;

/// What a page asks. Places are of the tool [m], in the frame of the base. A number may be
/// greater than the controller's: that is a place out of reach, not a message of another
/// version.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum ClientRequest {
    /// Nothing: it is alive.
    Alive,
    /// To be in control: given to any page while the arm rests, and while it moves where
    /// the page in control is lost.
    Control,
    /// Something of the controller.
    Request(ControllerRequest),
    /// To move the tool by this much, straight.
    Jog([f64; 2]),
    /// To have the tool follow to this point; a later one takes its place.
    Follow([f64; 2]),
    /// To turn a joint by so much [rad].
    JogJoint {
        /// The joint.
        joint: Joint,
        /// The change of θ1 or θ4 [rad].
        by: f64,
    },
    /// To turn a joint to an angle; a later one takes its place.
    Turn {
        /// The joint.
        joint: Joint,
        /// θ1 or θ4 [rad], whole turns aside.
        to: f64,
    },
    /// To bring the elbows to the working mode, the tool staying where it is.
    Mode([Side; 2]),
    /// To load a job and see its path.
    Load {
        /// Its name.
        name: String,
        /// The G-code.
        text: String,
    },
    /// To do the job that is loaded.
    Run,
}

/// A driven joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Joint {
    Theta1,
    Theta4,
}

/// The controller's requests, as pages name them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum ControllerRequest {
    Arm,
    Disarm,
    Home,
    Stop,
    EmergencyStop,
    ClearFault,
}

impl ControllerRequest {
    /// Whether anyone may ask it: it makes the arm safer.
    pub(super) fn is_open_to_all(self) -> bool {
        matches!(self, Self::Stop | Self::EmergencyStop)
    }
}

impl From<ControllerRequest> for Request {
    fn from(wanted: ControllerRequest) -> Self {
        match wanted {
            ControllerRequest::Arm => Self::Arm,
            ControllerRequest::Disarm => Self::Disarm,
            ControllerRequest::Home => Self::Home,
            ControllerRequest::Stop => Self::Stop,
            ControllerRequest::EmergencyStop => Self::EmergencyStop,
            ControllerRequest::ClearFault => Self::ClearFault,
        }
    }
}

/// What happens at a page.
#[derive(Clone, Debug)]
pub(super) enum Event {
    /// It has connected.
    Joined,
    /// It asks for something.
    Request(ClientRequest),
    /// It asks for something that there is not: what the reader says.
    Strange(String),
    /// It has missed some news.
    Missed,
    /// It has gone.
    Left,
}

/// What the server tells the pages.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum News<'a> {
    /// The controller, some thirty times a second.
    State(State<'a>),
    /// A sentence for one page, or for all.
    Notice {
        /// The page it is for.
        to: Option<PageId>,
        /// Something was not done.
        refused: bool,
        /// The sentence.
        text: String,
    },
    /// The tick that raised the fault; none: it is cleared.
    Fault(Option<FaultNews>),
    /// The job that is loaded, to be drawn.
    Job(&'a JobNews),
}

/// The controller and its job.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct State<'a> {
    #[serde(flatten)]
    pub(super) status: &'a Status,
    /// Its time since its start [s].
    pub(super) time: f64,
    /// Its seconds per second of the clock; none in the first second.
    pub(super) speed: Option<f32>,
    /// B, C, D [m]; none until it is homed.
    pub(super) joints: Option<[[f32; 2]; 3]>,
    /// The working mode that the arm stands in; none until it is homed.
    pub(super) elbows: Option<[Side; 2]>,
    /// The page in control.
    pub(super) control: Option<PageId>,
    /// Whether that page lives.
    pub(super) alive: bool,
    /// Moves of the running job that are handed over, and all of them.
    pub(super) progress: Option<[usize; 2]>,
}

/// A fault, named, with what its tick saw.
#[derive(Clone, Debug, Serialize)]
pub(super) struct FaultNews {
    pub(super) name: String,
    #[serde(flatten)]
    pub(super) snapshot: Snapshot,
}

/// A job to be drawn before it is done.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(super) struct JobNews {
    pub(super) name: String,
    /// How many moves it has.
    pub(super) moves: usize,
    /// Its way.
    pub(super) strokes: Vec<Stroke>,
    /// Why it cannot be done.
    pub(super) refusal: Option<String>,
    /// The place of it that cannot be passed [m].
    pub(super) at: Option<[f32; 2]>,
}

/// Part of a way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Stroke {
    /// Whether the pen is down.
    pub(super) down: bool,
    /// Points of it [m].
    pub(super) points: Vec<[f32; 2]>,
}

/// The pages' end of both channels.
#[derive(Clone)]
pub(super) struct WebSide {
    pub(super) events: mpsc::Sender<(PageId, Event)>,
    pub(super) news: broadcast::Sender<Utf8Bytes>,
}

/// The machine's end of both channels.
pub(super) struct MachineSide {
    pub(super) events: mpsc::Receiver<(PageId, Event)>,
    news: broadcast::Sender<Utf8Bytes>,
}

/// The channels between pages and machine.
pub(super) fn channels() -> (WebSide, MachineSide) {
    let (event_sender, events) = mpsc::channel();
    let (news, _) = broadcast::channel(WAITING);
    let web = WebSide {
        events: event_sender,
        news: news.clone(),
    };
    (web, MachineSide { events, news })
}

impl MachineSide {
    /// Tells all pages.
    pub(super) fn tell(&self, news: &News<'_>) {
        if let Ok(text) = serde_json::to_string(news) {
            // Nobody may be there to hear.
            let _ = self.news.send(text.into());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{ClientRequest, State};
    use fivebar_firmware::{Controller, Settings};

    const DOCUMENT: &str = include_str!("../../../../docs/live-page.md");

    #[test]
    fn every_wish_of_the_document_is_understood_and_every_kind_is_there() {
        let (_, rest) = DOCUMENT.split_once("```json\n").unwrap();
        let (examples, _) = rest.split_once("```").unwrap();
        let mut seen = [false; 9];
        for example in examples.lines() {
            let kind = match serde_json::from_str(example).expect(example) {
                ClientRequest::Alive => 0,
                ClientRequest::Control => 1,
                ClientRequest::Request(_) => 2,
                ClientRequest::Jog(_) => 3,
                ClientRequest::Follow(_) => 4,
                ClientRequest::JogJoint { .. } | ClientRequest::Turn { .. } => 5,
                ClientRequest::Mode(_) => 6,
                ClientRequest::Load { .. } => 7,
                ClientRequest::Run => 8,
            };
            seen[kind] = true;
        }
        assert_eq!(seen, [true; 9]);
    }

    #[test]
    fn every_key_of_a_state_is_in_the_document() {
        let controller = Controller::new(&Settings::BENCHTOP).expect("sound settings");
        let status = &controller.status();
        let state = State {
            status,
            time: 0.0,
            speed: None,
            joints: None,
            elbows: None,
            control: None,
            alive: false,
            progress: None,
        };
        let (_, section) = DOCUMENT.split_once("The keys of `state`").unwrap();
        let state = serde_json::to_value(state).unwrap();
        for key in state.as_object().unwrap().keys() {
            assert!(section.contains(&format!("`{key}`")), "{key}");
        }
    }

    #[test]
    fn what_is_no_wish_is_not_understood() {
        for text in [
            r#"{"request": "set_angles"}"#,
            r#"{"turn": {"joint": "theta2", "to": 0.5}}"#,
            r#"{"turn": {"joint": "theta1", "to": 0.5, "by": 1}}"#,
            r#"{"jog": [0.001]}"#,
            r#""emergency""#,
            "",
        ] {
            assert!(
                serde_json::from_str::<ClientRequest>(text).is_err(),
                "{text}"
            );
        }
    }
}
