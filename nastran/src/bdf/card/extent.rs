//! Fields that a card has; a value in another field is a fault.

use super::super::fault::DeckFaultKind;
use super::super::fields::{Fields, excerpt};

/// Fields of a card as bits: bit 0 is field 2, and bits 8 and above are the fields of continuations.
type Mask = u64;

/// Returns the first `n` fields.
const fn first_fields(n: u32) -> Mask {
    match n {
        64.. => Mask::MAX,
        n => (1 << n) - 1,
    }
}

/// Returns the fields from `from` up to the one before `to`.
const fn span(from: u32, to: u32) -> Mask {
    first_fields(to) & !first_fields(from)
}

/// Fields of each line of an MPC after the first: field 2 and field 9 are blank.
const MPC_LINES: Mask = 0x7e7e_7e7e_7e7e_7e7e;

/// Returns the fields of a card. Returns `None` for a card of any length, or if the fields depend on other fields.
///
/// # Reference
/// MSC Nastran 2022.4 and Simcenter Nastran quick reference guides, formats of bulk data entries.
fn fields_of(name: &[u8]) -> Option<Mask> {
    Some(match name {
        b"GRID" | b"CORD1R" | b"CORD1C" | b"CORD1S" | b"CONROD" | b"CELAS2" | b"CGAP"
        | b"PMASS" | b"PELAS" | b"PSOLID" | b"PLOAD1" | b"PLOAD2" | b"TEMPD" => first_fields(8),
        b"GRDSET" => 1 << 1 | span(5, 8),
        b"CORD2R" | b"CORD2C" | b"CORD2S" | b"PSHELL" | b"CFAST" | b"PGAP" | b"MATT1"
        | b"RFORCE" | b"RFORCE1" => first_fields(11),
        b"CQUAD4" | b"CQUADR" => first_fields(8) | span(9, 14),
        b"CTRIA3" | b"CTRIAR" => first_fields(7) | span(9, 13),
        b"CQUAD8" | b"CPENTA" => first_fields(17),
        b"CTRIA6" | b"PLOAD4" => first_fields(14),
        b"SNORM" | b"FORCE1" | b"MOMENT1" => first_fields(5),
        b"CSHEAR" | b"CELAS1" | b"CMASS1" | b"CMASS2" | b"RBAR1" | b"PSHEAR" | b"PROD"
        | b"PTUBE" | b"PLOAD" => first_fields(6),
        b"CBAR" => first_fields(16),
        b"CBEAM" => first_fields(18),
        b"BAROR" | b"BEAMOR" => 1 << 1 | span(4, 8),
        b"CROD" | b"CTUBE" | b"CELAS3" | b"CELAS4" | b"CMASS3" | b"CMASS4" => first_fields(4),
        b"CBUSH" => first_fields(13),
        b"CTETRA" | b"MAT1" => first_fields(12),
        b"CHEXA" => first_fields(22),
        b"CPYRAM" => first_fields(15),
        b"CONM1" => first_fields(24),
        b"CONM2" => first_fields(7) | span(8, 14),
        b"RBAR" => first_fields(9),
        b"RTRPLT" => first_fields(7) | span(8, 13),
        b"MPC" => 1 | MPC_LINES,
        b"SPC" | b"SPCD" | b"FORCE" | b"MOMENT" | b"FORCE2" | b"MOMENT2" | b"SLOAD" | b"GRAV"
        | b"TEMP" => first_fields(7),
        b"PBAR" => first_fields(7) | span(8, 19),
        b"PARAM" => first_fields(3),
        _ => return None,
    })
}

/// Adds a fault at the first value in a field that the card does not have.
#[inline]
pub(super) fn check(f: &mut Fields) {
    let Some(mask) = fields_of(f.name) else {
        return;
    };
    let last = f.len();
    // An MPC may have any number of lines.
    let is_field = |i: usize| match u32::try_from(i) {
        Ok(i @ ..64) => mask >> i & 1 == 1,
        _ => f.name == b"MPC" && MPC_LINES >> (i % 8) & 1 == 1,
    };
    if let Some(i) = (0..last).find(|&i| !f.is_blank(i) && !is_field(i)) {
        let found = excerpt(f.bytes_at(i));
        f.fault(i, "unused", DeckFaultKind::NoSuchField { found });
    }
}
