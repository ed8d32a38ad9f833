//! The pens of an SVG: its layers as Inkscape has them, or else the colours of its lines.

use super::super::drawing::{Pen, Stroke};
use std::collections::{BTreeMap, BTreeSet};
use usvg::Paint;
use usvg::roxmltree::Document;

const INKSCAPE: &str = "http://www.inkscape.org/namespaces/inkscape";
/// The most colours that are pens; a picture with more is drawn with one.
const MOST_COLOURS: usize = 12;

/// What a stroke is drawn with, as the file has it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Ink {
    layer: Option<String>,
    /// None: a gradient or a pattern.
    colour: Option<[u8; 3]>,
    is_line: bool,
}

/// The strokes of each layer and colour.
pub(super) struct Pens {
    /// The names of layers, by the identifiers of their groups.
    names: BTreeMap<String, String>,
    layer: Option<String>,
    parts: Vec<(Ink, Vec<Stroke>)>,
    /// The numbers of the parts.
    part_of: BTreeMap<Ink, usize>,
}

impl Pens {
    pub(super) fn new(document: &Document<'_>) -> Self {
        let layers = document
            .descendants()
            .filter(|node| node.attribute((INKSCAPE, "groupmode")) == Some("layer"));
        let names = layers.filter_map(|layer| {
            let id = layer.attribute("id")?;
            let name = layer.attribute((INKSCAPE, "label")).unwrap_or(id);
            Some((id.to_owned(), name.to_owned()))
        });
        Self {
            names: names.collect(),
            layer: None,
            parts: Vec::new(),
            part_of: BTreeMap::new(),
        }
    }

    /// Enters a group; returns what [`Self::leave`] needs. A layer in another one belongs to it.
    pub(super) fn enter(&mut self, id: &str) -> Option<String> {
        let before = self.layer.clone();
        if self.layer.is_none() {
            self.layer = self.names.get(id).cloned();
        }
        before
    }

    pub(super) fn leave(&mut self, before: Option<String>) {
        self.layer = before;
    }

    /// Adds the strokes of a shape.
    pub(super) fn add(&mut self, path: &usvg::Path, strokes: Vec<Stroke>) {
        let line = path.stroke().filter(|it| it.opacity().get() > 0.0);
        let paint = line.map(usvg::Stroke::paint);
        let paint = paint.or_else(|| path.fill().map(usvg::Fill::paint));
        self.add_ink(paint, line.is_some(), strokes);
    }

    /// The number of what draws the lines that fill a shape, for [`Self::add_line`].
    pub(super) fn of_fill(&mut self, fill: &usvg::Fill) -> usize {
        self.add_ink(Some(fill.paint()), true, Vec::new())
    }

    /// Adds a line that fills a shape.
    pub(super) fn add_line(&mut self, number: usize, line: Stroke) {
        if let Some((_, lines)) = self.parts.get_mut(number) {
            lines.push(line);
        }
    }

    fn add_ink(&mut self, paint: Option<&Paint>, is_line: bool, strokes: Vec<Stroke>) -> usize {
        let ink = Ink {
            layer: self.layer.clone(),
            colour: match paint {
                Some(Paint::Color(colour)) => Some([colour.red, colour.green, colour.blue]),
                _ => None,
            },
            is_line,
        };
        if let Some(&same) = self.part_of.get(&ink) {
            self.parts[same].1.extend(strokes);
            return same;
        }
        self.part_of.insert(ink.clone(), self.parts.len());
        self.parts.push((ink, strokes));
        self.parts.len() - 1
    }

    /// The pens in the order of the file, and whether their colours are too many for pens.
    pub(super) fn into_pens(self) -> (Vec<Pen>, bool) {
        let layers = self.count(|ink| Some(&ink.layer));
        if layers > 1 {
            let name = |ink: &Ink| ink.layer.clone().unwrap_or_else(|| "no layer".into());
            return (self.by(name), false);
        }
        let lines = self.count(|ink| Some(ink.colour).filter(|_| ink.is_line));
        let colours = self.count(|ink| Some(ink.colour));
        if lines > 1 && colours <= MOST_COLOURS {
            let name = |ink: &Ink| match ink.colour {
                Some([red, green, blue]) => format!("#{red:02x}{green:02x}{blue:02x}"),
                None => "gradients and patterns".into(),
            };
            return (self.by(name), false);
        }
        (self.by(|_| String::new()), lines > MOST_COLOURS)
    }

    /// How many different values there are.
    fn count<'a, T: Ord>(&'a self, value: impl Fn(&'a Ink) -> Option<T>) -> usize {
        let values = self.parts.iter().filter_map(|(ink, _)| value(ink));
        values.collect::<BTreeSet<T>>().len()
    }

    fn by(self, name: impl Fn(&Ink) -> String) -> Vec<Pen> {
        let mut pens: Vec<Pen> = Vec::new();
        let mut pen_of: BTreeMap<String, usize> = BTreeMap::new();
        for (ink, strokes) in self.parts {
            let name = name(&ink);
            let pen = *pen_of.entry(name.clone()).or_insert(pens.len());
            match pens.get_mut(pen) {
                Some(pen) => pen.strokes.extend(strokes),
                None => pens.push(Pen { name, strokes }),
            }
        }
        pens
    }
}
