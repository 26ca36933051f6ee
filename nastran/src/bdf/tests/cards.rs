use super::read_clean_deck;
use crate::cards::*;

#[test]
fn pbeam_fills_blank_stations_as_the_guide_states() {
    // Blank values of end B are the values of end A, and blank values of stations between are interpolated.
    let deck = read_clean_deck(
        "PBEAM,1,1,2.,4.,6.,,8.\n,.1,.2,.3,.4,.5,.6,.7,.8\n,NO,.5,,,,,,\n,YESA,1.,4.,,,,,\n,.9,.8\n",
    );
    let p = &deck.cards.pbeams[0];
    let at = |i: usize| {
        (
            p.stations[i].x_xb,
            p.stations[i].area,
            p.stations[i].i1,
            p.stations[i].output,
        )
    };
    assert_eq!(p.stations.len(), 3);
    assert_eq!(
        [at(0), at(1), at(2)],
        [
            (0.0, 2.0, 4.0, true),
            (0.5, 3.0, 4.0, false),
            (1.0, 4.0, 4.0, true)
        ]
    );
    assert_eq!(p.stations[2].recovery, p.stations[0].recovery);
    assert_eq!(p.k, [Some(0.9), Some(0.8)]);
}

#[test]
fn pbeam_with_one_line_is_uniform() {
    let deck = read_clean_deck("PBEAM,1,1,2.,4.,6.,,8.\n");
    let p = &deck.cards.pbeams[0];
    assert_eq!(
        (p.stations.len(), p.stations[1].x_xb, p.stations[1].j),
        (2, 1.0, 8.0)
    );
    let k_line = read_clean_deck(
        "PBEAM,101,501,15000.,2500.,250.,0.0,25000.,0.0\n,.1,.1,-0.1,.1,-0.1,-0.1,.1,-0.1\n,0.0,0.0\n",
    );
    assert_eq!(k_line.cards.pbeams[0].k, [Some(0.0), Some(0.0)]);
}

#[test]
fn pbeaml_stations_take_blank_dimensions_from_end_a() {
    let deck = read_clean_deck("PBEAML,1,1,,BAR\n,10.,20.,.5,YES,.4,12.,,.6,NO,1.,,5.\n");
    let p = &deck.cards.pbeamls[0];
    let dims: Vec<(f64, Vec<f64>, f64)> = p
        .stations
        .iter()
        .map(|s| (s.x_xb, s.dims.clone(), s.nsm))
        .collect();
    assert_eq!(
        dims,
        [
            (0.0, vec![10.0, 20.0], 0.5),
            (0.4, vec![12.0, 20.0], 0.6),
            (1.0, vec![10.0, 5.0], 0.0)
        ]
    );
}

#[test]
fn pcomp_plies_repeat_material_and_thickness() {
    let deck = read_clean_deck("PCOMP,7,,,,,,,SYM\n,1,0.1,45.,YES,,,-45.\n,2,.2\n");
    let p = &deck.cards.pcomps[0];
    let plies: Vec<(u32, f64, f64, bool)> = p
        .plies
        .iter()
        .map(|q| (q.mid, q.t, q.theta_deg, q.output))
        .collect();
    assert_eq!(
        plies,
        [
            (1, 0.1, 45.0, true),
            (1, 0.1, -45.0, false),
            (2, 0.2, 0.0, false)
        ]
    );
    assert!(p.symmetric);
    let g = read_clean_deck("PCOMPG,9\n,1,1,0.1\n,2,1,0.2,90.,YES\n");
    assert_eq!(g.cards.pcomps[0].plies.len(), 2);
    assert_eq!(g.cards.pcomps[0].plies[1].theta_deg, 90.0);
}

#[test]
fn rbe3_groups_begin_with_a_weight() {
    let deck = read_clean_deck(
        "RBE3,14,,100,1234,1.0,123,1,3\n,5,4.7,1,2,4,6,5.2,2\n,7,8,9,5.1,1,15,16\n,UM,100,14,5,3,7,2\n,ALPHA,6.5-6\n",
    );
    let e = &deck.cards.rbe3s[0];
    let groups: Vec<(f64, String, &[u32])> = e
        .groups
        .iter()
        .map(|g| (g.weight, g.dofs.to_string(), g.grids.as_slice()))
        .collect();
    let expected: [(f64, String, &[u32]); 4] = [
        (1.0, "123".into(), &[1, 3, 5]),
        (4.7, "1".into(), &[2, 4, 6]),
        (5.2, "2".into(), &[7, 8, 9]),
        (5.1, "1".into(), &[15, 16]),
    ];
    assert_eq!(groups, expected);
    assert_eq!(
        e.um.iter()
            .map(|(g, d)| (*g, d.to_string()))
            .collect::<Vec<_>>(),
        [(100, "14".into()), (5, "3".into()), (7, "2".into())]
    );
    assert_eq!(e.alpha, 6.5e-6);
}

#[test]
fn rbe2_may_end_in_a_thermal_expansion() {
    let deck = read_clean_deck("RBE2,9,8,12,10,12,14,15,16\n,20,6.5-6\n");
    assert_eq!(
        (
            deck.cards.rbe2s[0].dependent.as_slice(),
            deck.cards.rbe2s[0].alpha
        ),
        ([10, 12, 14, 15, 16, 20].as_slice(), 6.5e-6)
    );
}

#[test]
fn rbe1_lists_independent_and_dependent_dofs() {
    let deck = read_clean_deck("RBE1,59,59,123,60,456\n,UM,61,246,,,62,3\n");
    let e = &deck.cards.rbe1s[0];
    assert_eq!((e.independent.len(), e.dependent.len()), (2, 2));
    assert_eq!(e.dependent[1].0, 62);
}

#[test]
fn pairs_on_one_card_are_two_entries() {
    let deck = read_clean_deck(
        "CORD1R,3,16,32,19,5,1,2,3\nPELAS,7,4.29,.06,7.92,27,2.17,.0032\nTEMP,3,94,316.2,49,219.8\nTEMPD,1,216.3,2,217.\n",
    );
    assert_eq!(
        deck.cards.coords.iter().map(|c| c.id).collect::<Vec<_>>(),
        [3, 5]
    );
    assert_eq!(
        deck.cards.coords[1].definition,
        CoordDefinition::Grids([1, 2, 3])
    );
    assert_eq!(
        deck.cards
            .pelas
            .iter()
            .map(|p| (p.id, p.k))
            .collect::<Vec<_>>(),
        [(7, 4.29), (27, 2.17)]
    );
    assert_eq!((deck.cards.temps.len(), deck.cards.tempds.len()), (2, 2));
    assert_eq!((deck.counts["CORD1R"], deck.counts["PELAS"]), (1, 1));
}

#[test]
fn lists_hold_ids_and_ranges() {
    let deck = read_clean_deck(
        "SPC1,3,2,1,3,10,9\nSPC1,4,123,5,thru,13\nPLOAD2,1,2.5,1,THRU,9\nPLOAD4,2,1106,10.,8.,5.,,THRU,1143\nSPOINT,1,2,3\n",
    );
    assert_eq!(deck.cards.spc1s[0].grids, IdList::Each(vec![1, 3, 10, 9]));
    assert_eq!(deck.cards.spc1s[1].grids, IdList::Thru(5, 13));
    assert_eq!(deck.cards.pload2s[0].elements, IdList::Thru(1, 9));
    assert_eq!(deck.cards.pload4s[0].elements, IdList::Thru(1106, 1143));
    assert_eq!(
        deck.cards.pload4s[0].pressure,
        [Some(10.0), Some(8.0), Some(5.0), None]
    );
    assert_eq!(deck.cards.spoints[0].card, IdList::Each(vec![1, 2, 3]));
}

#[test]
fn pbush_lines_begin_with_what_they_hold() {
    let deck =
        read_clean_deck("PBUSH,35,K,4.35,2.4,,,RIGID,3.1\n,,GE,.01\n,,RCV,7.3,3.3\n,,B,1.,2.\n");
    let p = &deck.cards.pbushes[0];
    assert_eq!(p.k, [4.35, 2.4, 0.0, 0.0, 0.0, 3.1]);
    assert!(p.rigid[4] && !p.rigid[0]);
    assert_eq!(
        (p.ge, p.b[1], p.recovery),
        ([0.01; 6], 2.0, [7.3, 3.3, 1.0, 1.0])
    );
}

#[test]
fn mpc_terms_stand_in_two_columns_of_fields() {
    let deck = read_clean_deck(
        "MPC     3       28      3       6.2     2       1       4.29\n                1       4       -2.91\n",
    );
    assert_eq!(
        deck.cards.mpcs[0].terms,
        [(28, 3, 6.2), (2, 1, 4.29), (1, 4, -2.91)]
    );
}

#[test]
fn tubes_may_lack_the_inner_radius() {
    assert_eq!(
        read_clean_deck("PBARL,1,1,,TUBE\n,.5\n").cards.pbarls[0].dims,
        [0.5, 0.0]
    );
    assert_eq!(
        read_clean_deck("PBARL,1,1,,tube\n,.5,.4,2.\n").cards.pbarls[0].nsm,
        2.0
    );
}

#[test]
fn defaults_of_bars_and_grids_are_kept_apart() {
    let deck = read_clean_deck(
        "BAROR,,39,,,.6,2.9,-5.87,GOG\nGRDSET,,16,,,,32,3456\nBEAMOR,,4,,,1.,2.,3.\n",
    );
    assert_eq!(
        deck.cards.baror.as_ref().unwrap().orientation,
        Orientation::Vector([0.6, 2.9, -5.87])
    );
    assert_eq!(
        (
            deck.cards.grdset.as_ref().unwrap().cp,
            deck.cards.grdset.as_ref().unwrap().cd
        ),
        (Some(16), Some(32))
    );
    assert_eq!(deck.cards.beamor.as_ref().unwrap().pid, Some(4));
}

#[test]
fn scalar_masses_name_components_or_scalar_points() {
    let deck = read_clean_deck(
        "CMASS1,1,7,2,1\nCMASS2,2,.5,,,3,2\nCMASS3,3,7,90\nCMASS4,4,.25,90,91\nPMASS,7,1.,8,2.,9,3.,10,4.\n",
    );
    let masses: Vec<ScalarMass> = deck.cards.scalar_masses.iter().map(|m| m.card).collect();
    let property = ScalarMassValue::Property(Some(7));
    assert_eq!(
        (masses[0].mass, masses[0].ends),
        (property, [Some((2, 1)), None])
    );
    assert_eq!(masses[1].ends, [None, Some((3, 2))]);
    assert_eq!(
        (masses[2].mass, masses[2].ends),
        (property, [Some((90, 0)), None])
    );
    assert_eq!(masses[3].mass, ScalarMassValue::Direct(0.25));
    assert_eq!(masses[3].ends, [Some((90, 0)), Some((91, 0))]);
    let properties: Vec<(u32, f64)> = deck.cards.pmasses.iter().map(|p| (p.id, p.mass)).collect();
    assert_eq!(properties, [(7, 1.0), (8, 2.0), (9, 3.0), (10, 4.0)]);
}

#[test]
fn tables_end_at_endt_leave_out_skip_and_keep_their_order() {
    let one = |text: &str| read_clean_deck(text).cards.material_tables[0].card.clone();
    let table = one("TABLEM1,9\n,0.,1.,5.,SKIP,10.,3.,20.,4.\n,ENDT\n,99.,99.\n");
    assert_eq!(
        table.form,
        MaterialTableForm::Replaces(vec![(0.0, 1.0), (10.0, 3.0), (20.0, 4.0)])
    );
    assert_eq!(
        one("TABLEM1,9,,,,FLAT\n,0.,1.,5.,2.,ENDT\n").options,
        "FLAT"
    );
    for wrong in [
        "TABLEM1,9\n,0.,1.,5.,2.,3.,4.,ENDT\n",
        "TABLEM1,9\n,0.,1.,ENDT\n",
        "TABLEM3,9,1.,0.\n,0.,1.,1.,2.,ENDT\n",
        "ACCEL,5,,1.,0.,0.,W\n,1.,2.\n",
        "ACCEL1,5,,1.,1.,0.,0.\n",
        // These cards have a value in an entry without an id.
        "PMASS,7,1.,,2.\n",
        "PELAS,7,1.,,,,2.\n",
    ] {
        assert_eq!(super::bulk(wrong).faults.len(), 1, "{wrong}");
    }
}

#[test]
fn a_station_without_stress_output_has_the_points_of_end_a() {
    // MSC Nastran Quick Reference Guide, PBEAM: the line of points is omitted if SO is YESA or NO.
    for so in ["NO", "YESA"] {
        let deck = super::read_clean_deck(&format!(
            "PBEAM,1,1,8.,2.,3.,,1.\n,20.,10.,-20.,10.\n,{so},.5,9.,4.,5.\n,YES,1.,16.,4.,6.\n,21.,11.,-21.,11.\n"
        ));
        let stations = &deck.cards.pbeams[0].stations;
        let points: Vec<[f64; 2]> = stations.iter().map(|s| s.recovery[0]).collect();
        assert_eq!(points, [[20.0, 10.0], [20.0, 10.0], [21.0, 11.0]], "{so}");
    }
}

#[test]
fn a_shell_scales_the_thicknesses_that_it_states() {
    let deck = super::read_clean_deck(
        "CQUAD4,1,1,1,2,3,4\n,,,2.,,4.\nCQUAD4,2,1,1,2,3,4\n,,1,2.,2.,2.,2.\nCQUAD4,3,1,1,2,3,4\n",
    );
    let scaled: Vec<_> = deck
        .cards
        .shells
        .iter()
        .map(|s| s.card.with_thickness_times(0.5).map(|s| s.thickness))
        .collect();
    assert_eq!(
        scaled,
        [Some([Some(1.0), None, Some(2.0), None]), None, None]
    );
}
