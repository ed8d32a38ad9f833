//! Hostile robots, designs, linkages, mechanisms and paths, in TOML and JSON.

use crate::{Input, Kind, counted};

const ROBOT: &str = include_str!("../../robots/benchtop.toml");
const DESIGN: &str = include_str!("../../designs/plotter.toml");
const PATH: &str = include_str!("../../paths/square.json");

/// A text that begins a file.
type Text = (&'static str, fn() -> String);

const TOML: [Text; 11] = [
    ("deep arrays", || nested("a = ", "[", "]", 400_000)),
    ("deep tables", || nested("a = ", "{b = ", "}", 150_000)),
    ("parts of a key", || nested("a", ".a", "", 400_000)),
    ("parts of a table's name", || {
        nested("[a", ".a", "", 400_000)
    }),
    ("entries of an array", || nested("a = [", "1,", "", 400_000)),
    ("digits", || nested("a = ", "1", "", 900_000)),
    ("underlines", || nested("a = 1", "_1", "", 400_000)),
    ("a text without end", || {
        nested("a = \"\"\"", "x", "", 900_000)
    }),
    ("arms", || {
        nested("", "[[actuator]]\nmass = 1\n", "", 40_000)
    }),
    ("keys", || numbered("k# = 1\n")),
    ("tables", || numbered("[t#]\nk = 1\n")),
];

fn nested(before: &str, open: &str, close: &str, count: usize) -> String {
    let count = counted(count);
    format!("{before}{}1{}\n", open.repeat(count), close.repeat(count))
}

fn numbered(line: &str) -> String {
    let lines = (0..counted(60_000)).map(|n| line.replace('#', &n.to_string()));
    lines.collect()
}

pub(crate) fn kinds() -> Vec<Kind> {
    let mut kinds: Vec<Kind> = Vec::new();
    for (name, text) in TOML {
        let robot = move || Input::Robot(text() + ROBOT);
        kinds.push((format!("robot: {name}"), Box::new(robot)));
        let design = move || Input::Design(text() + DESIGN);
        kinds.push((format!("design: {name}"), Box::new(design)));
    }
    let linkage = || Input::Linkage(nested("a = ", "[", "]", 400_000));
    kinds.push(("linkage: deep arrays".into(), Box::new(linkage)));
    for (name, open, close) in [("arrays", "[", "]"), ("objects", "{\"a\":", "}")] {
        let text = move || nested("", open, close, 200_000);
        let path = move || Input::Path(text());
        kinds.push((format!("path: deep {name}"), Box::new(path)));
        let mechanisms = move || Input::Mechanisms(text());
        kinds.push((format!("mechanisms: deep {name}"), Box::new(mechanisms)));
    }
    let lines = || {
        let line = r#"{ "kind": "line", "from": [0.01, 0.13], "to": [0.01, 0.13] },"#;
        let head = "\"path\": [";
        let long = format!("{head}{}", line.repeat(counted(15_000)));
        Input::Path(PATH.replacen(head, &long, 1))
    };
    kinds.push(("path: lines".into(), Box::new(lines)));
    kinds
}
