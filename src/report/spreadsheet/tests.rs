use super::*;
use crate::finding::{Finding, Severity};

fn book(findings: &[Finding]) -> Vec<u8> {
    let mut sheet = Sheet::new("Loads", &["run", "value, kN"]);
    sheet.rows.push(vec!["R1".into(), 1.25.into()]);
    sheet.rows.push(vec!["R2".into(), f64::NAN.into()]);
    let units = [UnitOf {
        quantity: "force",
        unit: "kN".into(),
    }];
    let about = WorkbookDescription {
        title: "A truck & <its> trailer",
        units: &units,
        findings,
    };
    spreadsheet(&[sheet], &about).unwrap()
}

#[test]
fn the_same_tables_give_the_same_bytes_and_a_zip_archive() {
    let findings = [Finding::new(
        Severity::Info,
        "code",
        "subject",
        "message",
        "remedy",
    )];
    let first = book(&findings);
    // A ZIP archive begins with the local header of its first entry (APPNOTE.TXT 4.3.7).
    assert!(first.starts_with(b"PK\x03\x04"));
    assert_eq!(first, book(&findings));
    assert_ne!(first, book(&[]));
}
