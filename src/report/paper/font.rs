//! The font of figures: how wide words are, and the outlines of their letters.
//!
//! A part of DejaVu Sans that is in the program, so that figures are the same on every machine.

use std::sync::OnceLock;

use ttf_parser::{Face, GlyphId, OutlineBuilder};

const FONT: &[u8] = include_bytes!("../assets/DejaVuSans-subset.ttf");

fn face() -> &'static Face<'static> {
    static FACE: OnceLock<Face<'static>> = OnceLock::new();
    // The bytes are part of the program, and a test reads them.
    FACE.get_or_init(|| Face::parse(FONT, 0).expect("the font in the program"))
}

/// The letters of words with where each begins, for a font of height 1; the last number is how far marks
/// above a tall letter are raised.
fn letters(words: &str) -> impl Iterator<Item = (GlyphId, f64, f64)> {
    let em = f64::from(face().units_per_em());
    let mut before = None;
    words.chars().scan(0.0, move |place, letter| {
        let glyph = face().glyph_index(letter).unwrap_or(GlyphId(0));
        let here = *place;
        *place += f64::from(face().glyph_hor_advance(glyph).unwrap_or(0)) / em;
        let mark = ('\u{300}'..='\u{36f}').contains(&letter);
        let raised = before.filter(|_| mark).map_or(0.0, |before| over(before, glyph) / em);
        before = Some(glyph);
        Some((glyph, here, raised))
    })
}

/// How far a mark must be raised to be above a letter.
fn over(letter: GlyphId, mark: GlyphId) -> f64 {
    let extent = |glyph| face().glyph_bounding_box(glyph);
    let (Some(letter), Some(mark)) = (extent(letter), extent(mark)) else { return 0.0 };
    const GAP: f64 = 100.0;
    (f64::from(letter.y_max) + GAP - f64::from(mark.y_min)).max(0.0)
}

/// The width of words.
pub fn width(words: &str, size: f64) -> f64 {
    let em = f64::from(face().units_per_em());
    let last = letters(words).last();
    last.map_or(0.0, |(glyph, place, _)| {
        size * (place + f64::from(face().glyph_hor_advance(glyph).unwrap_or(0)) / em)
    })
}

/// Gives the outlines of words to a builder, in units of the font's height; x and y of each point come with
/// where the letter begins added, y upwards.
pub fn outline(words: &str, builder: &mut impl Pen) {
    let em = f64::from(face().units_per_em());
    for (glyph, place, raised) in letters(words) {
        let mut pen = Shifted { builder, place, raised, em };
        let _ = face().outline_glyph(glyph, &mut pen);
    }
}

/// Takes outlines.
pub trait Pen {
    /// Begins at a point.
    fn move_to(&mut self, to: [f64; 2]);
    /// A line to a point.
    fn line_to(&mut self, to: [f64; 2]);
    /// A parabola to a point.
    fn curve_to(&mut self, by: [f64; 2], to: [f64; 2]);
    /// Back to where it began.
    fn close(&mut self);
}

struct Shifted<'a, P> {
    builder: &'a mut P,
    place: f64,
    raised: f64,
    em: f64,
}

impl<P> Shifted<'_, P> {
    fn at(&self, x: f32, y: f32) -> [f64; 2] {
        [self.place + f64::from(x) / self.em, self.raised + f64::from(y) / self.em]
    }
}

impl<P: Pen> OutlineBuilder for Shifted<'_, P> {
    fn move_to(&mut self, x: f32, y: f32) {
        self.builder.move_to(self.at(x, y));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.builder.line_to(self.at(x, y));
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.builder.curve_to(self.at(x1, y1), self.at(x, y));
    }

    fn curve_to(&mut self, _: f32, _: f32, _: f32, _: f32, x: f32, y: f32) {
        // TrueType outlines have parabolas only.
        self.builder.line_to(self.at(x, y));
    }

    fn close(&mut self) {
        self.builder.close();
    }
}

#[cfg(test)]
mod tests {
    use super::{face, width};

    #[test]
    fn the_font_has_what_figures_write() {
        for letter in "aZ09.,:;()[]%éαβωπμΩΔµ·×−±≤≥≈∞°⁰¹²³⁴⁵⁶⁷⁸⁹⁻₁₂→…–".chars()
        {
            assert!(face().glyph_index(letter).is_some(), "{letter}");
        }
        // Advance widths of DejaVu Sans: 1303 of 2048 for a digit.
        assert!((width("00", 8.0) - 16.0 * 1303.0 / 2048.0).abs() < 1e-9);
        assert_eq!(width("", 8.0), 0.0);
    }
}
