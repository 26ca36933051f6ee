use super::{Punch, PunchError};
use crate::results::{Analysis, ElementType, Quantity, RowId, ShellForm};

/// Returns a line of a punch file: the id columns, then slots of 18 columns.
fn line(head: &str, slots: &[&str]) -> String {
    let mut text = format!("{head:<18}");
    for s in slots {
        text += &format!("{s:>18}");
    }
    format!("{text:<72}{:>8}\n", 1)
}

fn header(subcase: u32, quantity: &str, more: &str) -> String {
    let mut text = String::new();
    for l in [
        "$TITLE   = A FRAME",
        "$SUBTITLE=BRAKING",
        "$LABEL   =",
        &format!("${quantity}"),
        "$REAL OUTPUT",
        &format!("$SUBCASE ID = {subcase:>11}"),
    ] {
        text += &format!("{l:<72}{:>8}\n", 1);
    }
    if more.is_empty() {
        text
    } else {
        format!("{text}{more:<72}{:>8}\n", 1)
    }
}

/// Returns the lines of an element entry from its values.
fn entry(id: u32, words: &[String]) -> String {
    let mut text = String::new();
    for (i, three) in words.chunks(3).enumerate() {
        let head = if i == 0 {
            format!("{id:>10}")
        } else {
            "-CONT-".to_string()
        };
        text += &line(&head, &three.iter().map(String::as_str).collect::<Vec<_>>());
    }
    text
}

fn reals(values: impl IntoIterator<Item = f64>) -> Vec<String> {
    values.into_iter().map(|v| format!("{v:.6E}")).collect()
}

fn read_shared_file(path: &str) -> Option<Vec<u8>> {
    crate::support::bytes(&format!("nastran/{path}"))
}

#[test]
fn the_punch_file_of_a_bush_agrees_with_pynastran_s_reading_of_its_op2() {
    let (Some(bytes), Some(json)) = (
        read_shared_file("nx_cbush/cbush.pch"),
        read_shared_file("nx_cbush/expected.json"),
    ) else {
        return;
    };
    let punch = Punch::read(&bytes).unwrap();
    let expected: serde_json::Value = serde_json::from_slice(&json).unwrap();
    let quantities: Vec<_> = punch.blocks.iter().map(|b| b.quantity).collect();
    assert_eq!(
        quantities,
        [
            Quantity::Displacement,
            Quantity::SpcForce,
            Quantity::Strain,
            Quantity::Stress
        ]
    );
    for (ix, name, ids) in [
        (0, "displacements", 4),
        (1, "spc_forces", 4),
        (2, "strain.cbush_strain", 3),
        (3, "stress.cbush_stress", 3),
    ] {
        let block = &punch.blocks[ix];
        assert_eq!((block.subcase, block.analysis), (1, Analysis::Statics));
        let rows = punch.rows(ix).unwrap();
        let table = expected["op2"]["results"]
            .as_array()
            .unwrap()
            .iter()
            .find(|r| r["result"] == name)
            .unwrap();
        let wanted = table["rows"].as_array().unwrap();
        assert_eq!(
            (rows.len(), block.entries),
            (wanted.len(), wanted.len()),
            "{name}"
        );
        for (i, row) in wanted.iter().enumerate() {
            assert_eq!(u64::from(rows.ids[i].entity), row[2].as_u64().unwrap());
            for (got, want) in rows.row(i).iter().zip(&row.as_array().unwrap()[ids..]) {
                // Punch prints seven digits.
                let want = want.as_f64().unwrap();
                assert!(
                    (got - want).abs() <= 5e-7 * want.abs(),
                    "{name} row {i}: {got} {want}"
                );
            }
        }
    }
}

#[test]
fn shells_with_corners_give_a_centre_and_corner_rows_of_two_fibres() {
    let mut words = vec!["CEN/              ".to_string(), "4        ".to_string()];
    words.extend(reals((0..16).map(|k| f64::from(k) / 8.0)));
    for grid in [11, 12, 13, 14] {
        words.push(format!("{grid}        "));
        words.extend(reals(
            (0..16).map(|k| f64::from(grid) + f64::from(k) / 16.0),
        ));
    }
    let text = header(
        3,
        "ELEMENT STRAINS",
        "$ELEMENT TYPE =         144  QUAD4C    VONM",
    ) + &entry(77, &words)
        + &entry(78, &words);
    let punch = Punch::read(text.as_bytes()).unwrap();
    let block = &punch.blocks[0];
    assert_eq!(
        (block.element, block.subcase, block.entries),
        (Some(ElementType(144)), 3, 2)
    );
    assert_eq!(
        (block.form, block.von_mises),
        (Some(ShellForm::Fiber), true)
    );
    assert_eq!(block.titles, ["A FRAME", "BRAKING", ""]);
    let rows = punch.rows(0).unwrap();
    assert_eq!(rows.len(), 20);
    assert_eq!(
        rows.ids[1],
        RowId {
            entity: 77,
            at: 0,
            layer: 2
        }
    );
    assert_eq!(
        rows.row(1),
        [1.0, 1.125, 1.25, 1.375, 1.5, 1.625, 1.75, 1.875]
    );
    assert_eq!(
        rows.ids[8],
        RowId {
            entity: 77,
            at: 14,
            layer: 1
        }
    );
    assert_eq!(rows.row(8)[0], 14.0);
    assert_eq!(rows.ids[10].entity, 78);
}

#[test]
fn fibre_columns_of_zero_and_minus_one_mean_curvature_form() {
    let mut fibres = vec![0.0; 16];
    fibres[8] = -1.0;
    let element = "$ELEMENT TYPE =          33  QUAD4";
    let strain = header(1, "ELEMENT STRAINS", element) + &entry(5, &reals(fibres.clone()));
    let stress = header(1, "ELEMENT STRESSES", element) + &entry(5, &reals(fibres));
    let text = strain + &stress;
    let punch = Punch::read(text.as_bytes()).unwrap();
    assert_eq!(punch.blocks[0].form, Some(ShellForm::Curvature));
    assert_eq!(punch.blocks[1].form, Some(ShellForm::Fiber));
}

#[test]
fn beams_leave_out_stations_that_were_not_asked_for() {
    let mut words = Vec::new();
    for station in 0..11 {
        let grid = match station {
            0 => 21,
            10 => 22,
            _ => 0,
        };
        words.push(format!("{grid}        "));
        words.extend(reals((0..9).map(|k| {
            if grid == 0 {
                0.0
            } else {
                f64::from(k + grid) - 21.0
            }
        })));
    }
    let text =
        header(1, "ELEMENT STRAINS", "$ELEMENT TYPE =           2  BEAM") + &entry(9, &words);
    let rows = Punch::read(text.as_bytes()).unwrap().rows(0).unwrap();
    assert_eq!(
        rows.ids.iter().map(|id| id.at).collect::<Vec<_>>(),
        [21, 22]
    );
    assert_eq!(rows.row(1), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
}

#[test]
fn blank_margins_of_a_bar_are_no_number_and_scalar_points_have_one_component() {
    let mut words = reals((1..=15).map(f64::from));
    words[7] = String::new();
    words[14] = String::new();
    let text = header(1, "ELEMENT STRAINS", "$ELEMENT TYPE =          34  BAR") + &entry(4, &words);
    let rows = Punch::read(text.as_bytes()).unwrap().rows(0).unwrap();
    assert!(rows.row(0)[7].is_nan() && rows.row(0)[14].is_nan());
    assert_eq!((rows.row(0)[6], rows.row(0)[8]), (7.0, 9.0));
    let text = header(1, "DISPLACEMENTS", "") + &line("        90       S", &["2.500000E-01"]);
    let rows = Punch::read(text.as_bytes()).unwrap().rows(0).unwrap();
    assert_eq!(
        rows.ids[0],
        RowId {
            entity: 90,
            at: 2,
            layer: 0
        }
    );
    assert_eq!(rows.row(0), [0.25, 0.0, 0.0, 0.0, 0.0, 0.0]);
}

#[test]
fn modes_carry_their_number_and_complex_and_sort2_blocks_are_reported() {
    let grid = line("         1       G", &["1.0", "0.0", "0.0"])
        + &line("-CONT-", &["0.0", "0.0", "1.234567-101"]);
    let modes = header(
        1,
        "EIGENVECTOR",
        "$EIGENVALUE =  0.3947842E+05  MODE =     2",
    ) + &grid;
    let complex =
        header(2, "DISPLACEMENTS", "").replace("$REAL OUTPUT", "$REAL-IMAGINARY OUTPUT") + &grid;
    let sort2 = header(
        2,
        "DISPLACEMENTS",
        "$POINT ID =           1  IDENTIFIED BY TIME",
    ) + &grid;
    let text = modes + &complex + &sort2;
    let punch = Punch::read(text.as_bytes()).unwrap();
    assert_eq!(
        (
            punch.blocks[0].mode,
            punch.blocks[0].step,
            punch.blocks[0].analysis
        ),
        (2, 39478.42, Analysis::Modes)
    );
    assert_eq!(punch.rows(0).unwrap().row(0)[5], 1.234567e-101);
    assert_eq!(punch.notes.len(), 2);
    assert!(matches!(punch.rows(1), Err(PunchError::NotDecoded { .. })));
    assert!(matches!(punch.rows(2), Err(PunchError::NotDecoded { .. })));
    assert_eq!(punch.blocks[2].analysis, Analysis::Transient);
}

#[test]
fn complex_blocks_are_of_the_analysis_that_their_header_names_and_never_static() {
    let block = |extra: &str| {
        header(1, "VELOCITY", extra).replace("$REAL OUTPUT", "$MAGNITUDE-PHASE OUTPUT")
            + &line("         1       G", &["1.0", "2.0", "3.0"])
            + &line("-CONT-", &["4.0", "5.0", "6.0"])
            + &line("-CONT-", &["7.0", "8.0", "9.0"])
            + &line("-CONT-", &["10.0", "11.0", "12.0"])
    };
    for (extra, expected) in [
        (
            "$POINT ID =         11  IDENTIFIED BY FREQUENCY",
            Analysis::Frequency,
        ),
        ("$FREQUENCY =   0.1000000E+02", Analysis::Frequency),
        (
            "$EIGENVALUE =  0.3947842E+05  MODE =     2",
            Analysis::ComplexEigen,
        ),
        ("", Analysis::Other(0)),
    ] {
        let text = block(extra);
        let punch = Punch::read(text.as_bytes()).unwrap();
        let found = &punch.blocks[0];
        assert_eq!(
            (found.quantity, found.analysis),
            (Quantity::Velocity, expected),
            "{extra}"
        );
        assert!(found.complex && punch.rows(0).is_err());
    }
}

#[test]
fn crlf_and_missing_line_numbers_change_nothing() {
    let text = header(1, "DISPLACEMENTS", "")
        + &line("         1       G", &["1.0", "2.0", "3.0"])
        + &line("-CONT-", &["4.0", "5.0", "6.0"]);
    let short: String = text
        .lines()
        .map(|l| format!("{}\r\n", l.get(..72).unwrap_or(l).trim_end()))
        .collect();
    let (a, b) = (
        Punch::read(text.as_bytes()).unwrap(),
        Punch::read(short.as_bytes()).unwrap(),
    );
    assert_eq!(a.rows(0).unwrap(), b.rows(0).unwrap());
}

#[test]
fn truncated_and_mutated_files_give_an_answer_or_an_error_but_no_panic() {
    let mut corner = vec!["CEN/              ".to_string(), "4        ".to_string()];
    corner.extend(reals((0..84).map(f64::from)));
    let sample = read_shared_file("nx_cbush/cbush.pch").unwrap_or_default();
    let mut text =
        header(3, "ELEMENT STRAINS", "$ELEMENT TYPE =         144  QUAD4C") + &entry(77, &corner);
    text += &(header(3, "ELEMENT STRAINS", "$ELEMENT TYPE =          67  HEXA")
        + &entry(8, &reals((0..192).map(f64::from))));
    text += &(header(3, "ELEMENT STRAINS", "$ELEMENT TYPE =           2  BEAM")
        + &entry(8, &reals((0..20).map(f64::from))));
    let whole = [sample, text.into_bytes()].concat();
    let read_all = |bytes: &[u8]| {
        if let Ok(punch) = Punch::salvage(bytes).map(|s| s.file) {
            for ix in 0..=punch.blocks.len() {
                let _ = punch.rows(ix);
            }
        }
    };
    for cut in 0..whole.len() {
        read_all(&whole[..cut]);
    }
    // A small linear congruential generator (Knuth's constants) gives the same mutations on every machine.
    let mut state = 20_261_121_u64;
    let mut next = move |n: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n
    };
    for _ in 0..10_000 {
        let mut damaged = whole.clone();
        for _ in 0..=next(4) {
            let at = next(damaged.len());
            damaged[at] = b" $-\n0189.EG\xff\x00"[next(13)];
        }
        read_all(&damaged);
    }
}
