//! Edits of case control and of the executive section.

use super::super::case::CaseLine;
use super::super::deck::Deck;
use super::super::source::Position;
use super::edit::Edits;

impl Edits {
    /// Adds lines at the end of case control, after the last subcase.
    ///
    /// A deck of bulk data alone gets the sections `SOL 101`, `CEND`, these lines and `BEGIN BULK` in front, and ENDDATA.
    pub fn insert_case_end(&mut self, deck: &Deck, text: &str) {
        // The lines must precede a packet, which extends to the end of case control. Skipped lines that other statements follow are not such a
        // packet.
        let lines = deck.case_control.lines.iter().rev();
        let packet = lines.take_while(|l| l.in_packet).last();
        match packet.map(position).or(deck.bounds.bulk_line) {
            Some(p) => self.patch(p.source, p.offset, p.offset, text),
            None => self.add_sections(deck, text),
        }
    }

    /// Removes the case control statements for which `is_unwanted` returns true.
    pub fn remove_case_lines(&mut self, deck: &Deck, is_unwanted: impl Fn(&CaseLine) -> bool) {
        for line in deck.case_control.lines.iter().filter(|l| is_unwanted(l)) {
            self.patch(line.at.source.0 as usize, line.start, line.end, "");
        }
    }

    /// Removes all subcases with their statements; comments remain.
    pub fn remove_subcases(&mut self, deck: &Deck) {
        self.remove_case_lines(deck, |l| l.subcase.is_some() && !l.in_packet);
    }

    /// Replaces the deck's SOL statement by `SOL text`; a deck without SOL stays unchanged.
    pub fn replace_sol(&mut self, deck: &Deck, text: &str) {
        if let Some((p, end)) = deck.bounds.sol {
            self.patch(p.source, p.offset, end, &format!("SOL {text}"));
        }
    }

    fn add_sections(&mut self, deck: &Deck, text: &str) {
        let start = deck.sources.first().map_or(0, |s| {
            if s.bytes.starts_with(&[0xEF, 0xBB, 0xBF]) {
                3
            } else {
                0
            }
        });
        let gap = if text.is_empty() || text.ends_with('\n') {
            ""
        } else {
            "\n"
        };
        self.patch(
            0,
            start,
            start,
            &format!("SOL 101\nCEND\n{text}{gap}BEGIN BULK\n"),
        );
        if deck.bounds.enddata.is_none() {
            self.end_with_enddata(deck);
        }
    }
}

fn position(line: &CaseLine) -> Position {
    Position {
        source: line.at.source.0 as usize,
        offset: line.start,
    }
}
