//! `/NASTRAN/RESULT/NODAL/GRID_WEIGHT`.

use super::H5Error;
use super::table::Table;
use crate::results::GridPointWeight;

/// Reads the first record of the table; `None` if the table is empty.
pub(super) fn grid_point_weight(table: &Table<'_>) -> Result<Option<GridPointWeight>, H5Error> {
    let (id, mo, s, inertia) = (
        table.need("ID")?,
        table.need("MO")?,
        table.need("S")?,
        table.need("I")?,
    );
    let mass = [table.need("MX")?, table.need("MY")?, table.need("MZ")?];
    let cg = [
        [table.need("XX")?, table.need("YX")?, table.need("ZX")?],
        [table.need("XY")?, table.need("YY")?, table.need("ZY")?],
        [table.need("XZ")?, table.need("YZ")?, table.need("ZZ")?],
    ];
    let mut found = None;
    table.each_record(0, table.rows.min(1), |r| {
        found = Some(GridPointWeight {
            reference: id.id(r, 0),
            mo: std::array::from_fn(|i| std::array::from_fn(|j| mo.read_real(r, 6 * i + j))),
            s: std::array::from_fn(|i| std::array::from_fn(|j| s.read_real(r, 3 * i + j))),
            mass: mass.map(|f| f.read_real(r, 0)),
            cg: cg.map(|row| row.map(|f| f.read_real(r, 0))),
            inertia_cg: std::array::from_fn(|i| {
                std::array::from_fn(|j| inertia.read_real(r, 3 * i + j))
            }),
        });
        Ok(())
    })?;
    Ok(found)
}
