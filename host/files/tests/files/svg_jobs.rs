//! SVG drawings: true size, transforms, curves within the tolerance, the order of strokes.

use fivebar_files::job::{Action, Job, JobError, JobOptions, Placement, Step};

const AS_WRITTEN: Placement = Placement {
    origin: [0.0, 0.0],
    scale: 1.0,
    turn: 0.0,
    home: [0.05, 0.2],
};
const TOLERANCE: f64 = 2e-5;

fn read(text: &str) -> Result<Job, JobError> {
    let options = JobOptions {
        tolerance: TOLERANCE,
        ..JobOptions::default()
    };
    Job::parse_with(text, &AS_WRITTEN, &options)
}

/// A page of 100 mm × 50 mm with a unit of 1 mm.
fn page(content: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100mm\" \
         height=\"50mm\" viewBox=\"0 0 100 50\">{content}</svg>"
    )
}

/// The strokes [mm].
fn strokes(job: &Job) -> Vec<Vec<[f64; 2]>> {
    let mut strokes: Vec<Vec<[f64; 2]>> = Vec::new();
    for Step { tool, action, .. } in &job.steps {
        let Action::Line { to, .. } = action else {
            panic!("{action:?}");
        };
        let to = to.map(|metres| 1e3 * metres);
        match (strokes.last_mut(), *tool > 0.0) {
            (Some(stroke), true) => stroke.push(to),
            _ => strokes.push(vec![to]),
        }
    }
    strokes
}

fn of(content: &str) -> Vec<Vec<[f64; 2]>> {
    strokes(&read(&page(content)).unwrap_or_else(|error| panic!("{error}")))
}

#[track_caller]
fn assert_points(found: &[[f64; 2]], expected: &[[f64; 2]]) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (a, b) in found.iter().zip(expected) {
        let far = (a[0] - b[0]).hypot(a[1] - b[1]);
        assert!(far < 1e-4, "{a:?} mm, not {b:?} mm");
    }
}

const LINE: &str = "fill=\"none\" stroke=\"black\"";

#[test]
fn a_drawing_has_its_true_size_with_y_up() {
    let found = of(&format!("<path {LINE} d=\"M10 40 H30 V20\"/>"));
    assert_points(&found[0], &[[10.0, 10.0], [30.0, 10.0], [30.0, 30.0]]);
    // Without a unit, a unit is a pixel, of which an inch has 96.
    let pixels = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"192\" height=\"96\">\
                  <line stroke=\"red\" x1=\"0\" y1=\"96\" x2=\"192\" y2=\"0\"/></svg>";
    let job = read(pixels).unwrap();
    assert_points(&strokes(&job)[0], &[[0.0, 0.0], [50.8, 25.4]]);
    assert!(job.is_drawing && job.steps[0].line == 1 && job.steps[1].line == 2);
}

#[test]
fn transforms_of_groups_and_uses_are_applied() {
    let content = format!(
        "<defs><path id=\"p\" {LINE} d=\"M0 0 L5 0\"/></defs>\
         <g transform=\"translate(20 30) rotate(90)\"><g transform=\"scale(2)\">\
         <use href=\"#p\"/></g></g>"
    );
    assert_points(&of(&content)[0], &[[20.0, 10.0], [20.0, 20.0]]);
}

#[test]
fn curves_are_within_the_tolerance_and_coarser_where_it_is_greater() {
    let circle = format!("<circle {LINE} cx=\"50\" cy=\"25\" r=\"20\"/>");
    let found = of(&circle);
    let radius = |[x, y]: [f64; 2]| (x - 50.0).hypot(y - 25.0);
    // The circle is made of Bézier curves, which differ from it by up to 2.7e-4 of the radius.
    let bezier = 20.0 * 2.8e-4;
    for pair in found[0].windows(2) {
        let middle = [0, 1].map(|axis| 0.5 * (pair[0][axis] + pair[1][axis]));
        for (point, allowed) in [(pair[0], bezier), (middle, bezier + 1e3 * TOLERANCE)] {
            let error = (radius(point) - 20.0).abs();
            assert!(error < allowed, "{error} mm at {point:?}");
        }
    }
    let coarse = JobOptions {
        tolerance: 100.0 * TOLERANCE,
        ..JobOptions::default()
    };
    let coarse = strokes(&Job::parse_with(&page(&circle), &AS_WRITTEN, &coarse).unwrap());
    let ratio = found[0].len() as f64 / coarse[0].len() as f64;
    assert!((5.0..12.0).contains(&ratio), "{ratio}");
    // A quadratic parabola, whose points are known.
    let parabola = of(&format!("<path {LINE} d=\"M10 40 Q30 0 50 40\"/>"));
    assert!(parabola[0].len() > 10);
    for &[x, y] in &parabola[0] {
        let t = (x - 10.0) / 40.0;
        assert!((y - (10.0 + 80.0 * t * (1.0 - t))).abs() < 1e-4, "{x} {y}");
    }
}

#[test]
fn closed_shapes_end_at_their_start_and_each_subpath_is_a_stroke() {
    let found = of("<rect x=\"10\" y=\"10\" width=\"20\" height=\"5\"/>");
    let corners = [
        [10.0, 40.0],
        [30.0, 40.0],
        [30.0, 35.0],
        [10.0, 35.0],
        [10.0, 40.0],
    ];
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].len(), 5);
    assert_eq!(found[0][0], found[0][4]);
    for corner in corners {
        let near = |point: &&[f64; 2]| (point[0] - corner[0]).hypot(point[1] - corner[1]) < 1e-4;
        assert!(found[0].iter().any(|point| near(&point)), "{corner:?}");
    }
    let two = of(&format!("<path {LINE} d=\"M1 1 L9 1 M1 3 L9 3\"/>"));
    assert_eq!(two.len(), 2);
}

#[test]
fn lines_of_no_width_are_left_out_and_noted() {
    let shown = page(&format!("<path {LINE} d=\"M1 1 L9 1\"/>"));
    assert!(read(&shown).unwrap().warnings.is_empty());
    let job = read(&page(&format!(
        "<path {LINE} d=\"M1 1 L9 1\"/><path {LINE} stroke-width=\"0\" d=\"M1 3 L9 3\"/>"
    )));
    let job = job.unwrap();
    assert_eq!(strokes(&job).len(), 1);
    let note = job.warnings[0].to_string();
    assert!(note.contains("no width"), "{note}");
}

#[test]
fn strokes_are_ordered_and_turned_for_short_ways() {
    // Three parallel lines: drawn as written, each way back crosses the page.
    let found = of(&format!(
        "<path {LINE} d=\"M10 50 L90 50\"/><path {LINE} d=\"M10 30 L90 30\"/>\
         <path {LINE} d=\"M10 40 L90 40\"/>"
    ));
    assert_points(&found[0], &[[10.0, 0.0], [90.0, 0.0]]);
    assert_points(&found[1], &[[90.0, 10.0], [10.0, 10.0]]);
    assert_points(&found[2], &[[10.0, 20.0], [90.0, 20.0]]);
}

#[test]
fn what_is_hidden_is_left_out_and_what_differs_is_noted() {
    let hidden = format!(
        "<path fill=\"none\" d=\"M1 1 L9 1\"/><path {LINE} display=\"none\" d=\"M1 1 L9 1\"/>\
         <path {LINE} visibility=\"hidden\" d=\"M1 1 L9 1\"/>"
    );
    assert!(matches!(read(&page(&hidden)), Err(JobError::Drawing(_))));
    let noted = format!(
        "{hidden}<path {LINE} stroke-dasharray=\"1 2\" d=\"M1 1 L9 1\"/>\
         <text x=\"10\" y=\"20\" font-size=\"8\">I</text>\
         <image href=\"secret.png\" width=\"9\" height=\"9\"/>"
    );
    let job = read(&page(&noted)).unwrap();
    let notes: Vec<String> = job.warnings.iter().map(ToString::to_string).collect();
    let notes = notes.join("; ");
    for words in ["dashed", "Hershey", "images"] {
        assert!(notes.contains(words), "{notes}");
    }
    // The letter I is one upright line.
    let upright = |stroke: &Vec<[f64; 2]>| stroke.len() == 2 && stroke[0][0] == stroke[1][0];
    assert!(strokes(&job).iter().any(upright), "{:?}", strokes(&job));
}

#[test]
fn a_hatch_fills_what_is_seen_by_the_pen_of_its_fill() {
    let options = JobOptions {
        tolerance: TOLERANCE,
        hatch: Some(1e-3),
        ..JobOptions::default()
    };
    let ring = "<path fill-rule=\"evenodd\" d=\"M10 10H30V30H10ZM15 15H25V25H15Z\"";
    let read = |content: &str| Job::parse_with(&page(content), &AS_WRITTEN, &options).unwrap();
    let hatched = strokes(&read(&format!("{ring} fill=\"red\"/>")));
    // Edges are level or upright; a line that begins in a corner goes on from the outline.
    let edges = hatched.iter().flat_map(|stroke| stroke.windows(2));
    let lines: Vec<_> = edges
        .filter(|edge| (edge[1][0] - edge[0][0]) * (edge[1][1] - edge[0][1]) != 0.0)
        .collect();
    let length = |line: &&[[f64; 2]]| (line[1][0] - line[0][0]).hypot(line[1][1] - line[0][1]);
    let filled: f64 = lines.iter().map(length).sum();
    assert!((filled - 300.0).abs() < 12.0, "{filled} mm², 1 mm apart");
    for line in &lines {
        let middle = [0, 1].map(|axis| 0.5 * (line[0][axis] + line[1][axis]));
        let is_in_hole = (15.0..25.0).contains(&middle[0]) && (25.0..35.0).contains(&middle[1]);
        assert!(!is_in_hole, "{line:?}");
    }
    for empty in [
        "fill=\"white\" stroke=\"red\"",
        "fill=\"none\" stroke=\"red\"",
    ] {
        assert_eq!(
            strokes(&read(&format!("{ring} {empty}/>"))).len(),
            2,
            "two outlines"
        );
    }
    let on_white = "<rect width=\"100\" height=\"50\" fill=\"white\"/>";
    let both = strokes(&read(&format!("{on_white}{ring} fill=\"red\"/>")));
    assert_eq!(both, hatched, "a white page is no stroke");
    // The outline's pen and the fill's are two.
    let two = read(&format!("{ring} fill=\"red\" stroke=\"blue\"/>"));
    assert_eq!(two.stops.len(), 1, "{:?}", two.stops);
}

#[test]
fn shapes_that_no_one_sees_are_not_drawn() {
    let seen = format!("<path {LINE} d=\"M1 1 L9 1\"/>");
    for hidden in [
        "fill=\"none\" stroke=\"black\" opacity=\"0\"",
        "fill=\"none\" stroke=\"black\" stroke-opacity=\"0\"",
        "fill=\"none\" stroke=\"transparent\"",
        "fill-opacity=\"0\"",
        "fill=\"none\" stroke=\"black\" display=\"none\"",
        "fill=\"none\" stroke=\"black\" visibility=\"hidden\"",
        "style=\"fill:none;stroke:#0000\"",
    ] {
        let drawn = of(&format!("{seen}<path {hidden} d=\"M2 20 L30 20 L30 9\"/>"));
        assert_eq!(drawn.len(), 1, "{hidden}");
        let group = format!("{seen}<g opacity=\"0\"><path {LINE} d=\"M2 20 L30 20\"/></g>");
        assert_eq!(of(&group).len(), 1);
    }
    let half = "<path fill=\"none\" stroke=\"black\" stroke-opacity=\"0.5\" d=\"M2 20 L30 20\"/>";
    assert_eq!(of(half).len(), 1);
}

#[test]
fn a_text_is_drawn_in_single_strokes_of_its_height_where_it_stands() {
    let text = |content: &str| of(&format!("<text x=\"10\" y=\"40\" {content}</text>"));
    // H has two posts and a bar, seven tenths of the size high; x and y are of the left end of the base line.
    let found = text("font-size=\"20\">H");
    assert_eq!(found.len(), 3);
    let heights = |strokes: &[Vec<[f64; 2]>]| {
        let all = strokes.iter().flatten().map(|point| point[1]);
        [
            all.clone().fold(f64::INFINITY, f64::min),
            all.fold(0.0, f64::max),
        ]
    };
    let [low, high] = heights(&found);
    assert!(
        (low - 10.0).abs() < 1e-3 && (high - 24.0).abs() < 1e-3,
        "{low} {high}"
    );
    // A line of marks that is straight, and one letter after the other.
    assert_eq!(text("font-size=\"20\">-").len(), 1);
    assert_eq!(text("font-size=\"20\">HH").len(), 6);
    let ends = text("font-size=\"20\" text-anchor=\"end\">HH");
    assert!(
        ends.iter().flatten().all(|point| point[0] < 10.0),
        "{ends:?}"
    );
    // What the outlines of letters fill is no area here.
    let options = JobOptions {
        tolerance: TOLERANCE,
        hatch: Some(1e-3),
        ..JobOptions::default()
    };
    let hatched = Job::parse_with(
        &page("<text x=\"1\" y=\"40\" font-size=\"20\">O</text>"),
        &AS_WRITTEN,
        &options,
    );
    assert_eq!(strokes(&hatched.unwrap()).len(), 1);
}

#[test]
fn characters_that_a_font_lacks_are_named() {
    let text = |text: &str| {
        page(&format!(
            "<text x=\"5\" y=\"30\" font-size=\"9\">{text}</text>"
        ))
    };
    let notes = |content: &str| {
        let job = read(&text(content)).unwrap();
        job.warnings
            .iter()
            .map(ToString::to_string)
            .collect::<Vec<_>>()
            .join("; ")
    };
    assert_eq!(
        notes("Äø"),
        "texts are drawn in single strokes of the Hershey font"
    );
    assert_eq!(
        notes("Aж"),
        "a text is drawn as outlines of DejaVu Sans, because the Hershey font lacks ж (U+0436)"
    );
    assert!(notes("A日").contains("no font here has them: 日 (U+65E5)"));
    let refused = read(&text("日本")).unwrap_err().to_string();
    assert!(refused.contains("日 (U+65E5), 本 (U+672C)"), "{refused}");
}

#[test]
fn files_that_are_no_svg_are_refused() {
    for text in [
        "<",
        "<xml></xml>",
        "<svg",
        "<svg xmlns=\"http://www.w3.org/2000/svg\"/>",
    ] {
        assert!(matches!(read(text), Err(JobError::Drawing(_))), "{text}");
    }
    let huge = format!("<path {LINE} d=\"M0 0 L2e6 0\"/>");
    assert!(matches!(read(&page(&huge)), Err(JobError::Drawing(_))));
}

#[test]
fn deeply_nested_groups_do_not_exhaust_a_small_stack() {
    let nested = |depth: usize| {
        let (open, close) = ("<g opacity=\"0.5\">".repeat(depth), "</g>".repeat(depth));
        page(&format!("{open}<path {LINE} d=\"M1 1 L9 1\"/>{close}"))
    };
    let thread = std::thread::Builder::new().stack_size(1 << 18);
    let reader = thread.spawn(move || {
        assert_eq!(strokes(&read(&nested(1000)).unwrap()).len(), 1);
        assert!(matches!(read(&nested(100_000)), Err(JobError::Drawing(_))));
    });
    reader.unwrap().join().unwrap();
}

/// A short file can be a large drawing, and the time for a text grows with the square of its length.
#[test]
fn a_drawing_that_would_take_minutes_is_refused_by_its_size() {
    let repeated = |part: &str, count: usize| part.repeat(count);
    let doubled: String = (1..20)
        .map(|n| {
            let inner = n - 1;
            format!("<g id=\"a{n}\"><use href=\"#a{inner}\"/><use href=\"#a{inner}\"/></g>")
        })
        .collect();
    let marked = format!(
        "<marker id=\"m\">{}</marker><g marker-mid=\"url(#m)\"><path d=\"M0 0{}\"/></g>",
        repeated("<path d=\"M0 0L1 1\"/>", 50),
        repeated("L5 5L6 9", 1000)
    );
    let rules = format!(
        "<style>{}</style>{}",
        repeated(".c{fill:red}", 2000),
        repeated("<path class=\"c\" d=\"M0 0L9 9\"/>", 2000)
    );
    for (content, words) in [
        (
            format!("<text>{}</text>", repeated("word ", 6_400)),
            "32000 characters in a line of text, more than 2000: split it into lines, or convert it to paths",
        ),
        (
            format!("<text>{}</text>", repeated("<tspan>a</tspan>", 1_000)),
            "1000000 characters times pieces",
        ),
        (
            repeated("<text>0123456789012345678901234</text>", 900),
            "22500 characters of text, more than 20000",
        ),
        (repeated("<text>a</text>", 1_001), "1001 lines of text"),
        (
            format!("<defs><path id=\"a0\" d=\"M0 0L1 1\"/>{doubled}</defs><use href=\"#a19\"/>"),
            "elements, with those drawn by reference, more than 50000: simplify it",
        ),
        (marked, "elements, with those drawn by reference"),
        (rules, "rules of style sheets times elements"),
        (
            repeated("<circle r=\"1\"/>", 50_001),
            "50002 elements, with those drawn by reference",
        ),
    ] {
        let started = std::time::Instant::now();
        let error = read(&page(&content)).unwrap_err().to_string();
        assert!(error.contains(words), "`{words}` is missing in: {error}");
        assert!(started.elapsed().as_secs() < 10, "{words}");
    }
    // Targets that refer to each other are no drawing, and no endless one.
    let circle = "<g id=\"a\"><use href=\"#b\"/></g><g id=\"b\"><use href=\"#a\"/></g>";
    assert!(read(&page(circle)).is_err());
}

/// The names of the pens behind the first one, each with the first x of its strokes [mm].
fn pens(content: &str) -> Vec<(String, f64)> {
    let job = read(&page(content)).unwrap();
    let pens = job.stops.iter().map(|stop| {
        let [x, _] = job.steps[stop.before].action.end().unwrap();
        (stop.name.clone().unwrap(), (1e3 * x).round())
    });
    pens.collect()
}

#[test]
fn layers_are_pens_and_without_them_the_colours_of_lines_are() {
    let red = "<path d=\"M10 0H11\" stroke=\"red\"/>";
    let blue = "<path d=\"M20 0H21\" style=\"stroke:#0000ff\"/>";
    let filled = "<path d=\"M30 0h1v1z\" fill=\"#00ff00\"/>";
    let layer = |id: &str, label: &str, content: &str| {
        format!(
            "<g xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" id=\"{id}\" \
             inkscape:groupmode=\"layer\" {label}>{content}</g>"
        )
    };
    let outlines = layer("a", "inkscape:label=\"Outlines\"", &format!("{red}{blue}"));
    let nested = layer("c", "", &layer("d", "inkscape:label=\"inner\"", filled));
    let hatching = layer("b", "inkscape:label=\"Hatching &amp; more\"", blue);
    let found = pens(&format!("{outlines}{hatching}{nested}"));
    assert_eq!(
        found,
        [("Hatching & more".into(), 20.0), ("c".into(), 30.0)]
    );
    assert_eq!(pens(&outlines), [("#0000ff".into(), 20.0)]);
    let found = pens(&format!("{red}{filled}{blue}{red}"));
    assert_eq!(found, [("#00ff00".into(), 30.0), ("#0000ff".into(), 21.0)]);
    // Fills alone are no lines to be drawn with pens of their own.
    assert_eq!(pens(&format!("{red}{filled}")), []);
    let many = (0..20).map(|at| format!("<path d=\"M{at} 0h1\" stroke=\"#0000{at:02}\"/>"));
    let job = read(&page(&many.collect::<String>())).unwrap();
    assert!(
        job.stops.is_empty()
            && job.warnings[0]
                .to_string()
                .contains("more colours than pens")
    );
}
