use super::solution_file::{decode, encode};
use super::{Folder, Key, SolutionStore};
use crate::fe::{Balance, DisplacementSolution, MassProperties, Reaction, Reactions, SolveReport};
use crate::finding::explain::codes;
use crate::finding::{Finding, Severity};
use crate::host::half_written::name_of_part;
use crate::linalg::Matrix6;
use crate::linalg::sparse::OrderingMethod;
use crate::model::Vec3;

fn example_solution() -> DisplacementSolution {
    DisplacementSolution {
        displacements: vec![vec![[0.1, -0.2, 1e-300, 4.0, 5.0, 1.0 / 3.0]; 7]; 3],
        report: SolveReport {
            grids: 7,
            dofs: 42,
            factor_nonzeros: 99,
            ordering: Some(OrderingMethod::MinimumDegree),
            smallest_pivot: 1.0 / 7.0,
            epsilon: [1e-8, 1e-13],
            balance: vec![Balance {
                subcase: 4,
                applied: [1.0, 2.0, 3.0, 4.0, 5.0, 0.1],
                inertia: [-1.0, -2.0, -3.0, -4.0, -5.0, -0.1],
                acceleration: [0.5; 6],
                residual: 1e-15,
            }],
            mass: Some(MassProperties {
                mass: 2.0,
                cg: Vec3::new(1.0, 2.0, 3.0),
                matrix: Matrix6::from_fn(|r, c| (r * 6 + c) as f64 / 3.0),
            }),
            modes: vec![2.5, 3.5],
            reactions: vec![Reactions {
                subcase: 4,
                applied: [3.0; 6],
                total: [-3.0; 6],
                residual: 1e-16,
                grids: vec![Reaction {
                    grid: 11,
                    force: [-3.0, 0.5, 0.25, 0.0, 1.0, 2.0],
                }],
            }],
            seconds: Vec::new(),
        },
        findings: vec![
            Finding::new(Severity::Info, "autospc", "grid/dof 5/6", "held", "nothing")
                .with_numbers(1.0, 2.0),
        ],
    }
}

#[test]
fn a_kept_solution_comes_back_bit_by_bit() {
    let (s, hash) = (example_solution(), Key([7; 32]));
    let back = decode(&encode(&s, &hash), &hash, 7, 3).unwrap();
    assert_eq!(back.displacements, s.displacements);
    assert_eq!(back.report, s.report);
    assert_eq!(back.findings, s.findings);
}

#[test]
fn findings_of_every_code_come_back() {
    let hash = Key([7; 32]);
    for code in codes() {
        let mut s = example_solution();
        s.findings = vec![Finding::new(Severity::Warning, code.code, "a", "b", "c")];
        let back = decode(&encode(&s, &hash), &hash, 7, 3);
        assert_eq!(back.expect(code.code).findings, s.findings);
    }
}

#[test]
fn a_file_with_any_byte_changed_or_cut_off_is_no_solution() {
    let (s, hash) = (example_solution(), Key([7; 32]));
    let bytes = encode(&s, &hash);
    for at in 0..bytes.len() {
        let mut other = bytes.clone();
        other[at] ^= 0x10;
        assert!(decode(&other, &hash, 7, 3).is_none(), "byte {at}");
        assert!(decode(&bytes[..at], &hash, 7, 3).is_none(), "length {at}");
    }
    assert!(
        decode(&bytes, &Key([8; 32]), 7, 3).is_none(),
        "another hash"
    );
    assert!(decode(&bytes, &hash, 8, 3).is_none(), "another model");
    assert!(decode(&bytes, &hash, 7, 2).is_none(), "other cases");
}

#[test]
fn a_solution_half_written_by_a_killed_run_goes_when_another_is_kept() {
    if !std::path::Path::new("/proc/self/ns/pid").exists() {
        return;
    }
    let path = std::env::temp_dir().join(format!("strainbridge-store-{}", std::process::id()));
    std::fs::create_dir_all(&path).unwrap();
    // No process has the largest number.
    let own = format!("-{}-", std::process::id());
    let dead = name_of_part("0.solution", 0).replace(&own, &format!("-{}-", u32::MAX));
    std::fs::write(path.join(&dead), "half").unwrap();
    let store = Folder::new(&path);
    store.write(&Key([7; 32]), b"whole".to_vec()).unwrap();
    assert!(!path.join(&dead).exists());
    assert_eq!(store.read(&Key([7; 32])), Ok(Some(b"whole".to_vec())));
    assert_eq!(store.clean().unwrap(), (1, 5));
    assert!(!path.exists());
}
