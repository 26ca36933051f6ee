//! Static decks of `../shared/nastran` with results of MSC and NX.
//!
//! The tests compare displacement and strain of every element type and print the table of the README (`cargo test
//! --test verification real_decks -- --nocapture`).

use crate::decks::{faulty_model_of, find_shared_path};
use crate::real_deck_limits::{self as limits, Limits};
use nastran::results::{Analysis, Quantity, ResultsFile, Rows};
use std::collections::BTreeMap;
use strainbridge::fe::from_results::{ReadOptions, solution_from_results};
use strainbridge::fe::*;
use strainbridge::model::{GridIx, Load, MaterialKind, Model, RodCard, Vec3};

/// Relative differences from the reference, by element type and quantity.
type Table = BTreeMap<String, Vec<f64>>;

fn quantile(list: &[f64], share: f64) -> f64 {
    let mut sorted = list.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[((sorted.len() - 1) as f64 * share).round() as usize]
}

/// Adds the relative distance of each pair of vectors whose size is at least a tenth of the largest.
fn compare(table: &mut Table, name: &str, pairs: &[(Vec<f64>, Vec<f64>)]) {
    let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let largest = pairs.iter().map(|p| norm(&p.1)).fold(0.0, f64::max);
    for (ours, reference) in pairs {
        let size = norm(reference);
        if size >= 0.1 * largest && size > 0.0 {
            let off: Vec<f64> = ours.iter().zip(reference).map(|(a, b)| a - b).collect();
            table
                .entry(name.to_owned())
                .or_default()
                .push(norm(&off) / size);
        }
    }
}

struct Solved {
    model: Model,
    solution: Solution,
    table: Table,
}

/// Returns the model and cases of a deck, or of the geometry blocks if there is no deck.
fn prepare_model(deck: Option<&str>, file: &ResultsFile) -> Option<(Model, Vec<LoadCase>)> {
    if let Some(deck) = deck {
        let (model, control) = faulty_model_of(&find_shared_path(deck)?);
        let cases = control
            .effective_subcases()
            .iter()
            .map(|s| LoadCase {
                relief: Relief::None,
                ..LoadCase::of_subcase(&model, s, String::new())
            })
            .collect();
        return Some((model, cases));
    }
    let (cards, _) = file.cards()?;
    let (model, _) = Model::from_cards(&cards);
    // The geometry blocks have no case control. The last sets are the sums of the others.
    let case = LoadCase {
        subcase: 1,
        label: String::new(),
        loads: model
            .load_sets
            .last()
            .map(|s| UnitLoad::Set(s.sid))
            .into_iter()
            .collect(),
        spc: model.spcs.last().map(|s| s.sid),
        mpc: None,
        relief: Relief::None,
    };
    Some((model, vec![case]))
}

/// Returns E and nu of the material of a solid or rod, or `None` if the material is not isotropic.
fn isotropic_constants(
    model: &Model,
    material: Option<strainbridge::model::MaterialIx>,
) -> Option<(f64, f64)> {
    match model.materials.get(material?.us())?.kind {
        MaterialKind::Isotropic { e, nu, .. } => Some((e, nu)),
        _ => None,
    }
}

fn solve(
    deck: Option<&str>,
    results: &str,
    alter: impl Fn(&mut Model, &mut Vec<LoadCase>),
) -> Option<Solved> {
    let bytes = std::fs::read(find_shared_path(results)?).unwrap();
    let file = ResultsFile::read(&bytes, results).unwrap();
    let (mut model, mut cases) = prepare_model(deck, &file)?;
    alter(&mut model, &mut cases);
    let (solution, _) = solve_cases(&model, &cases, &SolveOptions::default())
        .unwrap_or_else(|e| panic!("{results}: {e}"));
    let mut solved = Solved {
        model,
        solution,
        table: Table::new(),
    };
    let reference = solution_from_results(
        &solved.model,
        &[("results", &file)],
        &ReadOptions::default(),
    );
    solved.shells_and_beams(&reference);
    for (i, block) in file.blocks().iter().enumerate() {
        if block.analysis == Analysis::Statics
            && !block.complex
            && !block.sort2
            && let Ok(rows) = file.rows(i)
        {
            let element = block.element.map_or(0, |e| e.0);
            solved.block(block.quantity, element, block.subcase, &rows);
        }
    }
    solved.compare_recovered_strain(&cases, &reference);
    for (name, list) in &solved.table {
        eprintln!(
            "{results}: {name}: {} rows, median {:.2e}, 95 % {:.2e}",
            list.len(),
            quantile(list, 0.5),
            quantile(list, 0.95)
        );
    }
    Some(solved)
}

impl Solved {
    fn case(&self, subcase: u32) -> Option<&CaseResult> {
        self.solution.cases.iter().find(|c| c.subcase == subcase)
    }

    fn shells_and_beams(&mut self, reference: &Solution) {
        let mut table = std::mem::take(&mut self.table);
        for theirs in &reference.cases {
            let Some(ours) = self.case(theirs.subcase) else {
                continue;
            };
            let mut shells: BTreeMap<&str, Vec<(Vec<f64>, Vec<f64>)>> = BTreeMap::new();
            for (ix, strain) in theirs.shells.elements.iter().zip(&theirs.shells.centre) {
                let shell = &self.model.shells[ix.us()];
                let flat = |s: &[[f64; 3]; 2]| s.iter().flatten().copied().collect::<Vec<f64>>();
                let mine = flat(&ours.shells.centre[ix.us()]);
                let row = flat(strain);
                if row.iter().all(|v| v.is_finite()) {
                    shells
                        .entry(shell.shape.card())
                        .or_default()
                        .push((mine, row));
                }
            }
            for (card, pairs) in shells {
                compare(&mut table, &format!("{card} strain"), &pairs);
            }
            let mut beams: BTreeMap<&str, Vec<(Vec<f64>, Vec<f64>)>> = BTreeMap::new();
            for (ix, stations) in theirs.beams.elements.iter().zip(&theirs.beams.stations) {
                let beam = &self.model.beams[ix.us()];
                let mine = &ours.beams.stations[ix.us()];
                for (xi, row) in stations {
                    if let Some((_, own)) = mine.iter().find(|s| (s.0 - xi).abs() < 1e-6) {
                        let card = if beam.is_beam { "CBEAM" } else { "CBAR" };
                        beams
                            .entry(card)
                            .or_default()
                            .push((own.to_vec(), row.to_vec()));
                    }
                }
            }
            for (card, pairs) in beams {
                compare(&mut table, &format!("{card} strain"), &pairs);
            }
        }
        self.table = table;
    }

    /// Compares strain that the elements of this project recover from the displacements of the file. This tests the
    /// formula of each element independently of the rest of the model.
    fn compare_recovered_strain(&mut self, cases: &[LoadCase], reference: &Solution) {
        let mut theirs = reference.clone();
        theirs.cases.retain(|c| !c.displacement.is_empty());
        let cases: Vec<LoadCase> = theirs
            .cases
            .iter()
            .filter_map(|c| cases.iter().find(|case| case.subcase == c.subcase).cloned())
            .collect();
        let displacements = theirs
            .cases
            .iter()
            .map(|c| {
                let finite = |u: &[f64; 6]| u.map(|v| if v.is_finite() { v } else { 0.0 });
                c.displacement.iter().map(finite).collect()
            })
            .collect();
        let solved = strainbridge::fe::DisplacementSolution {
            displacements,
            ..Default::default()
        };
        let Ok((own, _)) = solution_of(&self.model, &cases, solved, &SolveOptions::default())
        else {
            return;
        };
        let mut other = Solved {
            model: self.model.clone(),
            solution: own,
            table: Table::new(),
        };
        other.shells_and_beams(reference);
        for (name, list) in other.table {
            self.table
                .insert(format!("{name} from their displacements"), list);
        }
    }

    fn block(&mut self, quantity: Quantity, element: u32, subcase: u32, rows: &Rows) {
        let Some(case) = self.case(subcase) else {
            return;
        };
        let mut table = Table::new();
        match (quantity, element) {
            (Quantity::Displacement, _) => self.displacement(case, rows, &mut table),
            (Quantity::Strain, 39 | 67 | 68) => self.solids(case, rows, element, None, &mut table),
            (Quantity::Stress, 39 | 67 | 68) => {
                self.solids(case, rows, element, Some(()), &mut table);
            }
            (Quantity::Stress | Quantity::Strain, 1 | 3 | 10) => {
                self.rods(case, rows, quantity == Quantity::Stress, &mut table);
            }
            (Quantity::PlyStrain, 95 | 97) => self.plies(case, rows, &mut table),
            _ => {}
        }
        for (name, list) in table {
            self.table.entry(name).or_default().extend(list);
        }
    }

    fn displacement(&self, case: &CaseResult, rows: &Rows, table: &mut Table) {
        let mut largest = 0.0_f64;
        let mut off = Vec::new();
        for (i, id) in rows.ids.iter().enumerate() {
            let Some(g) = self.model.grid_ix(id.entity) else {
                continue;
            };
            if self.model.grids[g.us()].kind == strainbridge::model::PointKind::Scalar {
                continue;
            }
            let u = case.displacement[g.us()];
            let ours = self.model.cd_axes(g) * Vec3::new(u[0], u[1], u[2]);
            let theirs = Vec3::from_column_slice(&rows.row(i)[..3]);
            largest = largest.max(theirs.norm());
            off.push((id.entity, (ours - theirs).norm()));
        }
        // The differences are shares of the largest displacement. Rotations about normals are specific to each program.
        let worst = off.iter().max_by(|a, b| a.1.total_cmp(&b.1));
        eprintln!("  largest displacement {largest:.4e}, worst grid {worst:?}");
        let shares = off.into_iter().map(|o| o.1 / largest);
        table
            .entry("displacement".to_owned())
            .or_default()
            .extend(shares);
    }

    fn solids(
        &self,
        case: &CaseResult,
        rows: &Rows,
        element: u32,
        stress: Option<()>,
        table: &mut Table,
    ) {
        let mut pairs = Vec::new();
        for (i, id) in rows.ids.iter().enumerate() {
            if id.at != 0 {
                continue;
            }
            let Some(ix) = self.model.solids.iter().position(|s| s.id == id.entity) else {
                continue;
            };
            let row = rows.row(i)[..6].to_vec();
            let mut ours = case.solids.centre[ix].to_vec();
            if stress.is_some() {
                let property =
                    &self.model.solid_properties[self.model.solids[ix].property as usize];
                let Some((e, nu)) = isotropic_constants(&self.model, Some(property.material))
                else {
                    continue;
                };
                let c = e / ((1.0 + nu) * (1.0 - 2.0 * nu));
                let trace = ours[0] + ours[1] + ours[2];
                let g = e / (2.0 + 2.0 * nu);
                ours = (0..6)
                    .map(|k| {
                        if k < 3 {
                            c * ((1.0 - 2.0 * nu) * ours[k] + nu * trace)
                        } else {
                            g * ours[k]
                        }
                    })
                    .collect();
            }
            if rows.len() < 40 {
                eprintln!("  solid {}: {ours:?} for {row:?}", id.entity);
            }
            pairs.push((ours, row));
        }
        let card = match element {
            39 => "CTETRA",
            67 => "CHEXA",
            _ => "CPENTA",
        };
        let what = if stress.is_some() { "stress" } else { "strain" };
        compare(table, &format!("{card} {what}"), &pairs);
    }

    fn rods(&self, case: &CaseResult, rows: &Rows, stress: bool, table: &mut Table) {
        let mut by_card: BTreeMap<&str, Vec<(Vec<f64>, Vec<f64>)>> = BTreeMap::new();
        for (i, id) in rows.ids.iter().enumerate() {
            let Some(rod) = self.model.rods.iter().find(|r| r.id == id.entity) else {
                continue;
            };
            let at = |g: GridIx| self.model.grids[g.us()].x;
            let d = at(rod.grids[1]) - at(rod.grids[0]);
            let u = |g: GridIx| Vec3::from_column_slice(&case.displacement[g.us()][..3]);
            let strain = (u(rod.grids[1]) - u(rod.grids[0])).dot(&d) / d.norm_squared();
            let Some((e, _)) = isotropic_constants(&self.model, Some(rod.material)) else {
                continue;
            };
            let card = match rod.card {
                RodCard::Crod => "CROD",
                RodCard::Ctube => "CTUBE",
                RodCard::Conrod => "CONROD",
            };
            let ours = if stress { e * strain } else { strain };
            by_card
                .entry(card)
                .or_default()
                .push((vec![ours], vec![rows.row(i)[0]]));
        }
        for (card, pairs) in by_card {
            compare(
                table,
                &format!("{card} axial {}", if stress { "stress" } else { "strain" }),
                &pairs,
            );
        }
    }

    fn plies(&self, case: &CaseResult, rows: &Rows, table: &mut Table) {
        let mut pairs = Vec::new();
        for (i, id) in rows.ids.iter().enumerate() {
            let Some(ix) = self.model.shell_ix(id.entity) else {
                continue;
            };
            let plies = ply_strains(&self.model, ix, &case.shells.centre[ix.us()]);
            if let Some(ply) = plies.get((id.layer as usize).wrapping_sub(1)) {
                pairs.push((ply.to_vec(), rows.row(i)[..3].to_vec()));
            }
        }
        compare(table, "ply strain", &pairs);
    }

    /// Fails with every row that exceeds its limit.
    #[track_caller]
    fn reaches(&self, limits: Limits) {
        let beyond: Vec<String> = limits
            .iter()
            .filter_map(|(name, median, most)| {
                let Some(list) = self.table.get(*name) else {
                    return Some(format!("no {name} in {:?}", self.table.keys()));
                };
                let (m, q) = (quantile(list, 0.5), quantile(list, 0.95));
                let within = m <= *median && q <= *most;
                (!within).then(|| {
                    format!("{name}: median {m:.2e} (limit {median:.0e}), 95 % {q:.2e} (limit {most:.0e})")
                })
            })
            .collect();
        assert!(beyond.is_empty(), "{beyond:#?}");
    }
}

fn as_it_is(_: &mut Model, _: &mut Vec<LoadCase>) {}

#[test]
fn a_wing_box_of_laminates_shear_panels_and_rods_agrees_with_msc() {
    let Some(s) = solve(
        Some("nastran/msc64_two_cases/d173.bdf"),
        "nastran/msc64_two_cases/d173.op2",
        as_it_is,
    ) else {
        return;
    };
    s.reaches(limits::WING_BOX);
}

#[test]
fn one_element_of_each_kind_agrees_with_nx() {
    let Some(s) = solve(
        Some("nastran/nx_static_shell_bar/static_solid_shell_bar.bdf"),
        "nastran/nx_static_shell_bar/static_solid_shell_bar.op2",
        as_it_is,
    ) else {
        return;
    };
    s.reaches(limits::SHELL_BAR);
}

#[test]
fn nearly_every_element_type_agrees_with_nx() {
    let Some(s) = solve(
        Some("nastran/nx_static_elements/static_elements.bdf"),
        "nastran/nx_static_elements/static_elements.op2",
        |model, _| {
            // The printed loads of the run come from an earlier deck: only the force at grid 13 and PLOAD4.
            for set in &mut model.load_sets {
                set.loads.retain(|(_, load)| match load {
                    Load::Force(_, f) => f.z == 10_000.0,
                    Load::ShellPressure { pressure, .. } => pressure[0] == 20_000.0,
                    _ => false,
                });
            }
        },
    ) else {
        return;
    };
    s.reaches(limits::NEARLY_EVERY);
}

#[test]
fn every_kind_of_load_on_nearly_every_element_agrees_with_msc() {
    let Some(s) = solve(
        Some("nastran/nx_static_elements/static_elements.bdf"),
        "nastran/nx_static_elements/static_elements.h5",
        as_it_is,
    ) else {
        return;
    };
    s.reaches(limits::NEARLY_EVERY);
}

#[test]
fn a_plate_partly_of_plies_agrees_with_msc() {
    let Some(s) = solve(
        Some("nastran/msc_plate_pcomp_2cases/Flat_plate_tip_loads_mixed_2cases.bdf"),
        "nastran/msc_plate_pcomp_2cases/flat_plate_tip_loads_mixed_2cases.op2",
        as_it_is,
    ) else {
        return;
    };
    s.reaches(limits::PLIES);
}

#[test]
fn single_solids_and_curved_shells_agree_with_nx() {
    let Some(s) = solve(
        Some("nastran/nx_quad8_replicated_deck/cqrcc128a.bdf"),
        "nastran/nx_quad8_replicated_deck/cqrcc128a.op2",
        as_it_is,
    ) else {
        return;
    };
    s.reaches(limits::SINGLE);
}

#[test]
fn a_brick_beam_with_rigid_ends_agrees_with_msc() {
    let Some(s) = solve(
        None,
        "nastran/msc_rbe2_2020/rigid_rbe2--v2020.op2",
        as_it_is,
    ) else {
        return;
    };
    s.reaches(limits::RIGID_ENDS);
}

#[test]
fn a_brick_beam_on_a_bush_agrees_with_msc() {
    let Some(s) = solve(
        Some("nastran/msc_cbush_2021/cbush_test.bdf"),
        "nastran/msc_cbush_2021/cbush_test.op2",
        as_it_is,
    ) else {
        return;
    };
    s.reaches(limits::BUSH);
}
