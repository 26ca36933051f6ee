//! Assigns record codes to cards.

use super::records::{Geometry, Record};
use super::{
    constraints, grids, lines, loads, masses, materials, properties, rigid, sections, shells,
    solids,
};
use crate::cards::{ShellShape, SolidShape};
use crate::op2::words::Words;

/// Adds the cards of one record of a geometry block.
pub(in crate::op2) fn read_record(table: &str, words: Words<'_>, out: &mut Geometry) {
    let (Some(a), Some(b), Some(third)) = (words.int(0), words.int(1), words.int(2)) else {
        return;
    };
    if words.len() <= 3 {
        return; // the closing record 65535, or a record without cards
    }
    let prefix = third
        .checked_div(10_000)
        .filter(|p| (1..10_000).contains(p))
        .and_then(|p| usize::try_from(p).ok());
    let stated = prefix.map(|p| (p / 10, p % 10 == 2));
    let record = Record {
        words: words.rest(3),
        table,
        stated,
    };
    // The code of some cards has a third number above 10 000. No card that is read here has such a code.
    let code = (
        a,
        b,
        if prefix.is_some() {
            third % 10_000
        } else {
            third
        },
    );
    if !(elements(code, record, out) || read_other_cards(code, record, out)) {
        out.add_unread_entries(code, record);
    }
}

fn elements(code: (i64, i64, i64), r: Record<'_>, g: &mut Geometry) -> bool {
    use ShellShape as Sh;
    use SolidShape as So;
    match code {
        (4501, 45, 1) => g.add_fixed_cards(r, "GRID", &[8], grids::grid, |c| &mut c.grids),
        (5551, 49, 105) => g.add_fixed_cards(r, "SPOINT", &[1], grids::spoint, |c| &mut c.spoints),
        (1701, 17, 6) => g.add_fixed_cards(r, "CORD1C", &[6], grids::cord1, |c| &mut c.coords),
        (1801, 18, 5) => g.add_fixed_cards(r, "CORD1R", &[6], grids::cord1, |c| &mut c.coords),
        (1901, 19, 7) => g.add_fixed_cards(r, "CORD1S", &[6], grids::cord1, |c| &mut c.coords),
        (2001, 20, 9) => g.add_fixed_cards(r, "CORD2C", &[13], grids::cord2, |c| &mut c.coords),
        (2101, 21, 8) => g.add_fixed_cards(r, "CORD2R", &[13], grids::cord2, |c| &mut c.coords),
        (2201, 22, 10) => g.add_fixed_cards(r, "CORD2S", &[13], grids::cord2, |c| &mut c.coords),

        (2958, 51, 177) => {
            g.add_fixed_cards(r, "CQUAD4", &[14, 15], shells::quad4(Sh::Quad4), |c| {
                &mut c.shells
            })
        }
        (8009, 80, 367) => {
            g.add_fixed_cards(r, "CQUADR", &[14, 15], shells::quad4(Sh::QuadR), |c| {
                &mut c.shells
            })
        }
        (5959, 59, 282) => {
            g.add_fixed_cards(r, "CTRIA3", &[13, 14], shells::tria3(Sh::Tria3), |c| {
                &mut c.shells
            })
        }
        (9200, 92, 385) => {
            g.add_fixed_cards(r, "CTRIAR", &[13, 14], shells::tria3(Sh::TriaR), |c| {
                &mut c.shells
            })
        }
        (4701, 47, 326) | (15901, 159, 9956) => {
            g.add_fixed_cards(r, "CQUAD8", &[17, 18, 16], shells::quad8, |c| &mut c.shells)
        }
        (4801, 48, 327) | (15801, 158, 9955) => {
            g.add_fixed_cards(r, "CTRIA6", &[14, 15, 13], shells::tria6, |c| &mut c.shells)
        }
        (3101, 31, 61) => g.add_fixed_cards(r, "CSHEAR", &[6], shells::shear_panel, |c| {
            &mut c.shear_panels
        }),

        (2408, 24, 180) => g.add_fixed_cards(r, "CBAR", &[16], lines::bar, |c| &mut c.bars),
        (5408, 54, 261) => g.add_fixed_cards(r, "CBEAM", &[18], lines::beam, |c| &mut c.beams),
        (3001, 30, 48) => {
            g.add_fixed_cards(r, "CROD", &[4], |f| lines::rod(f, false), |c| &mut c.rods)
        }
        (3701, 37, 49) => {
            g.add_fixed_cards(r, "CTUBE", &[4], |f| lines::rod(f, true), |c| &mut c.rods)
        }
        (1601, 16, 47) => g.add_fixed_cards(r, "CONROD", &[8], lines::conrod, |c| &mut c.conrods),
        (2608, 26, 60) => g.add_fixed_cards(r, "CBUSH", &[14], lines::bush, |c| &mut c.bushes),
        (601, 6, 73) => g.add_fixed_cards(r, "CELAS1", &[6], lines::celas1, |c| &mut c.springs),
        (701, 7, 74) => g.add_fixed_cards(r, "CELAS2", &[8], lines::celas2, |c| &mut c.springs),
        (801, 8, 75) => g.add_fixed_cards(r, "CELAS3", &[4], lines::celas3, |c| &mut c.springs),
        (901, 9, 76) => g.add_fixed_cards(r, "CELAS4", &[4], lines::celas4, |c| &mut c.springs),

        (5508, 55, 217) => g.add_fixed_cards(r, "CTETRA", &[12], solids::solid(So::Tetra), |c| {
            &mut c.solids
        }),
        (4108, 41, 280) => g.add_fixed_cards(r, "CPENTA", &[17], solids::solid(So::Penta), |c| {
            &mut c.solids
        }),
        (7308, 73, 253) => g.add_fixed_cards(r, "CHEXA", &[22], solids::solid(So::Hexa), |c| {
            &mut c.solids
        }),
        (17200, 172, 1000) => {
            g.add_fixed_cards(r, "CPYRAM", &[16], solids::solid(So::Pyram), |c| {
                &mut c.solids
            })
        }

        (1001, 10, 65) => {
            g.add_fixed_cards(r, "CMASS1", &[6], masses::cmass1, |c| &mut c.scalar_masses)
        }
        (1101, 11, 66) => {
            g.add_fixed_cards(r, "CMASS2", &[6], masses::cmass2, |c| &mut c.scalar_masses)
        }
        (1201, 12, 67) => {
            g.add_fixed_cards(r, "CMASS3", &[4], masses::cmass3, |c| &mut c.scalar_masses)
        }
        (1301, 13, 68) => {
            g.add_fixed_cards(r, "CMASS4", &[4], masses::cmass4, |c| &mut c.scalar_masses)
        }
        (1401, 14, 63) => g.add_fixed_cards(r, "CONM1", &[24], masses::conm1, |c| &mut c.conm1s),
        (1501, 15, 64) => g.add_fixed_cards(r, "CONM2", &[13], masses::conm2, |c| &mut c.conm2s),

        (6601, 66, 292) => g.add_fixed_cards(r, "RBAR", &[7, 8, 9], rigid::rbar, |c| &mut c.rbars),
        (6801, 68, 294) => g.add_varying_cards(r, "RBE1", rigid::rbe1(r), |c| &mut c.rbe1s),
        (6901, 69, 295) => g.add_varying_cards(r, "RBE2", rigid::rbe2(r), |c| &mut c.rbe2s),
        (7101, 71, 187) => g.add_varying_cards(r, "RBE3", rigid::rbe3(r), |c| &mut c.rbe3s),
        _ => return false,
    }
    true
}

fn read_other_cards(code: (i64, i64, i64), r: Record<'_>, g: &mut Geometry) -> bool {
    match code {
        (4901, 49, 17) => g.add_varying_cards(r, "MPC", rigid::mpc, |c| &mut c.mpcs),
        (4891, 60, 83) => {
            g.add_varying_cards(r, "MPCADD", constraints::set_sum, |c| &mut c.mpcadds)
        }
        (5501, 55, 16) => g.add_fixed_cards(r, "SPC", &[4, 5], constraints::spc, |c| &mut c.spcs),
        (5481, 58, 12) => g.add_varying_cards(r, "SPC1", constraints::spc1, |c| &mut c.spc1s),
        (5491, 59, 13) => {
            g.add_varying_cards(r, "SPCADD", constraints::set_sum, |c| &mut c.spcadds)
        }
        (5601, 56, 14) => {
            g.add_fixed_cards(r, "SUPORT", &[2], constraints::suport, |c| &mut c.suports)
        }
        (10100, 101, 472) => {
            g.add_varying_cards(r, "SUPORT1", constraints::suport1, |c| &mut c.suports)
        }

        (4201, 42, 18) => g.add_fixed_cards(r, "FORCE", &[7], loads::force, |c| &mut c.forces),
        (4801, 48, 19) => g.add_fixed_cards(r, "MOMENT", &[7], loads::force, |c| &mut c.moments),
        (5101, 51, 24) => g.add_fixed_cards(r, "PLOAD", &[6], loads::pload, |c| &mut c.ploads),
        (6909, 69, 198) => g.add_fixed_cards(r, "PLOAD1", &[8], loads::pload1, |c| &mut c.pload1s),
        (6802, 68, 199) => g.add_fixed_cards(r, "PLOAD2", &[3], loads::pload2, |c| &mut c.pload2s),
        (7209, 72, 299) => {
            g.add_fixed_cards(r, "PLOAD4", &[12, 16], loads::pload4, |c| &mut c.pload4s)
        }
        (4401, 44, 26) => g.add_fixed_cards(r, "GRAV", &[7, 6], loads::grav, |c| &mut c.gravs),
        (5509, 55, 190) => {
            g.add_fixed_cards(r, "RFORCE", &[10, 9, 8], loads::rforce, |c| &mut c.rforces)
        }
        (4551, 61, 84) => g.add_varying_cards(r, "LOAD", loads::load_sum, |c| &mut c.loads),
        (5701, 57, 27) => g.add_fixed_cards(r, "TEMP", &[3], loads::temp, |c| &mut c.temps),
        (5641, 65, 98) => g.add_fixed_cards(r, "TEMPD", &[2], loads::tempd, |c| &mut c.tempds),

        (2302, 23, 283) => {
            g.add_fixed_cards(r, "PSHELL", &[11], properties::pshell, |c| &mut c.pshells)
        }
        (2706, 27, 287) => g.add_varying_cards(r, "PCOMP", properties::pcomp, |c| &mut c.pcomps),
        (15006, 150, 604) => {
            g.add_varying_cards(r, "PCOMPG", properties::pcompg, |c| &mut c.pcomps)
        }
        (1002, 10, 42) => {
            g.add_fixed_cards(r, "PSHEAR", &[6], properties::pshear, |c| &mut c.pshears)
        }
        (52, 20, 181) => g.add_fixed_cards(r, "PBAR", &[19], sections::pbar, |c| &mut c.pbars),
        (9102, 91, 52) => g.add_varying_cards(r, "PBARL", sections::pbarl, |c| &mut c.pbarls),
        (5402, 54, 262) => {
            g.add_fixed_cards(r, "PBEAM", &[197], sections::pbeam, |c| &mut c.pbeams)
        }
        (9202, 92, 53) => g.add_varying_cards(r, "PBEAML", sections::pbeaml, |c| &mut c.pbeamls),
        (902, 9, 29) => g.add_fixed_cards(r, "PROD", &[6], properties::prod, |c| &mut c.prods),
        (1602, 16, 30) => {
            g.add_fixed_cards(r, "PTUBE", &[5, 6], properties::ptube, |c| &mut c.ptubes)
        }
        (1402, 14, 37) => {
            g.add_fixed_cards(r, "PBUSH", &[23, 24, 27, 18], properties::pbush, |c| {
                &mut c.pbushes
            })
        }
        (302, 3, 46) => g.add_fixed_cards(r, "PELAS", &[4], properties::pelas, |c| &mut c.pelas),
        (402, 4, 44) => g.add_fixed_cards(r, "PMASS", &[2], masses::pmass, |c| &mut c.pmasses),
        (2402, 24, 281) => {
            g.add_fixed_cards(r, "PSOLID", &[7], properties::psolid, |c| &mut c.psolids)
        }

        (103, 1, 77) => g.add_fixed_cards(r, "MAT1", &[12], materials::mat1, |c| &mut c.mat1s),
        (203, 2, 78) => g.add_fixed_cards(r, "MAT2", &[17, 23], materials::mat2, |c| &mut c.mat2s),
        (2503, 25, 288) => g.add_fixed_cards(r, "MAT8", &[19], materials::mat8, |c| &mut c.mat8s),
        (2603, 26, 300) => {
            g.add_fixed_cards(r, "MAT9", &[35, 56, 31], materials::mat9, |c| &mut c.mat9s)
        }
        _ => return false,
    }
    true
}
