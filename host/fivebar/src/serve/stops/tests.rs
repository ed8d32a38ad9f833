use crate::senders::{Console, Endpoints, Senders};
use crate::serve::controller_thread::ControllerThread;
use crate::serve::packed::Shelved;
use crate::serve::parsed_job::{ParsedJob, Size};
use crate::serve::wire::channels::{WebEnd, channels};
use crate::serve::wire::message::ServerMessage;
use crate::serve::wire::stop_signal::Stop;
use crate::serve::wire::updates::Updates;
use crate::test_session::{self, robot};
use fivebar_files::job::{Job, JobReader, Placement};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::{Move, MoveKind, Request};
use fivebar_kinematics::five_bar::Side;
use fivebar_sim::controller::Session;
use fivebar_sim::link::LinkError;
use std::sync::{Arc, Mutex};
use tokio::sync::broadcast::Receiver;
use tokio_tungstenite::tungstenite::Utf8Bytes;

/// Senders that are in control or not, and note what they are asked for.
struct Noted {
    is_in_control: bool,
    asked: Arc<Mutex<Vec<&'static str>>>,
}

impl Senders for Noted {
    fn endpoints(&self) -> Option<&Endpoints> {
        None
    }

    fn open_console(&mut self) -> Console {
        unreachable!("no page opens a console")
    }

    fn is_console_in_control(&self) -> bool {
        false
    }

    fn is_console_idle(&self, _: &Session) -> bool {
        false
    }

    fn release_console(&mut self, _: &Session) -> bool {
        false
    }

    fn serve(&mut self, _: &mut Session, _: bool) -> Result<bool, LinkError> {
        Ok(self.is_in_control)
    }

    fn is_in_control(&self) -> bool {
        self.is_in_control
    }

    fn hold(&mut self, _: &mut Session) -> Result<(), LinkError> {
        self.asked.lock().unwrap().push("hold");
        Ok(())
    }

    /// Clears the fault that the page has latched.
    fn emergency_stop(&mut self, session: &mut Session) -> Result<(), LinkError> {
        self.asked.lock().unwrap().push("emergency stop");
        session.request(Request::ClearFault)?.unwrap();
        session.wait_until_off()
    }

    fn take_note(&mut self) -> Option<String> {
        None
    }
}

struct Rig {
    thread: ControllerThread,
    web: WebEnd,
    notices: Receiver<(Option<u64>, Utf8Bytes)>,
    asked: Arc<Mutex<Vec<&'static str>>>,
}

impl Rig {
    /// Page 7 is the one that asks.
    fn new(is_in_control: bool) -> Self {
        let session = test_session::homed();
        let (web, controller, pages) = channels(session.clock.clone());
        let notices = web.notices.subscribe();
        let asked = Arc::<Mutex<Vec<_>>>::default();
        let senders = Box::new(Noted {
            is_in_control,
            asked: Arc::clone(&asked),
        });
        let updates = Updates::start(pages);
        let thread = ControllerThread::new(
            session,
            senders,
            robot(),
            (JobReader::default(), None, Box::new(|_| Ok(()))),
            controller,
            updates,
        );
        Self {
            thread: thread.unwrap(),
            web,
            notices,
            asked,
        }
    }

    /// An armed arm on its way to a target, which more requests of a page follow.
    fn moving() -> Self {
        let mut rig = Self::new(false);
        rig.arm();
        let [x, y] = rig.thread.session.status.reference.unwrap();
        for left in [0.02, 0.01] {
            rig.thread.feeder.set_target(MoveKind::Line {
                to: [x - left, y],
                feed: 0.05,
            });
        }
        rig.thread.mode_wanted = Some((7, [Side::Left; 2]));
        rig.thread.run_asked_by = Some((7, 0));
        rig
    }

    fn arm(&mut self) {
        let session = &mut self.thread.session;
        session.request(Request::Arm).unwrap().unwrap();
        while session.status.state != State::Armed || session.status.reference.is_none() {
            session.pass_time().unwrap();
            session.read_status().unwrap();
        }
    }

    /// What page 7 asks for is done; what pages are told.
    fn stop(&mut self, stop: Stop) -> Vec<(Option<u64>, String)> {
        self.web.shared.stop.raise(stop, 7);
        assert!(self.thread.stop_if_asked().unwrap());
        assert!(!self.thread.stop_if_asked().unwrap(), "it is done once");
        self.thread.session.read_status().unwrap();
        self.notices()
    }

    fn notices(&mut self) -> Vec<(Option<u64>, String)> {
        self.thread.notice("the end");
        let mut notices = Vec::new();
        loop {
            let (to, text) = self.notices.blocking_recv().unwrap();
            if text.contains("the end") {
                return notices;
            }
            notices.push((to, text.to_string()));
        }
    }

    fn state(&self) -> (State, Option<Fault>) {
        let status = &self.thread.session.status;
        (status.state, status.fault)
    }

    fn wants_nothing(&self) -> bool {
        let thread = &self.thread;
        thread.feeder.has_no_target()
            && thread.mode_wanted.is_none()
            && thread.run_asked_by.is_none()
    }
}

fn confirmed(stop: Stop) -> Vec<(Option<u64>, String)> {
    vec![(None, ServerMessage::Stopped(stop).json().to_string())]
}

#[test]
fn an_emergency_stop_is_latched_and_confirmed_and_drops_what_pages_want() {
    let mut rig = Rig::moving();
    assert_eq!(rig.stop(Stop::Emergency), confirmed(Stop::Emergency));
    assert_eq!(rig.state(), (State::Fault, Some(Fault::EmergencyStop)));
    assert!(rig.wants_nothing());
    let mut off = Rig::new(false);
    assert_eq!(off.stop(Stop::Emergency), confirmed(Stop::Emergency));
    assert_eq!(off.state().1, Some(Fault::EmergencyStop), "bridges are off");
}

#[test]
fn an_emergency_stop_reaches_the_sender_in_control_and_no_other() {
    let mut rig = Rig::new(true);
    // This sender's stop clears the fault, which is then not confirmed.
    let notices = rig.stop(Stop::Emergency);
    assert_eq!(*rig.asked.lock().unwrap(), ["emergency stop"]);
    assert_eq!(notices.len(), 1);
    assert!(notices[0].0.is_none() && notices[0].1.contains("No fault is latched."));
    let mut rig = Rig::new(false);
    assert_eq!(rig.stop(Stop::Emergency), confirmed(Stop::Emergency));
    assert!(rig.asked.lock().unwrap().is_empty());
}

#[test]
fn a_stop_on_the_path_is_confirmed_to_all_or_refused_to_its_page() {
    let mut rig = Rig::moving();
    assert_eq!(rig.stop(Stop::OnPath), confirmed(Stop::OnPath));
    assert!(rig.wants_nothing());
    let mut off = Rig::new(false);
    off.stop(Stop::Emergency);
    let notices = off.stop(Stop::OnPath);
    assert_eq!(notices.len(), 1);
    let (to, text) = &notices[0];
    assert!(
        *to == Some(7) && text.contains("\"refused\":true"),
        "{text}"
    );
}

#[test]
fn a_stop_on_the_path_holds_the_sender_in_control_and_no_other() {
    let mut rig = Rig::new(true);
    assert_eq!(rig.stop(Stop::OnPath), []);
    assert_eq!(*rig.asked.lock().unwrap(), ["hold"]);
    let mut rig = Rig::new(false);
    rig.arm();
    assert_eq!(rig.stop(Stop::OnPath), confirmed(Stop::OnPath));
    assert!(rig.asked.lock().unwrap().is_empty());
}

#[test]
fn a_stop_keeps_the_place_of_a_job_and_says_where_it_is() {
    let mut rig = Rig::moving();
    let home = rig.thread.session.status.reference.unwrap().map(f64::from);
    let placement = Placement {
        origin: home,
        scale: 1.0,
        turn: 0.0,
        home,
    };
    let job = Job::parse("G1 X-1 F600\nX-20\n", &placement).unwrap();
    let lines = job.steps.iter().map(|step| step.line);
    let moves = job.moves(0.1).zip(lines);
    let moves: Vec<_> = moves.map(|(next, tag)| Move { tag, ..next }).collect();
    let text = Arc::new(Shelved::of(&String::new()));
    let job = ParsedJob::new("a job".into(), text, (job, Size::TRUE), &moves);
    rig.thread.feeder.run(Arc::new(job), 1, None);
    let notices = rig.stop(Stop::OnPath);
    assert!(!rig.thread.feeder.is_running());
    let held = "The job has stopped at line 1 and can be resumed there.";
    assert!(notices[0].1.contains(held), "{notices:?}");
}

#[test]
fn without_a_request_nothing_stops() {
    let mut rig = Rig::moving();
    assert!(!rig.thread.stop_if_asked().unwrap());
    rig.thread.session.read_status().unwrap();
    assert_eq!(rig.state(), (State::Armed, None));
    assert_eq!(rig.notices(), []);
}

#[test]
fn an_arm_rests_in_three_states() {
    use State::{Armed, Crossing, Exciting, Fault, Homing, Running, Stopped, Stopping};
    let mut rig = Rig::new(false);
    for state in [
        Armed, Crossing, Exciting, Fault, Homing, Running, Stopped, Stopping,
    ] {
        rig.thread.session.status.state = state;
        let rests = matches!(state, Armed | Fault | Stopped);
        assert_eq!(rig.thread.rests(), rests, "{state:?}");
    }
}
