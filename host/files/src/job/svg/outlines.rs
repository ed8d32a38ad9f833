//! The outlines of lines, which `usvg` calculates for the box around each of them, and which nothing here needs.
//!
//! It divides a curve until a parabola is within a quarter of a pixel of the outline. In f32, coordinates or widths
//! of more than some ten thousand pixels are rounded by as much, so that it divides without end: one curve 10^9 px wide
//! takes half a second. With the width [`WIDE`] the first comparison overflows, and no curve is divided.
//!
//! Two kinds of drawings need their own widths: markers are as large as the lines are wide, and a line of no width is not
//! seen. Their curves are counted before.

use super::texts::Fonts;
use super::unread;
use crate::budget::{Budget, OverBudget};
use crate::job::JobError;
use usvg::roxmltree::Document;
use usvg::tiny_skia_path::{PathSegment, Point};
use usvg::{Group, Node, Transform, Tree};

/// A width whose square overflows in f32 [px].
const WIDE: f64 = 1e26;
/// Markers are larger than this only in the drawing with lines of [`WIDE`].
const LARGER_THAN_ANY: f64 = 1e13;
/// Curves and widths up to this are rounded by a hundredth of a pixel in f32 [px].
const EXACT: f64 = 4.5e4;
/// Steps for a curve, measured in µs of a processor: some, and more for a longer one.
const SHORT: f64 = 5.0;
const BY_LENGTH: f64 = 4.0;

/// The drawing in the document, and how many lines are not in it because they have no width.
pub(super) fn tree(document: &Document<'_>, fonts: &Fonts) -> Result<(Tree, usize), JobError> {
    let parsed = |style: Option<String>| {
        let mut options = fonts.reading();
        options.style_sheet = style;
        Tree::from_xmltree(document, &options).map_err(|error| unread(&error))
    };
    let widths = Widths::of(document);
    let wide = parsed(Some(format!("*{{stroke-width:{WIDE:e}!important}}")))?;
    if !widths.are_needed {
        return Ok((wide, 0));
    }
    let mut steps = Steps {
        widest: widths.widest,
        budget: Budget::outlines(),
    };
    steps.take(wide.root()).map_err(super::too_large)?;
    let tree = parsed(None)?;
    let left_out = seen(wide.root()).saturating_sub(seen(tree.root()));
    Ok((tree, left_out))
}

/// How many paths of a group are seen.
fn seen(group: &Group) -> usize {
    let count = |node: &Node| match node {
        Node::Group(group) => seen(group),
        Node::Path(path) => usize::from(super::is_seen(path)),
        Node::Text(_) | Node::Image(_) => 0,
    };
    group.children().iter().map(count).sum()
}

/// The widths of lines that a document states.
struct Widths {
    /// The greatest one, or more [px].
    widest: f64,
    /// Whether there are markers or lines of no width.
    are_needed: bool,
}

impl Widths {
    fn of(document: &Document<'_>) -> Self {
        let mut widths = Self {
            widest: 1.0,
            are_needed: false,
        };
        for node in document.descendants() {
            if node.tag_name().name() == "style" {
                let texts = node.children().filter_map(|child| child.text());
                texts.for_each(|text| widths.styles(text));
            }
            for attribute in node.attributes() {
                match attribute.name() {
                    "style" => widths.styles(attribute.value()),
                    "stroke-width" => widths.width(attribute.value()),
                    "marker-start" | "marker-mid" | "marker-end" => {
                        widths.marker(attribute.value());
                    }
                    _ => {}
                }
            }
        }
        widths
    }

    /// The declarations of a style, or of a style sheet.
    fn styles(&mut self, text: &str) {
        for declaration in text.split(['{', '}', ';']) {
            let Some((name, value)) = declaration.split_once(':') else {
                continue;
            };
            // Comments may stand before a name.
            let name = name.trim();
            if name.ends_with("stroke-width") {
                self.width(value);
            } else if name
                .rsplit(['/', ' ', '\n'])
                .next()
                .is_some_and(|it| it.starts_with("marker"))
            {
                self.marker(value);
            }
        }
    }

    fn marker(&mut self, value: &str) {
        let value = value.split('!').next().unwrap_or_default();
        self.are_needed |= value.trim() != "none";
    }

    fn width(&mut self, value: &str) {
        let value = value.trim();
        let is_of_number = |c: char| c.is_ascii_digit() || "+-.eE".contains(c);
        let end = value.find(|c| !is_of_number(c)).unwrap_or(value.len());
        // The e of `em` belongs to the unit.
        let number = value[..end].trim_end_matches(['e', 'E']);
        let unit = value[number.len()..].split('!').next().unwrap_or_default();
        let pixels = match unit.trim() {
            "" | "px" => 1.0,
            "pt" | "pc" | "mm" | "cm" | "in" => 96.0,
            _ if value.starts_with("inherit") => return,
            // Of a font, or of the page.
            _ => {
                self.are_needed = true;
                EXACT
            }
        };
        let width = number.parse::<f32>().map_or(f64::INFINITY, f64::from);
        self.are_needed |= width <= 0.0;
        self.widest = self.widest.max(pixels * width);
    }
}

/// The steps along the outlines of a drawing.
struct Steps {
    /// The greatest width [px].
    widest: f64,
    budget: Budget,
}

impl Steps {
    /// Takes those of a group, which was read with lines of [`WIDE`].
    fn take(&mut self, group: &Group) -> Result<(), OverBudget> {
        for node in group.children() {
            let mut result = match node {
                Node::Group(group) => self.take(group),
                Node::Path(path) => self.path(path),
                Node::Text(text) => self.take(text.flattened()),
                Node::Image(_) => Ok(()),
            };
            node.subroots(|root| {
                if result.is_ok() {
                    result = self.take(root);
                }
            });
            result?;
        }
        Ok(())
    }

    fn path(&mut self, path: &usvg::Path) -> Result<(), OverBudget> {
        let turned = path.abs_transform().has_skew();
        let growth = if turned {
            self.growth(path.abs_transform())
        } else {
            1.0
        };
        let mut from = Point::zero();
        for segment in path.data().segments() {
            let points = match segment {
                PathSegment::MoveTo(to) | PathSegment::LineTo(to) => {
                    from = to;
                    continue;
                }
                PathSegment::QuadTo(a, to) => [a, to, to],
                PathSegment::CubicTo(a, b, to) => [a, b, to],
                PathSegment::Close => continue,
            };
            let greatest = |a: f32, b: f32| f64::from(a.abs().max(b.abs()));
            let far = points.map(|it| greatest(it.x, it.y));
            let far = far.into_iter().fold(greatest(from.x, from.y), f64::max);
            let long = points.map(|it| greatest(it.x - from.x, it.y - from.y));
            let long = long.into_iter().fold(0.0, f64::max);
            let steps = match growth.max(1.0) * far + self.widest {
                exact if exact <= EXACT => SHORT + BY_LENGTH * (growth.max(1.0) * long).sqrt(),
                // It can be half a second.
                _ => f64::INFINITY,
            };
            // A path that is turned has two boxes.
            let boxes = if turned { 2.0 } else { 1.0 };
            self.budget.take_calculated(boxes * steps)?;
            from = points[2];
        }
        Ok(())
    }

    /// The greatest factor by which a length grows with the lines' own widths, or more.
    fn growth(&self, by: Transform) -> f64 {
        let [a, b, c, d] = [by.sx, by.ky, by.kx, by.sy].map(f64::from);
        let wide = a.hypot(b).hypot(c.hypot(d));
        if wide > LARGER_THAN_ANY {
            wide / WIDE * self.widest
        } else {
            wide
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Fonts, Widths, tree};
    use usvg::roxmltree::Document;
    use usvg::{Group, Node, Tree};

    fn page(content: &str) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"80\" height=\"60\">{content}</svg>"
        )
    }

    /// All paths of a group: where they lie, and whether they have a line.
    fn paths(group: &Group) -> Vec<String> {
        let of = |node: &Node| match node {
            Node::Group(group) => paths(group),
            Node::Path(path) => {
                let line = path.stroke().map(|it| match it.paint() {
                    usvg::Paint::Color(colour) => format!("{colour:?} {:?}", it.opacity()),
                    _ => "not a colour".into(),
                });
                let text = format!("{:?} {:?} {line:?}", path.data(), path.abs_transform());
                vec![text]
            }
            Node::Text(text) => paths(text.flattened()),
            Node::Image(_) => Vec::new(),
        };
        group.children().iter().flat_map(of).collect()
    }

    #[test]
    fn the_width_of_lines_changes_no_line() {
        for content in [
            "<path d='M0 0C1 9 5 9 9 0' stroke='red' stroke-width='3' fill='none'/>",
            "<g transform='rotate(30)' style='stroke:blue;stroke-width:2mm'><circle r='9'/></g>",
            "<text x='9' y='20' stroke='red' font-size='9'>a text</text>",
            "<pattern id='p' width='9' height='9'><path d='M0 0Q1 9 9 9' stroke='red'/></pattern>\
             <path d='M0 0H9V9' fill='url(#p)' stroke='url(#p)'/>",
            "<path d='M0 0L9 9' stroke='red' stroke-dasharray='1 2' opacity='0.5' filter='blur(1)'/>",
            "<mask id='m'><path d='M0 0L9 9' stroke='#fff'/></mask>\
             <path d='M0 0h9v9z' stroke='red' mask='url(#m)' transform='scale(1e3)'/>",
        ] {
            let text = page(content);
            let document = Document::parse(&text).expect("XML");
            assert!(!Widths::of(&document).are_needed, "{content}");
            let plain = Tree::from_xmltree(&document, &Fonts::new().reading()).expect("SVG");
            let (wide, _) = tree(&document, &Fonts::new()).expect("SVG");
            assert!(!paths(wide.root()).is_empty(), "{content}");
            assert_eq!(paths(wide.root()), paths(plain.root()), "{content}");
        }
    }

    #[test]
    fn markers_and_lines_of_no_width_keep_their_widths() {
        for content in [
            "<marker id='m'><path d='M0 0Q1 9 9 9'/></marker>\
             <path d='M0 0L9 5' stroke='red' marker-end='url(#m)' stroke-width='3'/>",
            "<marker id='m' orient='auto'><path d='M0 0Q1 9 9 9'/></marker>\
             <path d='M0 0L9 5' style='stroke:red; marker-end : url(#m)'/>",
            "<path d='M0 0L9 9' stroke='red' stroke-width='0'/><path d='M0 0L1 1' stroke='red'/>",
            "<path d='M0 0L9 9' stroke='red' style='fill:none;stroke-width:0px'/><path d='M0 0v9'/>",
            "<style>.a{stroke-width:1e-60}</style><g class='a'><path d='M0 0L9 9' fill='none' \
             stroke='red'/></g><path d='M0 0v9' stroke='red'/>",
        ] {
            let text = page(content);
            let document = Document::parse(&text).expect("XML");
            assert!(Widths::of(&document).are_needed, "{content}");
            let plain = Tree::from_xmltree(&document, &Fonts::new().reading()).expect("SVG");
            let (read, _) = tree(&document, &Fonts::new()).expect("SVG");
            assert_eq!(paths(read.root()), paths(plain.root()), "{content}");
        }
    }

    #[test]
    fn the_greatest_width_is_found() {
        for (content, least) in [
            ("<g/>", 1.0_f64),
            ("<g stroke-width='1e9'/>", 1e9),
            ("<g style='stroke-width:2in'/>", 192.0),
            ("<style>g{stroke-width : 3cm}</style>", 113.0),
            ("<g stroke-width='2em'/>", 9e4),
            ("<g stroke-width='&#49;e9'/>", 1e9),
            ("<g style='/**/stroke-width:1e9 !important'/>", 1e9),
        ] {
            let text = page(content);
            let widest = Widths::of(&Document::parse(&text).expect("XML")).widest;
            assert!(
                (least..2.0 * f64::max(least, 200.0)).contains(&widest),
                "{content}: {widest}"
            );
        }
    }

    #[test]
    fn curves_that_would_be_divided_without_end_are_refused_only_where_their_width_is_needed() {
        let marker = "<marker id='m'><path d='M0 0L9 9'/></marker>";
        let curve = "<path d='M0 0C1 9 5 9 9 0' stroke='red' fill='none' stroke-width='1e9'";
        let read = |content: &str| {
            let text = page(content);
            tree(&Document::parse(&text).expect("XML"), &Fonts::new())
                .map(|it| paths(it.0.root()).len())
        };
        assert_eq!(read(&format!("{curve}/>").repeat(1000)).expect("SVG"), 1000);
        let refused = read(&format!("{marker}{curve} marker-end='url(#m)'/>"));
        let sentence = refused.expect_err("too much").to_string();
        assert!(sentence.contains("outlines"), "{sentence}");
        let small = format!(
            "{marker}{}",
            "<path d='M0 0C1 9 5 9 9 0' stroke='red' marker-end='url(#m)'/>".repeat(9)
        );
        assert_eq!(read(&small).expect("SVG"), 18);
    }
}
