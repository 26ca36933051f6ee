use super::super::Named;
use super::clean;

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
        "$*  NX PHYSICAL PROPERTY: rail\n",
        "$*  I-DEAS property: 17   name: rail\n",
        "$ Elements and Element Properties for region : rail\n",
        "$ Property: rail\n",
    ];
    for form in forms {
        let deck = clean(&format!("{form}{card}"));
        assert_eq!(deck.label(Named::Property, 5), Some("rail"), "{form}");
        assert_eq!(deck.labels.len(), 1, "{form}");
    }
}

#[test]
fn components_and_materials_have_names_of_their_own() {
    let deck = clean(
        "$HMNAME COMP                  75\"Barre, lang\"\n$HMNAME MAT 1 \"steel\"\n$ Material Record : alu\nMAT1,2,7.+10,,.3\n$ Femap Material 3 : brass\n",
    );
    assert_eq!(deck.label(Named::Component, 75), Some("Barre, lang"));
    assert_eq!(deck.label(Named::Material, 1), Some("steel"));
    assert_eq!(deck.label(Named::Material, 2), Some("alu"));
    assert_eq!(deck.label(Named::Material, 3), Some("brass"));
}

#[test]
fn a_name_before_another_kind_of_card_names_nothing() {
    assert!(
        clean("$*  I-DEAS property: 17   name: MASS\nCONM2,1,2,,1.\nPSHELL,5,1,.1\n")
            .labels
            .is_empty()
    );
}
