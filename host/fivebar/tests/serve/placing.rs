//! A drawing is placed: moved, scaled, turned, fitted, and shown by a tour around it.

use crate::in_process::{Page, Server};
use crate::own_job::{load, notice};
use crate::state::{number, speed};
use fivebar_files::robot::Robot;
use fivebar_files::scenario::{Kept, Scenario};
use serde_json::{Value, json};

/// Least and greatest x and y of what a job draws [m], once its time is known.
fn box_of(message: &Value) -> Option<[f64; 4]> {
    message["job"]["time"].as_f64()?;
    let strokes = message["job"]["strokes"].as_array()?;
    let down = strokes.iter().filter(|stroke| stroke["down"] == true);
    let points = down.flat_map(|stroke| stroke["points"].as_array().expect("points"));
    let at = |axis: usize| points.clone().map(move |point| number(&point[axis]));
    let least = |axis| at(axis).fold(f64::MAX, f64::min);
    let most = |axis| at(axis).fold(f64::MIN, f64::max);
    Some([least(0), least(1), most(0), most(1)])
}

#[test]
fn a_drawing_is_moved_scaled_and_turned_about_a_point_and_checked_there() {
    let server = Server::start();
    let mut page = server.page();
    page.take_control_and_arm();
    load(&mut page);
    let place = json!({ "about": [0.04, 0.17], "by": [0.0, 0.0], "scale": 1.0, "turn": 0.0 });
    page.accepted(&json!({ "place": place }));
    let before @ [left, low, right, _] = page.wait("the same", box_of);
    let middle = [0.5 * (left + right), low];
    let turn = std::f64::consts::FRAC_PI_2;
    let place = json!({ "about": middle, "by": [0.01, 0.0], "scale": 0.5, "turn": turn });
    page.accepted(&json!({ "place": place }));
    let [left, low, right, high] = page.wait("the new place", box_of);
    assert_ne!([left, low, right, high], before);
    assert!((left - right).abs() < 1e-6 && (left - middle[0] - 0.01).abs() < 1e-6);
    assert!((high - low - 0.02).abs() < 1e-6 && (0.5 * (high + low) - middle[1]).abs() < 1e-6);
    let away = json!({ "about": middle, "by": [0.5, 0.0], "scale": 1.0, "turn": 0.0 });
    page.accepted(&json!({ "place": away }));
    page.wait("a refusal", |message| {
        message["job"]["refusal"].as_str().map(str::to_owned)
    });
}

/// The outline of a sheet of A4, upright.
const SHEET: &str = "G21 G90 F3000\nM3\nG1 X210\nG1 Y297\nG1 X0\nG1 Y0\nM5\n";

/// A page whose job, the sheet, is refused: it is too large.
fn too_large(server: &Server) -> Page {
    let mut page = server.page();
    page.take_control_and_arm();
    page.accepted(&json!({ "load": { "name": "sheet", "text": SHEET } }));
    page.wait("a refusal", |message| {
        message["job"]["refusal"].as_str().map(str::to_owned)
    });
    page
}

#[test]
fn a_drawing_that_is_too_large_is_fitted_by_one_request_as_the_command_line_fits_it() {
    let server = Server::start();
    let mut page = too_large(&server);
    page.accepted(&json!("fit"));
    let drawn = page.wait("the fitted sheet", box_of);
    let robot = Robot::load("benchtop").expect("a robot");
    let mut scenario = Scenario::new("sheet", robot, "sheet.gcode", SHEET.into());
    let free = Kept {
        scale: false,
        turn: false,
    };
    scenario.fit_to_reach(free).expect("a place");
    let (sin, cos) = scenario.turn.sin_cos();
    let size = [[0.21, 0.297], [0.297, 0.21]]
        .map(|[along, across]| scenario.scale * (along * cos.abs() + across * sin.abs()));
    for axis in 0..2 {
        let own = drawn[axis + 2] - drawn[axis];
        assert!((own - size[axis]).abs() < 1e-4, "{drawn:?} {size:?}");
    }
    assert!(size[0].max(size[1]) > 0.1, "{size:?}");
}

#[test]
fn a_drawing_is_fitted_with_the_margin_of_the_page() {
    let server = Server::start();
    let mut page = too_large(&server);
    let mut scales = Vec::new();
    for margin in [0.0, 0.01] {
        page.accepted(&json!({ "read": { "margin": margin } }));
        page.accepted(&json!("fit"));
        scales.push(page.wait("the fitted sheet", |message| {
            let job = message.get("job").filter(|job| job["time"].is_number())?;
            let is_read = job["reading"]["margin"].as_f64() == Some(margin);
            is_read.then(|| number(&job["scale"]))
        }));
    }
    let share = scales[1] / scales[0];
    assert!((0.5..0.97).contains(&share), "{scales:?}");
    page.send(&json!({ "read": { "margin": -1.0 } }));
    notice(&mut page, "margin must be");
}

#[test]
fn a_job_loaded_before_homing_is_drawn_timed_and_checked_from_home_and_again_once_homed() {
    let server = Server::start();
    let mut watcher = server.page();
    let mut page = server.page();
    page.send(&json!("control"));
    let text = "G21 G90 F3000\nM3\nG1 X40\nG1 X0\n";
    page.accepted(&json!({ "load": { "name": "strokes", "text": text } }));
    let whole = |message: &Value| {
        let job = message.get("job").filter(|job| job["time"].is_number())?;
        Some((
            job["is_from_home"] == true,
            job["refusal"].clone(),
            box_of(message)?,
        ))
    };
    let (is_from_home, refusal, at_home) = page.wait("the job", whole);
    assert!(is_from_home && refusal.is_null(), "{refusal}");
    assert!((at_home[2] - at_home[0] - 0.04).abs() < 1e-6, "{at_home:?}");
    page.accepted(&json!({ "load": { "name": "sheet", "text": SHEET } }));
    let refused = page.wait("a refusal", |message| {
        let job = message
            .get("job")
            .filter(|job| job["refusal"].is_string())?;
        Some((
            job["is_from_home"] == true,
            job["strokes"].as_array()?.len(),
        ))
    });
    assert!(refused.0 && refused.1 > 0, "{refused:?}");
    page.accepted(&json!({ "load": { "name": "strokes", "text": text } }));
    page.wait("the job", whole);
    page.take_control_and_arm();
    let (is_from_home, refusal, drawn) = watcher.wait("the job, homed", |message| {
        whole(message).filter(|(is_from_home, ..)| !is_from_home)
    });
    assert!(!is_from_home && refusal.is_null(), "{refusal}");
    assert!(
        (0..4).all(|it| (drawn[it] - at_home[it]).abs() < 1e-3),
        "{drawn:?} {at_home:?}"
    );
    page.send(&json!("run"));
    page.state("full speed", |state| {
        state["state"] == "Running" && speed(state) > 0.1
    });
}

/// The path of the tool until the job or the tour is done; fails if the tool is not up on all of it.
fn lifted_path(page: &mut Page) -> Vec<[f64; 2]> {
    let mut path = Vec::new();
    loop {
        let message = page.next();
        for point in message["state"]["trail"].as_array().into_iter().flatten() {
            assert!(number(&point[2]) < 0.01, "the tool is down: {point}");
            path.push([0, 1].map(|axis| number(&point[axis])));
        }
        if message["notice"]["text"] == "The job is done." {
            return path;
        }
    }
}

#[test]
fn the_lifted_tool_goes_along_the_rectangle_around_the_drawing() {
    for robot in ["benchtop_pen", "benchtop_stepper"] {
        let server = Server::of(robot, None);
        let mut page = server.page();
        page.take_control_and_arm();
        let text = "G21 G90 F3000\nM3\nG1 X30\nG3 X30 Y20 I0 J10\nG1 X0\nM5\n";
        page.accepted(&json!({ "load": { "name": "half round", "text": text } }));
        let [left, low, right, high] = page.wait("the job", box_of);
        assert!(
            (right - left - 0.04).abs() < 1e-4 && (high - low - 0.02).abs() < 1e-6,
            "{left} {low} {right} {high}"
        );
        page.accepted(&json!("frame"));
        let path = lifted_path(&mut page);
        // Each corner is passed, and between the first and the last one the tool stays on the sides.
        let corners = [[left, low], [right, low], [right, high], [left, high]];
        let near = |corner: [f64; 2]| {
            move |at: &[f64; 2]| (at[0] - corner[0]).hypot(at[1] - corner[1]) < 2e-3
        };
        for corner in corners {
            assert!(path.iter().any(near(corner)), "{robot}: {corner:?}");
        }
        let first = path.iter().position(near(corners[1])).unwrap();
        let last = path.iter().rposition(near(corners[3])).unwrap();
        for &[x, y] in &path[first..last] {
            let across = [x - left, x - right, y - low, y - high].map(f64::abs);
            let off = across.into_iter().fold(f64::MAX, f64::min);
            assert!(off < 1e-3, "{robot}: ({x}, {y}) is {off} m off the sides");
        }
        // The loaded job is still the drawing.
        page.accepted(&json!("run"));
        page.state("the tool down", |state| number(&state["tool_level"]) > 0.9);
    }
}

#[test]
fn a_tour_that_leaves_the_workspace_or_has_no_drawing_is_refused_with_the_reason() {
    let server = Server::start();
    let mut page = server.page();
    page.send(&json!("control"));
    page.send(&json!("frame"));
    notice(&mut page, "not armed");
    page.take_control_and_arm();
    page.send(&json!("frame"));
    notice(&mut page, "There is no job");
    page.accepted(&json!({ "load": { "name": "sheet", "text": SHEET } }));
    page.wait("a refusal", |message| {
        message["job"]["refusal"].as_str().map(str::to_owned)
    });
    page.send(&json!("frame"));
    notice(&mut page, "leaves where the arm can move");
}

#[test]
fn a_file_is_read_again_with_hatch_and_speed_where_it_lies() {
    let server = Server::start();
    let mut page = server.page();
    page.take_control_and_arm();
    let square = r##"<svg xmlns="http://www.w3.org/2000/svg" width="20mm" height="10mm" viewBox="0 0 20 10">
        <rect width="20" height="10" fill="#000"/></svg>"##;
    page.accepted(&json!({ "load": { "name": "square.svg", "text": square } }));
    let drawn = |message: &Value| {
        let at = box_of(message)?;
        let job = &message["job"];
        let count = job["strokes"].as_array()?.len();
        Some((at, count, number(&job["time"]), job.clone()))
    };
    let (first, ..) = page.wait("the job", drawn);
    let place =
        json!({ "about": [first[0], first[1]], "by": [0.0, 0.01], "scale": 1.5, "turn": 0.25 });
    page.accepted(&json!({ "place": place }));
    let (placed, outlines, time, job) = page.wait("the new place", drawn);
    assert!(
        (number(&job["scale"]) - 1.5).abs() < 1e-9 && (number(&job["turn"]) - 0.25).abs() < 1e-9
    );
    page.accepted(&json!({ "read": { "hatch": 0.001, "speed": null, "pen_height": null } }));
    let (hatched, lines, ..) = page.wait("the hatch", drawn);
    // Lines at 45° in a rectangle of 30 by 15 mm, 1 mm apart: 45/√2 of them, and travel before each.
    assert!(
        lines > outlines + 55 && lines < outlines + 70,
        "{outlines}, then {lines}"
    );
    page.accepted(&json!({ "read": { "hatch": null, "speed": 0.01, "pen_height": null } }));
    let (slow, count, slow_time, job) = page.wait("the speed", drawn);
    assert_eq!(count, outlines);
    assert_eq!(job["reading"]["speed"], 0.01);
    // 90 mm at 10 mm/s.
    assert!(
        slow_time > 9.0 && slow_time > 2.0 * time,
        "{slow_time} s for {time} s"
    );
    for other in [hatched, slow] {
        assert!(
            (0..4).all(|it| (other[it] - placed[it]).abs() < 1e-5),
            "{other:?} {placed:?}"
        );
    }
    for (read, words) in [
        (
            json!({ "hatch": 1e-5, "speed": null, "pen_height": null }),
            "hatch",
        ),
        (
            json!({ "hatch": null, "speed": 0.0, "pen_height": null }),
            "speed",
        ),
        (json!({ "level": 1.0 }), "level"),
        (json!({ "copies": [0, 2] }), "copies"),
        (
            json!({ "hatch": null, "speed": null, "pen_height": 2.0 }),
            "height",
        ),
    ] {
        page.send(&json!({ "read": read }));
        notice(&mut page, words);
    }
    // What was refused is forgotten, what was accepted holds for the next file.
    page.accepted(&json!({ "load": { "name": "square.svg", "text": square } }));
    let (.., job) = page.wait("the next job", |message| {
        drawn(message).filter(|(.., job)| number(&job["scale"]) == 1.0)
    });
    assert_eq!(job["reading"]["speed"], 0.01);
}
