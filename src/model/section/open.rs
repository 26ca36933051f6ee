//! Section types of open walls: I, CHAN, T, L, H, Z, HAT and their kin.

use super::area::of_rectangles;
use super::parts::{RECTANGLE_SHEAR, Shape, corners, finish, open_torsion, rectangle};
use super::thin::{Wall, open_walls};

/// Computes an I section from height, width of bottom and top flange, and thickness of web, bottom and top flange.
pub(super) fn i_section(
    h: f64,
    bottom_w: f64,
    top_w: f64,
    web: f64,
    bottom_t: f64,
    top_t: f64,
) -> Option<Shape> {
    if !(h > bottom_t + top_t && bottom_w > web && top_w > web && bottom_t > 0.0) {
        return None;
    }
    let across = |w: f64| [-w / 2.0, w / 2.0];
    let a = of_rectangles(&[
        rectangle([0.0, bottom_t], across(bottom_w)),
        rectangle([bottom_t, h - top_t], across(web)),
        rectangle([h - top_t, h], across(top_w)),
    ]);
    let (y0, y1) = (bottom_t / 2.0, h - top_t / 2.0);
    let points = [
        [y0, 0.0],
        [y1, 0.0],
        [y0, bottom_w / 2.0],
        [y0, -bottom_w / 2.0],
        [y1, top_w / 2.0],
        [y1, -top_w / 2.0],
    ];
    let wall = |from, to, t| Wall { from, to, t };
    let walls = [
        wall(0, 1, web),
        wall(0, 2, bottom_t),
        wall(0, 3, bottom_t),
        wall(1, 4, top_t),
        wall(1, 5, top_t),
    ];
    let (centre, cw) = open_walls(&points, &walls)?;
    let j = open_torsion(&[(bottom_w, bottom_t), (top_w, top_t), (y1 - y0, web)]);
    let flanges = bottom_w * bottom_t + top_w * top_t;
    let k = [
        (a.area - flanges) / a.area,
        RECTANGLE_SHEAR * flanges / a.area,
    ];
    let recovery = [
        [h, top_w / 2.0],
        [0.0, bottom_w / 2.0],
        [0.0, -bottom_w / 2.0],
        [h, -top_w / 2.0],
    ];
    finish(a, centre, j, k, recovery).map(|s| s.with_warping(cw))
}

/// Computes a channel with the web on the left and flanges to the right, from width, height, and thickness of web and flanges.
pub(super) fn channel(w: f64, h: f64, web: f64, flange: f64) -> Option<Shape> {
    if !(h > 2.0 * flange && w > web && flange > 0.0) {
        return None;
    }
    let a = of_rectangles(&[
        rectangle([0.0, h], [0.0, web]),
        rectangle([0.0, flange], [web, w]),
        rectangle([h - flange, h], [web, w]),
    ]);
    let (y0, y1, z0) = (flange / 2.0, h - flange / 2.0, web / 2.0);
    let (centre, cw) = open_walls(
        &[[y0, w], [y0, z0], [y1, z0], [y1, w]],
        &[
            Wall {
                from: 0,
                to: 1,
                t: flange,
            },
            Wall {
                from: 1,
                to: 2,
                t: web,
            },
            Wall {
                from: 2,
                to: 3,
                t: flange,
            },
        ],
    )?;
    let j = open_torsion(&[(w - z0, flange), (w - z0, flange), (y1 - y0, web)]);
    let k = [
        (y1 - y0) * web / a.area,
        RECTANGLE_SHEAR * 2.0 * w * flange / a.area,
    ];
    finish(a, centre, j, k, corners([0.0, h], [0.0, w])).map(|s| s.with_warping(cw))
}

/// Computes a channel with the web at the bottom and legs up, from thickness of legs and web, height and width.
pub(super) fn channel2(leg: f64, web: f64, h: f64, w: f64) -> Option<Shape> {
    if !(w > 2.0 * leg && h > web) {
        return None;
    }
    let half = w / 2.0;
    let a = of_rectangles(&[
        rectangle([0.0, web], [-half, half]),
        rectangle([web, h], [-half, -half + leg]),
        rectangle([web, h], [half - leg, half]),
    ]);
    let (y0, z1) = (web / 2.0, half - leg / 2.0);
    let (centre, cw) = open_walls(
        &[[h, -z1], [y0, -z1], [y0, z1], [h, z1]],
        &[
            Wall {
                from: 0,
                to: 1,
                t: leg,
            },
            Wall {
                from: 1,
                to: 2,
                t: web,
            },
            Wall {
                from: 2,
                to: 3,
                t: leg,
            },
        ],
    )?;
    let j = open_torsion(&[(h - y0, leg), (h - y0, leg), (2.0 * z1, web)]);
    let k = [
        RECTANGLE_SHEAR * 2.0 * h * leg / a.area,
        2.0 * z1 * web / a.area,
    ];
    finish(a, centre, j, k, corners([0.0, h], [-half, half])).map(|s| s.with_warping(cw))
}

/// Computes a T with the flange on top, from width, height, and thickness of flange and web. C top middle, D right end of the flange, E foot, F left
/// end.
pub(super) fn tee(w: f64, h: f64, flange: f64, web: f64) -> Option<Shape> {
    if !(h > flange && w > web) {
        return None;
    }
    let a = of_rectangles(&[
        rectangle([0.0, h - flange], [-web / 2.0, web / 2.0]),
        rectangle([h - flange, h], [-w / 2.0, w / 2.0]),
    ]);
    let centre = [h - flange / 2.0, 0.0];
    let j = open_torsion(&[(w, flange), (h - flange / 2.0, web)]);
    let k = [
        (h - flange / 2.0) * web / a.area,
        RECTANGLE_SHEAR * w * flange / a.area,
    ];
    finish(
        a,
        centre,
        j,
        k,
        [[h, 0.0], [h, w / 2.0], [0.0, 0.0], [h, -w / 2.0]],
    )
}

/// Computes a T with a vertical flange on the right and the web to the left. The arguments are the height of the flange, the length of the web, and
/// the thickness of flange and web.
pub(super) fn tee1(h: f64, reach: f64, flange: f64, web: f64) -> Option<Shape> {
    if !(h > web) {
        return None;
    }
    let a = of_rectangles(&[
        rectangle([-web / 2.0, web / 2.0], [0.0, reach]),
        rectangle([-h / 2.0, h / 2.0], [reach, reach + flange]),
    ]);
    let centre = [0.0, reach + flange / 2.0];
    let j = open_torsion(&[(h, flange), (reach + flange / 2.0, web)]);
    let k = [
        RECTANGLE_SHEAR * h * flange / a.area,
        (reach + flange / 2.0) * web / a.area,
    ];
    let right = reach + flange;
    finish(
        a,
        centre,
        j,
        k,
        [
            [0.0, right],
            [-h / 2.0, right],
            [0.0, 0.0],
            [h / 2.0, right],
        ],
    )
}

/// Computes a T with the flange at the bottom, from width, height, and thickness of flange and web.
pub(super) fn tee2(w: f64, h: f64, flange: f64, web: f64) -> Option<Shape> {
    if !(h > flange && w > web) {
        return None;
    }
    let a = of_rectangles(&[
        rectangle([flange, h], [-web / 2.0, web / 2.0]),
        rectangle([0.0, flange], [-w / 2.0, w / 2.0]),
    ]);
    let centre = [flange / 2.0, 0.0];
    let j = open_torsion(&[(w, flange), (h - flange / 2.0, web)]);
    let k = [
        (h - flange / 2.0) * web / a.area,
        RECTANGLE_SHEAR * w * flange / a.area,
    ];
    finish(
        a,
        centre,
        j,
        k,
        [
            [h, web / 2.0],
            [0.0, w / 2.0],
            [0.0, -w / 2.0],
            [h, -web / 2.0],
        ],
    )
}

/// Computes an angle with the corner at the lower left, from width, height, and thickness of the horizontal and of the vertical leg.
pub(super) fn angle(w: f64, h: f64, lying: f64, standing: f64) -> Option<Shape> {
    if !(w > standing && h > lying) {
        return None;
    }
    let a = of_rectangles(&[
        rectangle([0.0, h], [0.0, standing]),
        rectangle([0.0, lying], [standing, w]),
    ]);
    let centre = [lying / 2.0, standing / 2.0];
    let (long_y, long_z) = (h - lying / 2.0, w - standing / 2.0);
    let j = open_torsion(&[(long_y, standing), (long_z, lying)]);
    let k = [
        RECTANGLE_SHEAR * h * standing / a.area,
        RECTANGLE_SHEAR * w * lying / a.area,
    ];
    finish(
        a,
        centre,
        j,
        k,
        [[h, standing], [0.0, w], [0.0, 0.0], [h, 0.0]],
    )
}

/// Computes an H of two vertical flanges and a horizontal web, from inner width, thickness of a flange, height, and thickness of the web.
pub(super) fn h_section(inner: f64, flange: f64, h: f64, web: f64) -> Option<Shape> {
    if !(h > web) {
        return None;
    }
    let (half, y) = (inner / 2.0, [-h / 2.0, h / 2.0]);
    let a = of_rectangles(&[
        rectangle(y, [-half - flange, -half]),
        rectangle(y, [half, half + flange]),
        rectangle([-web / 2.0, web / 2.0], [-half, half]),
    ]);
    let j = open_torsion(&[(h, flange), (h, flange), (inner + flange, web)]);
    let k = [
        RECTANGLE_SHEAR * 2.0 * h * flange / a.area,
        inner * web / a.area,
    ];
    // Warping of two flanges that bend in opposite directions.
    let cw = flange * h.powi(3) * (inner + flange).powi(2) / 24.0;
    finish(
        a,
        [0.0; 2],
        j,
        k,
        corners(y, [-half - flange, half + flange]),
    )
    .map(|s| s.with_warping(cw))
}

/// Computes a Z with the top flange to the left and the bottom flange to the right. The arguments are the free width of a flange, the thickness of
/// the web, and the inner and outer height.
pub(super) fn z_section(free: f64, web: f64, inner: f64, h: f64) -> Option<Shape> {
    let t = (h - inner) / 2.0;
    if !(t > 0.0) {
        return None;
    }
    let (top, half) = (h / 2.0, web / 2.0);
    let a = of_rectangles(&[
        rectangle([-inner / 2.0, inner / 2.0], [-half, half]),
        rectangle([inner / 2.0, top], [-half - free, half]),
        rectangle([-top, -inner / 2.0], [-half, half + free]),
    ]);
    let (y, wall) = (top - t / 2.0, |from, t| Wall {
        from,
        to: from + 1,
        t,
    });
    let (_, cw) = open_walls(
        &[[y, -half - free], [y, 0.0], [-y, 0.0], [-y, half + free]],
        &[wall(0, t), wall(1, web), wall(2, t)],
    )?;
    let j = open_torsion(&[(free + half, t), (free + half, t), (h - t, web)]);
    let flanges = 2.0 * (free + web) * t;
    let k = [
        (a.area - flanges) / a.area,
        RECTANGLE_SHEAR * flanges / a.area,
    ];
    finish(
        a,
        [0.0; 2],
        j,
        k,
        [
            [top, half],
            [-top, half + free],
            [-top, -half],
            [top, -half - free],
        ],
    )
    .map(|s| s.with_warping(cw))
}

/// Computes a hat with the crown on top and brims at the bottom. The arguments are the height, the wall thickness, and the widths of crown and brim.
pub(super) fn hat(h: f64, t: f64, crown: f64, brim: f64) -> Option<Shape> {
    if !(h > 2.0 * t && crown > 2.0 * t) {
        return None;
    }
    let (half, wide) = (crown / 2.0, crown / 2.0 + brim);
    let a = of_rectangles(&[
        rectangle([h - t, h], [-half + t, half - t]),
        rectangle([0.0, h], [-half, -half + t]),
        rectangle([0.0, h], [half - t, half]),
        rectangle([0.0, t], [-wide, -half]),
        rectangle([0.0, t], [half, wide]),
    ]);
    let (y0, y1, z) = (t / 2.0, h - t / 2.0, half - t / 2.0);
    let wall = |from| Wall {
        from,
        to: from + 1,
        t,
    };
    let (centre, cw) = open_walls(
        &[
            [y0, -wide],
            [y0, -z],
            [y1, -z],
            [y1, z],
            [y0, z],
            [y0, wide],
        ],
        &[wall(0), wall(1), wall(2), wall(3), wall(4)],
    )?;
    let j = open_torsion(&[(2.0 * (wide - z) + 2.0 * (y1 - y0) + 2.0 * z, t)]);
    let k = [
        2.0 * (y1 - y0) * t / a.area,
        RECTANGLE_SHEAR * (crown + 2.0 * brim) * t / a.area,
    ];
    finish(
        a,
        centre,
        j,
        k,
        [[h, half], [0.0, wide], [0.0, -wide], [h, -half]],
    )
    .map(|s| s.with_warping(cw))
}
