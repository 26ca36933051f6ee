//! Cards and statements that the solver does not carry. They are refused before anything is solved.

use super::UnitLoad;
use super::element::shell::{Lamination, normals_beyond};
use super::error::{FeError, Refusal};
use super::load_case::LoadCase;
use crate::model::{Load, MaterialKind, Model, ShellKind};
use nastran::place::Place;

/// Faults that one refusal names.
const MOST: usize = 200;

/// Refuses a model and load cases with entries that the answer would leave out.
///
/// # Errors
/// Everything that the solver does not carry.
pub fn refuse(model: &Model, cases: &[LoadCase]) -> Result<(), FeError> {
    let mut refused = unsupported_cards(model, cases);
    refused.truncate(MOST);
    match refused.is_empty() {
        true => Ok(()),
        false => Err(FeError::Refused(refused)),
    }
}

/// Returns every entry of the model or of the loads that the answer would leave out.
pub(crate) fn unsupported_cards(model: &Model, cases: &[LoadCase]) -> Vec<Refusal> {
    let mut all = Vec::new();
    let mut refuse = |card: String, at: Place, reason: &str, remedy: &str| {
        all.push(Refusal::new(card, at, reason, remedy));
    };
    const ELSEWHERE: &str = "solve with Nastran and name its results in the job";
    for p in &model.shell_properties {
        let used = || {
            model
                .shells
                .iter()
                .any(|s| model.shell_properties[s.property.us()].id == p.id)
        };
        match &p.kind {
            ShellKind::Laminate { lam, .. } if used() && Lamination::parse_lam(lam).is_none() => {
                refuse(
                    format!("PCOMP {}", p.id),
                    p.at,
                    "LAM must be blank, SYM, MEM, BEND or SMEAR",
                    ELSEWHERE,
                );
            }
            ShellKind::Homogeneous {
                membrane,
                bending,
                shear,
                coupling,
                ..
            } => {
                for m in [membrane, bending, shear, coupling].into_iter().flatten() {
                    let material = &model.materials[m.us()];
                    if matches!(material.kind, MaterialKind::Anisotropic3d { .. }) {
                        refuse(
                            format!("MAT9 {}", material.id),
                            material.at,
                            "a PSHELL needs a plane-stress law",
                            "use MAT1, MAT2 or MAT8",
                        );
                    }
                }
            }
            ShellKind::Laminate { .. } => {}
        }
    }
    for p in &model.solid_properties {
        if (p.options[3].as_deref()).is_some_and(|w| w.starts_with("PFLU")) {
            refuse(
                format!("PSOLID {}", p.id),
                p.at,
                "the built-in solver has no fluid elements",
                ELSEWHERE,
            );
        }
    }
    for c in &model.unsupported_cards {
        let id = c.id.map_or(String::new(), |id| format!(" {id}"));
        refuse(
            format!("{}{id}", c.card),
            c.at,
            "the built-in solver does not support it, and it affects the answer",
            "delete it if it does not matter here, or solve with Nastran and name its results in the job",
        );
    }
    for case in cases {
        for load in &case.loads {
            let (sid, thermal) = match load {
                UnitLoad::Set(sid) => (sid, false),
                UnitLoad::Temperature { set, .. } => (set, true),
                UnitLoad::AtGrid { .. } => continue,
            };
            let temperatures = model
                .temperatures
                .iter()
                .filter(|t| thermal && t.sid == *sid);
            for (card, at) in temperatures.flat_map(|t| &t.unsupported) {
                refuse(
                    format!("{card} {sid}"),
                    *at,
                    "the built-in solver does not support it",
                    "give only means and gradients, or solve with Nastran",
                );
            }
            for set in model.load_sets.iter().filter(|s| s.sid == *sid) {
                for (_, load) in &set.loads {
                    if let Load::Unsupported(card, at) = load
                        && thermal == card.starts_with("TEMP")
                    {
                        refuse(
                            format!("{card} {sid}"),
                            *at,
                            "the built-in solver does not support this load",
                            "replace it by FORCE, MOMENT, PLOAD4 or GRAV, or solve with Nastran",
                        );
                    }
                }
            }
        }
    }
    all.extend(normals_and_rigids(model, cases));
    all
}

/// Normals of SNORM and expanding rigid elements that the solver does not carry.
fn normals_and_rigids(model: &Model, cases: &[LoadCase]) -> Vec<Refusal> {
    let mut all = Vec::new();
    let mut refuse = |card: String, at: Place, reason: &str, remedy: &str| {
        all.push(Refusal::new(card, at, reason, remedy));
    };
    for n in normals_beyond(model) {
        let id = model.grids.get(n.grid.us()).map_or(0, |g| g.id);
        refuse(
            format!("SNORM {id}"),
            n.at,
            "the normal differs from the normal of a shell at the grid by more than PARAM,SNORM",
            "state a normal closer to the normals of the shells, or increase PARAM,SNORM",
        );
    }
    let heated = |c: &LoadCase| {
        let mut loads = c.loads.iter();
        loads.any(|l| matches!(l, UnitLoad::Temperature { .. }))
    };
    if model.params.expanding_rigids && cases.iter().any(heated) {
        for r in model.rigids.iter().filter(|r| r.kind.alpha() != 0.0) {
            refuse(
                format!("{} {}", r.kind.card(), r.id),
                r.at,
                "the built-in solver does not support ALPHA of rigid elements, which RIGID = LAGRAN or LGELIM asks for",
                "replace the rigid element by a stiff bar of that ALPHA, or solve with Nastran and name its results in the job",
            );
        }
    }
    all
}
