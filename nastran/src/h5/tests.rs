use super::{H5, H5Error, is_h5};
use crate::results::{Analysis, ElementType, Quantity, RowId, Rows, ShellForm};
use serde_json::Value;

fn read_shared_file(path: &str) -> Option<Vec<u8>> {
    crate::support::bytes(&format!("nastran/{path}"))
}

/// Returns the table of this name from the reference data: rows of (ids, values).
fn read_expected_rows(case: &str, result: &str, n_ids: usize) -> Option<Vec<(Vec<u32>, Vec<f64>)>> {
    let json: Value =
        serde_json::from_slice(&read_shared_file(&format!("{case}/expected.json"))?).unwrap();
    let table = json["op2"]["results"]
        .as_array()
        .unwrap()
        .iter()
        .find(|r| r["result"] == result)
        .unwrap()
        .clone();
    let row = |r: &Value| {
        let r = r.as_array().unwrap();
        let ids = r[2..2 + n_ids]
            .iter()
            .map(|v| v.as_u64().unwrap() as u32)
            .collect();
        (
            ids,
            r[2 + n_ids..]
                .iter()
                .map(|v| v.as_f64().unwrap_or(f64::NAN))
                .collect(),
        )
    };
    Some(table["rows"].as_array().unwrap().iter().map(row).collect())
}

fn block(h5: &H5, quantity: Quantity, element: Option<u32>) -> usize {
    h5.blocks
        .iter()
        .position(|b| b.quantity == quantity && b.element == element.map(ElementType))
        .unwrap()
}

/// Returns the largest difference of the columns `cols`, relative to the largest reference value in these columns.
fn difference(rows: &Rows, wanted: &[(Vec<u32>, Vec<f64>)], cols: std::ops::Range<usize>) -> f64 {
    let mut worst = vec![0.0_f64; cols.len()];
    let mut largest = vec![0.0_f64; cols.len()];
    for (i, (_, values)) in wanted.iter().enumerate() {
        for (j, c) in cols.clone().enumerate() {
            worst[j] = worst[j].max((rows.row(i)[c] - values[c]).abs());
            largest[j] = largest[j].max(values[c].abs());
        }
    }
    worst
        .iter()
        .zip(&largest)
        .map(|(w, l)| if *w == 0.0 { 0.0 } else { w / l })
        .fold(0.0, f64::max)
}

#[test]
fn the_double_precision_h5_of_the_svanberg_beam_agrees_with_the_op2_of_the_same_run() {
    let Some(bytes) = read_shared_file("msc_svanberg_beam/static.h5") else {
        return;
    };
    let h5 = H5::read(&bytes).unwrap();
    assert_eq!(h5.schema, Some(20190));
    for (quantity, name) in [
        (Quantity::Displacement, "displacements"),
        (Quantity::SpcForce, "spc_forces"),
    ] {
        let ix = block(&h5, quantity, None);
        assert_eq!(
            (h5.blocks[ix].subcase, h5.blocks[ix].analysis),
            (1, Analysis::Statics)
        );
        let rows = h5.rows(ix).unwrap();
        let wanted = read_expected_rows("msc_svanberg_beam", name, 2).unwrap();
        assert_eq!(
            rows.ids
                .iter()
                .map(|id| vec![id.entity, id.at])
                .collect::<Vec<_>>(),
            wanted.iter().map(|w| w.0.clone()).collect::<Vec<_>>()
        );
        // The OP2 has single precision.
        assert!(difference(&rows, &wanted, 0..6) < 1e-7, "{name}");
    }
    for (quantity, name) in [
        (Quantity::Strain, "strain.cbeam_strain"),
        (Quantity::Stress, "stress.cbeam_stress"),
    ] {
        let rows = h5.rows(block(&h5, quantity, Some(2))).unwrap();
        let wanted = read_expected_rows("msc_svanberg_beam", name, 2).unwrap();
        assert_eq!(
            rows.ids
                .iter()
                .map(|id| vec![id.entity, id.at])
                .collect::<Vec<_>>(),
            wanted.iter().map(|w| w.0.clone()).collect::<Vec<_>>()
        );
        // The columns in pyNastran are sxc .. smin, mst, msc; they do not contain the station.
        let shifted: Vec<_> = wanted
            .into_iter()
            .map(|(ids, v)| (ids, [vec![0.0], v].concat()))
            .collect();
        assert!(difference(&rows, &shifted, 1..7) < 2e-7, "{name}");
    }
}

#[test]
fn the_grid_point_weight_of_the_svanberg_beam_is_that_of_its_printed_output() {
    let (Some(bytes), Some(f06)) = (
        read_shared_file("msc_svanberg_beam/static.h5"),
        read_shared_file("msc_svanberg_beam/static.f06"),
    ) else {
        return;
    };
    let weight = H5::read(&bytes).unwrap().grid_point_weight.unwrap();
    let text = String::from_utf8_lossy(&f06);
    let first = text
        .lines()
        .skip_while(|l| !l.contains("MASS AXIS SYSTEM"))
        .nth(1)
        .unwrap();
    let numbers: Vec<f64> = first
        .split_whitespace()
        .filter_map(|t| t.parse().ok())
        .collect();
    for (got, want) in [
        weight.mass[0],
        weight.cg[0][0],
        weight.cg[0][1],
        weight.cg[0][2],
    ]
    .iter()
    .zip(&numbers)
    {
        assert!((got - want).abs() <= 1e-6 * weight.mass[0], "{got} {want}");
    }
    // The mean position of the mass is 2.5: five equal beams extend from 0 to 5.
    assert!((weight.cg[1][0] - 2.5).abs() < 1e-12);
}

#[test]
fn compressed_tables_of_msc_agree_with_the_op2_that_nx_wrote_for_the_same_deck() {
    let Some(bytes) = read_shared_file("nx_static_shell_bar/static_solid_shell_bar.h5") else {
        return;
    };
    let h5 = H5::read(&bytes).unwrap();
    // The tolerances are measured: the two solvers agree to single precision on this deck.
    for (quantity, element, name, n_ids, cols, tolerance) in [
        (Quantity::Displacement, None, "displacements", 2, 0..6, 1e-6),
        // Reactions that nearly cancel have fewer correct digits.
        (Quantity::SpcForce, None, "spc_forces", 2, 0..6, 2e-3),
        (Quantity::AppliedLoad, None, "load_vectors", 2, 0..6, 1e-6),
        (
            Quantity::Strain,
            Some(1),
            "strain.crod_strain",
            1,
            0..1,
            1e-6,
        ),
        (
            Quantity::Strain,
            Some(34),
            "strain.cbar_strain",
            1,
            0..7,
            1e-6,
        ),
        (
            Quantity::Strain,
            Some(74),
            "strain.ctria3_strain",
            2,
            0..4,
            1e-6,
        ),
        (
            Quantity::Strain,
            Some(144),
            "strain.cquad4_strain",
            2,
            0..4,
            1e-6,
        ),
        (
            Quantity::Stress,
            Some(144),
            "stress.cquad4_stress",
            2,
            0..4,
            1e-6,
        ),
    ] {
        let rows = h5.rows(block(&h5, quantity, element)).unwrap();
        let wanted = read_expected_rows("nx_static_shell_bar", name, n_ids).unwrap();
        assert_eq!(rows.len(), wanted.len(), "{name}");
        let ids: Vec<_> = rows
            .ids
            .iter()
            .map(|id| [id.entity, id.at][..n_ids].to_vec())
            .collect();
        assert_eq!(
            ids,
            wanted.iter().map(|w| w.0.clone()).collect::<Vec<_>>(),
            "{name}"
        );
        let d = difference(&rows, &wanted, cols);
        assert!(d < tolerance, "{name}: {d}");
    }
    assert_eq!(
        h5.blocks[block(&h5, Quantity::Strain, Some(144))].form,
        Some(ShellForm::Curvature)
    );
    assert_eq!(
        h5.blocks[block(&h5, Quantity::Stress, Some(144))].form,
        Some(ShellForm::Fiber)
    );
}

#[test]
fn every_table_of_the_element_zoo_is_read_or_reported() {
    let Some(bytes) = read_shared_file("nx_static_elements/static_elements.h5") else {
        return;
    };
    let h5 = H5::read(&bytes).unwrap();
    for ix in 0..h5.blocks.len() {
        let (rows, b) = (h5.rows(ix).unwrap(), &h5.blocks[ix]);
        assert!(rows.len() >= b.entries, "{}", b.table);
        assert_eq!(rows.values.len(), rows.len() * rows.columns.len());
    }
    let bars = h5.rows(block(&h5, Quantity::Strain, Some(100))).unwrap();
    assert_eq!(bars.ids.iter().map(|id| id.at).collect::<Vec<_>>(), [1, 2]);
    assert_eq!(bars.row(1)[0], 1.0);
    let quad8 = h5.rows(block(&h5, Quantity::Strain, Some(64))).unwrap();
    assert_eq!(
        quad8.ids[2],
        RowId {
            entity: 60,
            at: 4,
            layer: 1
        }
    );
    let subjects: Vec<_> = h5.notes.iter().map(|n| n.subject.as_str()).collect();
    assert!(
        subjects.contains(&"/NASTRAN/RESULT/ELEMENTAL/ENERGY"),
        "{subjects:?}"
    );
    assert!(
        subjects.contains(&"/NASTRAN/RESULT/NODAL/GRID_FORCE"),
        "{subjects:?}"
    );
}

#[test]
fn a_file_that_is_no_nastran_result_is_refused_with_the_reason() {
    assert!(matches!(
        H5::read(b"not hdf5 at all"),
        Err(H5Error::Container { .. })
    ));
    let mut other = hdf5_pure::FileBuilder::new();
    other.create_dataset("strain").with_f64_data(&[1.0, 2.0]);
    let bytes = other.finish().unwrap();
    assert!(is_h5(&bytes));
    assert_eq!(H5::read(&bytes).err(), Some(H5Error::NoResults));
}

#[test]
fn truncated_and_mutated_files_give_an_answer_or_an_error_but_no_panic() {
    let Some(bytes) = read_shared_file("nx_static_shell_bar/static_solid_shell_bar.h5") else {
        return;
    };
    let read_all = |bytes: &[u8]| {
        if let Ok(h5) = H5::salvage(bytes).map(|s| s.file) {
            for ix in 0..=h5.blocks.len() {
                let _ = h5.rows(ix);
            }
        }
    };
    for cut in (0..bytes.len()).step_by(4001) {
        read_all(&bytes[..cut]);
    }
    // A small linear congruential generator (Knuth's constants) gives the same mutations on every machine.
    let mut state = 20_261_121_u64;
    let mut next = move |n: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n
    };
    for _ in 0..N_MUTATIONS {
        let mut damaged = bytes.clone();
        for _ in 0..=next(8) {
            // The offset is in the superblock and root, or in the last part, which contains the result tables and their headers.
            let at = if next(4) == 0 {
                next(4096)
            } else {
                RESULTS_FROM + next(damaged.len() - RESULTS_FROM)
            };
            damaged[at] = if next(3) == 0 { 0xff } else { next(256) as u8 };
        }
        read_all(&damaged);
    }
}
const N_MUTATIONS: usize = 1000;
const RESULTS_FROM: usize = 200_000;
