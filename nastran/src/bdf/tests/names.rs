use super::super::NameOwner;
use super::read_clean_deck;

#[test]
fn comments_of_preprocessors_name_properties() {
    let card = "PSHELL,5,1,.1\n";
    let forms = [
        "$HMNAME PROP                   5\"rail\"\n",
        "$ HMNAME PROP 5 \"rail\"\n",
        "$HMNAME PROP                   5\"rail\" 4\n",
        "$SXNAME PROP    5       PSHELL  \"rail\"\n",
        "$ANSA_NAME_COMMENT;5;PSHELL;rail;;NO;NO;NO;NO;\n",
        "$ANSA_NAME;5;PSHELL;~\n$rail\n",
        "$ Femap Property 5 : rail\n",
        "$ Femap with NX Nastran Property 5 : rail\n",
        "$* Property: rail\n",
        "$* Property Name: rail\n",
        "$*  NX PHYSICAL PROPERTY: rail\n",
        "$*  I-DEAS property: 17   name: rail\n",
        "$ Elements and Element Properties for region : rail\n",
        "$ Property: rail\n",
    ];
    for form in forms {
        let deck = read_clean_deck(&format!("{form}{card}"));
        assert_eq!(deck.label(NameOwner::Property, 5), Some("rail"), "{form}");
        assert_eq!(deck.labels.len(), 1, "{form}");
    }
}

#[test]
fn components_and_materials_have_names_of_their_own() {
    let deck = read_clean_deck(
        "$HMNAME COMP                  75\"Barre, lang\"\n$HMNAME MAT 1 \"steel\"\n$ Material Record : alu\nMAT1,2,7.+10,,.3\n$ Femap Material 3 : brass\n",
    );
    assert_eq!(deck.label(NameOwner::Component, 75), Some("Barre, lang"));
    assert_eq!(deck.label(NameOwner::Material, 1), Some("steel"));
    assert_eq!(deck.label(NameOwner::Material, 2), Some("alu"));
    assert_eq!(deck.label(NameOwner::Material, 3), Some("brass"));
}

#[test]
fn a_name_before_another_kind_of_card_names_nothing() {
    assert!(
        read_clean_deck("$*  I-DEAS property: 17   name: MASS\nCONM2,1,2,,1.\nPSHELL,5,1,.1\n")
            .labels
            .is_empty()
    );
}

/// Returns a shell deck in which a comment above each of three properties names it, with other cards between.
#[test]
fn each_name_belongs_to_the_card_below_it() {
    let forms: [fn(u32) -> String; 5] = [
        |i| format!("$*\n$* Property: rail {i}\nPSHELL,{i},1,.1\n"),
        |i| format!("$*  NX PHYSICAL PROPERTY: rail {i}\n$*\nPCOMP,{i}\n,1,.1,0.\n"),
        |i| {
            format!(
                "$ Elements and Element Properties for region : rail {i}\nPSHELL  {i:<8}1       .1                                              +P{i}\n+P{i}\n$ Pset: \"rail {i}\" will be imported as: \"pshell.{i}\"\nCQUAD4,{i},{i},1,2,3,4\n"
            )
        },
        |i| {
            format!(
                "$ Elements and Element Properties for region : rail {i}\nCQUAD4,{i},{i},1,2,3,4\nPSHELL,{i},1,.1\n"
            )
        },
        |i| format!("$ Femap Property {i} : rail {i}\nPSHELL,{i},1,.1\n"),
    ];
    for form in forms {
        let parts: String = (7..10).map(form).collect();
        let deck = read_clean_deck(&format!(
            "CQUAD4,70,7,1,2,3,4\nGRID,1\n{parts}MAT1,1,1.,,.3\n"
        ));
        let mut names: Vec<(u32, &str)> = deck
            .labels
            .iter()
            .map(|l| (l.id, l.name.as_str()))
            .collect();
        names.sort_unstable();
        let expected = [(7, "rail 7"), (8, "rail 8"), (9, "rail 9")];
        assert_eq!(names, expected, "{}", form(7));
    }
}

#[test]
fn a_component_names_its_property() {
    let deck = read_clean_deck(
        "$HMNAME COMP                   3\"left rail\" 5 \"rail of 8 mm\" 4\nPSHELL,5,1,8.\n",
    );
    let component = deck.labels.iter().find(|l| l.kind == NameOwner::Component);
    assert_eq!(component.map(|l| (l.id, l.property)), Some((3, Some(5))));
    assert_eq!(deck.label(NameOwner::Property, 5), Some("rail of 8 mm"));
}

#[test]
fn a_name_without_its_card_names_no_later_card() {
    let deck = read_clean_deck(
        "$ANSA_NAME;5;PSHELL;~\nPSHELL,5,1,.1\n$ a remark\n$* Property: rail\nCONROD,1,1,2,1,.1\nPSHELL,6,1,.1\n",
    );
    assert!(deck.labels.is_empty(), "{:?}", deck.labels);
}
