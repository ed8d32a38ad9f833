//! The glyphs of the Hershey simplex sans, as strokes of a pen.
//!
//! A line of the font's file is a glyph, from the blank (U+0020) on: a number, the number of pairs of letters, and the pairs. A
//! letter is a coordinate: its distance from R. The first pair is the left and the right edge; ` R` lifts the pen. Letters with
//! accents are put together from the letters and the marks of the font.

/// The font, with one glyph of our own.
const FONT: &str = include_str!("futural.jhf");
/// ß, which the font lacks.
const SHARP_S: &str = "12345 18IZM[MJNGPFRFTGUIULTNROTPVRWUWWVYTZR[";

/// The height of capital letters [font units].
pub(super) const CAPITAL: f64 = 21.0;
/// The top of small letters above the base line [font units].
const SMALL: f64 = 14.0;
/// The base line, downwards from R [font units].
const BASE: f64 = 9.0;
/// The distance of a mark from its letter [font units].
const GAP: f64 = 2.5;

/// Strokes of a pen, x to the right and y up from the base line, from x = 0 to the next glyph [font units].
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Glyph {
    pub(crate) advance: f64,
    pub(crate) strokes: Vec<Vec<[f64; 2]>>,
}

/// How a mark lies on its letter.
#[derive(Clone, Copy, PartialEq)]
enum Mark {
    /// Above, as a glyph of the font at a scale, which can be negative to mirror it.
    Above(char, [f64; 2]),
    /// Two dots above.
    Dots,
    /// Below the base line.
    Below(char),
    /// From corner to corner.
    Across,
}

/// Marks, with the letters that have them and the letters below.
const COMPOSED: [(Mark, &str, &str); 9] = [
    (Mark::Dots, "ÄËÏÖÜŸäëïöüÿ", "AEIOUYaeiouy"),
    (Mark::Above('`', [1.0, 1.0]), "ÀÈÌÒÙàèìòù", "AEIOUaeiou"),
    (
        Mark::Above('`', [-1.0, 1.0]),
        "ÁÉÍÓÚÝáéíóúýĆćŃńŚśŹź",
        "AEIOUYaeiouyCcNnSsZz",
    ),
    (Mark::Above('^', [0.6, 0.6]), "ÂÊÎÔÛâêîôû", "AEIOUaeiou"),
    (
        Mark::Above('^', [0.6, -0.6]),
        "ČčĚěŇňŘřŠšŽž",
        "CcEeNnRrSsZz",
    ),
    (Mark::Above('~', [0.6, 0.6]), "ÃÑÕãñõ", "ANOano"),
    (Mark::Above('o', [0.4, 0.4]), "ÅåŮů°", "AaUu "),
    (Mark::Below(','), "ÇçŞş", "CcSs"),
    (Mark::Across, "Øø", "Oo"),
];

/// Characters that are drawn as another one.
const SAME: [(char, char); 10] = [
    ('\u{A0}', ' '),
    ('–', '-'),
    ('—', '-'),
    ('−', '-'),
    ('‘', '\''),
    ('’', '\''),
    ('“', '"'),
    ('”', '"'),
    ('„', '"'),
    ('×', 'x'),
];

/// Every character that has a glyph.
#[cfg(any(feature = "svg", test))]
pub(crate) fn characters() -> impl Iterator<Item = char> {
    let composed = COMPOSED.iter().flat_map(|(_, letters, _)| letters.chars());
    let same = SAME.iter().map(|&(of, _)| of);
    (' '..='~').chain(['ß']).chain(composed).chain(same)
}

/// The glyph of a character; none if there is none.
pub(crate) fn glyph(of: char) -> Option<Glyph> {
    match of {
        ' '..='~' => parsed(FONT.lines().nth(of as usize - ' ' as usize)?),
        'ß' => parsed(SHARP_S),
        _ => match SAME.iter().find(|&&(from, _)| from == of) {
            Some(&(_, to)) => glyph(to),
            None => composed(of),
        },
    }
}

fn parsed(line: &str) -> Option<Glyph> {
    let letters = line.as_bytes().get(8..)?;
    let mut pairs = letters.chunks_exact(2);
    let distance = |letter: u8| f64::from(letter) - f64::from(b'R');
    let [left, right] = *pairs.next()? else {
        return None;
    };
    let left = distance(left);
    let mut strokes = vec![Vec::new()];
    for pair in pairs {
        match (pair, strokes.last_mut()) {
            (b" R", _) => strokes.push(Vec::new()),
            (&[x, y], Some(stroke)) => stroke.push([distance(x) - left, BASE - distance(y)]),
            _ => return None,
        }
    }
    strokes.retain(|stroke: &Vec<_>| stroke.len() > 1);
    Some(Glyph {
        advance: distance(right) - left,
        strokes,
    })
}

fn composed(of: char) -> Option<Glyph> {
    let (mark, letter) = COMPOSED.iter().find_map(|&(mark, letters, below)| {
        let index = letters.chars().position(|letter| letter == of)?;
        Some((mark, below.chars().nth(index)?))
    })?;
    let mut glyph = glyph(letter)?;
    let is_above = !matches!(mark, Mark::Below(_) | Mark::Across);
    if letter == 'i' {
        // Its dot makes room.
        glyph
            .strokes
            .retain(|stroke| stroke.iter().any(|point| point[1] < SMALL));
    }
    if letter == ' ' {
        glyph.advance = CAPITAL / 2.0;
    }
    let top = if letter.is_lowercase() {
        SMALL
    } else {
        CAPITAL
    };
    let [low, high] = match bounds(&glyph.strokes) {
        Some(found) => found,
        // A degree sign has no letter below it.
        None => [[0.0, 0.0], [glyph.advance, CAPITAL - 9.0]],
    };
    let middle = 0.5 * (low[0] + high[0]);
    let top = if is_above && letter != ' ' {
        top
    } else {
        high[1]
    };
    let added = match mark {
        Mark::Dots => {
            let dot = placed('.', [1.0, 1.0], [middle - 4.0, top + GAP])?;
            [dot, placed('.', [1.0, 1.0], [middle + 4.0, top + GAP])?].concat()
        }
        Mark::Above(mark, scale) => placed(mark, scale, [middle, top + GAP])?,
        Mark::Below(mark) => placed(mark, [1.0, 1.0], [middle, -6.0])?,
        Mark::Across => vec![vec![low, high]],
    };
    glyph.strokes.extend(added);
    Some(glyph)
}

/// The strokes of a character, scaled, with the middle of their lower edge at a point.
fn placed(of: char, [sx, sy]: [f64; 2], at: [f64; 2]) -> Option<Vec<Vec<[f64; 2]>>> {
    let scaled = |[x, y]: [f64; 2]| [sx * x, sy * y];
    let mut strokes = glyph(of)?.strokes;
    for point in strokes.iter_mut().flatten() {
        *point = scaled(*point);
    }
    let [low, high] = bounds(&strokes)?;
    let shift = [at[0] - 0.5 * (low[0] + high[0]), at[1] - low[1]];
    for point in strokes.iter_mut().flatten() {
        *point = [point[0] + shift[0], point[1] + shift[1]];
    }
    Some(strokes)
}

/// The least and the greatest x and y; none if there are no points.
fn bounds(strokes: &[Vec<[f64; 2]>]) -> Option<[[f64; 2]; 2]> {
    let mut points = strokes.iter().flatten();
    let first = *points.next()?;
    Some(points.fold([first; 2], |[low, high], point| {
        [
            [low[0].min(point[0]), low[1].min(point[1])],
            [high[0].max(point[0]), high[1].max(point[1])],
        ]
    }))
}

#[cfg(test)]
mod tests {
    use super::{CAPITAL, FONT, bounds, characters, glyph};

    #[test]
    fn each_line_of_the_font_has_as_many_pairs_as_it_says() {
        assert!(FONT.lines().count() >= 95);
        for (line, of) in FONT.lines().zip(' '..='~') {
            let stated: usize = line[5..8].trim().parse().unwrap();
            assert_eq!(line.len(), 8 + 2 * stated, "{of}");
        }
    }

    #[test]
    fn every_glyph_is_as_high_and_as_wide_as_letters_are() {
        for of in characters() {
            let glyph = glyph(of).unwrap_or_else(|| panic!("{of} has no glyph"));
            assert!((4.0..=40.0).contains(&glyph.advance), "{of}");
            let Some([low, high]) = bounds(&glyph.strokes) else {
                assert!(of == ' ' || of == '\u{A0}', "{of} has no strokes");
                continue;
            };
            assert!(
                low[1] >= -12.0 && high[1] <= CAPITAL + 12.0,
                "{of}: {low:?} {high:?}"
            );
            assert!(low[0] >= -4.0 && high[0] <= glyph.advance + 4.0, "{of}");
        }
        let [low, high] = bounds(&glyph('H').unwrap().strokes).unwrap();
        assert_eq!([low[1], high[1]], [0.0, CAPITAL]);
    }

    #[test]
    fn a_letter_with_a_mark_is_the_letter_and_the_mark_apart_from_it() {
        for (of, letter) in [('Ü', 'U'), ('ü', 'u'), ('é', 'e'), ('Š', 'S'), ('Å', 'A')] {
            let (with, without) = (glyph(of).unwrap(), glyph(letter).unwrap());
            assert_eq!(with.advance, without.advance, "{of}");
            let (letter, mark) = with.strokes.split_at(without.strokes.len());
            assert_eq!(letter, without.strokes, "{of}");
            let [[_, top], [_, low]] = [bounds(letter).unwrap()[1], bounds(mark).unwrap()[0]];
            assert!(low > top, "{of}: the mark touches the letter");
        }
        let dots = |of| glyph(of).unwrap().strokes.len();
        assert_eq!(dots('ï'), dots('i') + 1, "the dot of i makes room for two");
        assert!(glyph('ж').is_none() && glyph('漢').is_none());
    }
}
