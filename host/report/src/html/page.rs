//! The page of a report: text, tables and pictures, one below the other.

use super::uplot::{UPLOT_SCRIPT, UPLOT_STYLE};
use super::{Animation, Chart};
use quick_xml::escape::escape;
use serde_json::Value;
use std::fmt::Write as _;

/// A report under construction.
#[derive(Clone, Debug)]
pub struct Page {
    title: String,
    body: String,
    animated: bool,
    charted: bool,
}

impl Page {
    /// A page that has only a title.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            body: String::new(),
            animated: false,
            charted: false,
        }
    }

    /// Adds the heading of a section.
    pub fn heading(&mut self, text: &str) -> &mut Self {
        self.push(&format!("<h2>{}</h2>\n", escape(text)))
    }

    /// Adds a paragraph.
    pub fn paragraph(&mut self, text: &str) -> &mut Self {
        self.push(&format!("<p>{}</p>\n", escape(text)))
    }

    /// Adds a paragraph about a failure, in red.
    pub fn failure(&mut self, text: &str) -> &mut Self {
        self.push(&format!("<p class=\"failure\">{}</p>\n", escape(text)))
    }

    /// Adds a row of the most important figures, each with its name: ("RMS tip error", "42 µm").
    pub fn key_figures(&mut self, figures: &[(&str, String)]) -> &mut Self {
        self.push("<dl class=\"key\">\n");
        for (name, value) in figures {
            self.push(&format!(
                "<div><dt>{}</dt><dd>{}</dd></div>\n",
                escape(*name),
                escape(value)
            ));
        }
        self.push("</dl>\n")
    }

    /// Adds a table. A column is right-aligned if all of its cells start with a number.
    pub fn table(&mut self, header: &[&str], rows: &[Vec<String>]) -> &mut Self {
        let numeric: Vec<bool> = (0..header.len())
            .map(|column| {
                let mut cells = rows.iter().filter_map(|row| row.get(column)).peekable();
                cells.peek().is_some() && cells.all(|cell| starts_like_a_number(cell))
            })
            .collect();
        let class = |column: usize| match numeric.get(column) {
            Some(true) => " class=\"number\"",
            _ => "",
        };
        let mut html = String::from("<div class=\"scroll\" tabindex=\"0\"><table>\n<thead><tr>");
        for (column, cell) in header.iter().enumerate() {
            let (class, text) = (class(column), escape(*cell));
            let _ = write!(html, "<th scope=\"col\"{class}>{text}</th>");
        }
        html.push_str("</tr></thead>\n<tbody>\n");
        for row in rows {
            html.push_str("<tr>");
            for (column, cell) in row.iter().enumerate() {
                let (class, text) = (class(column), escape(cell));
                let _ = write!(html, "<td{class}>{text}</td>");
            }
            html.push_str("</tr>\n");
        }
        html.push_str("</tbody></table></div>\n");
        self.push(&html)
    }

    /// Adds a chart.
    pub fn chart(&mut self, chart: &Chart) -> &mut Self {
        self.charted = true;
        self.push(&chart.to_html())
    }

    /// Adds an SVG with a caption. The SVG is inserted unchanged: it must be well formed and its
    /// text escaped.
    pub fn figure(&mut self, svg: &str, caption: &str) -> &mut Self {
        self.push(&format!(
            "<figure>{svg}<figcaption>{}</figcaption></figure>\n",
            escape(caption)
        ))
    }

    /// Adds an animation of a mechanism.
    pub fn animation(&mut self, animation: &Animation) -> &mut Self {
        self.animated = true;
        self.push(&animation.to_html())
    }

    /// The whole page as one HTML file.
    pub fn render(&self) -> String {
        let title = escape(&self.title);
        let mut style = include_str!("style.css").to_owned();
        let mut scripts = String::new();
        let mut script = |text: &str| scripts += &format!("<script>\n{text}</script>\n");
        if self.charted {
            style.insert_str(0, UPLOT_STYLE);
            script(UPLOT_SCRIPT);
            script(include_str!("charts.js"));
        }
        if self.animated {
            script(include_str!("animation.js"));
        }
        if !scripts.is_empty() {
            scripts += "<noscript>The charts and the animation need JavaScript.</noscript>\n";
        }
        let body = &self.body;
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>{title}</title>\n<style>\n{style}</style>\n</head>\n<body>\n<main>\n\
             <h1>{title}</h1>\n{body}</main>\n{scripts}</body>\n</html>\n"
        )
    }

    fn push(&mut self, html: &str) -> &mut Self {
        self.body.push_str(html);
        self
    }
}

/// An element with data for a script.
pub(super) fn json_element(data: &Value) -> String {
    // A "<" must not occur in a script element. In JSON it occurs in strings only, where it
    // can be escaped.
    let data = data.to_string().replace('<', "\\u003c");
    format!("<script type=\"application/json\">{data}</script>")
}

fn starts_like_a_number(cell: &str) -> bool {
    let unsigned = cell.trim_start_matches(['-', '−', '+', '<', '≤', '≥', '±', ' ']);
    unsigned.starts_with(|c: char| c.is_ascii_digit()) || matches!(cell, "" | "–" | "—")
}

#[cfg(test)]
mod tests {
    use super::Page;
    use crate::html::{AnimatedBody, AnimatedTrace, Animation, Chart};

    #[test]
    fn all_texts_are_escaped() {
        let evil = "<script>alert('\"&')</script>";
        let mut animation = Animation::new(evil, "m", vec![0.0, 1.0]);
        animation.fixed.push((evil.into(), vec![[0.0, 0.0]]));
        animation.bodies.push(AnimatedBody {
            name: evil.into(),
            frames: vec![vec![[0.0, 0.0]], vec![[1.0, 0.0]]],
        });
        animation.traces.push(AnimatedTrace {
            name: evil.into(),
            times: vec![0.0],
            points: vec![[0.0, 0.0]],
        });
        let html = Page::new(evil)
            .heading(evil)
            .paragraph(evil)
            .failure(evil)
            .key_figures(&[(evil, evil.into())])
            .table(&[evil], &[vec![evil.into()]])
            .chart(&Chart::new(evil, evil, evil).line(evil, vec![[0.0, 0.0], [1.0, 1.0]]))
            .figure("<svg/>", evil)
            .animation(&animation)
            .render();
        // Data for a script end at the first "<", which none may have within.
        let (mut text, mut data) = (String::new(), String::new());
        for (index, part) in html.split("<script type=\"application/json\">").enumerate() {
            let (json, rest) = if index == 0 {
                ("", part)
            } else {
                part.split_once("</script>").unwrap()
            };
            data += json;
            text += rest;
        }
        assert!(!text.contains("alert('") && !data.contains('<'));
        assert!(data.contains("\\u003cscript>alert('"));
        assert!(!html.contains("<script>alert"));
        assert!(html.contains("&lt;script&gt;alert(&apos;&quot;&amp;&apos;)"));
    }

    #[test]
    fn a_page_references_no_other_file() {
        let chart = Chart::new("t", "x", "y").line("s", vec![[0.0, 0.0], [1.0, 1.0]]);
        let animation = Animation::new("a", "m", vec![0.0]);
        let html = Page::new("p").chart(&chart).animation(&animation).render();
        // The library names its home in a comment.
        let html = html.replace("https://github.com/leeoniya/uPlot", "");
        for reference in ["http:", "https:", "src=", "href=", "url(", "@import"] {
            assert!(!html.contains(reference), "{reference}");
        }
    }

    #[test]
    fn numbers_are_right_aligned_and_words_left_aligned() {
        let rows = [
            vec!["peak".into(), "−3 N".into()],
            vec!["rms".into(), "≤ 1 N".into()],
        ];
        let html = Page::new("p").table(&["what", "value"], &rows).render();
        assert!(html.contains("<td>peak</td><td class=\"number\">−3 N</td>"));
    }
}
