//! `docs/verify/data/tables.csv` has every table that `cargo test` does not take as a whole, and a test that takes a part of
//! it.

use crate::safety_document::{all_sources, is_there};

const TABLES: &str = include_str!("../../../docs/verify/data/tables.csv");

#[test]
fn every_table_that_is_left_out_is_listed_with_the_test_of_a_row() {
    let texts = all_sources();
    let mut listed = Vec::new();
    for row in TABLES.lines().skip(1) {
        let mut cells = row.split(',').skip(1);
        let [Some(part), Some(whole)] = [cells.next(), cells.next()] else {
            panic!("{row} names no two tests");
        };
        for name in [part, whole] {
            assert!(is_there(&texts, name), "there is no test {name}");
        }
        listed.push(whole);
    }
    let begin = "\nfn whole_table";
    let there = texts.iter().flat_map(|text| text.split(begin).skip(1));
    for rest in there {
        let name = format!("whole_table{}", rest.split('(').next().unwrap_or_default());
        assert!(
            listed.contains(&name.as_str()),
            "docs/verify/data/tables.csv lacks {name}"
        );
    }
}
