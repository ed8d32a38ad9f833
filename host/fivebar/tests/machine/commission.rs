//! The guided page of a commissioning: steps by clicks, tasks, mistakes, stops at any time, and a run
//! that goes on where it stopped.

use crate::arms::{ARMS, text};
use crate::program::{Server, machine};
use crate::stops::EndOnDrop;
use serde_json::Value;
use std::fs;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Status and body of the answer to a request.
fn ask(server: &Server, method: &str, path: &str, body: &str, cookie: &str) -> (u16, String) {
    let mut stream = TcpStream::connect(&server.host).unwrap();
    let length = body.len();
    write!(
        stream,
        "{method} {path} HTTP/1.1\r\nHost: {}\r\nCookie: {cookie}\r\nContent-Length: {length}\r\n\
         Content-Type: text/plain\r\nConnection: close\r\n\r\n{body}",
        server.host
    )
    .unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    let (head, body) = answer.split_once("\r\n\r\n").unwrap();
    let status = head.split(' ').nth(1).unwrap().parse().unwrap();
    (status, body.into())
}

fn start(out: &Path, more: &[&str]) -> Server {
    let out = out.display().to_string();
    Server::start(&[&["--commission", &out], more].concat())
}

fn click(server: &Server, path: &str, body: &str) -> u16 {
    ask(server, "POST", path, body, &server.cookie()).0
}

fn state(server: &Server) -> Value {
    let (status, body) = ask(server, "GET", "/state.json", "", &server.cookie());
    assert_eq!(status, 200);
    serde_json::from_str(&body).unwrap()
}

/// Waits for a state.
fn wait(server: &Server, what: &str, holds: impl Fn(&Value) -> bool) -> Value {
    let started = Instant::now();
    loop {
        let state = state(server);
        if holds(&state) {
            return state;
        }
        assert!(
            started.elapsed() < Duration::from_secs(60),
            "{what}: {state}"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Does a step; the simulated operator does its tasks.
fn finish(server: &Server, step: &str) -> Value {
    assert_eq!(click(server, "/begin", step), 204);
    let ended = |state: &Value| {
        state["running"].is_null() && (state["next"] != step || !state["trouble"].is_null())
    };
    let state = wait(server, step, |state| {
        ended(state) || !state["task"].is_null()
    });
    if !state["task"].is_null() {
        assert_eq!(click(server, "/done", "all"), 204);
    }
    wait(server, step, ended)
}

const BEFORE_MOTORS: [&str; 4] = ["supply", "emergency-stop", "switches", "encoders"];

#[test]
fn each_click_does_a_step_and_each_task_waits_for_a_click() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let server = start(&out, &[]);
    let begun = state(&server);
    assert_eq!(begun["next"], "supply");
    assert_eq!(begun["steps"].as_array().unwrap().len(), 13);
    assert!(
        finish(&server, "supply")["steps"][0]["found"]
            .as_str()
            .unwrap()
            .contains("the bus has 24")
    );
    assert_eq!(click(&server, "/begin", "emergency-stop"), 204);
    for words in ["Press the emergency stop", "Release the emergency stop"] {
        let asked = wait(&server, words, |state| {
            state["task"]["text"]
                .as_str()
                .is_some_and(|text| text.contains(words))
        });
        assert_eq!(asked["running"], "emergency-stop");
        // Another step does not begin meanwhile.
        assert_eq!(click(&server, "/begin", "supply"), 409);
        assert_eq!(click(&server, "/done", ""), 204);
    }
    wait(&server, "the next step", |state| {
        state["next"] == "switches"
    });
    for step in ["switches", "encoders", "motors"] {
        finish(&server, step);
    }
    let done = state(&server);
    assert_eq!(
        (&done["next"], &done["trouble"]),
        (&"electrics".into(), &Value::Null)
    );
    drop(server);
    // It goes on where it stopped.
    let server = start(&out, &[]);
    assert_eq!(state(&server)["next"], "electrics");
    assert_eq!(click(&server, "/again", "switches"), 204);
    wait(&server, "the repeated step", |state| {
        state["next"] == "switches"
    });
}

#[test]
fn a_mistake_is_named_with_what_to_do_and_the_step_is_not_done() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("dot.gcode"), "G1 X1 F600\n").unwrap();
    let scenario = folder.path().join("wired.toml");
    fs::write(
        &scenario,
        "job = \"dot.gcode\"\n[wiring]\nmotors_swapped = true\n",
    )
    .unwrap();
    let scenario = scenario.display().to_string();
    let server = start(&folder.path().join("out"), &["--scenario", &scenario]);
    for step in BEFORE_MOTORS {
        finish(&server, step);
    }
    let found = finish(&server, "motors");
    let trouble = found["trouble"].as_str().unwrap();
    assert!(
        trouble.contains("the motors are swapped") && trouble.contains("To do: "),
        "{trouble}"
    );
    assert_eq!(found["next"], "motors");
}

/// Up to the step that turns each joint by its motor.
#[test]
fn each_kind_of_drive_goes_through_its_own_first_steps_by_clicks() {
    for arm in ARMS {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("arm.toml");
        fs::write(&file, text(arm)).unwrap();
        let file = file.display().to_string();
        let server = start(&folder.path().join("out"), &["--robot", &file]);
        let (first, motors) = match arm {
            "benchtop" => ("supply", 5),
            "benchtop_stepper" | "new" => ("emergency-stop", 6),
            "leg" | "mit" => ("drives", 5),
            _ => ("emergency-stop", 2),
        };
        let begun = state(&server);
        assert_eq!(begun["next"], first, "{arm}");
        let names = begun["steps"].as_array().unwrap().iter();
        let names: Vec<&str> = names.map(|step| step["name"].as_str().unwrap()).collect();
        assert_eq!(names[motors - 1], "motors", "{arm}: {names:?}");
        for pair in names[..=motors].windows(2) {
            let after = finish(&server, pair[0]);
            assert!(after["trouble"].is_null(), "{arm}: {after}");
            assert_eq!(after["next"], pair[1], "{arm}");
        }
    }
}

#[test]
fn drives_on_a_bus_that_are_swapped_are_named_where_a_joint_is_turned() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("dot.gcode"), "G1 X1 F600\n").unwrap();
    let scenario = folder.path().join("wired.toml");
    let swapped = "robot = \"leg\"\njob = \"dot.gcode\"\n[wiring]\nnodes_swapped = true\n";
    fs::write(&scenario, swapped).unwrap();
    let scenario = scenario.display().to_string();
    let options = ["--robot", "leg", "--scenario", &scenario];
    let server = start(&folder.path().join("out"), &options);
    for step in ["drives", "emergency-stop", "switches"] {
        assert!(finish(&server, step)["trouble"].is_null());
    }
    let found = finish(&server, "encoders");
    let trouble = found["trouble"].as_str().unwrap();
    assert!(trouble.contains("the drives are swapped"), "{trouble}");
    assert_eq!(found["next"], "encoders");
}

#[test]
fn a_stop_ends_a_step_at_any_moment_and_the_step_can_be_done_again() {
    let folder = tempfile::tempdir().unwrap();
    let server = start(&folder.path().join("out"), &[]);
    // While nothing is done, while a task waits, and while a motor has a voltage.
    assert_eq!(click(&server, "/stop", ""), 204);
    wait(&server, "a stop", |state| state["stops"] == 1);
    go_on(&server);
    finish(&server, "supply");
    assert_eq!(click(&server, "/begin", "emergency-stop"), 204);
    wait(&server, "a task", |state| !state["task"].is_null());
    assert_eq!(click(&server, "/stop", ""), 204);
    let stopped = wait(&server, "a stop", |state| state["stops"] == 2);
    assert!(
        stopped["task"].is_null() && stopped["running"].is_null(),
        "{stopped}"
    );
    go_on(&server);
    for step in &BEFORE_MOTORS[1..] {
        finish(&server, step);
    }
    finish(&server, "motors");
    for (stops, millis) in [(3, 0), (4, 5), (5, 15)] {
        assert_eq!(click(&server, "/begin", "electrics"), 204);
        std::thread::sleep(Duration::from_millis(millis));
        assert_eq!(click(&server, "/stop", ""), 204);
        let stopped = wait(&server, "a stop", |state| state["stops"] == stops);
        let trouble = stopped["trouble"].as_str().unwrap();
        assert!(trouble.contains("the bridges are off"), "{trouble}");
        assert_eq!(stopped["next"], "electrics");
        go_on(&server);
    }
    let rest = [
        "homing", "belts", "friction", "geometry", "dynamics", "tuning",
    ];
    for (step, next) in ["electrics"].iter().chain(&rest).zip(&rest) {
        assert_eq!(finish(&server, step)["next"], *next);
    }
    finish(&server, "tuning");
    let whole = finish(&server, "validation");
    assert!(
        whole["next"].is_null() && whole["trouble"].is_null(),
        "{whole}"
    );
    for file in ["record.json", "robot.toml", "validation.svg"] {
        assert!(folder.path().join("out").join(file).exists(), "{file}");
    }
}

/// A person says that the arm is safe, and looks at it for a second.
fn go_on(server: &Server) {
    assert_eq!(click(server, "/safe", ""), 204);
    std::thread::sleep(Duration::from_millis(1050));
}

#[test]
fn after_a_stop_no_step_begins_before_a_person_has_said_that_the_arm_is_safe_and_a_second_has_passed()
 {
    let folder = tempfile::tempdir().unwrap();
    let server = start(&folder.path().join("out"), &[]);
    assert_eq!(click(&server, "/stop", ""), 204);
    wait(&server, "a stop", |state| state["stopped"] == true);
    assert_eq!(click(&server, "/begin", "supply"), 409);
    assert_eq!(click(&server, "/safe", ""), 204);
    let released = Instant::now();
    assert_eq!(click(&server, "/begin", "supply"), 409);
    assert!(released.elapsed() < Duration::from_secs(1));
    std::thread::sleep(Duration::from_millis(1050));
    finish(&server, "supply");
}

/// Connections that show no token: this many a second, until `ends`.
fn connect_and_leave(server: &Server, rate: u32, ends: &AtomicBool) -> u32 {
    let start = Instant::now();
    let mut count = 0;
    while !ends.load(Ordering::Relaxed) {
        let due = start + count * Duration::from_secs(1) / rate;
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
        if let Ok(mut stream) = TcpStream::connect(&server.host) {
            let _ = write!(stream, "GET / HTTP/1.1\r\nHost: {}\r\n\r\n", server.host);
        }
        count += 1;
    }
    count
}

#[test]
fn no_emergency_stop_is_lost_while_a_thousand_connections_a_second_show_no_token() {
    let folder = tempfile::tempdir().unwrap();
    let server = start(&folder.path().join("out"), &[]);
    let _machine = machine();
    let mut page = server.page();
    let ends = AtomicBool::new(false);
    let mut times = Vec::new();
    let begun = Instant::now();
    let connections: u32 = std::thread::scope(|scope| {
        let _end = EndOnDrop(&ends);
        let floods: Vec<_> = (0..4)
            .map(|_| scope.spawn(|| connect_and_leave(&server, 250, &ends)))
            .collect();
        for _ in 0..80 {
            let asked = Instant::now();
            page.request("emergency_stop");
            page.stopped("emergency_stop");
            times.push(asked.elapsed());
            while asked.elapsed() < Duration::from_millis(60) {
                page.next();
            }
        }
        ends.store(true, Ordering::Relaxed);
        floods.into_iter().map(|flood| flood.join().unwrap()).sum()
    });
    times.sort();
    let rate = f64::from(connections) / begun.elapsed().as_secs_f64();
    eprintln!(
        "80 stops under {rate:.0} connections a second: {:?} in the middle, {:?} at most",
        times[40], times[79]
    );
    assert!(times[76] < Duration::from_millis(500), "{times:?}");
    page.wait("its message", |message| {
        (message.get("guide")?["stops"].as_u64()? >= 80).then_some(())
    });
}

#[test]
fn what_does_not_belong_to_the_state_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let server = start(&folder.path().join("out"), &[]);
    assert_eq!(click(&server, "/done", ""), 409);
    assert_eq!(click(&server, "/begin", "flying"), 400);
    assert_eq!(click(&server, "/begin", &"x".repeat(100)), 413);
    assert_eq!(click(&server, "/begin", "homing"), 204);
    let refused = wait(&server, "a refusal", |state| !state["trouble"].is_null());
    assert_eq!(refused["trouble"], "homing is not the next step");
    for (method, path) in [
        ("GET", "/state.json"),
        ("POST", "/stop"),
        ("POST", "/begin"),
    ] {
        assert_eq!(ask(&server, method, path, "supply", "").0, 401, "{path}");
    }
}
