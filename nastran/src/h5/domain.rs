//! `/NASTRAN/RESULT/DOMAINS`: meaning of a DOMAIN_ID.

use super::H5Error;
use super::table::Table;
use crate::results::Analysis;
use std::collections::BTreeMap;

/// A subcase and step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Domain {
    pub subcase: u32,
    pub analysis: Analysis,
    pub mode: i32,
    pub step: f64,
}

/// Domains by id.
pub(super) fn domains(table: &Table<'_>) -> Result<BTreeMap<i64, Domain>, H5Error> {
    let (id, subcase, analysis) = (
        table.need("ID")?,
        table.need("SUBCASE")?,
        table.need("ANALYSIS")?,
    );
    let (mode, value) = (table.field("MODE"), table.field("TIME_FREQ_EIGR"));
    let mut all = BTreeMap::new();
    table.each_record(0, table.rows, |r| {
        let domain = Domain {
            subcase: subcase.id(r, 0),
            analysis: Analysis::from_code(i32::try_from(analysis.integer(r, 0)).unwrap_or(0)),
            mode: mode.map_or(0, |f| i32::try_from(f.integer(r, 0)).unwrap_or(0)),
            step: value.map_or(0.0, |f| f.read_real(r, 0)),
        };
        all.insert(id.integer(r, 0), domain);
        Ok(())
    })?;
    Ok(all)
}
