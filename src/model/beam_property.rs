//! PBAR, PBARL, PBEAM, PBEAML.

use super::build::Builder;
use super::fault::FaultKind;
use super::section::{SectionFault, bar_section};
use super::types::*;
use nastran::cards::{BeamStation, Pbar, Pbarl, Pbeam, Pbeaml};
use nastran::place::{Place, PlacedCard};
use std::collections::HashMap;

impl Builder<'_> {
    /// Returns the properties by ascending id, and the index of each property by family (beam or not) and id. A PBAR and a PBEAM may have one id.
    pub(super) fn beam_properties(
        &mut self,
    ) -> (Vec<BeamProperty>, HashMap<(bool, u32), BeamPropertyIx>) {
        let cards = self.cards;
        let mut out: Vec<(bool, BeamProperty)> = Vec::new();
        let mut note = |b: &mut Self, id: u32, beam: bool, p: Option<BeamProperty>| match p {
            Some(p) => out.push((beam, p)),
            None => {
                b.refused_properties.insert((beam, id));
            }
        };
        for p in &cards.pbars {
            let property = self.pbar(p);
            note(self, p.id, false, property);
        }
        for p in &cards.pbarls {
            let property = self.pbarl(p);
            note(self, p.id, false, property);
        }
        for p in &cards.pbeams {
            let property = self.pbeam(p);
            note(self, p.id, true, property);
        }
        for p in &cards.pbeamls {
            let property = self.pbeaml(p);
            note(self, p.id, true, property);
        }
        out.sort_by_key(|(beam, p)| (p.id, *beam, p.at));
        for pair in out.windows(2) {
            if let [(a_beam, a), (b_beam, b)] = pair
                && a.id == b.id
                && a_beam == b_beam
            {
                let kind = FaultKind::Duplicate {
                    what: "bar or beam property id",
                    first: a.at,
                };
                let card = format!("property {}", b.id);
                self.faults.push(super::ModelFault {
                    card,
                    field: "PID",
                    at: b.at,
                    kind,
                });
            }
        }
        out.dedup_by_key(|(beam, p)| (*beam, p.id));
        let ix = out
            .iter()
            .enumerate()
            .map(|(i, (beam, p))| ((*beam, p.id), BeamPropertyIx(i as u32)))
            .collect();
        (out.into_iter().map(|o| o.1).collect(), ix)
    }

    fn check_positive(
        &mut self,
        what: &'static str,
        value: f64,
        card: &str,
        field: &'static str,
        at: Place,
    ) {
        if !(value > 0.0) {
            self.fault(
                card.to_owned(),
                field,
                at,
                FaultKind::NotPositive { what, value },
            );
        }
    }

    fn pbar(&mut self, p: &PlacedCard<Pbar>) -> Option<BeamProperty> {
        let name = format!("PBAR {}", p.id);
        let material = self.material(p.mid, &name, "MID", p.at)?;
        // The area may be zero: such a bar carries bending and torsion only.
        self.not_negative("area", p.area, &name, "A", p.at);
        self.not_negative("torsion constant", p.j, &name, "J", p.at);
        if [p.area, p.i1, p.i2, p.j] == [0.0; 4] {
            let kind = FaultKind::Unsupported {
                what: "a bar whose A, I1, I2 and J are all 0".into(),
                remedy: "state one of them above 0, or delete the bar",
            };
            self.fault(name, "A", p.at, kind);
            return None;
        }
        let s = Section {
            area: p.area,
            i1: p.i1,
            i2: p.i2,
            i12: p.i12,
            j: p.j,
            nsm: p.nsm,
            recovery: p.recovery,
            ..Section::default()
        };
        let k = p.k.map(|k| k.unwrap_or(0.0));
        Some(BeamProperty {
            id: p.id,
            material,
            sections: vec![(0.0, s), (1.0, s)],
            k,
            section_type: String::new(),
            bar_centroid: [0.0; 2],
            warping: [0.0; 2],
            at: p.at,
        })
    }

    fn pbarl(&mut self, p: &PlacedCard<Pbarl>) -> Option<BeamProperty> {
        let name = format!("PBARL {}", p.id);
        let material = self.material(p.mid, &name, "MID", p.at)?;
        let shape = self.section(&p.section, &p.dims, &name, p.at)?;
        // The neutral axis of a bar is the element axis for every section, so the recovery points are relative to the centroid.
        let [y, z] = shape.section.neutral;
        let s = Section {
            nsm: p.nsm,
            neutral: [0.0; 2],
            recovery: shape.section.recovery.map(|[a, b]| [a - y, b - z]),
            ..shape.section
        };
        let section_type = p.section.clone();
        Some(BeamProperty {
            id: p.id,
            material,
            sections: vec![(0.0, s), (1.0, s)],
            k: shape.k,
            section_type,
            bar_centroid: shape.section.neutral,
            warping: [0.0; 2],
            at: p.at,
        })
    }

    fn pbeam(&mut self, p: &PlacedCard<Pbeam>) -> Option<BeamProperty> {
        let name = format!("PBEAM {}", p.id);
        let material = self.material(p.mid, &name, "MID", p.at)?;
        let end = |pair: &[Option<f64>; 2], other: &[Option<f64>; 2]| -> [f64; 2] {
            [
                pair[0].or(other[0]).unwrap_or(0.0),
                pair[1].or(other[1]).unwrap_or(0.0),
            ]
        };
        let nsi_a = p.nsi[0].unwrap_or(0.0);
        let at_ends = |v: &[[Option<f64>; 2]; 2]| [end(&v[0], &[None, None]), end(&v[1], &v[0])];
        let (m, n) = (at_ends(&p.m), at_ends(&p.n));
        let nsi = [nsi_a, p.nsi[1].unwrap_or(nsi_a)];
        let blend = |v: [[f64; 2]; 2], x: f64| [0, 1].map(|i| v[0][i] + x * (v[1][i] - v[0][i]));
        let mut sections: Vec<(f64, Section)> = p
            .stations
            .iter()
            .map(|s: &BeamStation| {
                let x = s.x_xb;
                let section = Section {
                    area: s.area,
                    i1: s.i1,
                    i2: s.i2,
                    i12: s.i12,
                    j: s.j,
                    nsm: s.nsm,
                    recovery: s.recovery,
                    neutral: blend(n, x),
                    nsm_centre: blend(m, x),
                    nsi: nsi[0] + x * (nsi[1] - nsi[0]),
                };
                (x, section)
            })
            .collect();
        self.complete_sections(&mut sections, &name, p.at)?;
        for (_, s) in &sections {
            if self
                .not_negative("torsion constant", s.j, &name, "J", p.at)
                .is_none()
            {
                break;
            }
        }
        for (cw, field) in p.cw.iter().zip(["CW(A)", "CW(B)"]) {
            self.not_negative("warping constant", cw.unwrap_or(0.0), &name, field, p.at);
        }
        // Blank K1 and K2 of a PBEAM are 1. Stated zeros mean rigid in shear.
        let k = p.k.map(|k| k.unwrap_or(1.0));
        Some(BeamProperty {
            id: p.id,
            material,
            sections,
            k,
            section_type: String::new(),
            bar_centroid: [0.0; 2],
            warping: end(&p.cw, &[p.cw[0], p.cw[0]]),
            at: p.at,
        })
    }

    fn pbeaml(&mut self, p: &PlacedCard<Pbeaml>) -> Option<BeamProperty> {
        let name = format!("PBEAML {}", p.id);
        let material = self.material(p.mid, &name, "MID", p.at)?;
        let mut sections = Vec::new();
        let mut k = [1.0; 2];
        let mut warping = Vec::new();
        for (i, s) in p.stations.iter().enumerate() {
            let shape = self.section(&p.section, &s.dims, &name, p.at)?;
            if i == 0 {
                k = shape.k;
            }
            warping.push(shape.cw);
            sections.push((
                s.x_xb,
                Section {
                    nsm: s.nsm,
                    ..shape.section
                },
            ));
        }
        self.complete_sections(&mut sections, &name, p.at)?;
        Some(BeamProperty {
            id: p.id,
            material,
            sections,
            k,
            section_type: p.section.clone(),
            bar_centroid: [0.0; 2],
            warping: [warping.first(), warping.last()].map(|cw| cw.copied().unwrap_or(0.0)),
            at: p.at,
        })
    }

    /// Sections by ascending station, with one at each end.
    fn complete_sections(
        &mut self,
        sections: &mut Vec<(f64, Section)>,
        name: &str,
        at: Place,
    ) -> Option<()> {
        sections.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (first, last) = (*sections.first()?, *sections.last()?);
        if first.0 > 0.0 {
            sections.insert(0, (0.0, first.1));
        }
        if last.0 < 1.0 {
            sections.push((1.0, last.1));
        }
        for (_, s) in sections.iter() {
            if !(s.area > 0.0) {
                self.check_positive("area", s.area, name, "A", at);
                break;
            }
        }
        Some(())
    }

    fn section(
        &mut self,
        section: &str,
        dims: &[f64],
        name: &str,
        at: Place,
    ) -> Option<super::section::Shape> {
        match bar_section(section, dims) {
            Ok(s) => Some(s),
            Err(e) => {
                let section = section.to_owned();
                let kind = match e {
                    SectionFault::Unknown => FaultKind::UnknownSection { section },
                    SectionFault::Count { expected } => FaultKind::SectionDimensions {
                        section,
                        expected,
                        found: dims.len(),
                    },
                    SectionFault::Shape => FaultKind::SectionShape { section },
                };
                self.fault(name.to_owned(), "TYPE", at, kind);
                None
            }
        }
    }
}
