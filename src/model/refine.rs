//! Refines a model to half the mesh width, which shows the mesh error of a result.

use super::types::{
    FrameIx, Grid, GridIx, Load, LoadSet, Model, MpcSet, Shell, ShellIx, SpcSet, TemperatureSet,
};
use nastran::cards::{CoordKind, Dofs, ShellShape};
use nastran::place::Place;
use std::collections::{BTreeMap, BTreeSet};

/// A model whose shells, all or some, are divided in four, with the children of each.
#[derive(Clone, Debug)]
pub struct RefinedModel {
    /// The finer model. It omits load sets that act on elements, because these loads would have to be divided as well. New grids have the mean
    /// temperature of their side or shell.
    pub model: Model,
    /// Shells into which each shell of the coarse model was divided. Child k of a quadrilateral has its corner k. Child k of a triangle (k < 3) has
    /// corner k, and the fourth child is in the middle. For a shell that was not divided, the list contains the shell four times.
    pub children: Vec<[ShellIx; 4]>,
}

impl RefinedModel {
    /// Returns whether every shell was divided.
    pub fn is_whole(&self) -> bool {
        self.children.iter().all(|c| c[0] != c[1])
    }
}

impl Model {
    /// Returns the model with every shell divided in four at the middles of its sides, see [`Model::refine_shells_at`]. `None` if that is impossible.
    ///
    /// # Example
    /// ```
    /// use nastran::bdf::{MemoryLoader, read_deck};
    /// use strainbridge::model::Model;
    ///
    /// # const DECK: &str = "BEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,3.,0.,0.\nGRID,3,,4.,2.,0.\nGRID,4,,0.,2.,0.
    /// # CQUAD4,7,1,1,2,3,4\nPSHELL,1,1,.1,1,,1\nMAT1,1,2.1+11,,.3,7850.\nENDDATA\n";
    /// let deck = read_deck("plate.bdf", DECK.into(), &mut MemoryLoader::default());
    /// let (coarse, _) = Model::from_deck(&deck);
    /// let fine = coarse.refine_shells().unwrap();
    /// assert!(fine.is_whole() && fine.children.len() == 1);
    /// assert_eq!((fine.model.shells.len(), fine.model.grids.len()), (4, 9));
    /// // Division changes neither mass nor centre of gravity by more than the rule of the shell.
    /// assert!((fine.model.weight().mass / coarse.weight().mass - 1.0).abs() < 1e-12);
    /// ```
    pub fn refine_shells(&self) -> Option<RefinedModel> {
        self.refine_shells_at(&vec![true; self.shells.len()])
    }

    /// Returns the model with each shell that `divided` marks, by index, divided into four at the middles of its sides.
    ///
    /// Returns `None` if this would tear the mesh or change nothing. This is the case if no shell is marked or a marked shell has mid-side grids. It
    /// is also the case if a side is shared with another element and its ends are not in one rectangular displacement frame.
    ///
    /// Grids keep their index, so loads, masses and rigid elements keep their locations. New grids are on the straight sides, so a curved surface
    /// keeps its facets. A new grid is constrained if both ends of its side are, by PS as by SPC sets.
    ///
    /// Bars, rods, shear panels, solids and unmarked shells are not divided. If such an element has an edge along a side of a marked shell, the new
    /// grid there moves as the mean of the ends. Its motion is then linear along the side, as on the edges of both elements before.
    pub fn refine_shells_at(&self, divided: &[bool]) -> Option<RefinedModel> {
        if !self.can_be_refined(divided) {
            return None;
        }
        let ties = self.sides_of_others(divided)?;
        let mut builder = Builder {
            grids: self.grids.clone(),
            middles: BTreeMap::new(),
            next_id: self.grids.last()?.id,
            parents: Vec::new(),
            ties,
            tied: BTreeSet::new(),
        };
        let n_divided = divided.iter().filter(|d| **d).count();
        let mut shells = Vec::with_capacity(self.shells.len() + n_divided.checked_mul(3)?);
        let mut children = Vec::with_capacity(self.shells.len());
        let mut next_id = self.shells.last()?.id;
        for (shell, is_divided) in self.shells.iter().zip(divided) {
            let first = ShellIx(u32::try_from(shells.len()).ok()?);
            let whole = [(shell.grids, shell.thickness)];
            let quarters = is_divided.then(|| builder.divide(shell));
            let parts = match &quarters {
                Some(parts) => parts.as_ref()?.as_slice(),
                None => &whole,
            };
            for (grids, thickness) in parts {
                next_id = next_id.checked_add(1)?;
                shells.push(Shell {
                    id: next_id,
                    grids: *grids,
                    thickness: *thickness,
                    ..*shell
                });
            }
            let of_quarter = |k: u32| ShellIx(first.0 + if *is_divided { k } else { 0 });
            children.push([0, 1, 2, 3].map(of_quarter));
        }
        let temperatures = self
            .temperatures
            .iter()
            .map(|t| self.finer_temperatures(t, &builder.parents, &children, &shells))
            .collect();
        let spcs = self
            .spcs
            .iter()
            .map(|s| self.finer_supports(s, &builder))
            .collect();
        let (mpcs, mpc) = self.finer_equations(&builder);
        let model = Self {
            grids: builder.grids,
            spcs,
            mpcs,
            mpc,
            shells,
            load_sets: self.load_sets_at_grids(),
            temperatures,
            ..self.clone()
        };
        Some(RefinedModel { model, children })
    }

    /// Returns by index whether a shell is one of `of`, or within `rows` rows of elements around one of them. Elements that share a grid are
    /// neighbours.
    pub fn shells_near(&self, of: &[ShellIx], rows: usize) -> Vec<bool> {
        let mut near = vec![false; self.shells.len()];
        let mut touched = vec![false; self.grids.len()];
        let corners = |i: usize| {
            let shell = self.shells.get(i).into_iter();
            shell.flat_map(|s| s.grids.iter().take(s.shape.n_corners()))
        };
        let mut next: Vec<usize> = of.iter().map(|s| s.us()).collect();
        next.retain(|i| *i < near.len());
        for row in 0..=rows {
            if row > 0 {
                let meets = |i: &usize| !near[*i] && corners(*i).any(|g| touched[g.us()]);
                next = (0..near.len()).filter(meets).collect();
            }
            for &i in &next {
                near[i] = true;
                corners(i).for_each(|g| touched[g.us()] = true);
            }
        }
        near
    }

    /// Load sets that act at grids and by inertia alone.
    fn load_sets_at_grids(&self) -> Vec<LoadSet> {
        let stays = |load: &Load| match load {
            Load::Force(..) | Load::Moment(..) | Load::Gravity(_) | Load::Spin { .. } => true,
            // Acceleration is listed by grid, so new grids would get none.
            Load::Acceleration { .. } => false,
            Load::ShellPressure { .. }
            | Load::FacePressure { .. }
            | Load::Line { .. }
            | Load::Enforced { .. }
            | Load::Unsupported(..) => false,
        };
        let whole = |s: &&LoadSet| s.loads.iter().all(|(_, load)| stays(load));
        self.load_sets.iter().filter(whole).cloned().collect()
    }

    /// Returns a temperature set on the divided mesh; `parents` are the parent grids of each new grid.
    fn finer_temperatures(
        &self,
        set: &TemperatureSet,
        parents: &[Vec<GridIx>],
        children: &[[ShellIx; 4]],
        shells: &[Shell],
    ) -> TemperatureSet {
        let at = set.by_grid(self.grids.len());
        let mut out = set.clone();
        out.grids = (0..).map(GridIx).zip(at.iter().copied()).collect();
        for of in parents {
            let mean = of.iter().map(|g| at[g.us()]).sum::<f64>() / of.len().max(1) as f64;
            out.grids.push((GridIx(out.grids.len() as u32), mean));
        }
        for (shell, into) in self.shells.iter().zip(children) {
            if let Some(t) = set.elements.get(&shell.id) {
                let ids = into.iter().map(|c| shells[c.us()].id);
                out.elements.extend(ids.map(|id| (id, *t)));
            }
        }
        out
    }

    /// An SPC set on the divided mesh: a new grid is held where all its parents are, at their mean value.
    fn finer_supports(&self, set: &SpcSet, made: &Builder) -> SpcSet {
        let mut held: BTreeMap<GridIx, [Option<f64>; 6]> = BTreeMap::new();
        for (g, dofs, value) in &set.terms {
            let of = held.entry(*g).or_default();
            dofs.iter0().for_each(|i| of[i] = Some(*value));
        }
        let mut out = set.clone();
        let frame = |g: &GridIx| self.grids.get(g.us()).map(|g| g.cd);
        for (new, of) in (self.grids.len() as u32..).map(GridIx).zip(&made.parents) {
            if made.tied.contains(&new) || of.windows(2).any(|w| frame(&w[0]) != frame(&w[1])) {
                continue;
            }
            for dof in 0..6 {
                let values: Option<Vec<f64>> = of
                    .iter()
                    .map(|g| held.get(g).and_then(|h| h[dof]))
                    .collect();
                if let (Some(values), Some(dofs)) = (values, Dofs::from_digits(dof as u32 + 1)) {
                    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
                    out.terms.push((new, dofs, mean));
                }
            }
        }
        out
    }

    /// Returns the equation sets, each with the equations of the tied grids added, and the id of the set that applies under unit loads.
    fn finer_equations(&self, made: &Builder) -> (Vec<MpcSet>, Option<u32>) {
        let mut sets = self.mpcs.clone();
        if made.tied.is_empty() {
            return (sets, self.mpc);
        }
        let free = sets.iter().map(|s| s.sid).max().unwrap_or(0).checked_add(1);
        let mpc = self.mpc.or(free);
        if let Some(sid) = mpc.filter(|sid| sets.iter().all(|s| s.sid != *sid)) {
            let equations = Vec::new();
            sets.push(MpcSet { sid, equations });
        }
        let middles = (self.grids.len() as u32..).map(GridIx).zip(&made.parents);
        let tied = middles.filter(|(new, _)| made.tied.contains(new));
        for (new, of) in tied {
            for dof in 0..6 {
                let share = -1.0 / of.len() as f64;
                let ends = of.iter().map(|g| (*g, dof, share));
                let terms: Vec<_> = std::iter::once((new, dof, 1.0)).chain(ends).collect();
                for set in &mut sets {
                    set.equations.push((terms.clone(), Place::default()));
                }
            }
        }
        (sets, mpc)
    }

    fn can_be_refined(&self, divided: &[bool]) -> bool {
        let plain = |s: &Shell| {
            use ShellShape::{Quad4, QuadR, Tria3, TriaR};
            matches!(s.shape, Quad4 | QuadR | Tria3 | TriaR)
        };
        let mut marked = self.shells.iter().zip(divided).filter(|s| *s.1);
        divided.len() == self.shells.len()
            && divided.contains(&true)
            && marked.all(|(s, _)| plain(s))
    }

    /// Sides of marked shells along which another element or a shell that is not marked goes. `None` where the ends of one don't share a
    /// rectangular displacement frame.
    fn sides_of_others(&self, divided: &[bool]) -> Option<BTreeSet<(GridIx, GridIx)>> {
        let of_shells = |marked: bool| -> BTreeSet<(GridIx, GridIx)> {
            let shells = self.shells.iter().zip(divided);
            let shells = shells.filter(|(_, d)| **d == marked).map(|(s, _)| s);
            shells.flat_map(sides_of).collect()
        };
        let sides = of_shells(true);
        let mut out: BTreeSet<_> = of_shells(false).intersection(&sides).copied().collect();
        let mut all_of = |grids: &[GridIx]| {
            for (i, a) in grids.iter().enumerate() {
                let pairs = grids[i + 1..].iter().map(|b| side(*a, *b));
                out.extend(pairs.filter(|pair| sides.contains(pair)));
            }
        };
        self.beams.iter().for_each(|b| all_of(&b.grids[..2]));
        self.rods.iter().for_each(|r| all_of(&r.grids));
        self.shear_panels.iter().for_each(|p| all_of(&p.grids));
        for solid in &self.solids {
            let corners = solid.grids.iter().take(solid.shape.n_corners());
            let corners: Vec<GridIx> = corners.copied().flatten().collect();
            all_of(&corners);
        }
        let level = |(a, b): &(GridIx, GridIx)| {
            let frame = |g: &GridIx| self.grids.get(g.us()).map(|g| g.cd);
            let kind = |f: FrameIx| self.frames.get(f.us()).map(|f| f.kind);
            frame(a) == frame(b) && frame(a).and_then(kind) == Some(CoordKind::Rectangular)
        };
        out.iter().all(level).then_some(out)
    }
}

fn side(a: GridIx, b: GridIx) -> (GridIx, GridIx) {
    (a.min(b), a.max(b))
}

fn sides_of(s: &Shell) -> impl Iterator<Item = (GridIx, GridIx)> {
    let n = s.shape.n_corners();
    (0..n).map(move |i| side(s.grids[i], s.grids[(i + 1) % n]))
}

struct Builder {
    grids: Vec<Grid>,
    middles: BTreeMap<(GridIx, GridIx), GridIx>,
    next_id: u32,
    /// Parents of each new grid.
    parents: Vec<Vec<GridIx>>,
    /// Sides to which other elements connect.
    ties: BTreeSet<(GridIx, GridIx)>,
    /// New grids on these sides.
    tied: BTreeSet<GridIx>,
}

/// Grids and corner thicknesses of a child.
type Part = ([GridIx; 8], [f64; 4]);

impl Builder {
    fn add(&mut self, of: &[GridIx]) -> Option<GridIx> {
        let parents: Option<Vec<Grid>> =
            of.iter().map(|g| self.grids.get(g.us()).copied()).collect();
        let parents = parents?;
        let first = *parents.first()?;
        let sum = parents.iter().fold(first.x * 0.0, |s, g| s + g.x);
        self.next_id = self.next_id.checked_add(1)?;
        let same_frame = parents.iter().all(|g| g.cd == first.cd);
        let tied = matches!(of, [a, b] if self.ties.contains(&side(*a, *b)));
        let constrained = same_frame && !tied && parents.iter().all(|g| g.ps == first.ps);
        let ix = GridIx(u32::try_from(self.grids.len()).ok()?);
        self.grids.push(Grid {
            id: self.next_id,
            x: sum / parents.len() as f64,
            cd: if constrained || tied {
                first.cd
            } else {
                FrameIx(0)
            },
            ps: if constrained { first.ps } else { Dofs(0) },
            ..first
        });
        self.parents.push(of.to_vec());
        if tied {
            self.tied.insert(ix);
        }
        Some(ix)
    }

    fn add_middle_grid(&mut self, a: GridIx, b: GridIx) -> Option<GridIx> {
        if let Some(&known) = self.middles.get(&side(a, b)) {
            return Some(known);
        }
        let made = self.add(&[a, b])?;
        self.middles.insert(side(a, b), made);
        Some(made)
    }

    fn divide(&mut self, shell: &Shell) -> Option<[Part; 4]> {
        let [p0, p1, p2, p3, ..] = shell.grids;
        let [t0, t1, t2, t3] = shell.thickness;
        let mean = |a: f64, b: f64| 0.5 * (a + b);
        let four = |g: [GridIx; 4]| [g[0], g[1], g[2], g[3], g[0], g[1], g[2], g[3]];
        if shell.shape.n_corners() == 3 {
            let (a, b, c) = (
                self.add_middle_grid(p0, p1)?,
                self.add_middle_grid(p1, p2)?,
                self.add_middle_grid(p2, p0)?,
            );
            let (ta, tb, tc) = (mean(t0, t1), mean(t1, t2), mean(t2, t0));
            let three = |g: [GridIx; 3]| [g[0], g[1], g[2], g[0], g[1], g[2], g[0], g[1]];
            return Some([
                (three([p0, a, c]), [t0, ta, tc, tc]),
                (three([a, p1, b]), [ta, t1, tb, tb]),
                (three([c, b, p2]), [tc, tb, t2, t2]),
                (three([b, c, a]), [tb, tc, ta, ta]),
            ]);
        }
        let (a, b, c, d) = (
            self.add_middle_grid(p0, p1)?,
            self.add_middle_grid(p1, p2)?,
            self.add_middle_grid(p2, p3)?,
            self.add_middle_grid(p3, p0)?,
        );
        let m = self.add(&[p0, p1, p2, p3])?;
        let (ta, tb, tc, td) = (mean(t0, t1), mean(t1, t2), mean(t2, t3), mean(t3, t0));
        let tm = 0.25 * (t0 + t1 + t2 + t3);
        Some([
            (four([p0, a, m, d]), [t0, ta, tm, td]),
            (four([a, p1, b, m]), [ta, t1, tb, tm]),
            (four([m, b, p2, c]), [tm, tb, t2, tc]),
            (four([d, m, c, p3]), [td, tm, tc, t3]),
        ])
    }
}
