use super::*;
use crate::model::{MaterialIx, ShearPanel, Shell, ShellPropertyIx};
use nastran::cards::ShellShape;

#[test]
fn shear_panels_and_grids_in_the_middle_of_sides_are_named() {
    let mut m = Model::default();
    m.shells.push(Shell {
        id: 5,
        shape: ShellShape::Quad8,
        // The sides 3 and 4 have no grid in their middle.
        grids: [0, 1, 2, 3, 4, 5, 2, 3].map(GridIx),
        property: ShellPropertyIx(0),
        material_angle_rad: 0.0,
        zoffs: 0.0,
        thickness: [1.0; 4],
        at: Default::default(),
    });
    m.shear_panels.push(ShearPanel {
        id: 7,
        grids: [2, 3, 8, 9].map(GridIx),
        material: MaterialIx(0),
        t: 1.0,
        nsm: 0.0,
        f1: 0.0,
        f2: 0.0,
        at: Default::default(),
    });
    assert_eq!(what_hangs(&m, GridIx(9)), "CSHEAR 7");
    assert_eq!(what_hangs(&m, GridIx(4)), "CQUAD8 5");
    assert_eq!(what_hangs(&m, GridIx(2)), "CQUAD8 5, CSHEAR 7");
    assert_eq!(what_hangs(&m, GridIx(6)), "no element");
    let grids: Vec<Vec<GridIx>> = m.elements().map(|e| m.element_grids(e)).collect();
    assert_eq!(grids[0], [0, 1, 2, 3, 4, 5].map(GridIx));
    assert_eq!(m.n_elements(), 2);
}
