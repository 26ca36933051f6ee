//! The fonts of the pages, and text that they can show.

use crate::report::drawing::picture::shorten_to;
use std::sync::OnceLock;
use typst::foundations::Bytes;
use typst::text::Font;

/// Families used: text, and hashes and lines of one width.
const FAMILIES: [&str; 2] = ["Libertinus Serif", "DejaVu Sans Mono"];

/// Returns both font families in the styles that the crate `typst-assets` has.
pub(super) fn fonts() -> &'static [Font] {
    static FONTS: OnceLock<Vec<Font>> = OnceLock::new();
    FONTS.get_or_init(|| {
        typst_assets::fonts()
            .flat_map(|data| Font::iter(Bytes::new(data)))
            .filter(|f| FAMILIES.contains(&f.info().family.as_str()))
            .collect()
    })
}

/// Returns the text as it can be printed. A character is written as its number, `[U+4E2D]`, if it has no font, is invisible, or reverses the reading
/// direction. A signed document must not contain empty boxes.
pub(super) fn make_printable(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_control() {
            out.push(' ');
        } else if is_shown(c) {
            out.push(c);
        } else {
            out.push_str(&format!("[U+{:04X}]", u32::from(c)));
        }
    }
    out
}

fn is_shown(c: char) -> bool {
    let hidden = matches!(u32::from(c), 0xAD | 0x200B..=0x200F | 0x2028..=0x202E | 0x2060..=0x206F | 0xFE00..=0xFE0F | 0xFEFF);
    c.is_ascii() || !hidden && fonts().iter().any(|f| f.info().coverage.contains(c.into()))
}

/// Returns printable text in which words longer than `longest` characters may be broken.
pub(super) fn make_breakable(text: &str, longest: usize) -> String {
    let text = make_printable(text);
    let mut out = String::with_capacity(text.len());
    for word in text.split_inclusive(char::is_whitespace) {
        let long = word.chars().count() > longest;
        for (i, c) in word.chars().enumerate() {
            if long && i > 0 && i % 8 == 0 {
                out.push('\u{200b}');
            }
            out.push(c);
        }
    }
    out
}

/// Returns at most `most` characters of printable text. A mark shows an omitted end.
pub(super) fn short_printable(text: &str, most: usize) -> String {
    shorten_to(&make_printable(text), most)
}
