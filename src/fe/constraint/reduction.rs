//! All constraints of a load case together: which dofs are free, which are held, which follow others.

use super::relation::{Claim, Relation};
use super::{body, mean};
use crate::fe::error::{FeError, Refusal};
use crate::model::{GridIx, Mat3, Model, RigidKind};
use nastran::cards::Dofs;
use std::collections::HashMap;

/// SPC set, MPC set, and enforced displacements by SPCD, which replace the values of the SPC set.
pub(crate) type Sets<'a> = (Option<u32>, Option<u32>, &'a [(GridIx, Dofs, f64)]);

/// State of a dof in the reduction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum State {
    /// An unknown.
    #[default]
    Free,
    /// Held at zero or at an enforced value.
    Held,
    /// Dependent: given by a row of other dofs.
    Dependent(u32),
}

/// Equation of a dependent dof: the displacement as a sum over free, held and enforced dofs.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Row {
    /// Free dofs and their coefficients.
    pub(crate) free: Vec<(u32, f64)>,
    /// Held dofs with their coefficients, through which the force at this dof acts on supports.
    pub(crate) held: Vec<(u32, f64)>,
    /// Displacement of the dof by enforced dofs.
    pub(crate) constant: f64,
}

/// u = T q + u0 over all dofs, numbered 6 * grid index + (0 to 5), displacement frames.
#[derive(Clone, Debug, Default)]
pub(crate) struct Reduction {
    pub(crate) state: Vec<State>,
    /// Rows of dependent dofs.
    pub(crate) rows: Vec<Row>,
    /// Enforced displacements that are not zero.
    pub(crate) enforced: HashMap<u32, f64>,
}

impl Reduction {
    /// Returns the displacements `u` from `q`, both over all dofs. Only entries of `q` at free dofs are used.
    pub(crate) fn expand(&self, q: &[[f64; 6]]) -> Vec<[f64; 6]> {
        let value = |dof: u32| q[(dof / 6) as usize][(dof % 6) as usize];
        let one = |dof: usize| match self.state[dof] {
            State::Free => value(dof as u32),
            State::Held => self.enforced.get(&(dof as u32)).copied().unwrap_or(0.0),
            State::Dependent(r) => {
                let row = &self.rows[r as usize];
                row.constant + row.free.iter().map(|(d, c)| c * value(*d)).sum::<f64>()
            }
        };
        (0..q.len())
            .map(|g| std::array::from_fn(|i| one(6 * g + i)))
            .collect()
    }

    /// Returns `T' f`: forces at dependent dofs are transferred to free dofs. Entries of held and dependent dofs are then zero.
    pub(crate) fn gather(&self, mut f: Vec<[f64; 6]>) -> Vec<[f64; 6]> {
        for (dof, state) in self.state.iter().enumerate() {
            if *state == State::Held {
                f[dof / 6][dof % 6] = 0.0;
            }
        }
        for (dof, state) in self.state.iter().enumerate() {
            if let State::Dependent(r) = state {
                let v = std::mem::replace(&mut f[dof / 6][dof % 6], 0.0);
                if v != 0.0 {
                    for (d, c) in &self.rows[*r as usize].free {
                        f[(*d / 6) as usize][(*d % 6) as usize] += c * v;
                    }
                }
            }
        }
        f
    }
}

impl Reduction {
    /// Returns the forces at held dofs: forces that act there, and forces that dependent dofs transfer there. Other entries are zero.
    pub(crate) fn onto_held(&self, f: &[[f64; 6]]) -> Vec<[f64; 6]> {
        let mut out = vec![[0.0; 6]; f.len()];
        for (dof, state) in self.state.iter().enumerate() {
            let v = f[dof / 6][dof % 6];
            match state {
                State::Free => {}
                State::Held => out[dof / 6][dof % 6] += v,
                State::Dependent(r) => {
                    for (d, c) in &self.rows[*r as usize].held {
                        out[(*d / 6) as usize][(*d % 6) as usize] += c * v;
                    }
                }
            }
        }
        out
    }

    /// Sets the displacements that SPC and SPCD enforce to zero.
    pub(crate) fn forget_enforced(&mut self) {
        self.enforced.clear();
        self.rows.iter_mut().for_each(|r| r.constant = 0.0);
    }

    /// Returns whether a force at this dof reaches a support.
    pub(crate) fn reaches_support(&self, dof: usize) -> bool {
        match self.state[dof] {
            State::Free => false,
            State::Held => true,
            State::Dependent(r) => !self.rows[r as usize].held.is_empty(),
        }
    }
}

/// Returns the constraints of one SPC set and one MPC set, together with rigid elements and permanent supports.
///
/// # Errors
/// Unusable rigid elements; a dof claimed twice; circles.
pub(crate) fn reduce(
    model: &Model,
    axes: &[Option<Mat3>],
    (spc, mpc, enforced): Sets<'_>,
) -> Result<Reduction, FeError> {
    let mut claims: Vec<Claim> = Vec::new();
    let mut relations: Vec<Relation> = Vec::new();
    let mut refused: Vec<Refusal> = Vec::new();
    for rigid in &model.rigids {
        let claim = claims.len() as u32;
        let result = match &rigid.kind {
            RigidKind::Body {
                independent,
                dependent,
                ..
            } => body::relations(model, axes, rigid, independent, dependent, claim),
            RigidKind::Mean {
                reference,
                refc,
                arms,
                um,
                ..
            } => mean::relations(model, axes, rigid, (*reference, *refc), arms, um, claim),
            RigidKind::Equations { equations, .. } => Ok(equations
                .iter()
                .filter_map(|terms| express_first_term(terms, claim))
                .collect()),
        };
        claims.push(Claim {
            card: format!("{} {}", rigid.kind.card(), rigid.id),
            at: rigid.at,
        });
        match result {
            Ok(mut list) => relations.append(&mut list),
            Err(refusal) => refused.push(refusal),
        }
    }
    for set in model.mpcs.iter().filter(|s| Some(s.sid) == mpc) {
        for (terms, at) in &set.equations {
            let claim = claims.len() as u32;
            claims.push(Claim {
                card: format!("MPC {}", set.sid),
                at: *at,
            });
            match express_first_term(terms, claim) {
                Some(relation) => relations.push(relation),
                None => refused.push(Refusal {
                    card: format!("MPC {}", set.sid),
                    at: *at,
                    reason: "coefficient of the first, dependent, term: 0".to_owned(),
                    remedy: "give the first term a coefficient".to_owned(),
                }),
            }
        }
    }
    if !refused.is_empty() {
        return Err(FeError::Refused(refused));
    }
    resolve(model, &relations, &claims, (spc, enforced))
}

/// Solves an equation for its first term; `None` if the coefficient of that term is zero.
fn express_first_term(terms: &[(GridIx, u8, f64)], claim: u32) -> Option<Relation> {
    let (&(g, i, a), rest) = terms.split_first()?;
    (a != 0.0).then(|| Relation {
        dependent: 6 * g.0 + u32::from(i),
        terms: rest
            .iter()
            .map(|&(g, i, c)| (6 * g.0 + u32::from(i), -c / a))
            .collect(),
        claim,
    })
}

fn resolve(
    model: &Model,
    relations: &[Relation],
    claims: &[Claim],
    (spc, spcd): (Option<u32>, &[(GridIx, Dofs, f64)]),
) -> Result<Reduction, FeError> {
    let n = 6 * model.grids.len();
    let mut state = vec![State::Free; n];
    let mut held_by: HashMap<u32, String> = HashMap::new();
    let mut enforced = HashMap::new();
    for (g, grid) in model.grids.iter().enumerate() {
        for i in grid.ps.iter0() {
            state[6 * g + i] = State::Held;
        }
    }
    for set in model.spcs.iter().filter(|s| Some(s.sid) == spc) {
        for (g, dofs, value) in &set.terms {
            for i in dofs.iter0() {
                let dof = 6 * g.0 + i as u32;
                state[dof as usize] = State::Held;
                held_by.insert(dof, format!("SPC {}", set.sid));
                if *value != 0.0 {
                    enforced.insert(dof, *value);
                }
            }
        }
    }
    for (g, dofs, value) in spcd {
        for i in dofs.iter0() {
            let dof = 6 * g.0 + i as u32;
            if state[dof as usize] != State::Held {
                let grid = &model.grids[g.us()];
                return Err(FeError::EnforcedFree {
                    grid: grid.id,
                    dof: i as u8 + 1,
                    at: grid.at,
                });
            }
            enforced.insert(dof, *value);
        }
    }
    for (r, relation) in relations.iter().enumerate() {
        let dof = relation.dependent;
        let grid = &model.grids[(dof / 6) as usize];
        let claim = &claims[relation.claim as usize];
        let earlier = match state[dof as usize] {
            State::Free => None,
            State::Held => Some(
                held_by
                    .get(&dof)
                    .cloned()
                    .unwrap_or_else(|| format!("PS of GRID {}", grid.id)),
            ),
            State::Dependent(other) => Some(
                claims[relations[other as usize].claim as usize]
                    .card
                    .clone(),
            ),
        };
        if let Some(earlier) = earlier {
            return Err(FeError::DependentTwice {
                grid: grid.id,
                dof: (dof % 6) as u8 + 1,
                claims: vec![earlier, claim.card.clone()],
                at: claim.at,
            });
        }
        if relation.terms.is_empty() {
            // A dof without terms is a support with a reaction, such as a rigid bush to ground.
            state[dof as usize] = State::Held;
            held_by.insert(dof, claim.card.clone());
        } else {
            state[dof as usize] = State::Dependent(r as u32);
        }
    }
    let rows = rows_without_dependent(model, relations, claims, &state, &enforced)?;
    Ok(Reduction {
        state,
        rows,
        enforced,
    })
}

/// The relations with every dependent dof on their right-hand sides replaced.
///
/// # Errors
/// Dofs that depend on themselves.
fn rows_without_dependent(
    model: &Model,
    relations: &[Relation],
    claims: &[Claim],
    state: &[State],
    enforced: &HashMap<u32, f64>,
) -> Result<Vec<Row>, FeError> {
    // Depth first: a row is complete when all dependent dofs in it are replaced.
    #[derive(Clone, Copy, PartialEq)]
    enum Mark {
        New,
        Open,
        Done,
    }
    let mut mark = vec![Mark::New; relations.len()];
    let mut rows = vec![Row::default(); relations.len()];
    let mut stack = Vec::new();
    for r in 0..relations.len() {
        stack.push(r);
        while let Some(&r) = stack.last() {
            if mark[r] == Mark::Done {
                stack.pop();
                continue;
            }
            let waits: Vec<usize> = relations[r]
                .terms
                .iter()
                .filter_map(|(d, _)| match state[*d as usize] {
                    State::Dependent(o) if mark[o as usize] != Mark::Done => Some(o as usize),
                    _ => None,
                })
                .collect();
            if waits.is_empty() {
                rows[r] = substitute(&relations[r].terms, state, &rows, enforced);
                mark[r] = Mark::Done;
                stack.pop();
            } else {
                if mark[r] == Mark::Open || waits.contains(&r) {
                    let dof = relations[r].dependent;
                    let grid = &model.grids[(dof / 6) as usize];
                    return Err(FeError::CircularDependence {
                        grid: grid.id,
                        dof: (dof % 6) as u8 + 1,
                        at: claims[relations[r].claim as usize].at,
                    });
                }
                mark[r] = Mark::Open;
                stack.extend(waits);
            }
        }
    }
    Ok(rows)
}

fn substitute(
    terms: &[(u32, f64)],
    state: &[State],
    rows: &[Row],
    enforced: &HashMap<u32, f64>,
) -> Row {
    let mut sum = Row {
        free: Vec::with_capacity(terms.len()),
        ..Row::default()
    };
    for &(dof, c) in terms {
        match state[dof as usize] {
            State::Free => sum.free.push((dof, c)),
            State::Held => {
                sum.constant += c * enforced.get(&dof).copied().unwrap_or(0.0);
                sum.held.push((dof, c));
            }
            State::Dependent(o) => {
                let row = &rows[o as usize];
                sum.constant += c * row.constant;
                sum.free.extend(row.free.iter().map(|(d, v)| (*d, c * v)));
                sum.held.extend(row.held.iter().map(|(d, v)| (*d, c * v)));
            }
        }
    }
    like_terms_added(&mut sum.free);
    like_terms_added(&mut sum.held);
    sum
}

fn like_terms_added(terms: &mut Vec<(u32, f64)>) {
    terms.sort_by_key(|t| t.0);
    terms.dedup_by(|later, first| {
        let same = later.0 == first.0;
        if same {
            first.1 += later.1;
        }
        same
    });
    terms.retain(|t| t.1 != 0.0);
}
