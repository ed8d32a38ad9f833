//! Files that ask for more than there is, sent while the arm is armed.

use crate::program::{Page, Server, machine};
use crate::stops::emergency_stop;
use serde_json::json;
use std::process::Command;

/// The most memory that the server may take [MB].
const MEMORY: f64 = 200.0;

fn load(page: &mut Page, text: &str) {
    page.send(&json!({ "load": { "name": "hostile", "text": text } }));
}

/// Why the job is refused.
fn refusal(page: &mut Page) -> String {
    page.wait("a refused job", |message| {
        let job = message.get("job").filter(|job| job["name"] == "hostile")?;
        Some(job["refusal"].as_str()?.to_owned())
    })
}

/// A DXF with one entity.
fn dxf(entity: &str) -> String {
    let entity = entity.replace([' ', '|'], "\n");
    format!("0\nSECTION\n2\nENTITIES\n{entity}\n0\nENDSEC\n0\nEOF\n")
}

#[test]
fn no_file_ends_the_server_and_an_armed_arm_stops_at_once_meanwhile() {
    let server = Server::start(&[]);
    let _machine = machine();
    let mut page = server.page();
    page.take_control_and_arm();
    let bulge = dxf("0 LWPOLYLINE|8 0|90 2|70 0|10 0|20 0|42 1e15|10 10|20 0");
    let spline = "0 SPLINE|71 3|40 0|40 0|40 0|40 0|40 1|40 1|40 1|40 1|10 0|20 0|10 9e5|20 9e5|10 -9e5|20 9e5|10 9|20 9|";
    let splines = spline.repeat(200) + "0 LINE|8 0|10 0|20 0|11 9|21 9";
    let svg = |content: &str| format!("<svg xmlns=\"http://www.w3.org/2000/svg\">{content}</svg>");
    for (text, words) in [
        (bulge, "more than 1000000 points"),
        (format!("G0 X{}", "7".repeat(40_000)), "40000 digits"),
        (svg(&"<g/>".repeat(500_001)), "nodes limit"),
        (svg(&"<g>".repeat(200_000)), "no SVG that can be read"),
    ] {
        load(&mut page, &text);
        let why = refusal(&mut page);
        assert!(why.contains(words), "{why}");
        assert_eq!(
            page.latest_state()["state"],
            "Armed",
            "nothing has stopped the arm"
        );
    }
    let long = "G1 X1 Y1\nG1 X0 Y0\n".repeat(100_000);
    let wide = "<path d=\"M0 0C1 9 5 9 9 0\" stroke=\"red\" stroke-width=\"1e9\"/>".repeat(9000);
    let mut times = Vec::new();
    for text in [format!("G21 G90 F600\n{long}"), svg(&wide), dxf(&splines)] {
        page.take_control_and_arm();
        load(&mut page, &text);
        page.send(&json!({ "jog": [0.0, 0.005] }));
        page.state("a move", |state| state["state"] == "Running");
        times.push(emergency_stop(&mut page).real);
    }
    eprintln!("emergency stops while files are read took {times:.3?} s");
    // A busy machine may delay one of them, by far less than the reading of a file would.
    times.sort_by(f64::total_cmp);
    assert!(times[1] < 0.1 && times[2] < 1.0, "{times:.3?}");
    assert!(server.peak_memory() < MEMORY, "{} MB", server.peak_memory());
}

/// A file is read by another process: if the system ends that one, the page gets a refusal, and the arm stays armed.
#[test]
fn the_end_of_the_process_that_reads_a_file_leaves_the_server_and_its_arm_alone() {
    let server = Server::start(&[]);
    let _machine = machine();
    let mut page = server.page();
    page.take_control_and_arm();
    load(
        &mut page,
        &format!("G21 G90 F600\n{}", "G1 X1 Y1\nG1 X0 Y0\n".repeat(300_000)),
    );
    let reader = (0..100_000).find_map(|_| server.children().next());
    let reader = reader.expect("a process that reads the file").to_string();
    let ended = Command::new("kill").args(["-9", &reader]).status();
    assert!(ended.expect("the program kill").success(), "{reader}");
    let why = refusal(&mut page);
    assert!(why.contains("simplify it"), "{why}");
    assert_eq!(page.latest_state()["state"], "Armed");
}
