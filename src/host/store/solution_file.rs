//! A stored solution as bytes: displacements and the report of the solver.
//!
//! The file contains a mark, the key's hash, little-endian numbers, and the SHA-256 of all bytes before. A file with another sum is not a solution.

use super::key::Key;
use crate::fe::{Balance, DisplacementSolution, MassProperties, Reaction, Reactions, SolveReport};
use crate::finding::{Finding, Severity, explain};
use crate::linalg::Matrix6;
use crate::linalg::sparse::OrderingMethod;
use crate::model::Vec3;
use sha2::{Digest, Sha256};

const MARK: &[u8] = b"strainbridge solution 2\n";

/// Returns a solution as bytes.
pub(super) fn encode(solved: &DisplacementSolution, Key(hash): &Key) -> Vec<u8> {
    let fields = &solved.displacements;
    let numbers = fields.first().map_or(0, |f| 6 * f.len()) * fields.len();
    let mut out = Vec::with_capacity(8 * numbers + (1 << 14));
    out.extend_from_slice(MARK);
    out.extend_from_slice(hash);
    let report = &solved.report;
    write_count(&mut out, report.grids);
    write_count(&mut out, report.dofs);
    write_count(&mut out, report.factor_nonzeros);
    write_count(
        &mut out,
        match report.ordering {
            None => 0,
            Some(OrderingMethod::NestedDissection) => 1,
            Some(OrderingMethod::MinimumDegree) => 2,
        },
    );
    let [first, last] = report.epsilon;
    reals(&mut out, &[report.smallest_pivot, first, last]);
    write_count(&mut out, usize::from(report.mass.is_some()));
    if let Some(m) = &report.mass {
        reals(&mut out, &[m.mass, m.cg.x, m.cg.y, m.cg.z]);
        reals(&mut out, m.matrix.as_slice());
    }
    write_count(&mut out, report.modes.len());
    reals(&mut out, &report.modes);
    write_count(&mut out, report.balance.len());
    for b in &report.balance {
        write_count(&mut out, b.subcase as usize);
        for six in [&b.applied, &b.inertia, &b.acceleration] {
            reals(&mut out, six);
        }
        reals(&mut out, &[b.residual]);
    }
    write_count(&mut out, report.reactions.len());
    for r in &report.reactions {
        write_count(&mut out, r.subcase as usize);
        reals(&mut out, &r.applied);
        reals(&mut out, &r.total);
        reals(&mut out, &[r.residual]);
        write_count(&mut out, r.grids.len());
        for g in &r.grids {
            write_count(&mut out, g.grid as usize);
            reals(&mut out, &g.force);
        }
    }
    write_count(&mut out, solved.findings.len());
    for f in &solved.findings {
        write_count(&mut out, f.severity as usize);
        for t in [f.code, &f.subject, &f.message, &f.remedy] {
            write_count(&mut out, t.len());
            out.extend_from_slice(t.as_bytes());
        }
        // A missing number is written as NaN.
        reals(
            &mut out,
            &[f.measured.unwrap_or(f64::NAN), f.limit.unwrap_or(f64::NAN)],
        );
    }
    write_count(&mut out, fields.len());
    for field in fields {
        write_count(&mut out, field.len());
        field.iter().for_each(|u| reals(&mut out, u));
    }
    let sum = Sha256::digest(&out);
    out.extend_from_slice(&sum);
    out
}

fn write_count(out: &mut Vec<u8>, n: usize) {
    out.extend_from_slice(&(n as u64).to_le_bytes());
}

fn reals(out: &mut Vec<u8>, values: &[f64]) {
    values
        .iter()
        .for_each(|v| out.extend_from_slice(&v.to_le_bytes()));
}

/// Returns the stored solution. `None` if the bytes are not a solution with this hash, number of grids and number of cases.
pub(super) fn decode(
    bytes: &[u8],
    Key(hash): &Key,
    grids: usize,
    cases: usize,
) -> Option<DisplacementSolution> {
    let (body, sum) = bytes.split_at_checked(bytes.len().checked_sub(32)?)?;
    let mut at = Cursor(body);
    if at.take(MARK.len())? != MARK
        || at.take(32)? != hash
        || Sha256::digest(body).as_slice() != sum
    {
        return None;
    }
    let mut report = SolveReport {
        grids: at.count()?,
        dofs: at.count()?,
        factor_nonzeros: at.count()?,
        ..SolveReport::default()
    };
    report.ordering = match at.count()? {
        1 => Some(OrderingMethod::NestedDissection),
        2 => Some(OrderingMethod::MinimumDegree),
        _ => None,
    };
    [report.smallest_pivot, report.epsilon[0], report.epsilon[1]] = at.array()?;
    if at.count()? == 1 {
        let [mass, x, y, z] = at.array()?;
        let matrix = Matrix6::from_column_slice(&at.array::<36>()?);
        report.mass = Some(MassProperties {
            mass,
            cg: Vec3::new(x, y, z),
            matrix,
        });
    }
    report.modes = at.list(Cursor::read_real)?;
    report.balance = at.list(|at| {
        Some(Balance {
            subcase: u32::try_from(at.count()?).ok()?,
            applied: at.array()?,
            inertia: at.array()?,
            acceleration: at.array()?,
            residual: at.read_real()?,
        })
    })?;
    report.reactions = at.list(|at| {
        Some(Reactions {
            subcase: u32::try_from(at.count()?).ok()?,
            applied: at.array()?,
            total: at.array()?,
            residual: at.read_real()?,
            grids: at.list(|at| {
                Some(Reaction {
                    grid: u32::try_from(at.count()?).ok()?,
                    force: at.array()?,
                })
            })?,
        })
    })?;
    let findings = at.list(|at| {
        let severity = match at.count()? {
            0 => Severity::Info,
            1 => Severity::Warning,
            _ => Severity::Error,
        };
        let code = explain::code(&at.text()?)?.code;
        let (subject, message, remedy) = (at.text()?, at.text()?, at.text()?);
        let [measured, limit] = at.array()?;
        let there = |v: f64| (!v.is_nan()).then_some(v);
        let mut f = Finding::new(severity, code, subject, message, remedy);
        (f.measured, f.limit) = (there(measured), there(limit));
        Some(f)
    })?;
    let displacements: Vec<Vec<[f64; 6]>> =
        at.list(|at| at.list(|at| at.array()).filter(|f| f.len() == grids))?;
    (at.0.is_empty() && displacements.len() == cases).then_some(DisplacementSolution {
        displacements,
        report,
        findings,
    })
}

/// Bytes that are not read yet.
struct Cursor<'a>(&'a [u8]);

impl<'a> Cursor<'a> {
    fn take(&mut self, n: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(n)?;
        self.0 = rest;
        Some(taken)
    }

    fn count(&mut self) -> Option<usize> {
        let bytes = self.take(8)?.try_into().ok()?;
        usize::try_from(u64::from_le_bytes(bytes)).ok()
    }

    fn read_real(&mut self) -> Option<f64> {
        Some(f64::from_le_bytes(self.take(8)?.try_into().ok()?))
    }

    fn array<const N: usize>(&mut self) -> Option<[f64; N]> {
        let mut out = [0.0; N];
        for o in &mut out {
            *o = self.read_real()?;
        }
        Some(out)
    }

    fn text(&mut self) -> Option<String> {
        let n = self.count()?;
        String::from_utf8(self.take(n)?.to_vec()).ok()
    }

    /// A number of entries, each of eight bytes at least, and the entries.
    fn list<T>(&mut self, mut entry: impl FnMut(&mut Self) -> Option<T>) -> Option<Vec<T>> {
        let n = self.count()?;
        if n > self.0.len() / 8 {
            return None;
        }
        (0..n).map(|_| entry(self)).collect()
    }
}
