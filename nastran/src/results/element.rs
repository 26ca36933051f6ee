//! Element types of result tables.

/// The element type number of an identification record (33 CQUAD4, 144 CQUAD4 with corners, 34 CBAR ...).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ElementType(pub u32);

impl ElementType {
    /// Returns the card name, with the usual suffix if one card has several types; `None` for an unknown number.
    pub fn name(self) -> Option<&'static str> {
        Some(match self.0 {
            1 => "CROD",
            2 => "CBEAM",
            3 => "CTUBE",
            4 => "CSHEAR",
            10 => "CONROD",
            11 => "CELAS1",
            12 => "CELAS2",
            13 => "CELAS3",
            14 => "CELAS4",
            33 => "CQUAD4",
            34 => "CBAR",
            39 => "CTETRA",
            64 => "CQUAD8",
            67 => "CHEXA",
            68 => "CPENTA",
            70 => "CTRIAR",
            74 => "CTRIA3",
            75 => "CTRIA6",
            82 => "CQUADR",
            95 => "CQUAD4-composite",
            96 => "CQUAD8-composite",
            97 => "CTRIA3-composite",
            98 => "CTRIA6-composite",
            100 => "CBAR-stations",
            102 => "CBUSH",
            126 => "CFAST",
            144 => "CQUAD4-corner",
            227 => "CTRIAR-centre",
            228 => "CQUADR-centre",
            232 => "CQUADR-composite",
            233 => "CTRIAR-composite",
            255 => "CPYRAM",
            _ => return None,
        })
    }
}
