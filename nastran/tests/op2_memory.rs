//! Reading takes less memory than four times the file size plus 64 MiB, while every row of every block is in memory.

mod support;

use nastran::op2::{Op2, Op2Writer};
use nastran::results::{Analysis, Block, ElementType, Quantity, RowId, Rows, ShellForm, columns};
use std::path::Path;

/// Returns the peak resident memory of this process in bytes, or `None` if the system does not report it.
fn peak() -> Option<usize> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    let kib: usize = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kib << 10)
}

fn read_all(path: &Path) -> (usize, usize) {
    let bytes = std::fs::read(path).unwrap();
    let Ok(op2) = Op2::read(&bytes) else {
        return (bytes.len(), 0);
    };
    let held: Vec<Rows> = (0..op2.blocks.len())
        .filter_map(|b| op2.rows(b).ok())
        .collect();
    let cards = op2.cards();
    let rows = held.iter().map(Rows::len).sum();
    drop(cards);
    (bytes.len(), rows)
}

/// Writes a file of `subcases` x `elements` quads with strain on both surfaces. Only a tenth of a MiB of it is in memory at a time.
fn write_large(path: &Path, subcases: u32, elements: u32) {
    let ids: Vec<RowId> = (1..=elements)
        .flat_map(|entity| {
            [1, 2].map(|layer| RowId {
                entity,
                at: 0,
                layer,
            })
        })
        .collect();
    let rows = Rows {
        columns: columns::SHELL_STRAIN,
        values: (0..ids.len() * columns::SHELL_STRAIN.len())
            .map(|i| i as f64)
            .collect(),
        ids,
        labels: Vec::new(),
    };
    let file = std::io::BufWriter::new(std::fs::File::create(path).unwrap());
    let mut writer = Op2Writer::new(file, [11, 21, 2026]).unwrap();
    for subcase in 1..=subcases {
        let block = Block {
            table: String::new(),
            quantity: Quantity::Strain,
            analysis: Analysis::Statics,
            subcase,
            mode: 0,
            step: 0.0,
            element: Some(ElementType(33)),
            form: Some(ShellForm::Fiber),
            von_mises: true,
            complex: false,
            sort2: false,
            num_wide: 0,
            entries: 0,
            titles: Default::default(),
        };
        writer.write_block(&block, &rows).unwrap();
    }
    writer.finish().unwrap();
}

#[test]
fn memory_stays_under_four_times_the_file_and_64_mib() {
    let large = Path::new(env!("CARGO_TARGET_TMPDIR")).join("large.op2");
    write_large(&large, 400, 2_000);
    let shared = support::find_shared_path("nastran").unwrap_or_default();
    let mut files = vec![large.clone()];
    for folder in std::fs::read_dir(shared).into_iter().flatten().flatten() {
        let inside = std::fs::read_dir(folder.path())
            .into_iter()
            .flatten()
            .flatten();
        files.extend(
            inside
                .map(|f| f.path())
                .filter(|p| p.extension().is_some_and(|e| e == "op2")),
        );
    }
    files.sort_by_key(|p| p.metadata().map_or(0, |m| m.len()));
    for path in files {
        let before = peak();
        let (size, rows) = read_all(&path);
        let bound = 4 * size + (64 << 20);
        if let (Some(before), Some(after)) = (before, peak()) {
            let taken = after - before;
            assert!(
                taken < bound,
                "{}: {taken} bytes for {size}, {rows} rows",
                path.display()
            );
        }
        if path == large {
            assert_eq!(rows, 400 * 2 * 2_000);
            assert!(size > 50 << 20, "{size}");
        }
    }
    std::fs::remove_file(&large).unwrap();
}
