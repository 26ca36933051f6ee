//! Rows of a Parquet file that two pieces decode together. A page on their border, and the data before it, is decoded once. Whichever of the two
//! threads is free decodes the next column.

use super::reader::Pick;
use super::strip::{Buffers, Strip};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// Decoded columns of some rows, by pick.
pub(super) type Strips = Vec<Strip>;

/// Rows being decoded, or decoded.
pub(super) struct Rows {
    /// Number of the rows.
    unit: usize,
    picks: Vec<Pick>,
    state: Mutex<State>,
    /// Something has changed.
    turn: Condvar,
}

struct State {
    /// Columns in work or to come.
    strips: Strips,
    /// The next column to be decoded.
    next: usize,
    /// Columns that are decoded.
    finished: usize,
    decoded: Option<Arc<Strips>>,
    failed: bool,
    /// Pieces that have not read them yet.
    left: usize,
}

/// Decoded rows that pieces use, the oldest first, and memory of rows that are no longer needed.
#[derive(Default)]
pub(super) struct SharedRows {
    rows: Mutex<Vec<Arc<Rows>>>,
    spare: Mutex<Vec<Strips>>,
    buffers: Mutex<Vec<Buffers>>,
}

fn lock_mutex<T>(m: &Mutex<T>) -> MutexGuard<'_, T> {
    m.lock().unwrap_or_else(PoisonError::into_inner)
}

impl SharedRows {
    /// Returns the rows `unit`, which `pieces` pieces read once each. At most `most` sets of rows are kept.
    pub fn rows(&self, unit: usize, pieces: usize, picks: &[Pick], most: usize) -> Arc<Rows> {
        let mut all = lock_mutex(&self.rows);
        if let Some(found) = all.iter().find(|r| r.unit == unit && r.picks == picks) {
            return found.clone();
        }
        let mut strips = self.spare();
        strips.resize_with(picks.len(), Strip::default);
        // If no columns are picked, there is nothing to decode.
        let decoded = picks.is_empty().then(Arc::default);
        let new = Arc::new(Rows {
            unit,
            picks: picks.to_vec(),
            state: Mutex::new(State {
                strips,
                next: 0,
                finished: 0,
                decoded,
                failed: false,
                left: pieces,
            }),
            turn: Condvar::new(),
        });
        all.push(new.clone());
        // A reader that stops early leaves rows that no other piece needs.
        if all.len() > most.max(1) {
            all.remove(0);
        }
        new
    }

    /// Counts one more piece that has read the rows. After the last piece, the rows are released.
    pub fn done_with(&self, rows: &Arc<Rows>, strips: Arc<Strips>) {
        drop(strips);
        let mut state = lock_mutex(&rows.state);
        state.left = state.left.saturating_sub(1);
        if state.left > 0 {
            return;
        }
        let decoded = state.decoded.take();
        drop(state);
        lock_mutex(&self.rows).retain(|r| !Arc::ptr_eq(r, rows));
        if let Some(strips) = decoded.and_then(Arc::into_inner) {
            lock_mutex(&self.spare).push(strips);
        }
    }

    /// Returns unused memory for columns, or new memory.
    pub fn spare(&self) -> Strips {
        lock_mutex(&self.spare).pop().unwrap_or_default()
    }

    /// Takes memory for columns back.
    pub fn take_back(&self, strips: Strips) {
        lock_mutex(&self.spare).push(strips);
    }

    /// Calls a function with memory for decoding.
    pub fn with_buffers<T>(&self, run: impl FnOnce(&mut Buffers) -> T) -> T {
        let mut buffers = lock_mutex(&self.buffers).pop().unwrap_or_default();
        let out = run(&mut buffers);
        lock_mutex(&self.buffers).push(buffers);
        out
    }
}

/// A column that a thread decodes. If the thread does not finish, the rows have failed.
struct Turn<'a> {
    rows: &'a Rows,
    column: usize,
    strip: Strip,
    good: bool,
}

impl Drop for Turn<'_> {
    fn drop(&mut self) {
        let mut state = lock_mutex(&self.rows.state);
        if let (true, Some(slot)) = (self.good, state.strips.get_mut(self.column)) {
            *slot = std::mem::take(&mut self.strip);
            state.finished += 1;
            if state.finished == self.rows.picks.len() {
                state.decoded = Some(Arc::new(std::mem::take(&mut state.strips)));
            }
        } else {
            state.failed = true;
        }
        self.rows.turn.notify_all();
    }
}

impl Rows {
    /// Returns the decoded columns. `decode` fills the strip of one column; it is called for columns that no other thread has begun. Returns `None`
    /// if a column failed, or if the rows were given up: the caller then decodes separately and reports the error.
    pub fn decode_columns(
        &self,
        decode: &mut dyn FnMut(usize, &mut Strip) -> bool,
    ) -> Option<Arc<Strips>> {
        let mut state = lock_mutex(&self.state);
        loop {
            if state.failed || state.left == 0 {
                return None;
            }
            if let Some(decoded) = &state.decoded {
                return Some(decoded.clone());
            }
            let column = state.next;
            if let Some(strip) = state.strips.get_mut(column).map(std::mem::take) {
                state.next += 1;
                drop(state);
                let mut turn = Turn {
                    rows: self,
                    column,
                    strip,
                    good: false,
                };
                turn.good = decode(column, &mut turn.strip);
                drop(turn);
                state = lock_mutex(&self.state);
            } else {
                state = self
                    .turn
                    .wait(state)
                    .unwrap_or_else(PoisonError::into_inner);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::series::record::{Options, open_record, read_channels};
    use parquet::data_type::{DoubleType, FloatType};
    use parquet::file::properties::WriterProperties;
    use parquet::file::writer::SerializedFileWriter;
    use parquet::schema::parser::parse_message_type;
    use std::sync::atomic::{AtomicUsize, Ordering};

    const PICKS: [Pick; 5] = [
        Pick::Time,
        Pick::Column(0),
        Pick::Column(1),
        Pick::Nothing,
        Pick::Column(3),
    ];

    /// Returns the strips of two pieces, each decoded on its own thread.
    fn of_two(
        shared: &SharedRows,
        decode: &(dyn Fn(usize) -> bool + Sync),
    ) -> [Option<Arc<Strips>>; 2] {
        let one = || {
            let rows = shared.rows(7, 2, &PICKS, 4);
            rows.decode_columns(&mut |j, _| decode(j))
        };
        std::thread::scope(|scope| {
            let two = [scope.spawn(one), scope.spawn(one)];
            two.map(|t| t.join().unwrap())
        })
    }

    #[test]
    fn two_pieces_decode_each_column_once_and_leave_their_memory() {
        let shared = SharedRows::default();
        let calls = AtomicUsize::new(0);
        let got = of_two(&shared, &|_| {
            calls.fetch_add(1, Ordering::Relaxed);
            true
        });
        assert_eq!(calls.load(Ordering::Relaxed), PICKS.len());
        for strips in got {
            let strips = strips.unwrap();
            assert_eq!(strips.len(), PICKS.len());
            let rows = shared.rows(7, 2, &PICKS, 4);
            shared.done_with(&rows, strips);
        }
        assert!(lock_mutex(&shared.rows).is_empty());
        assert_eq!(lock_mutex(&shared.spare).len(), 1);
    }

    #[test]
    fn where_a_column_fails_each_piece_is_left_to_itself() {
        let got = of_two(&SharedRows::default(), &|j| j != 2);
        assert!(got.iter().all(Option::is_none));
    }

    #[test]
    fn rows_of_no_column_are_not_waited_for() {
        let rows = SharedRows::default().rows(0, 2, &[], 1);
        let strips = rows.decode_columns(&mut |_, _| false);
        assert!(strips.is_some_and(|s| s.is_empty()));
    }

    #[test]
    fn rows_that_nobody_comes_back_for_are_not_kept() {
        let shared = SharedRows::default();
        for unit in 0..9 {
            let rows = shared.rows(unit, 2, &PICKS, 3);
            let strips = rows.decode_columns(&mut |_, _| true).unwrap();
            shared.done_with(&rows, strips);
        }
        assert_eq!(lock_mutex(&shared.rows).len(), 3);
    }

    #[test]
    fn a_row_group_of_several_pieces_is_what_was_written() {
        const ROWS: usize = 700_000;
        let schema = "message m { required double time; optional float g; required float h; }";
        let schema = Arc::new(parse_message_type(schema).unwrap());
        let mut bytes = Vec::new();
        let properties = Arc::new(WriterProperties::builder().build());
        let mut file = SerializedFileWriter::new(&mut bytes, schema, properties).unwrap();
        let mut group = file.next_row_group().unwrap();
        let times: Vec<f64> = (0..ROWS).map(|i| i as f64 * 0.01).collect();
        let mut column = group.next_column().unwrap().unwrap();
        let typed = column.typed::<DoubleType>();
        typed.write_batch(&times, None, None).unwrap();
        column.close().unwrap();
        let levels: Vec<i16> = (0..ROWS).map(|i| i16::from(i % 7 != 0)).collect();
        let known = (0..ROWS).filter(|i| i % 7 != 0);
        let known: Vec<f32> = known.map(|i| i as f32).collect();
        let mut column = group.next_column().unwrap().unwrap();
        let typed = column.typed::<FloatType>();
        typed.write_batch(&known, Some(&levels), None).unwrap();
        column.close().unwrap();
        let all: Vec<f32> = (0..ROWS).map(|i| -(i as f32)).collect();
        let mut column = group.next_column().unwrap().unwrap();
        let typed = column.typed::<FloatType>();
        typed.write_batch(&all, None, None).unwrap();
        column.close().unwrap();
        group.close().unwrap();
        file.close().unwrap();
        let record = open_record(Arc::new(bytes), &Options::default()).unwrap();
        assert!(record.n_pieces() > 2);
        let read = read_channels(&record).unwrap();
        assert_eq!(read.list[0].samples.len(), ROWS);
        for (i, (g, h)) in read.list[0]
            .samples
            .iter()
            .zip(&read.list[1].samples)
            .enumerate()
        {
            assert_eq!(*h, -(i as f64));
            assert!(
                if i % 7 == 0 {
                    g.is_nan()
                } else {
                    *g == i as f64
                },
                "{i}: {g}"
            );
        }
    }
}
