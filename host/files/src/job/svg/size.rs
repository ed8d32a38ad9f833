//! The size of a drawing, before it is laid out.
//!
//! A short file can be a large drawing: a `use` draws its target once more, a marker is drawn at each
//! vertex. And the time for a line of text grows with the square of its length, because the layout counts
//! the characters before each one, and shapes the whole line for each of its pieces (`tspan`). So what is
//! too large is refused before.

use std::collections::HashMap;
use usvg::roxmltree::{Document, Node};

/// Most shapes, groups and texts, with those that are drawn by reference.
const MOST_ELEMENTS: u64 = 50_000;

/// Most characters of a line of text, and most of all lines, each character times the line's pieces.
const LONGEST_LINE: u64 = 2_000;
const MOST_SHAPED: u64 = 200_000;

/// Most characters of all texts, and most lines: each is laid out by itself.
const MOST_CHARACTERS: u64 = 20_000;
const MOST_LINES: u64 = 1_000;

/// Most rules of style sheets times elements: each rule is compared with each element.
const MOST_MATCHES: u64 = 1_000_000;

/// Deeper nesting is refused by the reader.
const DEEPEST: u32 = 1_024;

/// Bytes of a path for a vertex, at least.
const VERTEX: usize = 4;

/// What is drawn of these is counted.
const DRAWN: [&str; 13] = [
    "svg", "g", "a", "switch", "symbol", "use", "path", "rect", "circle", "ellipse", "line",
    "polyline", "polygon",
];

/// What is drawn only where it is referred to.
const REFERRED: [&str; 6] = ["defs", "symbol", "marker", "pattern", "clipPath", "mask"];

/// Why a drawing is too large: what it has, the limit, and the remedy.
pub(super) fn refusal(document: &Document<'_>) -> Option<String> {
    let size = Counter::new(document).document(document);
    let as_paths = "convert its texts to paths, or leave some out";
    let in_lines = "split it into lines, or convert it to paths";
    let limits = [
        (
            size.elements,
            MOST_ELEMENTS,
            "elements, with those drawn by reference",
            "simplify it, or draw its parts one by one",
        ),
        (
            size.longest,
            LONGEST_LINE,
            "characters in a line of text",
            in_lines,
        ),
        (
            size.shaped,
            MOST_SHAPED,
            "characters times pieces (tspan) in its lines of text",
            in_lines,
        ),
        (
            size.characters,
            MOST_CHARACTERS,
            "characters of text",
            as_paths,
        ),
        (size.lines, MOST_LINES, "lines of text", as_paths),
        (
            size.matches,
            MOST_MATCHES,
            "rules of style sheets times elements",
            "leave out the rules: only lines are drawn",
        ),
    ];
    let broken = limits.into_iter().find(|(count, most, ..)| count > most);
    broken.map(|(count, most, what, remedy)| {
        format!("the SVG has {count} {what}, more than {most}: {remedy}")
    })
}

/// What a node draws.
#[derive(Clone, Copy, Default)]
struct Size {
    elements: u64,
    lines: u64,
    characters: u64,
    /// Characters of the longest line.
    longest: u64,
    /// Characters times pieces of their line.
    shaped: u64,
    matches: u64,
}

impl Size {
    fn add(&mut self, other: Self, times: u64) {
        let sum = |own: u64, other: u64| own.saturating_add(other.saturating_mul(times));
        self.elements = sum(self.elements, other.elements);
        self.lines = sum(self.lines, other.lines);
        self.characters = sum(self.characters, other.characters);
        self.longest = self.longest.max(other.longest);
        self.shaped = sum(self.shaped, other.shaped);
    }
}

struct Counter<'d, 'i> {
    targets: HashMap<&'d str, Node<'d, 'i>>,
    /// The sizes of targets that are known; nothing while one is counted, so that a circle ends.
    sizes: HashMap<&'d str, Size>,
    /// Vertices of all paths, for a marker that is inherited.
    vertices: u64,
}

impl<'d, 'i> Counter<'d, 'i> {
    fn new(document: &'d Document<'i>) -> Self {
        let nodes = || document.descendants();
        Self {
            targets: nodes()
                .filter_map(|node| Some((node.attribute("id")?, node)))
                .collect(),
            sizes: HashMap::new(),
            vertices: nodes().map(vertices).sum(),
        }
    }

    fn document(&mut self, document: &'d Document<'i>) -> Size {
        let mut size = self.node(document.root_element(), 0);
        let elements = document.descendants().filter(Node::is_element).count() as u64;
        let sheets = document.descendants().filter(|node| is(*node, "style"));
        for text in sheets
            .flat_map(|sheet| sheet.children())
            .filter_map(|node| node.text())
        {
            size.matches += elements.saturating_mul(text.matches('{').count() as u64);
            // A rule may hold for each element.
            self.references("style", text, self.vertices + elements, &mut size, 0);
        }
        size
    }

    fn node(&mut self, node: Node<'d, 'i>, depth: u32) -> Size {
        let mut size = Size::default();
        if !node.is_element() || depth > DEEPEST {
            return size;
        }
        if is(node, "text") {
            text(node, &mut size);
        } else {
            size.elements = u64::from(DRAWN.contains(&node.tag_name().name()));
            for child in node.children() {
                if REFERRED.contains(&child.tag_name().name()) {
                    continue;
                }
                size.add(self.node(child, depth + 1), 1);
            }
        }
        let own = vertices(node);
        let vertices = if own > 0 { own } else { self.vertices };
        for attribute in node.attributes() {
            let value = attribute.value();
            if is(node, "use") && attribute.name() == "href" {
                let target = value.trim().strip_prefix('#');
                size.add(
                    target.map_or_else(Size::default, |id| self.target(id, depth)),
                    1,
                );
            }
            self.references(attribute.name(), value, vertices, &mut size, depth);
        }
        size
    }

    /// Adds what `url(#…)` in a value refers to. Markers are drawn at each vertex.
    fn references(
        &mut self,
        name: &str,
        value: &'d str,
        vertices: u64,
        size: &mut Size,
        depth: u32,
    ) {
        for reference in value.split("url(").skip(1) {
            let id = reference.split(')').next().unwrap_or_default();
            let id = id.trim().trim_matches(['"', '\'']).trim_start_matches('#');
            let is_marker = name.starts_with("marker") || value.contains("marker");
            let target = self.target(id, depth);
            size.add(target, if is_marker { vertices } else { 1 });
        }
    }

    fn target(&mut self, id: &'d str, depth: u32) -> Size {
        if let Some(size) = self.sizes.get(id) {
            return *size;
        }
        let Some(&node) = self.targets.get(id) else {
            return Size::default();
        };
        self.sizes.insert(id, Size::default());
        let size = self.node(node, depth + 1);
        self.sizes.insert(id, size);
        size
    }
}

fn is(node: Node<'_, '_>, name: &str) -> bool {
    node.tag_name().name() == name
}

/// The vertices of a shape, at most; 0 of other nodes.
fn vertices(node: Node<'_, '_>) -> u64 {
    let points = node.attribute("d").or_else(|| node.attribute("points"));
    points.map_or(0, |points| 1 + points.len() / VERTEX) as u64
}

/// The lines of a text: one begins where an x or a y is given.
fn text(node: Node<'_, '_>, size: &mut Size) {
    size.elements += 1;
    let mut line = [0_u64; 2];
    let mut end = |[characters, pieces]: [u64; 2]| {
        if characters > 0 {
            size.lines += 1;
            size.characters += characters;
            size.longest = size.longest.max(characters);
            size.shaped += characters * pieces;
        }
    };
    for part in node.descendants() {
        let begins = part.is_element() && (part.has_attribute("x") || part.has_attribute("y"));
        if begins {
            end(std::mem::take(&mut line));
        }
        if let Some(text) = part.text().filter(|_| part.is_text()) {
            let [characters, pieces] = &mut line;
            *characters += text.chars().count() as u64;
            *pieces += 1;
        }
    }
    end(line);
}
