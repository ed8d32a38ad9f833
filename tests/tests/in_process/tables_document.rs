//! `docs/verify/tables.md` has every table that `cargo test` does not take as a whole, and a test that takes a part of it.

use crate::safety_document::{all_sources, is_there};

const DOCUMENT: &str = include_str!("../../../docs/verify/tables.md");

#[test]
fn every_table_that_is_left_out_is_listed_with_the_test_of_a_row() {
    let texts = all_sources();
    let rows: Vec<Vec<&str>> = DOCUMENT
        .lines()
        .filter(|line| line.starts_with("| ") && line.contains("| `whole_table"))
        .map(|line| line.split(" | ").collect())
        .collect();
    let mut listed = Vec::new();
    for row in &rows {
        let [_, _, part, _, whole] = row[..] else {
            panic!("{row:?} has other than five cells");
        };
        for name in [part, whole] {
            let name = name.trim_matches(['|', ' ', '`']);
            assert!(is_there(&texts, name), "there is no test {name}");
        }
        listed.push(whole.trim_matches(['|', ' ', '`']));
    }
    let begin = "\nfn whole_table";
    let there = texts.iter().flat_map(|text| text.split(begin).skip(1));
    for rest in there {
        let name = format!("whole_table{}", rest.split('(').next().unwrap_or_default());
        assert!(
            listed.contains(&name.as_str()),
            "docs/verify/tables.md lacks {name}"
        );
    }
}
