//! Joins the parts of a deck that were read apart.

use super::assemble::Part;
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
    let offset = to.deferred.len();
    to.deferred.extend(from.deferred);
    to.orphans.extend(from.orphans.into_iter().map(|mut o| {
        o.follows = o.follows.map(|i| i + offset);
        o
    }));
}

fn append_cards(to: &mut Cards, from: Cards) {
    let Cards {
        grids,
        grdset,
        spoints,
        coords,
        shells,
        shear_panels,
        bars,
        baror,
        beams,
        beamor,
        rods,
        conrods,
        bushes,
        springs,
        solids,
        conm1s,
        conm2s,
        rbe1s,
        rbe2s,
        rbe3s,
        rbars,
        mpcs,
        mpcadds,
        spcs,
        spcds,
        spc1s,
        spcadds,
        suports,
        pshells,
        pcomps,
        pshears,
        pbars,
        pbarls,
        pbeams,
        pbeamls,
        prods,
        ptubes,
        pbushes,
        pelas,
        psolids,
        mat1s,
        mat2s,
        mat8s,
        mat9s,
        forces,
        moments,
        forces_along,
        sloads,
        ploads,
        pload1s,
        pload2s,
        pload4s,
        gravs,
        rforces,
        loads,
        temps,
        tempds,
        tempp1s,
        temprbs,
        params,
    } = from;
    extend(&mut to.grids, grids);
    to.grdset = grdset.or(to.grdset.take());
    extend(&mut to.spoints, spoints);
    extend(&mut to.coords, coords);
    extend(&mut to.shells, shells);
    extend(&mut to.shear_panels, shear_panels);
    extend(&mut to.bars, bars);
    to.baror = baror.or(to.baror.take());
    extend(&mut to.beams, beams);
    to.beamor = beamor.or(to.beamor.take());
    extend(&mut to.rods, rods);
    extend(&mut to.conrods, conrods);
    extend(&mut to.bushes, bushes);
    extend(&mut to.springs, springs);
    extend(&mut to.solids, solids);
    extend(&mut to.conm1s, conm1s);
    extend(&mut to.conm2s, conm2s);
    extend(&mut to.rbe1s, rbe1s);
    extend(&mut to.rbe2s, rbe2s);
    extend(&mut to.rbe3s, rbe3s);
    extend(&mut to.rbars, rbars);
    extend(&mut to.mpcs, mpcs);
    extend(&mut to.mpcadds, mpcadds);
    extend(&mut to.spcs, spcs);
    extend(&mut to.spcds, spcds);
    extend(&mut to.spc1s, spc1s);
    extend(&mut to.spcadds, spcadds);
    extend(&mut to.suports, suports);
    extend(&mut to.pshells, pshells);
    extend(&mut to.pcomps, pcomps);
    extend(&mut to.pshears, pshears);
    extend(&mut to.pbars, pbars);
    extend(&mut to.pbarls, pbarls);
    extend(&mut to.pbeams, pbeams);
    extend(&mut to.pbeamls, pbeamls);
    extend(&mut to.prods, prods);
    extend(&mut to.ptubes, ptubes);
    extend(&mut to.pbushes, pbushes);
    extend(&mut to.pelas, pelas);
    extend(&mut to.psolids, psolids);
    extend(&mut to.mat1s, mat1s);
    extend(&mut to.mat2s, mat2s);
    extend(&mut to.mat8s, mat8s);
    extend(&mut to.mat9s, mat9s);
    extend(&mut to.forces, forces);
    extend(&mut to.moments, moments);
    extend(&mut to.forces_along, forces_along);
    extend(&mut to.sloads, sloads);
    extend(&mut to.ploads, ploads);
    extend(&mut to.pload1s, pload1s);
    extend(&mut to.pload2s, pload2s);
    extend(&mut to.pload4s, pload4s);
    extend(&mut to.gravs, gravs);
    extend(&mut to.rforces, rforces);
    extend(&mut to.loads, loads);
    extend(&mut to.temps, temps);
    extend(&mut to.tempds, tempds);
    extend(&mut to.tempp1s, tempp1s);
    extend(&mut to.temprbs, temprbs);
    extend(&mut to.params, params);
}

fn extend<T>(to: &mut Vec<T>, from: Vec<T>) {
    if to.is_empty() {
        *to = from;
    } else {
        to.extend(from);
    }
}
