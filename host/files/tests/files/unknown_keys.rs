//! Keys that a path or a list of mechanisms has not, such as a mistyped one, are refused and not ignored.

use fivebar_files::mobility;
use fivebar_files::path_case::PathCase;
use serde_json::{Value, json};

/// A value with one more key in the object at `place`, a JSON pointer.
fn with_key(value: &Value, place: &str, key: &str) -> String {
    let mut changed = value.clone();
    changed.pointer_mut(place).unwrap()[key] = json!("stop");
    changed.to_string()
}

#[test]
fn a_key_that_a_path_has_not_is_refused_wherever_it_stands() {
    let path = json!({
        "working_mode": ["right", "left"],
        "limits": { "torque": [0.7, 0.7] },
        "path": [{ "kind": "line", "from": [0.01, 0.13], "to": [0.07, 0.13] }],
        // Results of reference cases.
        "optimal_time_s": 1.0,
        "cross_checks_s": {},
        "runs": [],
    });
    let read = |text: &str| PathCase::parse("path.json", text);
    assert!(read(&path.to_string()).is_ok());
    for (place, key) in [("", "cornres"), ("/limits", "sped"), ("/path/0", "fed")] {
        let why = read(&with_key(&path, place, key))
            .err()
            .unwrap()
            .to_string();
        assert!(why.contains(&format!("unknown field `{key}`")), "{why}");
    }
}

#[test]
fn a_key_that_a_list_of_mechanisms_has_not_is_refused_wherever_it_stands() {
    let twists = [[0.0, 0.0, 1.0, 0.0, 0.0, 0.0]];
    let list = json!({
        "convention": "of the twists",
        "parallel": [{ "name": "one", "limbs": [twists, twists], "source": "", "expected": {} }],
        "graph": [{
            "name": "two",
            "bodies": 2,
            "platform_body": 1,
            "joints": [{ "a": 0, "b": 1, "twists": twists }],
        }],
    });
    let read = |text: &str| mobility::parse("list.json", text);
    let read_well = read(&list.to_string()).map(|cases| cases.len());
    assert_eq!(read_well.map_err(|error| error.to_string()), Ok(2));
    for place in ["", "/parallel/0", "/graph/0", "/graph/0/joints/0"] {
        let why = read(&with_key(&list, place, "platfrom"));
        let why = why.err().unwrap().to_string();
        assert!(why.contains("unknown field `platfrom`"), "{place}: {why}");
    }
}
