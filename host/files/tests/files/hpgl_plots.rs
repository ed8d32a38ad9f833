//! HPGL plots: pens, units, arcs, and what is refused.

use crate::placed::{AS_WRITTEN, job};
use fivebar_files::job::{Action, Job, Step};

/// The strokes [mm].
fn strokes(text: &str) -> Vec<Vec<[f64; 2]>> {
    let mut strokes: Vec<Vec<[f64; 2]>> = Vec::new();
    for Step { tool, action, .. } in job(text).steps {
        let Action::Line { to, .. } = action else {
            panic!("{action:?}");
        };
        let to = to.map(|metres| (1e9 * metres).round() / 1e6);
        match (strokes.last_mut(), tool > 0.0) {
            (Some(stroke), true) => stroke.push(to),
            _ => strokes.push(vec![to]),
        }
    }
    strokes
}

fn refused(text: &str) -> String {
    Job::parse(text, &AS_WRITTEN).unwrap_err().to_string()
}

#[test]
fn lines_are_in_units_of_25_micrometres_absolute_and_relative() {
    let square = [[10.0, 5.0], [20.0, 5.0], [20.0, 15.0], [10.0, 5.0]];
    for text in [
        "IN;SP1;PU400,200;PD800,200,800,600,400,200;PU;SP0;",
        "IN;SP1;PU400,200;PD800,200;PD800,600;PD400,200;PU0,0;SP0;",
        "in;sp1;pa400,200;pd;pa800 200 800 600\npa400 200;pu;",
        "IN;SP1;PA;PU400 200;PR;PD400,0,0,400;PD-400,-400;PU;",
        "\u{1B}.(\u{1B}.I81;;17:\u{1B}%0BINSP1PU400,200PD800,200,800,600,400,200PUSP0",
        "IN;IP0,0,4000,4000;SC0,100,0,100;SP1;PU10,5;PD20,5,20,15,10,5;PU;",
        "IN;SP1;DT#;LBa;b#;PU400,200;PD800,200,800,600,400,200;",
        "IN;SP0;PU0,0;PD9,9;SP2;PU400,200;PD800,200,800,600,400,200;",
    ] {
        assert_eq!(strokes(text), [square.to_vec()], "{text}");
    }
    let rectangle = strokes("IN;SP1;PU400,200;EA800,600;");
    let [a, b, c, d] = [[10.0, 5.0], [20.0, 5.0], [20.0, 15.0], [10.0, 15.0]];
    assert_eq!(rectangle, [vec![a, b, c, d, a]]);
}

#[test]
fn polygons_are_closed_and_parts_of_them_are_apart() {
    let [a, b, c] = [[10.0, 5.0], [20.0, 5.0], [20.0, 15.0]];
    let two = strokes(
        "IN;SP1;PU400,200;PM0;PD800,200,800,600;PM1;PD1000,200,1200,200,1200,600;PM2;EP;PU;",
    );
    let other = [a, b, c, a].map(|[x, y]| [x + 15.0, y]);
    let moved = [other[0], [30.0, 5.0], [30.0, 15.0], other[0]];
    assert_eq!(two, [vec![a, b, c, a], moved.to_vec()]);
    // A line of two points with the pen lifted before the polygon's end is no area.
    let line = strokes("IN;SP1;PU400,200;PM0;PD800,200;PU;PM2;EP;");
    assert_eq!(line, [vec![a, b]]);
}

#[test]
fn escapes_of_pcl_and_lines_of_pjl_are_skipped() {
    let start = "\u{1B}%-12345X@PJL JOB NAME=\"a;b\"\n@PJL ENTER LANGUAGE=PCL\n\u{1B}E\u{1B}&l1X\u{1B}*p0x0Y\u{1B}%0B";
    assert_eq!(
        strokes(&format!(
            "{start}INNP8SP1;PU400,200;PD800,200;\u{1B}%0A\u{1B}E"
        )),
        [vec![[10.0, 5.0], [20.0, 5.0]]]
    );
}

#[test]
fn circles_and_arcs_are_lines_within_the_tolerance() {
    let far = |[x, y]: [f64; 2]| ((x - 50.0).hypot(y - 40.0) - 20.0).abs();
    let circle = strokes("IN;SP1;PD;PU2000,1600;CI800;PU;");
    assert_eq!(circle.len(), 1);
    assert!(circle[0].len() > 60 && circle[0].iter().all(|&point| far(point) < 1e-5));
    let middles = circle[0]
        .windows(2)
        .map(|ends| [0, 1].map(|axis| 0.5 * (ends[0][axis] + ends[1][axis])));
    assert!(middles.map(far).all(|far| far < 0.026));
    let arc = strokes("IN;SP1;PU2000,800;PD;AA2000,1600,90;PU;");
    assert_eq!(
        (arc[0][0], arc[0].last().unwrap()),
        ([50.0, 20.0], &[70.0, 40.0])
    );
    // The stroke is drawn from its end, which is nearer to (0, 0).
    let clockwise = strokes("IN;SP1;PU2000,800;PD;AR0,800,-90;PD0,0");
    assert_eq!(clockwise[0][1], [30.0, 40.0]);
}

#[test]
fn pens_are_drawn_one_after_the_other_and_noted() {
    let plot = job("IN;SP2;PU0,0;PD40,0;SP1;PU400,0;PD440,0;SP2;PU80,0;PD120,0;SP0;");
    let ends: Vec<_> = plot
        .steps
        .iter()
        .filter_map(|step| step.action.end())
        .collect();
    let x: Vec<_> = ends.iter().map(|[x, _]| (1e3 * x).round()).collect();
    assert_eq!(x, [0.0, 1.0, 2.0, 3.0, 10.0, 11.0]);
    let note = plot.warnings[0].to_string();
    assert!(
        note.starts_with("the pens are pen 2, pen 1, in this order"),
        "{note}"
    );
}

#[test]
fn what_would_be_drawn_otherwise_is_refused_with_its_command() {
    for (text, what) in [
        ("IN;SP1;PD0,0,40;", "command 3, PD: a coordinate is missing"),
        ("IN;SP1;PE<=?;", "command 3, PE: it is not read"),
        ("IN;SC0,1,0,1;", "P1 and P2"),
        ("IN;SP1;RO45;PD9,9", "0, 90, 180 or 270"),
        ("IN;SP1;PD9,9;RO90;PD0,9", "export it unturned"),
        ("IN;SP1;PD;AT9,9,18,18.1,1,2;", "6 numbers do not suit it"),
        ("IN;SP1;PD;AT9,9,4,4;", "no arc passes"),
        ("IN;SP1;PD1x,2", "command 3, PD"),
        ("IN;SP1;ZZ4;", "command 3, ZZ: it is no command"),
        ("IN;SP999;", "from 0 to 255"),
        ("IN;SP1;PD99999999999,0;", "out of reach"),
        ("IN;SP1;PU5,5;", "draws nothing"),
    ] {
        let why = refused(text);
        assert!(why.contains(what), "{text}: {why}");
    }
}

#[test]
fn an_arc_through_three_points_passes_them_in_their_order() {
    let far = |[x, y]: [f64; 2]| ((x - 35.0).hypot(y - 25.0) - 10.0).abs();
    for text in [
        "IN;SP1;PU1000,1000;PD;AT1400,1400,1800,1000;PU;",
        "IN;SP1;PU1000,1000;PD;RT400,400,800,0;PU;",
    ] {
        let arc = strokes(text).concat();
        assert_eq!((arc[0], arc.last()), ([25.0, 25.0], Some(&[45.0, 25.0])));
        assert!(
            arc.iter()
                .all(|&point| far(point) < 1e-5 && point[1] > 24.999)
        );
        let lengths = arc.windows(2).map(|ends| {
            let [[x0, y0], [x1, y1]] = [ends[0], ends[1]];
            (x1 - x0).hypot(y1 - y0)
        });
        assert!((lengths.sum::<f64>() - 31.416).abs() < 0.1);
    }
    let below = strokes("IN;SP1;PU1000,1000;PD;AT1400,600,1800,1000;PU;").concat();
    assert!(below.iter().all(|point| point[1] < 25.001));
    let circle = strokes("IN;SP1;PU1000,1000;PD;AT1800,1000,1000,1000;PU;").concat();
    assert!(circle.len() > 40 && circle.iter().all(|&point| far(point) < 1e-5));
    let line = strokes("IN;SP1;PU0,0;PD;AT400,400,800,800;PU;");
    assert_eq!(line, [[[0.0, 0.0], [20.0, 20.0]]]);
}

#[test]
fn wedges_curves_and_turned_plots_are_drawn_and_what_changes_no_line_is_skipped() {
    let wedge = strokes("IN;SP1;CT1;PU400,400;EW400,0,90;PU;").concat();
    assert_eq!((wedge[0], wedge[1]), ([10.0, 10.0], [20.0, 10.0]));
    assert_eq!(wedge.last(), Some(&[10.0, 10.0]));
    assert_eq!(wedge[wedge.len() - 2], [10.0, 20.0]);
    for curve in [
        "IN;SP1;PU400,0;PD;BZ400,400,800,400,800,0;",
        "IN;SP1;PU400,0;PD;BR0,400,400,400,400,0;",
    ] {
        let curve = strokes(curve).concat();
        assert_eq!((curve[0], curve.last()), ([10.0, 0.0], Some(&[20.0, 0.0])));
        let highest = curve.iter().map(|point| point[1]).fold(0.0, f64::max);
        assert!((highest - 7.5).abs() < 0.03, "{highest}");
    }
    let turned = strokes("IN;SP1;RO90;FT3,100,45;PU400,200;PD800,200;PU;IN;");
    assert_eq!(turned, [[[-5.0, 10.0], [-5.0, 20.0]]]);
    let notes = job("IN;SP1;RO90;PD9,9;WG9,0,90;").warnings;
    let notes: Vec<_> = notes.iter().map(ToString::to_string).collect();
    assert_eq!(notes, ["the plot is turned by RO", "fills are left out"]);
}
