//! Reads the fields of a card into its struct, with one file for each family of cards.

mod connector;
mod constraint;
mod extent;
mod geometry;
mod ids;
mod line;
mod load;
mod mass;
mod material;
mod param;
mod pbeam;
mod property;
mod rigid;
mod section;
mod shell;
mod solid;
mod springs;
mod table;

pub(super) use geometry::connected_points;

use super::fields::Fields;
use crate::cards::Cards;
use crate::place::PlacedCard;

/// Adds the card to its list; returns false if no struct exists for the card.
///
/// `name` is in upper case and without `*`.
pub(super) fn read_card(f: &mut Fields, cards: &mut Cards) -> bool {
    extent::check(f);
    match f.name {
        b"GRID" => keep(&mut cards.grids, f, geometry::grid),
        b"GRDSET" => keep_one(&mut cards.grdset, f, geometry::grdset),
        b"CORD2R" | b"CORD2C" | b"CORD2S" => keep(&mut cards.coords, f, geometry::cord2),
        b"CORD1R" | b"CORD1C" | b"CORD1S" => {
            keep_several(&mut cards.coords, f, (2, 4), geometry::cord1)
        }
        b"SPOINT" => geometry::spoint(f, cards),
        b"CQUAD4" | b"CQUADR" | b"CQUAD8" | b"CTRIA3" | b"CTRIAR" | b"CTRIA6" => {
            keep(&mut cards.shells, f, shell::shell)
        }
        b"SNORM" => keep(&mut cards.snorms, f, shell::snorm),
        b"CSHEAR" => keep(&mut cards.shear_panels, f, shell::shear_panel),
        b"CBAR" => keep(&mut cards.bars, f, line::bar),
        b"CBEAM" => keep(&mut cards.beams, f, line::beam),
        b"BAROR" => keep_one(&mut cards.baror, f, line::bar_defaults),
        b"BEAMOR" => keep_one(&mut cards.beamor, f, line::bar_defaults),
        b"CROD" | b"CTUBE" => keep(&mut cards.rods, f, line::rod),
        b"CONROD" => keep(&mut cards.conrods, f, line::conrod),
        b"CBUSH" => keep(&mut cards.bushes, f, springs::bush),
        b"CELAS1" | b"CELAS2" => keep(&mut cards.springs, f, springs::spring),
        b"CELAS3" | b"CELAS4" => keep(&mut cards.springs, f, springs::scalar_spring),
        b"CWELD" => keep(&mut cards.welds, f, connector::weld),
        b"CFAST" => keep(&mut cards.fasteners, f, connector::fastener),
        b"CGAP" => keep(&mut cards.gaps, f, connector::gap),
        b"CTETRA" | b"CPENTA" | b"CHEXA" | b"CPYRAM" => keep(&mut cards.solids, f, solid::solid),
        b"CMASS1" | b"CMASS2" => keep(&mut cards.scalar_masses, f, mass::scalar_mass),
        b"CMASS3" | b"CMASS4" => keep(&mut cards.scalar_masses, f, mass::mass_of_points),
        b"PMASS" => keep_several(&mut cards.pmasses, f, (4, 2), mass::pmass),
        b"CONM1" => keep(&mut cards.conm1s, f, mass::conm1),
        b"CONM2" => keep(&mut cards.conm2s, f, mass::conm2),
        b"NSM" | b"NSM1" | b"NSML" | b"NSML1" => mass::nonstructural(f, cards),
        b"NSMADD" => keep(&mut cards.nsmadds, f, constraint::set_sum),
        b"RBE1" => keep(&mut cards.rbe1s, f, rigid::rbe1),
        b"RBE2" => keep(&mut cards.rbe2s, f, rigid::rbe2),
        b"RBE3" => keep(&mut cards.rbe3s, f, rigid::rbe3),
        b"RBAR" => keep(&mut cards.rbars, f, rigid::rbar),
        b"RBAR1" => keep(&mut cards.rbars, f, rigid::rbar1),
        b"RSPLINE" => keep(&mut cards.rsplines, f, rigid::rspline),
        b"RTRPLT" => keep(&mut cards.rbe1s, f, rigid::rtrplt),
        b"MPC" => keep(&mut cards.mpcs, f, constraint::mpc),
        b"MPCADD" => keep(&mut cards.mpcadds, f, constraint::set_sum),
        b"SPC" => keep(&mut cards.spcs, f, constraint::spc),
        b"SPCD" => keep(&mut cards.spcds, f, constraint::spc),
        b"SPC1" => constraint::spc1(f, cards),
        b"SPCADD" => keep(&mut cards.spcadds, f, constraint::set_sum),
        b"SUPORT" | b"SUPORT1" => keep(&mut cards.suports, f, constraint::suport),
        b"PSHELL" => keep(&mut cards.pshells, f, property::pshell),
        b"PCOMP" | b"PCOMPG" => keep(&mut cards.pcomps, f, property::pcomp),
        b"PSHEAR" => keep(&mut cards.pshears, f, property::pshear),
        b"PBAR" => keep(&mut cards.pbars, f, property::pbar),
        b"PBARL" => keep(&mut cards.pbarls, f, section::pbarl),
        b"PBEAM" => keep(&mut cards.pbeams, f, pbeam::pbeam),
        b"PBEAML" => keep(&mut cards.pbeamls, f, section::pbeaml),
        b"PROD" => keep(&mut cards.prods, f, property::prod),
        b"PTUBE" => keep(&mut cards.ptubes, f, property::ptube),
        b"PBUSH" => keep(&mut cards.pbushes, f, springs::pbush),
        b"PELAS" => keep_several(&mut cards.pelas, f, (2, 4), springs::pelas),
        b"PWELD" => keep(&mut cards.pwelds, f, connector::pweld),
        b"PFAST" => keep(&mut cards.pfasts, f, connector::pfast),
        b"PGAP" => keep(&mut cards.pgaps, f, connector::pgap),
        b"PSOLID" => keep(&mut cards.psolids, f, property::psolid),
        b"MAT1" => keep(&mut cards.mat1s, f, material::mat1),
        b"MAT2" => keep(&mut cards.mat2s, f, material::mat2),
        b"MAT8" => keep(&mut cards.mat8s, f, material::mat8),
        b"MAT9" => keep(&mut cards.mat9s, f, material::mat9),
        b"MATT1" => keep(&mut cards.matt1s, f, table::matt1),
        b"TABLEM1" | b"TABLEM2" | b"TABLEM3" | b"TABLEM4" => {
            keep(&mut cards.material_tables, f, table::material_table)
        }
        b"FORCE" => keep(&mut cards.forces, f, load::force),
        b"MOMENT" => keep(&mut cards.moments, f, load::force),
        b"FORCE1" | b"FORCE2" | b"MOMENT1" | b"MOMENT2" => {
            keep(&mut cards.forces_along, f, load::force_along)
        }
        b"SLOAD" => load::sload(f, cards),
        b"PLOAD" => keep(&mut cards.ploads, f, load::pload),
        b"PLOAD1" => keep(&mut cards.pload1s, f, load::pload1),
        b"PLOAD2" => load::pload2(f, cards),
        b"PLOAD4" => keep(&mut cards.pload4s, f, load::pload4),
        b"GRAV" => keep(&mut cards.gravs, f, load::grav),
        b"ACCEL" => keep(&mut cards.accels, f, load::accel),
        b"ACCEL1" => keep(&mut cards.accel1s, f, load::accel1),
        b"RFORCE" | b"RFORCE1" => keep(&mut cards.rforces, f, load::rforce),
        b"LOAD" => keep(&mut cards.loads, f, load::load),
        b"TEMP" => load::temp(f, cards),
        b"TEMPD" => load::tempd(f, cards),
        b"TEMPP1" => load::tempp1(f, cards),
        b"TEMPRB" => load::temprb(f, cards),
        b"PARAM" => keep(&mut cards.params, f, param::param),
        _ => return false,
    }
    true
}

fn keep<T>(list: &mut Vec<PlacedCard<T>>, f: &mut Fields, read: impl FnOnce(&mut Fields) -> T) {
    let card = read(f);
    if !f.unusable {
        list.push(PlacedCard { card, at: f.at });
    }
}

/// Adds the entries of a card that contains several, each in `width` fields. Entries with only blank fields are omitted, except the first.
fn keep_several<T>(
    list: &mut Vec<PlacedCard<T>>,
    f: &mut Fields,
    (most, width): (usize, usize),
    read: impl Fn(&mut Fields, usize) -> T,
) {
    for first in (0..most * width).step_by(width) {
        if first > 0 && (first..first + width).all(|i| f.is_blank(i)) {
            continue;
        }
        f.unusable = false;
        keep(list, f, |f| read(f, first));
    }
}

fn keep_one<T>(
    place: &mut Option<PlacedCard<T>>,
    f: &mut Fields,
    read: impl FnOnce(&mut Fields) -> T,
) {
    let card = read(f);
    if !f.unusable {
        *place = Some(PlacedCard { card, at: f.at });
    }
}
