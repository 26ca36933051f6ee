//! Section types with cells and more: HAT1 (a hat on a plate) and DBOX (two cells).

use super::area::of_rectangles;
use super::cells::of_cells;
use super::parts::{RECTANGLE_SHEAR, Shape, corners, finish, open_torsion, rectangle};
use super::thin::Wall;

fn wall(from: usize, to: usize, t: f64) -> Wall {
    Wall { from, to, t }
}

/// Computes the section from the width of the plate, the total height, the width of the crown, and the thicknesses of hat and plate. The brims are on
/// the plate and end with it.
pub(super) fn hat_on_plate([w, h, crown, t, plate]: [f64; 5]) -> Option<Shape> {
    if !(w > crown && crown > 2.0 * t && h > plate + t) {
        return None;
    }
    let (half, wide) = (crown / 2.0, w / 2.0);
    let a = of_rectangles(&[
        rectangle([0.0, plate], [-wide, wide]),
        rectangle([plate, plate + t], [-wide, -half]),
        rectangle([plate, plate + t], [half, wide]),
        rectangle([plate, h - t], [-half, -half + t]),
        rectangle([plate, h - t], [half - t, half]),
        rectangle([h - t, h], [-half, half]),
    ]);
    // Brim and plate together are one wall of both thicknesses. The plate is the lower wall of the cell.
    let (y0, y1, z) = (plate / 2.0, h - t / 2.0, half - t / 2.0);
    let both = t + plate;
    let cells = of_cells(
        &[
            [y0, -wide],
            [y0, -z],
            [y1, -z],
            [y1, z],
            [y0, z],
            [y0, wide],
        ],
        &[
            wall(0, 1, both),
            wall(1, 2, t),
            wall(2, 3, t),
            wall(3, 4, t),
            wall(4, 5, both),
            wall(1, 4, plate),
        ],
    )?;
    let j = cells.torsion + open_torsion(&[(2.0 * (wide - half), both)]);
    let k = [
        2.0 * (y1 - y0) * t / a.area,
        RECTANGLE_SHEAR * (w * plate + (w - crown) * t + crown * t) / a.area,
    ];
    finish(
        a,
        cells.centre,
        j,
        k,
        [[h, half], [0.0, wide], [0.0, -wide], [h, -half]],
    )
}

/// Returns the double box with the dimensions `d`. These are width, height and the distance of the midline of the middle wall from the left side.
/// Then follow the thicknesses of the left, middle and right wall, and of the top left, bottom left, top right and bottom right wall.
pub(super) fn double_box(d: [f64; 10]) -> Option<Shape> {
    let [
        w,
        h,
        middle,
        left,
        web,
        right,
        top_l,
        bottom_l,
        top_r,
        bottom_r,
    ] = d;
    let (inner_l, inner_r) = (middle - web / 2.0, middle + web / 2.0);
    let fits = inner_l > left && w - right > inner_r;
    if !(fits && h > top_l + bottom_l && h > top_r + bottom_r) {
        return None;
    }
    let a = of_rectangles(&[
        rectangle([0.0, h], [0.0, left]),
        rectangle([0.0, h], [inner_l, inner_r]),
        rectangle([0.0, h], [w - right, w]),
        rectangle([h - top_l, h], [left, inner_l]),
        rectangle([0.0, bottom_l], [left, inner_l]),
        rectangle([h - top_r, h], [inner_r, w - right]),
        rectangle([0.0, bottom_r], [inner_r, w - right]),
    ]);
    let (z0, z2) = (left / 2.0, w - right / 2.0);
    let mean = |l: f64, r: f64| (l + r) / 2.0;
    let (y_l, y_r) = (
        [bottom_l / 2.0, h - top_l / 2.0],
        [bottom_r / 2.0, h - top_r / 2.0],
    );
    let y_m = [mean(y_l[0], y_r[0]), mean(y_l[1], y_r[1])];
    let cells = of_cells(
        &[
            [y_l[0], z0],
            [y_l[1], z0],
            [y_m[0], middle],
            [y_m[1], middle],
            [y_r[0], z2],
            [y_r[1], z2],
        ],
        &[
            wall(0, 1, left),
            wall(2, 3, web),
            wall(4, 5, right),
            wall(1, 3, top_l),
            wall(0, 2, bottom_l),
            wall(3, 5, top_r),
            wall(2, 4, bottom_r),
        ],
    )?;
    let upright = (y_l[1] - y_l[0]) * left + (y_m[1] - y_m[0]) * web + (y_r[1] - y_r[0]) * right;
    let lying = (middle - z0) * (top_l + bottom_l) + (z2 - middle) * (top_r + bottom_r);
    let k = [upright / a.area, lying / a.area];
    finish(
        a,
        cells.centre,
        cells.torsion,
        k,
        corners([0.0, h], [0.0, w]),
    )
}
