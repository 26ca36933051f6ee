//! The text of a job, commented for whoever corrects it.

use super::mesh::{extent, shell_side};
use super::plain_name::plain_name;
use super::propose::{LeftOutLoad, ProposedLoad, StrainFrom};
use super::round::round;
use crate::fe::Support;
use crate::strain_chain::deck::DeckModel;
use crate::units::UnitSystem;
use crate::workflow::cases::from_folder;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Heading of the sections that are filled in once gauges are installed.
pub(super) const LATER: &str = "\n# Once gauges are glued and read:\n";
/// Largest number of listed properties. A longer list is left out, which means all properties.
const MOST_PROPERTIES: usize = 60;

/// The file of a proposed job.
pub const JOB: &str = "job.toml";

/// Inputs of the text of a job.
#[derive(Clone)]
pub(super) struct JobPlan<'a> {
    pub deck: &'a DeckModel,
    pub deck_path: &'a Path,
    pub results: &'a [PathBuf],
    /// Folder of the job.
    pub folder: &'a Path,
    /// System of units. With `None` the job does not state it.
    pub system: Option<UnitSystem>,
    pub from: StrainFrom,
    /// Reason why given results are left out.
    pub without_results: &'a str,
    pub loads: &'a [ProposedLoad],
    /// Loads and subcases that are not proposed.
    pub left_out: Vec<LeftOutLoad>,
    /// Least distance between gauges.
    pub spacing: f64,
    /// Degrees between the angles of candidates.
    pub angle_step_deg: u32,
}

/// Returns the least distance between gauges that suits a model: two sides of a shell, and a hundredth of the model.
pub(super) fn usual_spacing(deck: &DeckModel) -> f64 {
    let sides = 2.0 * shell_side(&deck.model).unwrap_or(0.0);
    round(sides.max(extent(&deck.model) / 100.0))
}

impl JobPlan<'_> {
    /// Returns the text of job.toml.
    pub(super) fn text(&self) -> String {
        [
            self.head(),
            self.loads_text(),
            self.candidates(),
            self.placement(),
            self.measured_text(),
        ]
        .concat()
    }

    fn head(&self) -> String {
        let path = |p: &Path| from_folder(self.folder, p);
        let title = self.deck_path.file_stem().unwrap_or_default();
        let choices = "\"m-kg-s\", \"mm-t-s\", \"mm-kg-s\" or \"in-lbf-s\"";
        let units = match self.system {
            Some(s) => format!(
                "units = \"{}\"                  # check: by Young's moduli and densities; {choices}",
                s.name()
            ),
            None => format!(
                "# units = \"m-kg-s\"                # fill in: the deck's materials fit none of {choices}"
            ),
        };
        let (force, moment) = match self.system {
            Some(UnitSystem::InLbfS) => ("lbf", "lbf in"),
            _ => ("kN", "kN m"),
        };
        let results: Vec<String> = self
            .results
            .iter()
            .map(|p| format!("\"{}\"", path(p)))
            .collect();
        let results = match (self.from, results.is_empty()) {
            (StrainFrom::Results, _) => format!("results = [{}]", results.join(", ")),
            (StrainFrom::Solver, false) => format!(
                "# results = [{}]        # not used: {}; the built-in solver computes the strain",
                results.join(", "),
                self.without_results
            ),
            (StrainFrom::Solver, true) => {
                "# results = [\"unit_loads.op2\"]        # of the deck that `strainbridge cases job.toml` writes; without this line the built-in solver computes them".to_owned()
            }
        };
        format!(
            "# Written by `strainbridge init`. Read every line with `check`: they are proposals from the deck.\n\
             title = \"{}\"\n\
             {units}\n\
             report_units = {{ force = \"{force}\", moment = \"{moment}\" }}\n\n\
             [model]\ndeck = \"{}\"\n{results}\n{}\n",
            plain_name(&title.to_string_lossy()),
            path(self.deck_path),
            self.support()
        )
    }

    /// Returns the `support` line of the job, with a comment on the support.
    fn support(&self) -> String {
        let held = Support::without_spc(&self.deck.model);
        match self.deck.model.selected_spcs.as_slice() {
            [] if held.is_held() || held.by_springs > 0 => format!("support = \"deck\"                     # check: the deck selects no SPC set; the structure is {}", held.words()),
            [] => "# support = \"free\"                   # the deck selects no SPC set: inertia balances every load".to_owned(),
            [set] => format!("support = \"deck\"                     # check: SPC set {set} of the deck holds the structure while gauges are read; \"free\": inertia relief"),
            [set, ..] => format!("support = {set}                          # check: the deck's subcases select several SPC sets; \"free\": inertia relief"),
        }
    }

    fn loads_text(&self) -> String {
        let mut t = String::from(
            "\n# One [[load]] for each load that acts while the gauges are read, those you don't ask for included (role = \"nuisance\").\n",
        );
        self.loads.iter().for_each(|l| t.push_str(&self.load(l)));
        if self.loads.is_empty() {
            t.push_str("\n[[load]]\nname = \"LF.FZ\"\ngrid = 1                              # fill in: the grid where it acts\ncomponent = \"FZ\"\nexpected = 10000.0\n");
        }
        for of_one in self.left_out.chunk_by(|a, b| a.why == b.why) {
            /// Largest number of sections that are written for one reason. Further sections are listed by name.
            const MOST: usize = 24;
            let _ = writeln!(t, "\n# Left out: {}.", of_one[0].why);
            for (i, l) in of_one.iter().enumerate() {
                match l.load.as_ref().filter(|_| i < MOST) {
                    Some(load) => {
                        let text = self.load(load);
                        let lines = text.trim().lines();
                        lines.for_each(|line| t.push_str(&format!("# {line}\n")));
                    }
                    None => t.push_str(&format!("# {}\n", l.name)),
                }
            }
        }
        t
    }

    fn load(&self, l: &ProposedLoad) -> String {
        let mut t = format!("\n[[load]]\nname = \"{}\"\n{}\n", l.name, l.what);
        let _ = writeln!(
            t,
            "applied = {:?}                      # check: size in its subcase, signed",
            l.applied
        );
        if self.from == StrainFrom::Results {
            if let Some(r) = &l.result {
                let _ = writeln!(t, "result = \"{}\"", from_folder(self.folder, Path::new(r)));
            }
            if let Some(s) = l.subcase {
                let _ = writeln!(t, "subcase = {s}");
            }
        }
        let _ = writeln!(
            t,
            "expected = {:?}                     # check: typical size{}, about a third of the largest",
            l.expected, l.expected_is
        );
        t
    }

    fn candidates(&self) -> String {
        let model = &self.deck.model;
        let mut properties: BTreeMap<u32, usize> = BTreeMap::new();
        for s in &model.shells {
            if let Some(p) = model.shell_properties.get(s.property.us()) {
                *properties.entry(p.id).or_default() += 1;
            }
        }
        let mut t = String::from(
            "\n[candidates]                           # where `place` may put gauges\n",
        );
        for (id, n) in &properties {
            let name = model
                .property_names
                .iter()
                .find(|p| p.0 == *id)
                .map_or(String::new(), |p| format!(" ({})", p.1));
            let _ = writeln!(t, "# property {id}{name}: {n} shells");
        }
        let ids: Vec<String> = properties.keys().map(u32::to_string).collect();
        if !ids.is_empty() && ids.len() <= MOST_PROPERTIES {
            let _ = writeln!(t, "properties = [{}]", ids.join(", "));
        }
        let side = shell_side(model).unwrap_or(0.0);
        let [grid, clear, far] = [0.2, 1.0, 4.0].map(|n| round(n * side));
        let _ = write!(
            t,
            "surfaces = [\"top\", \"bottom\"]         # drop the side that can't be reached\n\
             angle_step_deg = {}                  # or \"continuous\"\n\
             # grid_length = {grid:?}                  # strain is averaged over the gauge's grid; the shells have sides of {:?}\n\
             # clear_of = {{ edges = {clear:?}, holes = {clear:?}, joints = {clear:?}, loads = {far:?}, attachments = {far:?} }}  # strain there is not to be trusted\n",
            self.angle_step_deg,
            round(side)
        );
        t
    }

    fn placement(&self) -> String {
        let (n, more) = (self.loads.len().max(1), 2 * self.loads.len().max(1));
        // A technician positions a gauge with a ruler within 2 mm. On a small part the tolerance is smaller.
        let rule = self.system.map_or(f64::INFINITY, |s| 2e-3 / s.length_m());
        let shift = round(rule.min(extent(&self.deck.model) / 500.0));
        format!(
            "\n[placement]\n\
             gauges = {more}                           # twice the number of loads: some may fail\n\
             spacing = {:?}                       # least distance between gauges, at least their own length\n\
             noise_microstrain = 1.0\n\
             model_uncertainty_rel = 0.02         # of the predicted strain, 1 sd; [measured] states the same\n\
             angle_tolerance_deg = 2.0\n\
             position_tolerance = {shift:?}             # check: how well a gauge is glued at its place, 1 sd\n\
             # curve = [{n}, {more}]                     # what each of these numbers of gauges gives\n\
             # reserve = 2                        # gauges kept for validation\n\
             # loss = \"optimise\"                  # best layout after the worst loss of one gauge\n",
            self.spacing
        )
    }

    fn measured_text(&self) -> String {
        LATER.to_owned()
            + "# [gauges]\n\
         # file = \"job.out/gauges.csv\"\n\
         # [measured]\n\
         # strain = \"strain.csv\"                # one column for each gauge, microstrain; one row for each run (`run`) or sample (`time`)\n\
         # zero = \"zero.csv\"\n\
         # noise_microstrain = 1.0\n\
         # model_uncertainty_rel = 0.02\n"
    }
}
