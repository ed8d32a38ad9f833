//! The texts of an SVG: in the single strokes of the Hershey font, whatever font they name. Characters that it lacks are
//! outlines of DejaVu Sans.

use crate::lettering::{self, named, truetype_font};
use std::sync::Arc;
use usvg::fontdb::{Database, FaceInfo, ID, Source, Style, Weight};
use usvg::{Options, Text};

/// The two fonts. No other file is read.
pub(super) struct Fonts {
    faces: Arc<Database>,
    single: ID,
    outlined: Option<ID>,
}

impl Fonts {
    pub(super) fn new() -> Self {
        let mut faces = Database::new();
        let single = faces.push_face_info(FaceInfo {
            id: ID::dummy(),
            source: Source::Binary(Arc::new(truetype_font())),
            index: 0,
            families: Vec::new(),
            post_script_name: "Hershey".into(),
            style: Style::Normal,
            weight: Weight::NORMAL,
            stretch: Default::default(),
            monospaced: false,
        });
        let dejavu = Source::Binary(Arc::new(dejavu::sans::regular().to_vec()));
        let outlined = faces.load_font_source(dejavu).first().copied();
        Self {
            faces: Arc::new(faces),
            single,
            outlined,
        }
    }

    /// How a document is read with these fonts, and without pictures.
    pub(super) fn reading(&self) -> Options<'static> {
        let (single, outlined) = (self.single, self.outlined);
        let mut options = Options {
            fontdb: Arc::clone(&self.faces),
            ..Options::default()
        };
        options.font_resolver.select_font = Box::new(move |_, _| Some(single));
        options.font_resolver.select_fallback =
            Box::new(move |_, tried: &[ID], _| outlined.filter(|font| !tried.contains(font)));
        options.image_href_resolver = usvg::ImageHrefResolver {
            resolve_data: Box::new(|_, _: Arc<Vec<u8>>, _| None),
            resolve_string: Box::new(|_, _| None),
        };
        options
    }

    /// In which font a text is drawn, and what of it is not.
    pub(super) fn notes(&self, text: &Text) -> Vec<String> {
        let (mut is_single, mut outlined, mut missing) = (false, Vec::new(), Vec::new());
        let glyphs = text.layouted().iter().flat_map(|it| &it.positioned_glyphs);
        for glyph in glyphs {
            let first = glyph.text.chars().next();
            match glyph.id.0 {
                0 => missing.extend(first),
                _ if Some(glyph.font) == self.outlined => outlined.extend(first),
                _ => is_single = true,
            }
        }
        let mut notes = Vec::new();
        if is_single {
            notes.push("texts are drawn in single strokes of the Hershey font".into());
        }
        let names = |mut characters: Vec<char>| {
            characters.sort_unstable();
            characters.dedup();
            (!characters.is_empty()).then(|| named(&characters))
        };
        // The layout takes a line of text from the font that has all of it.
        outlined.retain(|&it| lettering::glyph(it).is_none());
        notes.extend(names(outlined).map(|it| {
            format!(
                "a text is drawn as outlines of DejaVu Sans, because the Hershey font lacks {it}"
            )
        }));
        notes.extend(names(missing).map(|it| {
            format!("left out of a text, because no font here has them: {it}; convert it to paths")
        }));
        notes
    }
}
