//! Files that ask for more than any job needs are refused in a sentence, and nothing of that size is made first.

use crate::placed::AS_WRITTEN;
use fivebar_files::job::{Job, JobError};

fn refused(text: &str) -> String {
    match Job::parse(text, &AS_WRITTEN) {
        Err(error) => error.to_string(),
        Ok(job) => panic!(
            "{} steps of {}",
            job.steps.len(),
            &text[..text.len().min(200)]
        ),
    }
}

/// A DXF of entities, and of blocks, whose groups are divided by `|`.
fn dxf(blocks: &str, entities: &str) -> String {
    let lines = |groups: &str| groups.replace([' ', '|'], "\n");
    let blocks = lines(blocks);
    let entities = lines(entities);
    format!(
        "0\nSECTION\n2\nBLOCKS\n{blocks}0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{entities}\n0\nENDSEC\n0\nEOF\n"
    )
}

#[test]
fn a_dxf_of_few_bytes_that_asks_for_gigabytes_of_points_is_refused() {
    let wide = "0 INSERT|2 a|10 0|20 0|41 1e300|42 1e300";
    let block = "0 BLOCK|2 a|0 CIRCLE|8 0|10 0|20 0|40 1|0 ENDBLK|";
    let many = "0 INSERT|2 a|10 0|20 0|70 1000|71 1000|44 1|45 1";
    let spline = "0 SPLINE|71 3|40 0|40 0|40 0|40 0|40 1|40 1|40 1|40 1|10 0|20 0|10 9e5|20 9e5|10 -9e5|20 9e5|10 9|20 9";
    for (blocks, entities) in [
        (
            "",
            "0 LWPOLYLINE|8 0|90 2|70 0|10 0|20 0|42 1e15|10 10|20 0".to_owned(),
        ),
        (block, wide.into()),
        (block, many.into()),
        ("", vec![spline; 200].join("|")),
    ] {
        let why = refused(&dxf(blocks, &entities));
        assert!(
            why.contains("more than 1000000 points are asked for: simplify"),
            "{why}"
        );
    }
}

#[test]
fn blocks_of_what_is_left_out_are_not_visited_without_end() {
    let mut blocks = String::from("0 BLOCK|2 b0|");
    blocks += &"0 TEXT|1 a|".repeat(1000);
    blocks += "0 ENDBLK|";
    for level in 1..8 {
        let inner = level - 1;
        blocks += &format!("0 BLOCK|2 b{level}|");
        blocks += &format!("0 INSERT|2 b{inner}|10 0|20 0|70 30|71 30|").repeat(3);
        blocks += "0 ENDBLK|";
    }
    let why = refused(&dxf(&blocks, "0 INSERT|2 b7|10 0|20 0"));
    assert!(why.contains("more than 1000000 points"), "{why}");
}

#[test]
fn numbers_of_thousands_of_digits_are_refused_and_none_is_compared_with_each_of_its_digits() {
    for number in ["1".repeat(40_000), format!("0.{}", "3".repeat(40_000))] {
        let why = refused(&format!("G0 X{number}\n"));
        assert!(why.contains("digits, more than 40: round it"), "{why}");
    }
    assert!(Job::parse("F100\nG1 X0.33333333333333333333 Y1", &AS_WRITTEN).is_ok());
}

#[test]
fn a_job_of_too_many_lines_is_refused() {
    let why = refused(&format!("G0 X1{}", "\n".repeat(1_000_001)));
    assert!(
        why.starts_with("line 1000001") && why.contains("more than 1000000 lines"),
        "{why}"
    );
}

#[test]
fn notes_of_very_many_kinds_become_one() {
    let codes: String = (1000..3000).map(|code| format!("M{code}\n")).collect();
    let job = Job::parse(&format!("G0 X1\n{codes}"), &AS_WRITTEN).unwrap();
    // With the note on the whole job, that no code moves the tool.
    assert_eq!(job.warnings.len(), 102);
    let others = job.warnings.iter().find(|note| note.count > 1).unwrap();
    assert_eq!(others.count, 1900);
    assert!(
        others.to_string().contains("more notes, of other kinds"),
        "{others}"
    );
}

#[test]
fn a_plot_is_refused_at_its_limit_and_arcs_with_the_pen_up_cost_nothing() {
    let circles = "PU0,0;CI39999999;".repeat(400);
    let why = refused(&format!("IN;SP1;{circles}"));
    assert!(why.contains("CI: more than 1000000 points"), "{why}");
    let travel = "AA0,0,360;".repeat(2000);
    let text = format!("IN;SP1;PU39999999,0;{travel}PU0,0;PD400,0;");
    let job = Job::parse(&text, &AS_WRITTEN).unwrap();
    assert_eq!(job.steps.len(), 2);
}

#[test]
fn markup_that_would_take_hours_to_parse_is_refused_before() {
    let page = |content: &str| format!("<svg xmlns=\"http://www.w3.org/2000/svg\">{content}</svg>");
    let attributes: String = (0..300).map(|n| format!(" a{n}=\"\"")).collect();
    let entity = "x".repeat(10_000);
    let references = "&a;".repeat(10_000);
    for (text, what) in [
        (
            page(&format!("<g{attributes}/>")),
            "300 attributes, more than 200",
        ),
        (page(&"<g/>".repeat(500_001)), "nodes limit"),
        (
            page(&format!("<path d=\"M0 0{}\"/>", "h1".repeat(4_000_001))),
            "more than 1000000 points",
        ),
        (
            page(&"<g a=\"\"/>".repeat(2_000_001)),
            "attributes, more than 2000000",
        ),
        (
            format!(
                "<!DOCTYPE svg [<!ENTITY a \"{entity}\">]>{}",
                page(&references)
            ),
            "entities too often",
        ),
    ] {
        let error = Job::parse(&text, &AS_WRITTEN).unwrap_err();
        assert!(matches!(error, JobError::Drawing(_)));
        assert!(
            error.to_string().contains(what),
            "`{what}` is missing in: {error}"
        );
    }
}
