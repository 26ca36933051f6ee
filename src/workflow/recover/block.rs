//! Loads of a piece of a record.

use super::sink::Block;
use crate::host::fault::Fault;
use crate::measured::record::Record;
use crate::recovery::Sums;
use crate::recovery::history::{Filter, SampleLoads};

/// Returns the loads of piece `i`, and the sums over this piece. The caller determines the place of the piece in the record.
pub(crate) fn block(record: &Record, filter: &Filter, i: usize) -> Result<(Block, Sums), Fault> {
    let mut sums = Sums::new(filter.n_gauges(), filter.n_loads());
    let mut loads = SampleLoads::default();
    record.each_strain_block(i, |strain| filter.apply(strain, 1.0, &mut loads, &mut sums))?;
    let block = Block {
        first: 0,
        times: record.times(i),
        loads,
    };
    Ok((block, sums))
}
