//! DXF drawings: units, curves, layers, and what is left out.

use fivebar_files::job::{Job, JobError, Placement};

const AS_WRITTEN: Placement = Placement {
    origin: [0.0, 0.0],
    scale: 1.0,
    turn: 0.0,
    home: [0.05, 0.2],
};

/// A file in millimetres; groups are written as `code value`, divided by `|`.
fn dxf(unit: u32, entities: &str) -> String {
    let file = format!(
        "0 SECTION|2 HEADER|9 $ACADVER|1 AC1027|9 $INSUNITS|70 {unit}|0 ENDSEC|0 SECTION|2 TABLES|\
         0 TABLE|2 LAYER|0 LAYER|2 shown|70 0|62 7|0 LAYER|2 off|70 0|62 -7|0 LAYER|2 frozen|70 1|62 7|\
         0 ENDTAB|0 ENDSEC|0 SECTION|2 BLOCKS|0 BLOCK|8 0|2 diagonal|10 1|20 0|0 LINE|8 0|10 1|20 0|11 3|21 4|0 ENDBLK|\
         0 BLOCK|8 0|2 ring|10 0|20 0|0 CIRCLE|8 0|10 0|20 0|40 1|0 ENDBLK|\
         0 BLOCK|8 0|2 outer|10 0|20 0|0 INSERT|8 0|2 diagonal|10 5|20 0|0 ENDBLK|\
         0 BLOCK|8 0|2 loop|10 0|20 0|0 INSERT|8 0|2 loop|10 5|20 0|0 ENDBLK|\
         0 ENDSEC|0 SECTION|2 ENTITIES|{entities}|0 ENDSEC|0 EOF"
    );
    let groups = file.split('|').map(|group| {
        let (code, value) = group.split_once(' ').expect(group);
        format!("{code:>3}\r\n{value}\r\n")
    });
    groups.collect()
}

fn read(unit: u32, entities: &str) -> Result<Job, JobError> {
    Job::parse(&dxf(unit, entities), &AS_WRITTEN)
}

/// The strokes [mm].
fn strokes(entities: &str) -> Vec<Vec<[f64; 2]>> {
    let mut strokes: Vec<Vec<[f64; 2]>> = Vec::new();
    let job = read(4, entities).unwrap_or_else(|error| panic!("{error}"));
    for step in &job.steps {
        let point = step.action.end().unwrap().map(|metres| 1e3 * metres);
        match (strokes.last_mut(), step.draws()) {
            (Some(stroke), true) => stroke.push(point),
            _ => strokes.push(vec![point]),
        }
    }
    strokes
}

/// All points lie on a circle, and the ends where they should.
#[track_caller]
fn assert_arc(entities: &str, center: [f64; 2], radius: f64, ends: [[f64; 2]; 2], length: f64) {
    let found = strokes(entities);
    assert_eq!(found.len(), 1, "{found:?}");
    let far = |[x, y]: [f64; 2], [u, v]: [f64; 2]| (x - u).hypot(y - v);
    for &point in &found[0] {
        assert!((far(point, center) - radius).abs() < 1e-6, "{point:?}");
    }
    let [first, last] = [found[0][0], *found[0].last().unwrap()];
    let forward = far(first, ends[0]) + far(last, ends[1]);
    let backward = far(first, ends[1]) + far(last, ends[0]);
    assert!(forward.min(backward) < 1e-6, "{first:?} {last:?}");
    let drawn: f64 = found[0].windows(2).map(|pair| far(pair[0], pair[1])).sum();
    assert!((drawn - length).abs() < 0.05, "{drawn} mm");
}

#[test]
fn lines_and_polylines_have_true_size_in_the_units_of_the_file() {
    let line = "0 LINE|8 shown|10 1|20 2|30 9|11 3|21 2|31 9";
    assert_eq!(strokes(line)[0].len(), 2);
    let ends = |unit| {
        let job = read(unit, line).unwrap();
        job.steps.last().unwrap().action.end().unwrap()[0]
    };
    assert!((ends(4) - 3e-3).abs() < 1e-12 && (ends(1) - 0.0762).abs() < 1e-12);
    assert!((ends(0) - 3e-3).abs() < 1e-12);
    let note = read(0, line).unwrap().warnings[0].to_string();
    assert!(note.contains("$INSUNITS"), "{note}");
    assert!(
        read(7, line)
            .unwrap_err()
            .to_string()
            .contains("its unit is 7")
    );
    let closed = "0 LWPOLYLINE|8 0|90 3|70 1|10 0|20 0|10 4|20 0|10 4|20 3";
    assert_eq!(strokes(closed)[0].len(), 4);
    let old = "0 POLYLINE|8 0|66 1|70 0|0 VERTEX|8 0|10 1|20 1|0 VERTEX|8 0|10 5|20 5|70 16|\
               0 VERTEX|8 0|10 1|20 2|0 SEQEND|8 0";
    let found = strokes(old);
    assert_eq!(found.len(), 1);
    assert!(
        found[0].iter().all(|[x, _]| (x - 1.0).abs() < 1e-9),
        "{found:?}"
    );
}

#[test]
fn arcs_are_round_and_turn_as_they_should() {
    use std::f64::consts::PI;
    let quarter = "0 ARC|8 0|10 10|20 5|40 4|50 270|51 0";
    assert_arc(
        quarter,
        [10.0, 5.0],
        4.0,
        [[10.0, 1.0], [14.0, 5.0]],
        2.0 * PI,
    );
    let mirrored = "0 ARC|8 0|10 -10|20 5|40 4|50 180|51 270|210 0|220 0|230 -1";
    assert_arc(
        mirrored,
        [10.0, 5.0],
        4.0,
        [[10.0, 1.0], [14.0, 5.0]],
        2.0 * PI,
    );
    let circle = "0 CIRCLE|8 0|10 1|20 2|40 3";
    assert_arc(circle, [1.0, 2.0], 3.0, [[4.0, 2.0]; 2], 6.0 * PI);
    // The bulge is the tangent of a quarter of the angle: a semicircle to the right of its chord.
    let half = "0 LWPOLYLINE|8 0|90 2|70 0|10 2|20 0|42 1|10 8|20 0";
    assert_arc(half, [5.0, 0.0], 3.0, [[2.0, 0.0], [8.0, 0.0]], 3.0 * PI);
    assert!(strokes(half)[0][1..5].iter().all(|[_, y]| *y < 0.0));
    let flat = "0 LWPOLYLINE|8 0|90 2|70 0|10 0|20 0|42 -0.41421356237|10 3|20 3";
    assert_arc(flat, [3.0, 0.0], 3.0, [[0.0, 0.0], [3.0, 3.0]], 1.5 * PI);
    let ellipse = "0 ELLIPSE|8 0|10 5|20 5|11 0|21 2|40 0.5|41 0|42 1.57079632679";
    for [x, y] in strokes(ellipse)[0].iter() {
        let value = (x - 5.0).powi(2) + ((y - 5.0) / 2.0).powi(2);
        assert!(
            (value - 1.0).abs() < 1e-6 && *x < 5.0 + 1e-6 && *y > 5.0 - 1e-6,
            "{x} {y}"
        );
    }
}

#[test]
fn splines_follow_their_control_points_and_weights() {
    // A quarter of a circle is a rational curve of the second degree.
    let quarter = "0 SPLINE|8 0|70 12|71 2|72 6|73 3|40 0|40 0|40 0|40 1|40 1|40 1|\
                   41 1|41 0.70710678118654752|41 1|10 7|20 0|10 7|20 7|10 0|20 7";
    let length = 3.5 * std::f64::consts::PI;
    assert_arc(quarter, [0.0, 0.0], 7.0, [[7.0, 0.0], [0.0, 7.0]], length);
    // At its inner knot a uniform cubic curve is (P1 + 2 P2 + P3) / 4.
    let cubic = "0 SPLINE|8 0|71 3|40 0|40 0|40 0|40 0|40 1|40 2|40 2|40 2|40 2|\
                 10 0|20 0|10 2|20 4|10 4|20 -4|10 6|20 4|10 8|20 0";
    let found = strokes(cubic);
    assert!(
        found[0].iter().any(|[x, y]| (x - 4.0).hypot(*y) < 1e-9),
        "{found:?}"
    );
    let short = quarter.replacen("40 0|", "", 1);
    let refusal = read(4, &short).unwrap_err().to_string();
    assert!(refusal.contains("SPLINE in line 151"), "{refusal}");
}

#[test]
fn layers_are_pens_and_hidden_ones_are_not_drawn_and_the_rest_is_noted_with_its_count() {
    let line = |layer: &str, x: i32| format!("0 LINE|8 {layer}|10 {x}|20 0|11 {x}|21 5|");
    let file = [
        line("cut", 1),
        line("off", 2),
        line("frozen", 3),
        line("mark", 4),
        line("cut", 5),
        "0 INSERT|8 0|2 block|10 0|20 0|0 TEXT|8 0|1 hello|10 0|20 0|0 TEXT|8 0|1 you|10 0|20 0"
            .into(),
    ];
    let job = read(4, &file.concat()).unwrap();
    let stops: Vec<_> = job
        .stops
        .iter()
        .map(|it| it.name.as_deref().unwrap())
        .collect();
    assert_eq!(stops, ["mark"]);
    assert_eq!(job.steps.iter().filter(|step| step.draws()).count(), 3);
    let notes: Vec<_> = job.warnings.iter().map(ToString::to_string).collect();
    assert!(notes[0].starts_with("left out: INSERT"), "{notes:?}");
    assert!(
        notes[1].starts_with("left out: TEXT") && notes[1].ends_with("(2 times)"),
        "{notes:?}"
    );
}

#[test]
fn what_is_no_drawing_is_refused_with_its_line() {
    let refusal = |text: &str| Job::parse(text, &AS_WRITTEN).unwrap_err().to_string();
    for (text, what) in [
        (dxf(4, "0 LINE|8 0|10 1|20 2|11 3"), "it has no group 21"),
        (
            dxf(4, "0 LINE|8 0|10 x|20 2|11 3|21 4"),
            "group 10 is no number",
        ),
        (
            dxf(4, "0 CIRCLE|8 0|10 1|20 2|40 1e9"),
            "2000000 m long, out of reach of any arm",
        ),
        (dxf(4, "0 TEXT|8 0|1 hello"), "no visible lines"),
        ("0\nSECTION\nfive\nsix\n".into(), "line 3 is no group code"),
        ("0\nSECTION\n2\n".into(), "ends behind line 3"),
        ("AutoCAD Binary DXF\r\n\u{1a}\0".into(), "save it as an SVG"),
    ] {
        assert!(refusal(&text).contains(what), "{}", refusal(&text));
    }
}

#[test]
fn blocks_are_drawn_where_they_are_inserted() {
    // Twice as wide, turned by 90°, at (10, 20).
    let turned = strokes("0 INSERT|8 shown|2 diagonal|10 10|20 20|41 2|42 1|50 90");
    assert_eq!(turned.len(), 1);
    for (found, wanted) in turned[0].iter().zip([[10.0, 20.0], [6.0, 24.0]]) {
        assert!(
            (found[0] - wanted[0]).hypot(found[1] - wanted[1]) < 1e-9,
            "{turned:?}"
        );
    }
    // Two columns and three rows; one block in another.
    let copies = strokes("0 INSERT|8 0|2 diagonal|10 0|20 0|70 2|71 3|44 10|45 20");
    assert_eq!(copies.len(), 6);
    let nested = strokes("0 INSERT|8 0|2 outer|10 1|20 1|41 -1");
    let ends = [[-4.0, 1.0], [-6.0, 5.0]];
    for (found, wanted) in nested[0].iter().zip(ends) {
        assert!(
            (found[0] - wanted[0]).hypot(found[1] - wanted[1]) < 1e-9,
            "{nested:?}"
        );
    }
    // A circle with two scales is an ellipse; its lines are as near as the tolerance.
    let ellipse = strokes("0 INSERT|8 0|2 ring|10 0|20 0|41 30|42 10");
    let off = |[x, y]: &[f64; 2]| ((x / 30.0).hypot(y / 10.0) - 1.0).abs();
    assert!(ellipse[0].len() > 60 && ellipse[0].iter().all(|point| off(point) < 1e-9));
    // Entities on layer 0 take the layer of their INSERT.
    let hidden = read(4, "0 INSERT|8 off|2 diagonal|10 0|20 0");
    assert!(hidden.unwrap_err().to_string().contains("no visible lines"));
    let endless = read(4, "0 INSERT|8 0|2 loop|10 0|20 0")
        .unwrap_err()
        .to_string();
    assert!(
        endless.contains("its blocks contain themselves"),
        "{endless}"
    );
    let wide = read(4, "0 INSERT|8 0|2 ring|10 0|20 0|70 99999")
        .unwrap_err()
        .to_string();
    assert!(wide.contains("1000 columns"), "{wide}");
}

#[test]
fn a_drawing_in_national_coordinates_keeps_its_shape_far_away() {
    let text = dxf(
        6,
        "0 LINE|8 0|10 3438000.5|20 5400000.25|11 3438010.5|21 5400000.25",
    );
    let job = Job::parse(&text, &AS_WRITTEN).unwrap();
    let ends: Vec<_> = job
        .steps
        .iter()
        .filter_map(|step| step.action.end())
        .collect();
    assert_eq!(
        ends,
        [[3_438_000.5, 5_400_000.25], [3_438_010.5, 5_400_000.25]]
    );
}
