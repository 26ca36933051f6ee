//! Loads and temperatures.

use super::fields::Fields;
use crate::cards::{
    Force, Grav, IdList, LoadSum, Pload, Pload1, Pload2, Pload4, Rforce, Temp, Tempd,
};

/// Reads FORCE, MOMENT: `sid g cid f n1 n2 n3`.
pub(super) fn force(f: &mut Fields<'_>) -> Option<Force> {
    Some(Force {
        sid: f.id()?,
        grid: f.id()?,
        cid: f.id_or_zero()?,
        scale: f.read_real()?,
        n: f.reals()?,
    })
}

/// Reads PLOAD: `sid p g1..g4`.
pub(super) fn pload(f: &mut Fields<'_>) -> Option<Pload> {
    let (sid, pressure) = (f.id()?, f.read_real()?);
    Some(Pload {
        sid,
        pressure,
        grids: [f.id()?, f.id()?, f.id()?, f.id_or_zero()?],
    })
}

/// Reads PLOAD1: `sid eid kind scale x1 p1 x2 p2`; kind and scale are numbers in the order of the card's description.
pub(super) fn pload1(f: &mut Fields<'_>) -> Option<Pload1> {
    const KINDS: [&[u8; 4]; 12] = [
        b"FX  ", b"FY  ", b"FZ  ", b"FXE ", b"FYE ", b"FZE ", b"MX  ", b"MY  ", b"MZ  ", b"MXE ",
        b"MYE ", b"MZE ",
    ];
    const SCALES: [&[u8; 4]; 4] = [b"LE  ", b"FR  ", b"LEPR", b"FRPR"];
    let pick = |i: i64, words: &[&[u8; 4]]| {
        words
            .get(usize::try_from(i).ok()?.checked_sub(1)?)
            .map(|w| **w)
    };
    let (sid, element) = (f.id()?, f.id()?);
    let (kind, scale) = (pick(f.int()?, &KINDS)?, pick(f.int()?, &SCALES)?);
    let [x1, p1, x2, p2] = f.reals()?;
    Some(Pload1 {
        sid,
        element,
        kind,
        scale,
        x1,
        p1,
        x2: Some(x2),
        p2: Some(p2),
    })
}

/// Reads PLOAD2: `sid p eid`.
pub(super) fn pload2(f: &mut Fields<'_>) -> Option<Pload2> {
    Some(Pload2 {
        sid: f.id()?,
        pressure: f.read_real()?,
        elements: IdList::Each(vec![f.id()?]),
    })
}

/// Reads PLOAD4: `sid eid p1..p4 g1 g34 cid n1 n2 n3`, 12 words; 16 with SORL and LDIR.
pub(super) fn pload4(f: &mut Fields<'_>) -> Option<Pload4> {
    let (sid, eid) = (f.id()?, f.id()?);
    let pressure = f.reals::<4>()?.map(Some);
    let face = [f.blank_or_id()?, f.blank_or_id()?];
    let cid = f.id_or_zero()?;
    let n: [f64; 3] = f.reals()?;
    let (sorl, ldir) = if f.words_left() > 0 {
        (f.text(2)?, f.text(2)?)
    } else {
        Default::default()
    };
    let word = |text: &str| text.chars().all(|c| c.is_ascii_alphabetic());
    (word(&sorl) && word(&ldir)).then_some(())?;
    let direction = (n != [0.0; 3]).then_some((cid, n));
    Some(Pload4 {
        sid,
        elements: IdList::Each(vec![eid]),
        pressure,
        face,
        direction,
        sorl,
        ldir,
    })
}

/// Reads GRAV: `sid cid a n1 n2 n3 mb`; 6 words in old versions.
pub(super) fn grav(f: &mut Fields<'_>) -> Option<Grav> {
    Some(Grav {
        sid: f.id()?,
        cid: f.id_or_zero()?,
        scale: f.read_real()?,
        n: f.reals()?,
    })
}

/// Reads RFORCE: `sid g cid a r1 r2 r3 method racc mb`; fewer words in old versions.
pub(super) fn rforce(f: &mut Fields<'_>) -> Option<Rforce> {
    let (sid, grid, cid, speed, r) = (
        f.id()?,
        f.id_or_zero()?,
        f.id_or_zero()?,
        f.read_real()?,
        f.reals()?,
    );
    let method = if f.words_left() > 0 {
        f.blank_or_id()?
    } else {
        None
    };
    let acceleration = if f.words_left() > 0 {
        f.read_real()?
    } else {
        0.0
    };
    Some(Rforce {
        is_rforce1: false,
        sid,
        grid,
        cid,
        speed,
        r,
        method,
        acceleration,
        part: 0,
    })
}

/// Reads LOAD: `sid s (si li) .. -1 -1`.
pub(super) fn load_sum(f: &mut Fields<'_>) -> Option<LoadSum> {
    let (sid, scale) = (f.id()?, f.read_real()?);
    let mut terms = Vec::new();
    loop {
        if f.peek()? == -1 {
            f.skip(2)?;
            return Some(LoadSum { sid, scale, terms });
        }
        terms.push((f.read_real()?, f.id()?));
    }
}

/// Reads TEMP: `sid g t`.
pub(super) fn temp(f: &mut Fields<'_>) -> Option<Temp> {
    Some(Temp {
        sid: f.id()?,
        grid: f.id()?,
        t: f.read_real()?,
    })
}

/// Reads TEMPD: `sid t`.
pub(super) fn tempd(f: &mut Fields<'_>) -> Option<Tempd> {
    Some(Tempd {
        sid: f.id()?,
        t: f.read_real()?,
    })
}
