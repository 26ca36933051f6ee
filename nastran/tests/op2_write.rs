//! A file of the OP2 writer is read back with equal content, and real files can be written again.

mod support;

use nastran::op2::{Op2, WriteError, write_blocks};
use nastran::results::{Analysis, Block, ElementType, Quantity, RowId, Rows, ShellForm, columns};

const DATE: [u32; 3] = [11, 21, 2026];

fn block(quantity: Quantity, element: Option<u32>, subcase: u32) -> Block {
    Block {
        table: String::new(),
        quantity,
        analysis: Analysis::Statics,
        subcase,
        mode: 0,
        step: 0.0,
        element: element.map(ElementType),
        form: element.map(|_| ShellForm::Fiber),
        von_mises: true,
        complex: false,
        sort2: false,
        num_wide: 0,
        entries: 0,
        titles: [
            "FRAME".to_owned(),
            format!("UNIT LOAD {subcase}"),
            "N, MM".to_owned(),
        ],
    }
}

/// Returns rows with values that are exact in 32 bits and all different.
fn rows(columns: &'static [&'static str], ids: Vec<RowId>) -> Rows {
    let n = ids.len() * columns.len();
    Rows {
        columns,
        ids,
        values: (0..n).map(|i| i as f64 * 0.125 - 3.0).collect(),
        labels: Vec::new(),
    }
}

fn id(entity: u32, at: u32, layer: u32) -> RowId {
    RowId { entity, at, layer }
}

#[test]
fn displacements_and_strain_of_shells_bars_and_beams_come_back_with_their_subcases_and_titles() {
    let mut written = Vec::new();
    for subcase in [1, 7] {
        let grids = (1..=20_000).map(|g| id(g, 1, 0)).collect();
        written.push((
            block(Quantity::Displacement, None, subcase),
            rows(columns::NODAL, grids),
        ));
    }
    for subcase in [1, 7] {
        let quads = (1..=9_000)
            .flat_map(|e| [id(e, 0, 1), id(e, 0, 2)])
            .collect();
        written.push((
            block(Quantity::Strain, Some(33), subcase),
            rows(columns::SHELL_STRAIN, quads),
        ));
        let triangles = [id(77, 0, 1), id(77, 0, 2)].to_vec();
        written.push((
            block(Quantity::Strain, Some(74), subcase),
            rows(columns::SHELL_STRAIN, triangles),
        ));
        let corners = [0, 11, 12, 13, 14]
            .into_iter()
            .flat_map(|g| [id(5, g, 1), id(5, g, 2)])
            .collect();
        written.push((
            block(Quantity::Strain, Some(144), subcase),
            rows(columns::SHELL_STRAIN, corners),
        ));
        let mut bar = block(Quantity::Strain, Some(34), subcase);
        bar.form = None;
        written.push((
            bar.clone(),
            rows(columns::BAR, vec![id(3, 0, 0), id(99_999_999, 0, 0)]),
        ));
        bar.element = Some(ElementType(2));
        let mut beam = rows(columns::BEAM, vec![id(4, 1, 0), id(4, 0, 0), id(4, 2, 0)]);
        [0.0, 0.5, 1.0]
            .into_iter()
            .enumerate()
            .for_each(|(i, x)| beam.values[i * 9] = x);
        written.push((bar, beam));
    }
    let bytes = write_blocks(written.iter().map(|(b, r)| (b, r)), DATE).unwrap();
    let op2 = Op2::read(&bytes).unwrap();
    assert!(op2.notes.is_empty(), "{:?}", op2.notes);
    let names: Vec<&str> = op2.tables.iter().map(|t| t.name.as_str()).collect();
    assert_eq!(names, ["OUGV1", "OSTR1X"]);
    assert_eq!(op2.blocks.len(), written.len());
    for (i, (block, rows)) in written.iter().enumerate() {
        let got = &op2.blocks[i];
        assert_eq!(
            (got.quantity, got.element, got.subcase),
            (block.quantity, block.element, block.subcase)
        );
        assert_eq!(
            (&got.titles, got.form, got.analysis),
            (&block.titles, block.form, block.analysis)
        );
        assert_eq!(
            op2.rows(i).unwrap(),
            *rows,
            "{} type {:?}",
            block.quantity.word(),
            block.element
        );
    }
}

#[test]
fn every_block_of_the_shared_files_that_can_be_written_comes_back() {
    let Some(shared) = support::find_shared_path("nastran") else {
        return;
    };
    let mut compared = 0;
    for file in std::fs::read_dir(shared)
        .unwrap()
        .flatten()
        .flat_map(|f| std::fs::read_dir(f.path()).into_iter().flatten().flatten())
    {
        let path = file.path();
        if path.extension().is_none_or(|e| e != "op2")
            || file.metadata().is_ok_and(|m| m.len() > 2_000_000)
        {
            continue;
        }
        let original = std::fs::read(&path).unwrap();
        let op2 = Op2::read(&original).unwrap();
        for (i, block) in op2.blocks.iter().enumerate() {
            let Ok(rows) = op2.rows(i) else { continue };
            match write_blocks([(block, &rows)], DATE) {
                Err(WriteError::Unsupported { .. }) => continue,
                Err(other) => panic!("{}: {other}", path.display()),
                Ok(bytes) => {
                    let again = Op2::read(&bytes).unwrap();
                    let got = again
                        .rows(0)
                        .unwrap_or_else(|e| panic!("{}: {e}", path.display()));
                    assert_eq!(got.ids, rows.ids, "{}", path.display());
                    assert_eq!(got.values.len(), rows.values.len());
                    let same =
                        |a: &f64, b: &f64| *a as f32 == *b as f32 || (a.is_nan() && b.is_nan());
                    assert!(
                        got.values.iter().zip(&rows.values).all(|(a, b)| same(a, b)),
                        "{}",
                        path.display()
                    );
                    let (was, is) = (block, &again.blocks[0]);
                    assert_eq!(
                        (
                            was.quantity,
                            was.element,
                            was.subcase,
                            was.analysis,
                            was.mode
                        ),
                        (is.quantity, is.element, is.subcase, is.analysis, is.mode)
                    );
                    assert_eq!(
                        (was.form, &was.titles),
                        (is.form, &is.titles),
                        "{}",
                        path.display()
                    );
                    compared += 1;
                }
            }
        }
    }
    // There are 78 blocks with displacements and forces at grids in statics. Strain and stress of shells, bars and solids add more.
    assert!(compared >= 100, "{compared} blocks compared");
}

#[test]
fn an_element_without_its_second_row_is_refused() {
    let strain = block(Quantity::Strain, Some(33), 1);
    let one_row = rows(columns::SHELL_STRAIN, vec![id(8, 0, 1)]);
    let err = write_blocks([(&strain, &one_row)], DATE).unwrap_err();
    assert_eq!(
        err.to_string(),
        "strain rows of entity 8: 1 rows, expected 2"
    );
}
