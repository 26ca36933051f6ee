//! Case control: subcases with their loads, constraints and output requests.

mod options;
mod read;
mod set;

pub(super) use read::read_case_control;
pub use set::{Set, SetItem};

use std::collections::BTreeMap;

use crate::cards::Param;
use crate::place::Place;

/// Case control as written; [`CaseControl::effective_subcase`] applies the values that subcases inherit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CaseControl {
    /// Statements above the first subcase; its id is 0.
    pub global: Subcase,
    /// SUBCASE, SUBCOM, SYM .. in file order.
    pub subcases: Vec<Subcase>,
    /// Every statement, comments left out, for edits.
    pub lines: Vec<CaseLine>,
}

/// A statement of case control.
#[derive(Clone, Debug, PartialEq)]
pub struct CaseLine {
    /// First line of the statement.
    pub at: Place,
    /// Index of its subcase in [`CaseControl::subcases`]; `None` above the first.
    pub subcase: Option<usize>,
    /// First keyword, upper case, as written.
    pub name: String,
    /// The statement without comments, its lines joined.
    pub text: String,
    /// Whether the statement is not executed: below OUTPUT(PLOT), OUTPUT(POST) and the like, or between SKIPON and SKIPOFF.
    pub in_packet: bool,
    /// Offsets of the first byte of the statement and after its last line.
    pub(super) start: usize,
    pub(super) end: usize,
}

/// Kind of the statement that begins a subcase.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum SubcaseKind {
    /// SUBCASE.
    #[default]
    Subcase,
    /// SUBCOM: a combination of the subcases above by SUBSEQ.
    Subcom,
    /// SYM.
    Sym,
    /// SYMCOM: a combination of the SYMs above by SYMSEQ.
    Symcom,
    /// REPCASE: other output of the subcase above.
    Repcase,
}

/// A subcase as written: a value of `None` is inherited.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Subcase {
    /// Number; 0 for the part above all subcases.
    pub id: u32,
    /// Kind of the statement that begins the subcase.
    pub kind: SubcaseKind,
    /// Place of this statement.
    pub at: Place,
    /// TITLE.
    pub title: Option<String>,
    /// SUBTITLE.
    pub subtitle: Option<String>,
    /// LABEL.
    pub label: Option<String>,
    /// LOAD.
    pub load: Option<u32>,
    /// SPC.
    pub spc: Option<u32>,
    /// MPC.
    pub mpc: Option<u32>,
    /// NSM.
    pub nsm: Option<u32>,
    /// SUPORT1.
    pub suport1: Option<u32>,
    /// TEMPERATURE(LOAD) or (BOTH), or without an option.
    pub temperature_load: Option<u32>,
    /// TEMPERATURE(INITIAL).
    pub temperature_initial: Option<u32>,
    /// TEMPERATURE(MATERIAL) or (BOTH), or without an option.
    pub temperature_material: Option<u32>,
    /// DEFORM.
    pub deform: Option<u32>,
    /// METHOD.
    pub method: Option<u32>,
    /// ANALYSIS, upper case.
    pub analysis: Option<String>,
    /// SUBSEQ or SYMSEQ.
    pub sequence: Vec<f64>,
    /// Output requests. Of several requests with one name, the last counts.
    pub requests: Vec<Request>,
    /// SETs defined here.
    pub sets: BTreeMap<u32, Set>,
    /// PARAMs given here.
    pub params: Vec<Param>,
}

/// An output request, such as `STRAIN(PLOT,FIBER) = ALL`.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// Full upper-case name: `DISPLACEMENT`, `STRAIN`, `STRESS`, `FORCE`, `SPCFORCES`, `MPCFORCES`, `OLOAD`, `GPFORCE` ..
    pub what: String,
    /// Options in brackets, upper case.
    pub options: Vec<String>,
    /// Grids or elements of the request.
    pub value: Selection,
}

/// Selection of grids or elements in a request.
#[derive(Clone, Debug, PartialEq)]
pub enum Selection {
    /// ALL (or YES).
    All,
    /// NONE (or NO).
    None,
    /// A SET.
    Set(u32),
    /// Ids that the request itself lists, `= 1, 2 THRU 9`.
    Ids(Set),
}

impl Request {
    /// Returns whether the request has an option.
    pub fn has(&self, option: &str) -> bool {
        self.options.iter().any(|o| o.eq_ignore_ascii_case(option))
    }
}

impl Subcase {
    /// Returns the request of this full name.
    pub fn request(&self, what: &str) -> Option<&Request> {
        self.requests.iter().rev().find(|r| r.what == what)
    }
}

impl CaseControl {
    /// Returns the subcase with the values that it inherits from the part above all subcases.
    pub fn effective_subcase(&self, subcase: &Subcase) -> Subcase {
        let global = &self.global;
        let mut full = subcase.clone();
        full.title = subcase.title.clone().or_else(|| global.title.clone());
        full.subtitle = subcase.subtitle.clone().or_else(|| global.subtitle.clone());
        full.label = subcase.label.clone().or_else(|| global.label.clone());
        full.load = subcase.load.or(global.load);
        full.spc = subcase.spc.or(global.spc);
        full.mpc = subcase.mpc.or(global.mpc);
        full.nsm = subcase.nsm.or(global.nsm);
        full.suport1 = subcase.suport1.or(global.suport1);
        full.temperature_load = subcase.temperature_load.or(global.temperature_load);
        full.temperature_initial = subcase.temperature_initial.or(global.temperature_initial);
        full.temperature_material = subcase.temperature_material.or(global.temperature_material);
        full.deform = subcase.deform.or(global.deform);
        full.method = subcase.method.or(global.method);
        full.analysis = subcase.analysis.clone().or_else(|| global.analysis.clone());
        let inherited = global
            .requests
            .iter()
            .filter(|r| subcase.request(&r.what).is_none())
            .cloned();
        full.requests = inherited.chain(subcase.requests.iter().cloned()).collect();
        for (id, set) in &global.sets {
            full.sets.entry(*id).or_insert_with(|| set.clone());
        }
        let params = global
            .params
            .iter()
            .filter(|p| subcase.params.iter().all(|own| own.name != p.name))
            .cloned();
        full.params = params.chain(subcase.params.iter().cloned()).collect();
        full
    }

    /// Returns the place of the statement of this full name that counts in a subcase. It is the last such statement in the subcase, otherwise the
    /// last above the subcases.
    pub fn place_of(&self, word: &str, subcase: Option<u32>) -> Option<Place> {
        let is_named = |l: &&CaseLine| {
            !l.in_packet && super::vocabulary::case_word(&l.name).is_some_and(|w| w.name == word)
        };
        let within = |l: &&CaseLine| {
            let own = l.subcase.and_then(|i| self.subcases.get(i));
            own.is_some_and(|s| Some(s.id) == subcase)
        };
        let lines = self.lines.iter().rev().filter(is_named);
        let here = lines.clone().find(within);
        let above = || lines.clone().find(|l| l.subcase.is_none());
        here.or_else(above).map(|l| l.at)
    }

    /// Returns the MPC set that belongs to the structure under every load. It is the set above the subcases, otherwise the smallest set that a
    /// subcase selects.
    pub fn mpc_of_structure(&self) -> Option<u32> {
        let below = self.subcases.iter().filter_map(|s| s.mpc).min();
        self.global.mpc.or(below)
    }

    /// Returns all subcases with the values that they inherit. A deck without SUBCASE has one subcase, with id 1.
    ///
    /// # Example
    /// ```
    /// use nastran::bdf::{MemoryLoader, read_deck};
    ///
    /// let text = "CEND\nSPC = 1\nLOAD = 10\nSUBCASE 1\n LABEL = front\nSUBCASE 2\n LOAD = 20\nBEGIN BULK\nENDDATA\n";
    /// let deck = read_deck("cases.bdf", text.into(), &mut MemoryLoader::default());
    /// let subcases = deck.case_control.effective_subcases();
    /// let loads: Vec<_> = subcases.iter().map(|s| (s.id, s.load)).collect();
    /// assert_eq!(loads, [(1, Some(10)), (2, Some(20))]);
    /// assert!(subcases.iter().all(|s| s.spc == Some(1)));
    /// // As written, the first subcase states no load.
    /// assert_eq!(deck.case_control.subcases[0].load, None);
    /// ```
    pub fn effective_subcases(&self) -> Vec<Subcase> {
        if self.subcases.is_empty() {
            let mut only = self.global.clone();
            only.id = 1;
            return vec![only];
        }
        self.subcases
            .iter()
            .map(|s| self.effective_subcase(s))
            .collect()
    }
}
