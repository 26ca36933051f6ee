//! Opens every result file of the shared set through the common interface, which recognises the format by the content.

mod support;

use nastran::results::{ResultsError, ResultsFile};

#[test]
fn every_op2_punch_and_h5_of_the_set_opens_and_each_block_decodes_or_states_the_reason() {
    let Some(folder) = support::find_shared_path("nastran") else {
        return;
    };
    let cases = std::fs::read_dir(folder).unwrap();
    let mut n_files = 0;
    for case in cases.flatten().filter(|c| c.path().is_dir()) {
        for file in std::fs::read_dir(case.path())
            .unwrap()
            .flatten()
            .map(|f| f.path())
        {
            let extension = file
                .extension()
                .and_then(|e| e.to_str())
                .unwrap_or("")
                .to_ascii_lowercase();
            let kind = match extension.as_str() {
                "op2" => "OP2",
                "pch" => "punch",
                "h5" => "HDF5",
                _ => continue,
            };
            n_files += 1;
            let bytes = std::fs::read(&file).unwrap();
            let results = ResultsFile::read(&bytes, &file.display().to_string()).unwrap();
            let found = match results {
                ResultsFile::Op2(_) => "OP2",
                ResultsFile::Punch(_) => "punch",
                ResultsFile::H5(_) => "HDF5",
            };
            assert_eq!(found, kind, "{}", file.display());
            for (ix, block) in results.blocks().iter().enumerate() {
                match results.rows(ix) {
                    Ok(rows) => assert_eq!(
                        rows.values.len(),
                        rows.len() * rows.columns.len(),
                        "{} {}",
                        file.display(),
                        block.table
                    ),
                    Err(e) => assert!(!e.to_string().is_empty()),
                }
            }
        }
    }
    assert!(n_files > 0);
}

#[test]
fn other_text_is_no_result_file() {
    let error = ResultsFile::read(b"CEND\nBEGIN BULK\n", "frame.bdf").unwrap_err();
    assert_eq!(
        error,
        ResultsError::UnknownKind {
            name: "frame.bdf".to_string()
        }
    );
}
