//! Elements that are solved as another element than their card, or in one of the states that their card allows.

use crate::finding::{Finding, Severity, list_few};
use crate::model::{Joint, JointCard, Model, RigidElement, RigidKind};
use nastran::cards::ShellShape;

/// Returns findings on elements that the solver computes with another formulation than Nastran.
pub(super) fn formulations(model: &Model) -> Vec<Finding> {
    let groups: [(&[ShellShape], &str, &str); 2] = [
        (
            &[ShellShape::QuadR, ShellShape::TriaR],
            "CQUADR, CTRIAR",
            "solved as CQUAD4 and CTRIA3 whose sides bend with the rotation about the normal (Allman 1984)",
        ),
        (
            &[ShellShape::Quad8, ShellShape::Tria6],
            "CQUAD8, CTRIA6",
            "solved as one quadrilateral at each corner around a point in the middle, on the curved surface through the grids",
        ),
    ];
    let mut all: Vec<Finding> = groups
        .into_iter()
        .filter_map(|(shapes, cards, what)| {
            let n = model.shells.iter().filter(|s| shapes.contains(&s.shape)).count();
            (n > 0).then(|| {
                Finding::new(
                    Severity::Info,
                    "formulation",
                    cards,
                    format!("{n} elements: {what}"),
                    "nothing for meshes of several elements on a side; solve with Nastran if single elements determine the answer",
                )
            })
        })
        .collect();
    all.extend(connectors(model));
    all.extend(halved_diameters(model));
    all.extend(connectors_at_an_angle(model));
    all.extend(gaps(model));
    all.extend(warping_beams(model));
    all.extend(idle_warping_points(model));
    all.extend(bushes_in_the_basic_frame(model));
    all.extend(ground_of_rigid_bushes(model));
    all
}

/// CWELD and CFAST: how they are tied.
fn connectors(model: &Model) -> Option<Finding> {
    let on_patches = |j: &&Joint| matches!(j.card, JointCard::Cweld | JointCard::Cfast);
    let n = model.joints.iter().filter(on_patches).count();
    (n > 0).then(|| {
        Finding::new(
            Severity::Info,
            "formulation",
            "CWELD, CFAST",
            format!(
                "{n} connectors are solved as six springs at the middle between two points. Each point follows the translations of its \
                 patch, by the slopes of its shape functions or by four auxiliary points"
            ),
            "nothing; a gauge within a few diameters of a connector reads the local strain of the connection",
        )
    })
}

/// Connectors whose diameter is wider than their patch.
fn halved_diameters(model: &Model) -> Option<Finding> {
    let halved = model.joints.iter().filter(|j| j.placed.halvings > 0);
    let ids: Vec<u32> = halved.clone().map(|j| j.id).collect();
    let most = halved.map(|j| j.placed.halvings).max()?;
    Some(
        Finding::new(
            Severity::Warning,
            "connector-halved",
            format!("CWELD, CFAST {}", list_few(&ids)),
            format!(
                "{} connectors are wider than their patch: the square of their auxiliary points has a diameter halved up to {most} times",
                ids.len()
            ),
            "give a diameter within the patch, or name more shells; the sheet around is less stiff than with the true diameter",
        )
        .with_numbers(f64::from(most), 0.0),
    )
}

/// Angle between two sheets, degrees, beyond which Nastran makes no connector (default of GSPROJ on SWLDPRM).
const GSPROJ_DEG: f64 = 20.0;

/// Connectors between sheets at an angle to each other.
fn connectors_at_an_angle(model: &Model) -> Option<Finding> {
    let tilted = model
        .joints
        .iter()
        .filter(|j| j.placed.angle_deg > GSPROJ_DEG);
    let ids: Vec<u32> = tilted.clone().map(|j| j.id).collect();
    let largest = tilted.map(|j| j.placed.angle_deg).max_by(f64::total_cmp)?;
    Some(
        Finding::new(
            Severity::Warning,
            "connector-angle",
            format!("CWELD, CFAST {}", list_few(&ids)),
            format!(
                "{} connectors join sheets at up to {largest:.0} degrees to each other; Nastran makes none beyond {GSPROJ_DEG:.0} (GSPROJ of SWLDPRM)",
                ids.len()
            ),
            "check the shells or properties of these connectors: a connector joins sheets that overlap",
        )
        .with_numbers(largest, GSPROJ_DEG),
    )
}

/// CBEAMs with warping points: what their strain leaves out.
fn warping_beams(model: &Model) -> Option<Finding> {
    let n = model.beams.iter().filter(|b| b.warping.is_some()).count();
    (n > 0).then(|| {
        Finding::new(
            Severity::Info,
            "formulation",
            "CBEAM",
            format!(
                "{n} beams twist with warping (Vlasov); their strain at C, D, E, F is the strain of axial force and bending, without the bimoment"
            ),
            "model the rail by shells if a gauge is on the edge of a flange near a restraint of its warping",
        )
    })
}

/// CBEAMs with SA and SB whose property has no CW.
fn idle_warping_points(model: &Model) -> Option<Finding> {
    let idle = model.beams.iter().filter(|b| b.idle_points);
    let ids: Vec<u32> = idle.map(|b| b.id).collect();
    (!ids.is_empty()).then(|| {
        Finding::new(
            Severity::Info,
            "formulation",
            format!("CBEAM {}", list_few(&ids)),
            format!(
                "{} beams state SA and SB, and their property has no warping constant: they twist without warping (Saint-Venant)",
                ids.len()
            ),
            "give CW(A) and CW(B) on PBEAM if warping matters",
        )
    })
}

/// Returns whether the two forces of a CGAP leave a moment, because a stiffness acts in a direction off the line between its grids.
pub(super) fn gap_leaves_moment(j: &Joint) -> bool {
    /// Sine of an angle that only the rounding of coordinates gives.
    const ROUNDING: f64 = 1e-9;
    let [a, b] = &j.ends;
    let line = b.x - a.x;
    let off = |i: usize| {
        let along = j.axes.row(i).transpose() * j.k[i];
        line.cross(&along).norm() > ROUNDING * line.norm() * j.k[i].abs()
    };
    matches!(j.card, JointCard::Cgap { .. }) && (0..3).any(off)
}

/// CGAP: which are carried as closed, which as open.
fn gaps(model: &Model) -> Option<Finding> {
    let mut closed = Vec::new();
    let mut open = Vec::new();
    let mut preloaded = 0;
    let mut unbalanced = Vec::new();
    for j in &model.joints {
        if let JointCard::Cgap { open: is, preload } = j.card {
            if is { &mut open } else { &mut closed }.push(j.id);
            preloaded += usize::from(preload != 0.0);
            if gap_leaves_moment(j) {
                unbalanced.push(j.id);
            }
        }
    }
    let n = closed.len() + open.len();
    (n > 0).then(|| {
        let preload = if preloaded > 0 {
            format!("; the preload of {preloaded} has no effect in a linear solution")
        } else {
            String::new()
        };
        let friction = if unbalanced.is_empty() {
            String::new()
        } else {
            format!(
                "; the forces of {} ({}) are not along the line between their grids, and their moment is not balanced. KT acts across this \
                 line, KA along a CID off the line",
                unbalanced.len(),
                list_few(&unbalanced)
            )
        };
        Finding::new(
            Severity::Warning,
            "gap-linear",
            "CGAP",
            format!(
                "{n} gaps remain in their initial state under every load: {} closed ({}), {} open ({}){preload}{friction}",
                closed.len(),
                list_few(&closed),
                open.len(),
                list_few(&open),
            ),
            "check that each gap remains in this state under the loads of the job: a closed one must be in compression; else solve with \
             Nastran, nonlinear",
        )
        .with_numbers(n as f64, 0.0)
    })
}

/// Bushes without axes of their own whose stiffness differs by direction.
fn bushes_in_the_basic_frame(model: &Model) -> Option<Finding> {
    let ids: Vec<u32> = model
        .bushes
        .iter()
        .filter(|b| b.frame_assumed)
        .map(|b| b.id)
        .collect();
    of_bushes(
        &ids,
        "bush-frame-assumed",
        "join coincident grids, or a grid and ground, without CID, and their stiffness differs by direction: the basic frame is used",
        "state CID (0 for the basic frame)",
    )
}

/// Rigid bushes to ground that tie dofs of their grid to each other: their force is on no single dof.
fn ground_of_rigid_bushes(model: &Model) -> Option<Finding> {
    let ids: Vec<u32> = model
        .rigids
        .iter()
        .filter(|r| held_off_axes(r))
        .map(|r| r.id)
        .collect();
    of_bushes(
        &ids,
        "bush-reaction-missing",
        "hold their grid rigidly to ground in directions other than its displacement frame: their force is not among the reactions",
        "give the grid a CD along the axes of the bush, or a stiff spring instead of RIGID, if reactions matter",
    )
}

/// Returns whether a rigid element connects dofs of one grid with each other, and through them with ground.
pub(super) fn held_off_axes(r: &RigidElement) -> bool {
    match &r.kind {
        RigidKind::Equations { equations, .. } => equations.iter().any(|terms| {
            let grid = terms.first().map(|t| t.0);
            terms.len() > 1 && terms.iter().all(|t| Some(t.0) == grid)
        }),
        RigidKind::Body { .. } | RigidKind::Mean { .. } => false,
    }
}

/// A warning about bushes, if there are any.
fn of_bushes(ids: &[u32], code: &'static str, what: &str, remedy: &'static str) -> Option<Finding> {
    (!ids.is_empty()).then(|| {
        Finding::new(
            Severity::Warning,
            code,
            format!("CBUSH {}", list_few(ids)),
            format!("{} bushes {what}", ids.len()),
            remedy,
        )
        .with_numbers(ids.len() as f64, 0.0)
    })
}
