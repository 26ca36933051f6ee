use super::super::{EditError, Edits, ToFields, read_deck, write_deck, write_edited};
use super::{bulk, read_clean_deck};
use crate::cards::*;

const DECK: &str = "SOL 101\r\nCEND\r\n$ my case\r\nSPC = 1\r\nSUBCASE 1\r\n  LOAD = 1 $ old\r\nSUBCASE 2\r\n$ kept\r\n  LOAD = 2\r\nBEGIN BULK\r\n$ my shells\r\nPSHELL  4       1       .25     1               1                       +P4\r\n$ inside\r\n+P4     -.1     .2\r\ngrid,1,,0.,0.,0. $ origin\r\nENDDATA 123\r\nafter\r\n";

fn first_file_text(files: Vec<(String, Vec<u8>)>) -> String {
    String::from_utf8(files.into_iter().next().unwrap().1).unwrap()
}

#[test]
fn an_unedited_deck_is_written_byte_for_byte() {
    assert_eq!(first_file_text(write_deck(&bulk(DECK))), DECK);
}

#[test]
fn a_changed_thickness_leaves_all_other_lines() {
    let deck = read_clean_deck(DECK);
    let mut p = deck.cards.pshells[0].clone();
    p.card.t = Some(0.3);
    let mut edits = Edits::default();
    edits.replace_card(&deck, p.at, &p.to_card()).unwrap();
    let new = first_file_text(write_edited(&deck, &edits));
    assert_eq!(read_clean_deck(&new).cards.pshells[0].card, p.card);
    let expected = DECK
        .replace(
            "PSHELL  4       1       .25     1               1                       +P4\r\n",
            "PSHELL  4       1       .3      1               1\r\n+       -.1     .2\r\n",
        )
        .replace("+P4     -.1     .2\r\n", "");
    assert_eq!(new, expected);
}

#[test]
fn subcases_are_replaced_and_comments_stay() {
    let deck = read_clean_deck(DECK);
    let mut edits = Edits::default();
    edits.remove_subcases(&deck);
    edits.insert_case_end(&deck, "SUBCASE 7\n  LOAD = 7\n");
    edits.insert_cards(&deck, "FORCE,7,1,,1.,0.,0.,1.");
    edits.replace_sol(&deck, "103");
    let new = first_file_text(write_edited(&deck, &edits));
    let expected = DECK
        .replace("SOL 101", "SOL 103")
        .replace("SUBCASE 1\r\n  LOAD = 1 $ old\r\nSUBCASE 2\r\n", "")
        .replace("  LOAD = 2\r\n", "SUBCASE 7\r\n  LOAD = 7\r\n")
        .replace("ENDDATA", "FORCE,7,1,,1.,0.,0.,1.\r\nENDDATA");
    assert_eq!(new, expected);
    let read = read_clean_deck(&new);
    assert_eq!(
        (
            read.sol,
            read.case_control.subcases.len(),
            read.cards.forces.len()
        ),
        (Some(103), 1, 1)
    );
}

#[test]
fn bulk_data_alone_gets_its_sections() {
    let deck = read_clean_deck("$ mesh\nGRID,1");
    let mut edits = Edits::default();
    edits.insert_case_end(&deck, "SUBCASE 1\n  LOAD = 1\n");
    edits.insert_cards(&deck, "FORCE,1,1,,1.,0.,0.,1.\n");
    let new = first_file_text(write_edited(&deck, &edits));
    assert_eq!(
        new,
        "SOL 101\nCEND\nSUBCASE 1\n  LOAD = 1\nBEGIN BULK\n$ mesh\nGRID,1\nFORCE,1,1,,1.,0.,0.,1.\nENDDATA\n"
    );
}

#[test]
fn replicated_cards_and_cards_apart_are_not_edited() {
    let deck = read_clean_deck("GRID,1\n=,*1,==\n");
    let grids = &deck.cards.grids;
    for grid in grids {
        assert_eq!(
            Edits::default().remove_card(&deck, grid.at),
            Err(EditError::Replicated(grid.at))
        );
    }
    let deck = read_clean_deck(
        "+P4     -.1     .2\nPSHELL  4       1       .25     1               1                       +P4\n",
    );
    let at = deck.cards.pshells[0].at;
    assert_eq!(
        Edits::default().remove_card(&deck, at),
        Err(EditError::ContinuationsApart(at))
    );
}

#[test]
fn removed_cards_are_gone_with_their_continuations() {
    let deck = read_clean_deck("RBE2,1,1,123,2,\n3,4\n,5\nGRID,1\n");
    let mut edits = Edits::default();
    edits.remove_card(&deck, deck.cards.rbe2s[0].at).unwrap();
    assert_eq!(first_file_text(write_edited(&deck, &edits)), "GRID,1\n");
}

#[test]
fn cards_in_included_files_are_edited_there() {
    let mut loader = super::super::MemoryLoader::default();
    loader
        .files
        .insert("mesh.inc".to_owned(), b"GRID,1\nGRID,2\n".to_vec());
    let deck = read_deck(
        "main.bdf",
        b"BEGIN BULK\nINCLUDE 'mesh.inc'\n".to_vec(),
        &mut loader,
    );
    let mut edits = Edits::default();
    edits.remove_card(&deck, deck.cards.grids[0].at).unwrap();
    let files = write_edited(&deck, &edits);
    assert_eq!(files[1], ("mesh.inc".to_owned(), b"GRID,2\n".to_vec()));
}

/// Values that need large field, and values that do not.
const R: [f64; 4] = [0.25, -333.333333333333, 7.85e-9, 2.1e11];

#[test]
fn written_cards_read_back_equal() {
    let grid = Grid {
        id: 12345678,
        cp: Some(0),
        x: [0.123456789012345, -2.0, 1e-7],
        cd: Some(-1),
        ps: Dofs::from_digits(126),
        seid: Some(3),
    };
    let force = Force {
        sid: 1,
        grid: 2,
        cid: 0,
        scale: 1.0,
        n: [0.0, 1.23456789012345, -1.0],
    };
    let load = LoadSum {
        sid: 1,
        scale: 1.0,
        terms: vec![(R[0], 2), (R[2], 3), (R[3], 4), (1.5, 5)],
    };
    let conm2 = Conm2 {
        id: 1,
        grid: 2,
        cid: -1,
        mass: R[0],
        offset: [1.0, 0.0, 0.0],
        inertia: [1.0, 0.0, 2.0, 0.0, 0.5, 3.0],
    };
    let rbe3 = Rbe3 {
        id: 1,
        reference: 9,
        refc: Dofs::ALL,
        groups: vec![
            Rbe3Group {
                weight: 1.0,
                dofs: Dofs(7),
                grids: (1..=20).collect(),
            },
            Rbe3Group {
                weight: R[2],
                dofs: Dofs(1),
                grids: vec![33],
            },
        ],
        um: vec![(1, Dofs(1)), (2, Dofs(2)), (3, Dofs(3)), (4, Dofs(4))],
        alpha: 1.2e-5,
    };
    let pshell = Pshell {
        id: 1,
        mid1: Some(1),
        t: Some(0.300000000001),
        mid2: Some(-1),
        bending_ratio: None,
        mid3: None,
        shear_ratio: Some(0.8333333333),
        nsm: None,
        z1: Some(-0.1),
        z2: Some(0.2),
        mid4: None,
    };
    let pbush = Pbush {
        id: 3,
        k: [1e5, 0.0, 3.5, 0.0, 0.0, 0.0],
        rigid: [false, true, false, false, false, false],
        b: [0.0; 6],
        ge: [0.0, 0.02, 0.0, 0.0, 0.0, 0.0],
        recovery: [1.0, 2.0, 1.0, 1.0],
        mass: 4.0,
    };
    let mat1 = Mat1 {
        id: 1,
        e: Some(2.1e11),
        g: None,
        nu: Some(0.3),
        rho: 7.85e-9,
        alpha: 1.2e-5,
        tref: 20.0,
        ge: 0.0,
        limits: [Some(1.0), None, None],
    };
    let suport = Suport {
        sid: None,
        terms: (1..=6).map(|g| (g, Dofs(1 << (g - 1)))).collect(),
    };
    let suport1 = Suport {
        sid: Some(4),
        terms: vec![(7, Dofs::ALL)],
    };
    let rbe1 = Rbe1 {
        id: 1,
        independent: vec![(1, Dofs(7)), (2, Dofs(56))],
        dependent: (3..8).map(|g| (g, Dofs(1))).collect(),
        alpha: 0.0,
    };
    let mpc = Mpc {
        sid: 1,
        terms: (1..6).map(|i| (i, 3, f64::from(i) * 0.125000001)).collect(),
    };
    let pbeam = Pbeam {
        id: 1,
        mid: 1,
        stations: [0.0, 0.5, 1.0]
            .iter()
            .map(|&x_xb| BeamStation {
                x_xb,
                output: x_xb != 0.5,
                area: 1.0 + x_xb,
                i1: 2.0,
                i2: 3.0,
                i12: 0.0,
                j: 4.0,
                nsm: 0.0,
                // A station without stress output has the points of end A.
                recovery: [
                    [if x_xb == 0.5 { 0.0 } else { x_xb }, 2.0],
                    [3.0, 4.0],
                    [5.0, 6.0],
                    [7.0, 8.0],
                ],
            })
            .collect(),
        k: [Some(0.8), None],
        s: [0.0; 2],
        nsi: [None; 2],
        cw: [None; 2],
        m: [[None; 2]; 2],
        n: [[Some(0.1), None], [None, None]],
    };
    let tria6 = Shell {
        id: 1,
        pid: Some(2),
        shape: ShellShape::Tria6,
        grids: [1, 2, 3, 4, 0, 6, 0, 0],
        angle: MaterialAngle::Mcid(0),
        zoffs: Some(0.5),
        tflag: true,
        thickness: [Some(1.0), None, Some(R[1].abs()), None],
    };
    let mut text = grid.to_card();
    for card in [
        force.to_force_card(),
        force.to_moment_card(),
        load.to_card(),
        conm2.to_card(),
        rbe3.to_card(),
        pshell.to_card(),
        pbush.to_card(),
        mat1.to_card(),
        suport.to_card(),
        suport1.to_card(),
        rbe1.to_card(),
        mpc.to_card(),
        pbeam.to_card(),
        tria6.to_card(),
        Shell {
            shape: ShellShape::Tria3,
            grids: [1, 2, 3, 0, 0, 0, 0, 0],
            ..tria6
        }
        .to_card(),
        Shell {
            shape: ShellShape::Quad8,
            grids: [1, 2, 3, 4, 5, 6, 7, 8],
            ..tria6
        }
        .to_card(),
        Param {
            name: "WTMASS".to_owned(),
            values: vec![ParamValue::Real(0.00259)],
        }
        .to_card(),
    ] {
        text.push_str(&card);
    }
    let deck = read_clean_deck(&text);
    let c = &deck.cards;
    assert_eq!(c.grids[0].card, grid);
    assert_eq!((&c.forces[0].card, &c.moments[0].card), (&force, &force));
    assert_eq!(c.loads[0].card, load);
    assert_eq!(c.conm2s[0].card, conm2);
    assert_eq!(c.rbe3s[0].card, rbe3);
    assert_eq!(c.pshells[0].card, pshell);
    assert_eq!(c.pbushes[0].card, pbush);
    assert_eq!(c.mat1s[0].card, mat1);
    assert_eq!(
        (&c.suports[0].card, &c.suports[1].card),
        (&suport, &suport1)
    );
    assert_eq!(c.rbe1s[0].card, rbe1);
    assert_eq!(c.mpcs[0].card, mpc);
    assert_eq!(c.pbeams[0].card, pbeam);
    assert_eq!(c.shells[0].card, tria6);
    assert_eq!(
        (c.shells[1].grids[2], c.shells[1].angle, c.shells[1].tflag),
        (3, MaterialAngle::Mcid(0), true)
    );
    assert_eq!((c.shells[2].grids[7], c.shells[2].zoffs), (8, Some(0.5)));
    assert_eq!(c.params[0].values, [ParamValue::Real(0.00259)]);
    assert!(text.lines().all(|l| l.len() <= 72));
}

/// Tests that scalar masses, accelerations, rotations, temperature dependent materials and normals read back as they were written.
#[test]
fn cards_of_mass_and_temperature_read_back_as_written() {
    let masses = [
        ScalarMassValue::Property(Some(7)),
        ScalarMassValue::Direct(0.125),
    ]
    .map(|mass| ScalarMass {
        id: 50,
        mass,
        ends: [Some((2, 1)), Some((90, 0))],
    });
    let accel = Accel {
        sid: 5,
        cid: 2,
        n: [0.0, 0.25, 2.0],
        direction: "Y".to_owned(),
        table: vec![(1.0, 1.1), (2.0, 2.1), (3.0, 3.1), (4.0, 4.1), (5.0, 5.1)],
    };
    let accel1 = Accel1 {
        sid: 5,
        cid: 2,
        scale: 9.81,
        n: [0.0, 1.0, 2.0],
        grids: vec![IdList::Each(vec![1, 4]), IdList::Thru(10, 20)],
    };
    let rforces = [true, false].map(|is_rforce1| Rforce {
        is_rforce1,
        sid: 5,
        grid: 1,
        cid: 0,
        speed: 3.0,
        r: [0.0, 0.0, 1.0],
        method: Some(2),
        acceleration: 0.5,
        part: 8,
    });
    let matt1 = Matt1 {
        id: 3,
        tables: std::array::from_fn(|k| [Some(9), None, Some(11)][k % 3]),
    };
    let points = vec![
        (0.0, 1.0),
        (10.0, 3.0),
        (20.0, 4.0),
        (30.0, 4.5),
        (40.0, 5.0),
    ];
    let forms = [
        MaterialTableForm::Replaces(points.clone()),
        MaterialTableForm::Shifted {
            x1: 20.0,
            points: points.clone(),
        },
        MaterialTableForm::Scaled {
            x: [20.0, 2.0],
            points,
        },
        MaterialTableForm::Series {
            x: [0.0, 10.0, 0.0, 50.0],
            a: vec![1.0, -2.0, 3.0],
        },
    ];
    let tables = forms.map(|form| MaterialTable {
        id: 9,
        form,
        options: String::new(),
    });
    let snorm = Snorm {
        grid: 4,
        cid: 2,
        n: [0.0, 0.6, 0.8],
    };
    let pmass = Pmass { id: 7, mass: 0.25 };
    let mut text = [accel.to_card(), accel1.to_card(), matt1.to_card()].concat();
    text += &[snorm.to_card(), pmass.to_card()].concat();
    masses.iter().for_each(|m| text += &m.to_card());
    rforces.iter().for_each(|r| text += &r.to_card());
    tables.iter().for_each(|t| text += &t.to_card());
    let c = read_clean_deck(&text).cards;
    assert_eq!((&c.accels[0].card, &c.accel1s[0].card), (&accel, &accel1));
    assert_eq!((&c.matt1s[0].card, &c.snorms[0].card), (&matt1, &snorm));
    assert_eq!(c.pmasses[0].card, pmass);
    assert_eq!(
        c.scalar_masses.iter().map(|m| m.card).collect::<Vec<_>>(),
        masses
    );
    assert_eq!(
        c.rforces.iter().map(|r| r.card).collect::<Vec<_>>(),
        rforces
    );
    let read: Vec<_> = c.material_tables.iter().map(|t| t.card.clone()).collect();
    assert_eq!(read, tables);
}
