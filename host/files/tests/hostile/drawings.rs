//! Hostile drawings in DXF and plots in HPGL.

use crate::{Kind, counted, kind};

/// A DXF of entities, and of blocks, whose groups are divided by `|`.
pub(crate) fn file(blocks: &str, entities: &str) -> String {
    let lines = |groups: &str| groups.replace([' ', '|'], "\n");
    format!(
        "0\nSECTION\n2\nBLOCKS\n{}0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{}\n0\nENDSEC\n0\nEOF\n",
        lines(blocks),
        lines(entities.trim_end_matches('|'))
    )
}

#[expect(clippy::too_many_lines, reason = "a list of files")]
pub(crate) fn dxf() -> Vec<Kind> {
    let mut kinds: Vec<Kind> = Vec::new();
    for bulge in ["1e15", "1e300", "-1e15", "1e-300", "nan", "inf", "1e999"] {
        let entity = format!("0 LWPOLYLINE|8 0|70 1|10 0|20 0|42 {bulge}|10 10|20 0");
        kinds.push(kind(format!("dxf: a bulge of {bulge}"), move || {
            file("", &entity)
        }));
    }
    let block = "0 BLOCK|2 a|0 CIRCLE|8 0|10 0|20 0|40 1|0 ENDBLK|";
    let itself = "0 BLOCK|2 a|0 INSERT|2 a|10 0|20 0|70 9|0 ENDBLK|";
    for (name, blocks, entities) in [
        (
            "a block of 10^300",
            block,
            "0 INSERT|2 a|10 0|20 0|41 1e300|42 1e300",
        ),
        (
            "a block of 10^10",
            block,
            "0 INSERT|2 a|10 0|20 0|41 1e10|42 1e10",
        ),
        (
            "a million copies",
            block,
            "0 INSERT|2 a|10 0|20 0|70 1000|71 1000",
        ),
        ("10^9 columns", block, "0 INSERT|2 a|10 0|20 0|70 1e9"),
        ("a block in itself", itself, "0 INSERT|2 a|10 0|20 0"),
        ("a circle of 10^300", "", "0 CIRCLE|8 0|10 0|20 0|40 1e300"),
        (
            "an arc of 10^300 turns",
            "",
            "0 ARC|8 0|10 0|20 0|40 9e5|50 0|51 1e300",
        ),
        (
            "an ellipse of a kilometre",
            "",
            "0 ELLIPSE|10 0|20 0|11 9e5|21 0|40 1|41 0|42 1e300",
        ),
    ] {
        kinds.push(kind(format!("dxf: {name}"), move || file(blocks, entities)));
    }
    let spline = "0 SPLINE|71 3|40 0|40 0|40 0|40 0|40 1|40 1|40 1|40 1|10 0|20 0|10 9e5|20 9e5|10 -9e5|20 9e5|10 9|20 9|";
    for (name, part, count) in [
        ("splines", spline, 200),
        (
            "circles of a kilometre",
            "0 CIRCLE|8 0|10 0|20 0|40 9e5|",
            2000,
        ),
        ("layers", "0 LINE|8 #|10 0|20 0|11 #|21 1|", 50_000),
        ("kinds of entities", "0 X#|8 0|", 100_000),
        (
            "blocks that are missing",
            "0 INSERT|2 b#|10 0|20 0|",
            50_000,
        ),
        ("groups", "1 a|", 900_000),
        (
            "vertices",
            "0 POLYLINE|8 0|0 VERTEX|10 0|20 0|0 VERTEX|10 #|20 1|",
            30_000,
        ),
    ] {
        let text = move || {
            let parts: String = (0..counted(count))
                .map(|n| part.replace('#', &n.to_string()))
                .collect();
            file("", &format!("{parts}0 LINE|8 0|10 0|20 0|11 9|21 9"))
        };
        kinds.push(kind(format!("dxf: {name}"), text));
    }
    let nested = || {
        let mut blocks = format!("0 BLOCK|2 b0|{}0 ENDBLK|", "0 TEXT|1 a|".repeat(1000));
        for level in 1..12 {
            let insert = format!("0 INSERT|2 b{}|10 0|20 0|70 30|71 30|", level - 1);
            blocks += &format!("0 BLOCK|2 b{level}|{}0 ENDBLK|", insert.repeat(3));
        }
        file(&blocks, "0 INSERT|2 b11|10 0|20 0")
    };
    kinds.push(kind("dxf: texts in blocks in blocks", nested));
    // Blocks within each other, each drawn ten times by the next: 10^9 lines.
    kinds.push(kind("dxf: lines in blocks in blocks", || {
        let mut blocks = "0 BLOCK|2 b0|0 LINE|8 0|10 0|20 0|11 9|21 9|0 ENDBLK|".to_owned();
        for level in 1..10 {
            let insert = format!("0 INSERT|2 b{}|10 0|20 0|", level - 1).repeat(10);
            blocks += &format!("0 BLOCK|2 b{level}|{insert}0 ENDBLK|");
        }
        file(&blocks, "0 INSERT|2 b9|10 0|20 0")
    }));
    for (name, many, columns) in [
        ("a million copies of nothing", 0, 1000),
        ("a million copies of a hatch", 1, 1000),
        ("copies of many texts", 20_000, 40),
    ] {
        kinds.push(kind(format!("dxf: {name}"), move || {
            let entities = "0 HATCH|8 0|".repeat(counted(many) * many.min(1));
            let insert = format!("0 INSERT|2 b|10 0|20 0|70 {columns}|71 {columns}|44 1|45 1|");
            file(
                &format!("0 BLOCK|2 b|{entities}0 ENDBLK|"),
                &insert.repeat(4),
            )
        }));
    }
    for (name, degree, points) in [
        ("a spline of degree 99", 99, 200),
        ("a spline of degree 300", 300, 9),
        ("a spline of many knots", 3, 100_000),
        ("a spline of high degree and many knots", 9, 60_000),
    ] {
        kinds.push(kind(format!("dxf: {name}"), move || {
            let points = counted(points).max(degree + 1);
            let knots = (0..points + degree + 1).map(|n| format!("40 {n}|"));
            let knots: String = knots.collect();
            let places = (0..points).map(|n| format!("10 {}|20 {}|", n % 7, 9e4 * (n % 2) as f64));
            let places: String = places.collect();
            file(
                "",
                &format!("0 SPLINE|71 {degree}|{knots}{places}0 LINE|8 0|10 0|20 0|11 9|21 9"),
            )
        }));
    }
    for (name, part, count) in [
        ("bulges on a polyline", "10 #|20 9|42 1e4|", 100_000),
        ("wide bulges on a polyline", "10 #|20 9|42 -1e-8|", 100_000),
        (
            "boundaries of a hatch",
            "91 1|92 1|93 1|72 1|10 0|20 0|11 9|21 9|97 0|",
            100_000,
        ),
        ("texts of a table", "1 text|", 400_000),
    ] {
        kinds.push(kind(format!("dxf: {name}"), move || {
            let kind = if name.contains("polyline") {
                "LWPOLYLINE"
            } else {
                "HATCH"
            };
            let parts = (0..counted(count)).map(|n| part.replace('#', &n.to_string()));
            let parts: String = parts.collect();
            file(
                "",
                &format!("0 {kind}|8 0|{parts}0 LINE|8 0|10 0|20 0|11 9|21 9"),
            )
        }));
    }
    kinds
}

pub(crate) fn hpgl() -> Vec<Kind> {
    let mut kinds: Vec<Kind> = Vec::new();
    for (name, part, count) in [
        ("circles of a kilometre", "PU0,0;CI39999999;", 1000),
        ("arcs with the pen up", "PU39999999,0;AA0,0,360;", 50_000),
        ("arcs through points on a line", "PD;AT1,1,2,2;", 50_000),
        (
            "arcs through points almost on a line",
            "PU0,0;PD;AT500,1,1000,0;",
            30_000,
        ),
        ("curves", "PD;BZ39999999,0,0,39999999,9,9;", 1000),
        ("encoded lines without end", "PE<=?", 100_000),
        ("labels without end", "LBa", 100_000),
        (
            "units of nothing",
            "IP0,0,1,1;SC0,1e30,0,1e30;PD9,9;",
            10_000,
        ),
        ("turns", "RO90;RO0;PD9,9;", 50_000),
        ("pens", "SP1;PD9,9;SP2;PD0,9;", 30_000),
        ("escapes", "\u{1B}.", 200_000),
        ("wedges", "EW39999999,0,360;", 1000),
        ("rectangles", "EA9,9;", 100_000),
        ("digits", "1", 400_000),
        ("commas", ",", 400_000),
        ("numbers of nothing", "PDinf,nan;", 50_000),
        (
            "arcs of a tiny chord",
            "PU1000,0;PD;AA0,0,360,0.0001;",
            20_000,
        ),
        (
            "arcs of 10^9 turns",
            "PU1000,0;PD;AA0,0,1000000000000;",
            20_000,
        ),
        (
            "wedges of a tiny chord",
            "EW9000,0,360,0.000000001;",
            20_000,
        ),
        ("letters", "LBa\u{3};", 200_000),
        ("a label of a megabyte", "a", 1_000_000),
        ("changes of units", "IP0,0,9,9;SC0,9,0,9;PD9,9;SC;", 50_000),
        ("polygons", "PM0;PD9,9;PM1;PD0,9;PM2;EP;", 50_000),
    ] {
        let label = if name.starts_with("a label") {
            "LB"
        } else {
            ""
        };
        let text = move || format!("IN;SP1;PD0,0;{label}{}", part.repeat(counted(count)));
        kinds.push(kind(format!("hpgl: {name}"), text));
    }
    kinds
}
