//! Where a job is drawn: by itself, by --fit, and what a refusal advises.

use crate::bench::Bench;
use fivebar_testkit::program;
use serde_json::Value;
use std::process::Stdio;

const PETAL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../files/jobs/petal.gcode");

impl Bench {
    /// Runs a job to its end; returns its figures and what it says on the standard error.
    #[track_caller]
    fn drawn(&self, arguments: &[&str]) -> (Value, String) {
        let output = self.sim(&[arguments, &["--json"]].concat());
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{arguments:?}: {message}");
        let figures: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(figures["faults"], serde_json::json!([]));
        (figures, message)
    }

    /// Refuses a job; returns the message.
    #[track_caller]
    fn refused(&self, arguments: &[&str]) -> String {
        let output = self.sim(arguments);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {message}");
        message
    }

    /// Extent of what was drawn in the last run [m].
    fn extent(&self) -> [[f64; 2]; 2] {
        self.extent_after(3.0)
    }

    /// As [`Self::extent`], of the lines after this one; strokes have two lines each.
    fn extent_after(&self, first: f64) -> [[f64; 2]; 2] {
        let trace = std::fs::read_to_string(self.path("out/sim/trace.csv")).unwrap();
        let mut lines = trace.lines();
        let header: Vec<&str> = lines.next().unwrap().split(',').collect();
        let column = |name: &str| header.iter().position(|it| *it == name).unwrap();
        let (x, y, line) = (
            column("reference_x_m"),
            column("reference_y_m"),
            column("line"),
        );
        let mut extent = [[f64::MAX; 2], [f64::MIN; 2]];
        for row in lines {
            let row: Vec<f64> = row
                .split(',')
                .map(|it| it.parse().unwrap_or(f64::NAN))
                .collect();
            if row[line] > first {
                for (axis, value) in [row[x], row[y]].into_iter().enumerate() {
                    extent[0][axis] = extent[0][axis].min(value);
                    extent[1][axis] = extent[1][axis].max(value);
                }
            }
        }
        extent
    }
}

fn rectangle(width: f64, height: f64) -> String {
    format!("G21 G90 F18000\nG0 X0 Y0\nM3\nG1 X{width}\nG1 Y{height}\nG1 X0\nG1 Y0\nM5\n")
}

#[test]
fn a_rectangle_as_large_as_the_largest_clear_page_is_placed_by_itself() {
    are_placed(&[(234.0, 90.0)]);
}

#[test]
#[ignore = "some seconds: ./ci.sh tables"]
fn whole_table_of_rectangles_that_are_placed_by_themselves() {
    are_placed(&[(200.0, 80.0), (220.0, 85.0), (230.0, 89.0), (234.0, 90.0)]);
}

fn are_placed(rectangles: &[(f64, f64)]) {
    let bench = Bench::new();
    for &(width, height) in rectangles {
        let job = bench.file("page.gcode", &rectangle(width, height));
        bench.drawn(&[&job]);
        let [low, high] = bench.extent();
        let size = [0, 1].map(|axis| 1e3 * (high[axis] - low[axis]));
        assert!(
            (size[0] - width).abs() < 0.1 && (size[1] - height).abs() < 0.1,
            "{size:?}"
        );
    }
}

/// The options that a refusal advises, each way as one list.
fn advised(message: &str) -> Vec<Vec<String>> {
    let (_, ways) = message.split_once("with ").expect("advice");
    ways.trim()
        .split(", or with ")
        .map(|way| way.split_whitespace().map(str::to_owned).collect())
        .collect()
}

#[test]
fn a_drawing_that_is_too_large_is_refused_with_the_sizes_and_a_scale_that_works() {
    are_refused_with_a_way_out(|job| job.contains("a4"));
}

#[test]
#[ignore = "some seconds: ./ci.sh tables"]
fn whole_table_of_drawings_that_are_too_large() {
    are_refused_with_a_way_out(|_| true);
}

fn are_refused_with_a_way_out(is_chosen: impl Fn(&str) -> bool) {
    let bench = Bench::new();
    let long = bench.file("long.gcode", "G0 X0 Y0\nG1 X9000 F18000\n");
    let line = bench.file("line.gcode", "G0 X0 Y0\nG1 X300 F18000\n");
    let bare = bench.file("bare.gcode", "G1 X300 F18000\n");
    let a4 = bench.file("a4.gcode", &rectangle(297.0, 210.0));
    for (arguments, words) in [
        (&[&long[..]][..], ["long.gcode, line 2:", "9000 × 0 mm"]),
        (&[&line], ["line.gcode, line 2:", "300 × 0 mm"]),
        (&[&bare], ["bare.gcode, line 1:", "300 × 0 mm"]),
        (&[&a4], ["a4.gcode, line 4:", "297 × 210 mm"]),
        (
            &[PETAL, "--scale", "100"],
            ["petal.gcode, line 5:", "2000 × 828.4 mm"],
        ),
    ]
    .into_iter()
    .filter(|(_, words)| is_chosen(words[0]))
    {
        let message = bench.refused(arguments);
        for word in words
            .into_iter()
            .chain(["page 234.5 × 90.5 mm", "fits with --scale"])
        {
            assert!(message.contains(word), "`{word}` is missing in: {message}");
        }
        assert!(!message.contains(" m;"), "metres: {message}");
        for way in advised(&message) {
            let way: Vec<&str> = way.iter().map(String::as_str).collect();
            bench.drawn(&[&arguments[..1], &way].concat());
        }
    }
    // A larger scale than the advised one by a tenth does not fit.
    bench.refused(&[&a4, "--scale", "0.605"]);
}

#[test]
fn a_wrong_origin_is_refused_with_what_helps() {
    let bench = Bench::new();
    let metres = bench.refused(&[PETAL, "--origin", "30,160"]);
    assert!(metres.contains("write --origin 30mm,160mm"), "{metres}");
    bench.drawn(&[PETAL, "--origin", "30mm,160mm"]);
    let far = bench.refused(&[PETAL, "--origin", "40mm,30cm"]);
    assert!(
        far.contains("petal.gcode, line 3:") && far.contains("at ("),
        "{far}"
    );
    assert!(far.contains("it fits without --origin"), "{far}");
    // The way to a job that draws at once belongs to no line of it.
    let off = bench.file("off.gcode", "G1 F6000 X10\nG1 X0 Y5");
    let message = bench.refused(&[&off, "--origin", "0.5,0.5"]);
    assert!(
        message.contains("off.gcode, line 1: the tool cannot reach"),
        "{message}"
    );
}

#[test]
fn fit_finds_the_greatest_scale_with_a_turn_and_keeps_what_is_given() {
    let bench = Bench::new();
    // Upright, this rectangle fits at 0.7 or so.
    let upright = bench.file("upright.gcode", &rectangle(90.0, 230.0));
    let (_, told) = bench.drawn(&[&upright, "--fit"]);
    let told: Vec<&str> = told.split_whitespace().collect();
    let after = |option: &str| -> f64 {
        let index = told.iter().position(|it| *it == option).unwrap();
        told[index + 1].parse().unwrap()
    };
    let (scale, turn) = (after("--scale"), after("--rotate"));
    assert!((1.0..1.2).contains(&scale), "{scale}");
    assert!(
        turn % 15.0 == 0.0 && (turn % 180.0 - 90.0).abs() <= 15.0,
        "{turn}"
    );
    let [low, high] = bench.extent();
    assert!(high[0] - low[0] > 0.2, "{low:?} {high:?}");

    let (_, kept) = bench.drawn(&[&upright, "--fit", "--rotate", "0"]);
    assert!(kept.contains("--rotate 0"), "{kept}");
    bench.refused(&[&upright]);
    let (_, kept) = bench.drawn(&[&upright, "--fit", "--scale", "1"]);
    assert!(kept.contains("--scale 1 --rotate"), "{kept}");
    // Longer than the page: only where it is asked for.
    let line = bench.file("line.gcode", "G0 X0 Y0\nG1 X300 F18000\n");
    bench.drawn(&[&line, "--fit", "--scale", "1"]);
}

#[test]
fn a_fitted_drawing_keeps_the_margin_that_is_asked_for() {
    let bench = Bench::new();
    let job = bench.file("job.gcode", &rectangle(90.0, 60.0));
    let width = |options: &[&str]| {
        bench.drawn(&[&[&job[..], "--fit", "--rotate", "0"], options].concat());
        let [low, high] = bench.extent();
        high[0] - low[0]
    };
    let [whole, inside] = [width(&[]), width(&["--margin", "10mm"])];
    assert!(
        inside < whole - 0.005 && inside > 0.5 * whole,
        "{inside} m of {whole} m"
    );
    let refused = bench.refused(&[&job, "--fit", "--margin", "200mm"]);
    assert!(refused.contains("choose a smaller --margin"), "{refused}");
    let alone = bench.sim(&[&job, "--margin", "10mm"]);
    let message = String::from_utf8(alone.stderr).unwrap();
    assert!(message.contains("--fit"), "{message}");
}

#[test]
fn rotate_turns_the_job_about_its_origin() {
    let bench = Bench::new();
    let job = bench.file("job.gcode", &rectangle(30.0, 10.0));
    bench.drawn(&[&job, "--origin", "50mm,150mm", "--rotate", "90"]);
    let [low, high] = bench.extent();
    let expected = [[0.04, 0.15], [0.05, 0.18]];
    for (found, expected) in low
        .into_iter()
        .chain(high)
        .zip(expected.into_iter().flatten())
    {
        assert!(
            (found - expected).abs() < 1e-3,
            "{found} m, not {expected} m"
        );
    }
}

#[test]
fn an_svg_is_drawn_in_its_true_size() {
    let bench = Bench::new();
    let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100mm\" height=\"60mm\" \
               viewBox=\"0 0 100 60\"><g fill=\"none\" stroke=\"black\">\
               <rect x=\"10\" y=\"10\" width=\"80\" height=\"40\"/>\
               <path d=\"M20 30 C40 0 60 60 80 30\"/></g></svg>";
    let drawing = bench.file("drawing.svg", svg);
    bench.drawn(&[&drawing, "--speed", "200mm"]);
    let [low, high] = bench.extent_after(1.0);
    let size = [0, 1].map(|axis| 1e3 * (high[axis] - low[axis]));
    assert!(
        (size[0] - 80.0).abs() < 0.1 && (size[1] - 40.0).abs() < 0.1,
        "{size:?}"
    );
    let message = bench.refused(&[&drawing, "--scale", "4"]);
    assert!(message.contains("drawing.svg, stroke 1:"), "{message}");
}

/// What the program prints on its standard output when `text` is its standard input.
fn piped(arguments: &[&str], text: &[u8]) -> Vec<u8> {
    let bench = Bench::new();
    let mut child = program(env!("CARGO_BIN_EXE_fivebar"))
        .args(arguments)
        .current_dir(bench.path(""))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    std::io::Write::write_all(&mut child.stdin.take().unwrap(), text).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{arguments:?}");
    output.stdout
}

#[test]
fn a_job_comes_from_the_standard_input() {
    let output = piped(&["sim", "-", "--json"], &std::fs::read(PETAL).unwrap());
    let figures: Value = serde_json::from_slice(&output).unwrap();
    assert_eq!(figures["scenario"], "standard input");
}

#[test]
fn a_file_goes_from_the_standard_input_to_the_standard_output() {
    let robot = piped(&["new", "-", "--defaults"], b"");
    let graph = piped(&["export", "dot", "-", "--out", "-"], &robot);
    let graph = String::from_utf8(graph).unwrap();
    assert!(
        graph.starts_with("graph") && graph.trim_end().ends_with('}'),
        "nothing but the graph: {graph}"
    );
}

#[test]
fn names_close_to_a_mistyped_one_are_told() {
    let bench = Bench::new();
    let message = bench.refused(&[PETAL, "--robot", "benchtpo"]);
    assert!(message.contains("did you mean `benchtop`?"), "{message}");
    let scenario = bench.file("run.toml", &format!("job = '{PETAL}'\nscael = 2.0\n"));
    let message = bench.refused(&[&scenario]);
    assert!(
        message.contains("line 2") && message.contains("did you mean `scale`?"),
        "{message}"
    );
    let far = bench.refused(&[PETAL, "--robot", "no/such/file.toml"]);
    assert!(!far.contains("did you mean"), "{far}");
}

#[test]
fn nothing_of_another_run_stays_beside_new_results() {
    let bench = Bench::new();
    bench.drawn(&[PETAL, "--out", "mine"]);
    let own = bench.path("mine/notes.csv");
    std::fs::write(&own, "my own").unwrap();
    let linkage = program(env!("CARGO_BIN_EXE_fivebar"))
        .args(["linkage", "four_bar", "--out", "mine"])
        .current_dir(bench.path(""))
        .output()
        .unwrap();
    assert!(linkage.status.success());
    let files = std::fs::read_dir(bench.path("mine")).unwrap();
    let mut names: Vec<_> = files.map(|file| file.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(
        names,
        ["notes.csv", "report.html", "summary.json", "table.csv"]
    );
}

#[test]
fn the_job_time_is_told_beside_the_simulations() {
    let bench = Bench::new();
    let job = bench.file("still.gcode", "G0 X0 Y0\nG4 S1.25\nG0 X1\n");
    let output = bench.sim(&[&job]);
    let printed = String::from_utf8(output.stdout).unwrap();
    let figure = |name: &str| -> f64 {
        let line = printed
            .lines()
            .find(|line| line.trim().starts_with(name))
            .unwrap();
        line.split_whitespace().nth(1).unwrap().parse().unwrap()
    };
    let (job, simulated) = (figure("job "), figure("simulated"));
    assert!(
        (1.25..3.0).contains(&job) && job + 0.5 < simulated,
        "{printed}"
    );
}

#[test]
fn the_dialect_decides_how_long_a_dwell_is() {
    let bench = Bench::new();
    let job = bench.file("wait.gcode", "G0 X0 Y0\nG4 P2\nG0 X1\n");
    let time = |dialect: &[&str]| -> f64 {
        let output = bench.sim(&[&[&job[..]], dialect].concat());
        let printed = String::from_utf8(output.stdout).unwrap();
        let line = printed
            .lines()
            .find(|line| line.starts_with("  job "))
            .unwrap();
        line.split_whitespace().nth(1).unwrap().parse().unwrap()
    };
    let [found, grbl, reprap] =
        [&[][..], &["--dialect", "grbl"], &["--dialect", "reprap"]].map(time);
    assert!(
        found > 2.0 && found == grbl && reprap < 1.5,
        "{found} {grbl} {reprap} s"
    );
    let wrong = bench.sim(&[&job, "--dialect", "fanuc"]);
    assert_eq!(wrong.status.code(), Some(2));
}
