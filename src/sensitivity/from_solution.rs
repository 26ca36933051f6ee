//! S from the strain fields of unit loads, and the shells that are in every field.

use super::{Load, Sensitivity};
use crate::fe::CaseResult;
use crate::finding::{Finding, Severity};
use crate::gauge::{Arm, Gauge, Spot, gauge_reading};
use crate::linalg::Matrix;
use crate::model::ShellIx;
use std::collections::BTreeSet;

/// A load and the case in which it acts with the size `applied` (job units, signed).
#[derive(Clone, Debug)]
pub struct LoadCaseOf<'a> {
    /// The column.
    pub load: Load,
    /// Size of the load in this case.
    pub applied: f64,
    /// Strain of the load case.
    pub case: &'a CaseResult,
}

/// A gauge without strain in some case.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("gauge `{gauge}`: {}: {}", self.describe_cause(), self.remedy())]
pub struct NoStrain {
    /// Gauge.
    pub gauge: String,
    /// Element id.
    pub element: u32,
    /// Subcase id.
    pub subcase: u32,
    /// Load.
    pub load: String,
    /// Cause of the missing strain.
    pub why: NoStrainCause,
}

/// Cause of missing strain at a gauge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoStrainCause {
    /// The case has no strain of the element.
    Absent,
    /// The station is between stations of the result, and the strain between them is not linear.
    BetweenStations,
}

impl NoStrain {
    /// Returns the cause as a message.
    pub fn describe_cause(&self) -> String {
        let Self {
            element,
            subcase,
            load,
            ..
        } = self;
        match self.why {
            NoStrainCause::Absent => {
                format!("element {element} has no strain in subcase {subcase} (load `{load}`)")
            }
            NoStrainCause::BetweenStations => format!(
                "the results do not determine the strain of element {element} at this `station` in subcase {subcase} (load `{load}`): PLOAD1 acts along the element, or its section changes along it"
            ),
        }
    }

    /// Returns the remedy.
    pub fn remedy(&self) -> &'static str {
        match self.why {
            NoStrainCause::Absent => {
                "ask for STRAIN of that element in every subcase, or move the gauge"
            }
            NoStrainCause::BetweenStations => {
                "state a station of the results (an end, or a CBARAO or PBEAM station), or delete `results`, so that the built-in solver \
                 computes the strain"
            }
        }
    }
}

/// Returns the cause of a missing reading.
fn cause(gauge: &Gauge, case: &CaseResult) -> NoStrainCause {
    let between = |arm: &Arm| match arm.spot {
        Spot::Beam { beam, .. } | Spot::BeamAxis { beam, .. } => {
            case.beams.is_at_stations_alone(beam)
        }
        Spot::Shell { .. } => false,
    };
    match gauge.arms.iter().any(between) {
        true => NoStrainCause::BetweenStations,
        false => NoStrainCause::Absent,
    }
}

/// Returns S from load cases: `S[g][l] = reading of gauge g in the case of load l / applied`.
///
/// # Errors
/// Returns every gauge that has no strain in some case.
///
/// # Example
/// A gauge at the free end of a cantilever reads zero, and a gauge at mid-length reads half the strain of the root:
/// ```
/// use nastran::bdf::{MemoryLoader, read_deck};
/// use strainbridge::fe::{LoadCase, solve_cases};
/// use strainbridge::gauge::{CornerRows, GaugePlace, GaugeSpec, build};
/// use strainbridge::model::{Model, ShellIx};
/// use strainbridge::sensitivity::{Load, LoadCaseOf, from_cases};
///
/// # const DECK: &str = "SOL 101\nCEND\nSPC = 1\nLOAD = 2\nBEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,1000.,0.,0.\nCBAR,1,1,1,2,0.,0.,1.
/// # PBAR,1,1,600.,2.+4,8.+4,1.+4\n,10.,0.\nMAT1,1,210000.,,.3\nSPC1,1,123456,1\nFORCE,2,2,,500.,0.,0.,1.\nENDDATA\n";
/// let deck = read_deck("cantilever.bdf", DECK.into(), &mut MemoryLoader::default());
/// let (model, _) = Model::from_deck(&deck);
/// let subcase = &deck.case_control.effective_subcases()[0];
/// let case = LoadCase::of_subcase(&model, subcase, "tip".to_owned());
/// let (solution, _) = solve_cases(&model, &[case], &Default::default())?;
///
/// let beam = model.beam_ix(1).unwrap();
/// let mut gauges = Vec::new();
/// for (name, station) in [("root", 0.0), ("middle", 0.5), ("end", 1.0)] {
///     let place = GaugePlace::Beam { beam, point: 0, station };
///     let spec = GaugeSpec { place, ..GaugeSpec::place_on_shell(name, ShellIx(0)) };
///     gauges.extend(build(&model, &spec, CornerRows::Absent)?.0);
/// }
/// let tip = LoadCaseOf { load: Load::from_name("tip"), applied: 500.0, case: &solution.cases[0] };
/// let s = from_cases(&gauges, &[tip]).unwrap();
/// let root = -1000.0 * 10.0 / (210_000.0 * 20_000.0); // -L c / (E I), strain per newton
/// assert!((s.values[(0, 0)] / root - 1.0).abs() < 1e-9);
/// assert!((s.values[(1, 0)] / root - 0.5).abs() < 1e-9 && (s.values[(2, 0)] / root).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn from_cases(gauges: &[Gauge], loads: &[LoadCaseOf]) -> Result<Sensitivity, Vec<NoStrain>> {
    let mut missing = Vec::new();
    let mut values = Matrix::zeros(gauges.len(), loads.len());
    for (g, gauge) in gauges.iter().enumerate() {
        for (l, load) in loads.iter().enumerate() {
            match gauge_reading(gauge, load.case) {
                Some(v) => values[(g, l)] = v / load.applied,
                None => missing.push(NoStrain {
                    gauge: gauge.name.clone(),
                    element: gauge.element,
                    subcase: load.case.subcase,
                    load: load.load.name.clone(),
                    why: cause(gauge, load.case),
                }),
            }
        }
    }
    if !missing.is_empty() {
        return Err(missing);
    }
    Ok(Sensitivity {
        gauges: gauges.iter().map(|g| g.name.clone()).collect(),
        loads: loads.iter().map(|l| l.load.clone()).collect(),
        values,
        uncertainty: None,
        noise: None,
    })
}

/// Returns the shells with strain in every load's case, ascending, and a finding with the number of other shells.
pub fn common_shells(loads: &[LoadCaseOf]) -> (Vec<ShellIx>, Vec<Finding>) {
    let Some((first, rest)) = loads.split_first() else {
        return (Vec::new(), Vec::new());
    };
    let mut common: Vec<ShellIx> = first.case.shells.elements.to_vec();
    let mut any: BTreeSet<ShellIx> = common.iter().copied().collect();
    for l in rest {
        if std::sync::Arc::ptr_eq(&l.case.shells.elements, &first.case.shells.elements) {
            continue;
        }
        any.extend(l.case.shells.elements.iter());
        common.retain(|ix| l.case.shells.elements.binary_search(ix).is_ok());
    }
    let left_out = any.len() - common.len();
    let mut findings = Vec::new();
    if left_out > 0 {
        findings.push(
            Finding::new(
                Severity::Info,
                "elements-not-in-every-subcase",
                "candidates",
                format!(
                    "{left_out} shells have strain in the subcases of some loads only: they are not candidates ({} are)",
                    common.len()
                ),
                "ask for STRAIN(FIBER,CENTER) = ALL in every subcase",
            )
            .with_numbers(left_out as f64, 0.0),
        );
    }
    (common, findings)
}
