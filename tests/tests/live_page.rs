//! The live page's server with controllers outside its process. Here websockets take the place
//! of pages; the pages themselves are tested in a browser (scripts/browser.sh).
#![cfg(unix)]

use fivebar::bridge::for_pages;
use fivebar::serve::{Guard, ServeError, ServeOptions, serve};
use fivebar_files::job::JobReader;
use fivebar_files::robot::Robot;
use fivebar_firmware::safety::State;
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{Mismatch, Plant};
use fivebar_sim::clock::Clock;
use fivebar_sim::controller::ControllerSource;
use fivebar_sim::link::{Client, Loopback, SerialLine};
use serde_json::{Value, json};
use serialport::{SerialPort, TTYPort};
use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tungstenite::client::IntoClientRequest as _;
use tungstenite::http::HeaderValue;
use tungstenite::{Error, Message, WebSocket};

/// A thread that runs until this value is dropped.
struct Until<T> {
    ends: Arc<AtomicBool>,
    thread: Option<JoinHandle<T>>,
}

impl<T: Send + 'static> Until<T> {
    fn start(body: impl FnOnce(Arc<AtomicBool>) -> T + Send + 'static) -> Self {
        let ends = Arc::new(AtomicBool::new(false));
        let end = Arc::clone(&ends);
        let thread = Some(std::thread::spawn(move || body(end)));
        Self { ends, thread }
    }

    fn end(&mut self) -> Option<T> {
        self.ends.store(true, Ordering::Relaxed);
        Some(self.thread.take()?.join().expect("no panic"))
    }
}

impl<T> Drop for Until<T> {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Relaxed);
    }
}

fn benchtop() -> Robot {
    Robot::load("benchtop").expect("a built-in robot")
}

/// Where a server is, and the token for it.
#[derive(Clone)]
struct Link {
    address: SocketAddr,
    token: String,
}

/// Any free port, and jobs as the controller plans them.
fn options(guard: Guard) -> ServeOptions {
    ServeOptions {
        address: "127.0.0.1:0".parse().expect("an address"),
        guard,
        senders: for_pages(None),
        time_optimal: None,
        keep: Box::new(|_| Ok(())),
        jobs: JobReader::default(),
        clock: Clock::real(),
    }
}

/// A server for the benchtop arm.
fn server(
    source: impl FnOnce() -> ControllerSource<'static> + Send + 'static,
) -> (Until<Result<(), ServeError>>, Link) {
    let guard = Guard::with_new_token().expect("random numbers");
    let token = guard.token().to_owned();
    let (ready, at) = mpsc::channel();
    let server = Until::start(move |ends| {
        serve(
            &benchtop(),
            source(),
            options(guard),
            |address, _| ready.send(address).expect("a test that waits"),
            move || ends.load(Ordering::Relaxed),
        )
    });
    let address = at
        .recv_timeout(Duration::from_secs(20))
        .expect("a server in time");
    (server, Link { address, token })
}

/// A page that gives signs of life.
struct Page {
    socket: WebSocket<TcpStream>,
    spoke: Instant,
}

impl Page {
    fn open(Link { address, token }: &Link) -> Self {
        let stream = TcpStream::connect(address).expect("a server");
        let mut request = format!("ws://{address}/live")
            .into_client_request()
            .expect("an address");
        let cookie = format!("fivebar{}={token}", address.port());
        let cookie = HeaderValue::from_str(&cookie).expect("text");
        request.headers_mut().insert("Cookie", cookie);
        let (socket, _) = tungstenite::client(request, stream).expect("a websocket");
        socket
            .get_ref()
            .set_read_timeout(Some(Duration::from_millis(20)))
            .expect("a timeout");
        let spoke = Instant::now();
        Self { socket, spoke }
    }

    fn send(&mut self, message: &Value) {
        self.spoke = Instant::now();
        let message = Message::text(message.to_string());
        self.socket.send(message).expect("the server listens");
    }

    fn request(&mut self, name: &str) {
        self.send(&json!({ "request": name }));
    }

    /// The next message for which `wanted` returns a value.
    fn wait<T>(&mut self, what: &str, mut wanted: impl FnMut(&Value) -> Option<T>) -> T {
        let deadline = Instant::now() + Duration::from_secs(60);
        let mut last = String::new();
        while Instant::now() < deadline {
            if self.spoke.elapsed() > Duration::from_millis(50) {
                self.send(&json!("alive"));
            }
            match self.socket.read() {
                Ok(Message::Text(text)) => {
                    let update = serde_json::from_str(&text).expect("JSON");
                    if let Some(found) = wanted(&update) {
                        return found;
                    }
                    last = text.to_string();
                }
                Ok(_) => {}
                Err(Error::Io(error))
                    if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
                Err(error) => panic!("waiting for {what}: {error}"),
            }
        }
        panic!("waited in vain for {what}; the last update was {last}");
    }

    /// The next state for which `wanted` holds.
    fn state(&mut self, what: &str, wanted: impl Fn(&Value) -> bool) -> Value {
        self.wait(what, |update| {
            let state = update.get("state")?;
            wanted(state).then(|| state.clone())
        })
    }

    fn state_named(&mut self, name: &str) -> Value {
        self.state(name, |state| state["state"] == name)
    }

    /// The latched fault's name, and the state in which it was raised.
    fn fault(&mut self) -> (String, String) {
        self.wait("a fault", |update| {
            let fault = update.get("fault")?;
            let text = |key: &str| Some(fault.get(key)?.as_str()?.to_owned());
            assert!(text("advice")?.ends_with('.'), "{fault}");
            Some((text("name")?, text("state")?))
        })
    }
}

/// The sentence of a notice.
fn refusal(update: &Value) -> Option<String> {
    Some(update.get("notice")?["text"].as_str()?.to_owned())
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// A controller that moves the simulated benchtop arm, at the far end of a serial port
/// whose name is returned. Its time advances also while the host is silent, and slower than real
/// time, so that a busy machine does not look like a silent host.
fn board() -> (Until<()>, String) {
    let (mut far, near) = TTYPort::pair().expect("a pseudo-terminal");
    far.set_timeout(Duration::from_millis(5))
        .expect("a timeout");
    let name = near.name().expect("a name");
    let robot = benchtop();
    let settings = robot.settings().expect("masses");
    // A little before the home switches, so that homing is short.
    let before = |joint: Joint| {
        let sign = if settings.axes[joint].home_forward {
            -1.0
        } else {
            1.0
        };
        0.03 * sign
    };
    let pose = robot.pose_near_home(Joint::ALL.map(before));
    let mut plant = Plant::new(
        &robot.plant_parameters().expect("masses"),
        &Mismatch::default(),
        &pose.expect("a reachable pose"),
        7,
    );
    let period = 1.0 / f64::from(settings.control.tick_rate);
    let arm = move |command: &_| {
        plant.step(command, period);
        plant.sense()
    };
    let controller = Loopback::driving(&settings, Box::new(arm));
    let mut controller: Loopback = controller.expect("valid settings");
    let board = Until::start(move |ends| {
        // The near end stays open; otherwise reads of the far end fail before the server opens
        // the port.
        let _near = near;
        let mut bytes = [0; 512];
        while !ends.load(Ordering::Relaxed) {
            let received = far.read(&mut bytes).unwrap_or(0);
            if received == 0 {
                std::thread::sleep(Duration::from_millis(20));
            }
            controller
                .write_all(&bytes[..received])
                .expect("a perfect line");
            if let Ok(said) = controller.read(&mut bytes) {
                // The write fails if the server has ended.
                let _ = far.write_all(&bytes[..said]);
            }
        }
    });
    (board, name)
}

fn at_port(name: &str) -> impl FnOnce() -> ControllerSource<'static> + Send + use<> {
    let name: &'static str = name.to_owned().leak();
    let upload = false;
    move || ControllerSource::Port { name, upload }
}

#[test]
fn an_arm_on_a_port_is_homed_jogged_and_stopped_from_a_page() {
    let (_board, port) = board();
    let (mut server, link) = server(at_port(&port));
    let mut page = Page::open(&link);
    page.request("home");
    page.state("home", |state| {
        state["homed"] == true && state["state"] == "Stopped"
    });
    page.request("arm");
    let before = page.state_named("Armed");
    page.send(&json!({ "jog": [0.0, 0.002] }));
    page.state("the jog", |state| {
        let moved = number(&state["tool"][1]) - number(&before["tool"][1]);
        state["state"] == "Armed" && (moved - 0.002).abs() < 5e-5
    });
    // A number too large for single precision is a position out of reach.
    page.send(&json!({ "jog": [1e39, 0.0] }));
    let refused = page.wait("a refusal", refusal);
    assert!(refused.contains("refused"), "{refused}");
    // A page that watches may stop the arm; it may not move it.
    let mut watcher = Page::open(&link);
    watcher.send(&json!({ "jog": [0.0, 0.002] }));
    let refused = watcher.wait("a refusal", refusal);
    assert!(refused.contains("take control first"), "{refused}");
    watcher.request("emergency_stop");
    assert_eq!(watcher.fault(), ("emergency stop".into(), "Armed".into()));
    server.end().expect("it was running").expect("no error");
}

#[test]
fn a_page_that_sends_too_many_messages_is_disconnected() {
    let (_server, link) = server(|| ControllerSource::Simulated);
    let mut flooding = Page::open(&link);
    let alive = || Message::text(r#""alive""#);
    let deadline = Instant::now() + Duration::from_secs(60);
    while flooding.socket.send(alive()).is_ok() {
        assert!(Instant::now() < deadline, "it still has its connection");
    }
    let mut page = Page::open(&link);
    page.state_named("Stopped");
}

#[test]
fn an_arm_on_a_port_comes_to_rest_when_its_page_is_lost() {
    let (_board, port) = board();
    let (_server, link) = server(at_port(&port));
    let mut page = Page::open(&link);
    page.request("home");
    page.state("home", |state| {
        state["homed"] == true && state["state"] == "Stopped"
    });
    page.request("arm");
    page.state_named("Armed");
    page.send(&json!({ "jog_joint": { "joint": "theta1", "by": -0.1 } }));
    page.state_named("Armed");
    page.send(&json!({ "load": { "name": "lines", "text": "G21 F600\nG1 X20\nG1 X0\nG1 X20\n" } }));
    page.send(&json!("run"));
    page.state_named("Running");
    // The page is still connected, but silent.
    let mut watcher = Page::open(&link);
    assert_eq!(
        watcher.fault(),
        ("command timeout".into(), "Running".into())
    );
    let speed = |state: &Value| number(&state["velocity"][0]).hypot(number(&state["velocity"][1]));
    watcher.state("rest", |state| {
        state["state"] == "Fault" && speed(state) < 1e-2
    });
    drop(page);
}

#[test]
fn an_arm_is_disarmed_when_the_server_ends() {
    let (_board, port) = board();
    let (mut server, link) = server(at_port(&port));
    let mut page = Page::open(&link);
    page.request("home");
    page.state("home", |state| {
        state["homed"] == true && state["state"] == "Stopped"
    });
    page.request("arm");
    page.state_named("Armed");
    page.send(&json!({ "jog": [0.0, 0.02] }));
    page.state_named("Running");
    server.end().expect("it was running").expect("no error");
    let line = SerialLine::open(&port).expect("a port that is free again");
    let (mut client, _) = Client::open(line).expect("a controller");
    let (status, _) = client.status().expect("an answer");
    assert_eq!((status.state, status.fault), (State::Stopped, None));
}

#[test]
fn a_controller_of_another_arm_is_refused() {
    let (_board, port) = board();
    let outcome = serve(
        &Robot::load("usp_2dof").expect("a built-in robot"),
        at_port(&port)(),
        options(Guard::with_new_token().expect("random numbers")),
        |_, _| panic!("nothing is to be served"),
        || false,
    );
    let error = outcome.expect_err("a refusal").to_string();
    assert!(error.contains("--upload"), "{error}");
}

/// The firmware on the emulated board runs slower than real time, and the page shows the speed.
#[cfg(feature = "emulator")]
#[test]
fn an_emulated_controller_homes_its_arm_and_stops_it_when_the_page_is_lost() {
    use fivebar_sim::link::Emulator;
    let image: &'static std::path::Path = Emulator::built_image("qemu").leak();
    let (mut server, link) = server(move || ControllerSource::Emulated(image));
    let mut page = Page::open(&link);
    let start = page.state_named("Stopped");
    page.request("home");
    let far = |state: &Value| (number(&state["angle"][0]) - number(&start["angle"][0])).abs();
    let state = page.state("the arm to move", |state| far(state) > 1e-3);
    assert_eq!(state["state"], "Homing");
    let state = page.state("its speed", |state| !state["speed"].is_null());
    let speed = number(&state["speed"]);
    assert!(speed > 0.0 && speed < 1.1, "{speed} × real time");
    drop(page);
    // A page that connects now does not get control by itself.
    let mut page = Page::open(&link);
    assert_eq!(page.fault(), ("command timeout".into(), "Homing".into()));
    page.send(&json!("control"));
    page.request("clear_fault");
    page.state_named("Stopped");
    server.end().expect("it was running").expect("no error");
}
