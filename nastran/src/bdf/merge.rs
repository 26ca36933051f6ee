//! Joins the parts of a deck that were read separately.

use super::part::Part;
use crate::cards::Cards;

/// Appends `from` to `to`.
pub(super) fn append(to: &mut Part, from: Part) {
    append_cards(&mut to.cards, from.cards);
    for (name, n) in from.counts {
        match to.counts.iter_mut().find(|(have, _)| *have == name) {
            Some((_, total)) => *total += n,
            None => to.counts.push((name, n)),
        }
    }
    to.others.extend(from.others);
    for fault in from.faults {
        super::fields::note_fault(&mut to.faults, fault);
    }
    to.notes.extend(from.notes);
    to.labels.extend(from.labels);
    to.loose.extend(from.loose);
    to.deferred.extend(from.deferred);
    to.orphans.extend(from.orphans);
}

/// Joins the fields of two [`Cards`]. Of a field in `one` the later value counts; the lists of a field in `many` are concatenated. A field that is
/// not listed does not compile.
macro_rules! join_cards {
    ($to:ident, $from:ident, one: $($one:ident)*, many: $($many:ident)*) => {
        let Cards { $($one,)* $($many,)* } = $from;
        $($to.$one = $one.or($to.$one.take());)*
        $(extend(&mut $to.$many, $many);)*
    };
}

fn append_cards(to: &mut Cards, from: Cards) {
    join_cards!(
        to,
        from,
        one: grdset baror beamor,
        many:
        grids spoints connected_points coords shells shear_panels snorms bars beams rods conrods bushes springs welds fasteners gaps solids
        conm1s conm2s scalar_masses pmasses nsms nsmadds rbe1s rbe2s rbe3s rbars rsplines mpcs mpcadds spcs spcds spc1s spcadds suports
        pshells pcomps pshears pbars pbarls pbeams pbeamls prods ptubes pbushes pelas pwelds pfasts pgaps psolids
        mat1s mat2s mat8s mat9s matt1s material_tables forces moments forces_along sloads ploads pload1s pload2s
        pload4s gravs rforces accels accel1s loads temps tempds tempp1s temprbs params unread
    );
}

fn extend<T>(to: &mut Vec<T>, from: Vec<T>) {
    if to.is_empty() {
        *to = from;
    } else {
        to.extend(from);
    }
}
