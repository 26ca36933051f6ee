use super::*;
use crate::model::{Grid, GridIx, PointKind, SpcSet, Vec3};
use nastran::cards::Dofs;
use nastran::place::Place;

fn model(selected: &[u32]) -> Model {
    let mut m = Model::default();
    m.grids.push(Grid {
        id: 7,
        kind: PointKind::Grid,
        x: Vec3::zeros(),
        cd: crate::model::FrameIx(0),
        ps: Dofs(0),
        at: Place::default(),
    });
    let x = Dofs::from_digits(1).unwrap();
    m.spcs = vec![
        SpcSet {
            sid: 1,
            terms: vec![(GridIx(0), x, 0.0), (GridIx(0), x, 0.0)],
        },
        SpcSet {
            sid: 2,
            terms: vec![(GridIx(0), x, 1.0), (GridIx(0), x, 2.0)],
        },
    ];
    m.selected_spcs = selected.to_vec();
    m
}

#[test]
fn the_decks_own_set_holds_unless_the_job_states_free_or_names_another() {
    let held = |set| {
        Ok(Support {
            spc: Some(set),
            relief: Relief::None,
            by_springs: 0,
        })
    };
    assert_eq!(support_of(&model(&[1]), SupportChoice::Deck), held(1));
    assert_eq!(
        support_of(&model(&[]), SupportChoice::Deck),
        Ok(Support::without_spc(&model(&[])))
    );
    assert_eq!(
        support_of(&model(&[1]), SupportChoice::Free),
        Ok(Support::without_spc(&model(&[])))
    );
    assert_eq!(support_of(&model(&[1]), SupportChoice::Set(2)), held(2));
}

#[test]
fn sets_that_are_not_there_or_not_one_are_refused_by_number() {
    let missing = support_of(&model(&[]), SupportChoice::Set(9)).unwrap_err();
    assert!(missing.to_string().contains('9') && missing.to_string().contains("1, 2"));
    let several = support_of(&model(&[1, 2]), SupportChoice::Deck).unwrap_err();
    assert_eq!(several, SupportError::Several { sets: vec![1, 2] });
}

#[test]
fn a_dof_held_at_two_values_is_an_error_and_held_twice_at_one_value_is_none() {
    assert!(contradictions(&model(&[]), Some(1)).is_none());
    let finding = contradictions(&model(&[]), Some(2)).unwrap();
    assert_eq!(
        (finding.severity, finding.code),
        (Severity::Error, "contradicting-spc")
    );
    assert!(finding.message.contains("grid 7 dof 1: 1 and 2"));
}
