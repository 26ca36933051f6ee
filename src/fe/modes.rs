//! Elastic modes of a free or supported structure.

use super::error::FeError;
use super::lanczos::{Accuracy, ModeRequest, Pair, find_lowest_modes};
use super::load_case::{LoadCase, Relief};
use super::mass::{Mass, MassProperties};
use super::options::SolveOptions;
use super::prepared_model::PreparedModel;
use super::strain_of_cases::with_strain;
use super::system::System;
use super::{DisplacementSolution, Solution, SolveReport};
use crate::finding::{Finding, Severity, list_few};
use crate::linalg::sparse::Factor;
use crate::model::{Model, Vec3};
use crate::stop::Stop;

/// Accuracy of frequencies computed with a static solution, to test whether records are slow: a few parts in ten thousand for any spacing.
const WITH_STATICS_ACCURACY: Accuracy = Accuracy {
    frequency: 2e-4,
    residual: f64::INFINITY,
};
/// Accuracy of modes that are computed alone: shapes are needed too, and their error is the residual over the gap.
const ALONE: Accuracy = Accuracy {
    frequency: 1e-8,
    residual: 1e-5,
};
/// Two modes nearer than this share of their frequency mix freely: their shapes are any two of the space they span.
const CLOSE: f64 = 1e-4;

/// A mode of vibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Cycles per unit of time.
    pub frequency: f64,
    /// u'Mu of the shape: 1 except for rounding.
    pub generalised_mass: f64,
    /// Share of the equation that is not satisfied: |K^-1 M u - u / omega^2| over |u / omega^2| in the norm of M.
    pub residual: f64,
    /// Bound on the relative error of the frequency that follows from residual and gap.
    pub frequency_error: f64,
    /// Distance to the nearest other mode, divided by the value of this mode. Values are 1 / omega^2.
    pub gap: f64,
    /// Modal effective mass along x, y, z and about axes through the centre of gravity: (u'MR)^2 / u'Mu. Zero for a free structure, whose
    /// elastic modes move no centre of gravity.
    pub effective_mass: [f64; 6],
    /// Shape with unit generalised mass, basic frame: translation and rotation by grid index.
    pub shape: Vec<[f64; 6]>,
}

/// Modes of a structure, with their strain.
#[derive(Clone, Debug, Default)]
pub struct ModalSolution {
    /// Modes with ascending frequency, without rigid motions.
    pub modes: Vec<Mode>,
    /// Number of rigid motions without a support.
    pub rigid_motions: usize,
    /// Mass and centre of gravity.
    pub mass: Option<MassProperties>,
    /// Number of unknowns.
    pub dofs: usize,
    /// Strain of every shape, with the subcase numbers 1 .. n.
    pub strain: Solution,
    /// Findings of the solver.
    pub findings: Vec<Finding>,
}

/// Computes the lowest elastic modes with their strain; rigid motions are left out.
///
/// `spc` supports the structure; rigid motions without a support remain free. Mass and stiffness are the same as in statics, including PARAM,WTMASS
/// and PARAM,COUPMASS.
///
/// # Errors
/// Returns every error of [`FeError`], for example [`FeError::NoMassToVibrate`] for a structure without mass.
///
/// # Example
/// Two free masses on a spring vibrate at `sqrt(k (1 / m1 + 1 / m2)) / 2 pi`:
/// ```
/// use nastran::bdf::{MemoryLoader, read_deck};
/// use strainbridge::fe::solve_modes;
/// use strainbridge::model::Model;
///
/// # const DECK: &str = "SOL 103\nCEND\nBEGIN BULK\nGRID,1,,0.,0.,0.,,23456\nGRID,2,,1.,0.,0.,,23456
/// # CELAS2,1,8000.,1,1,2,1\nCONM2,2,1,,2.\nCONM2,3,2,,3.\nENDDATA\n";
/// let deck = read_deck("masses.bdf", DECK.into(), &mut MemoryLoader::default());
/// let (model, _) = Model::from_deck(&deck);
/// let found = solve_modes(&model, None, None, 1, &Default::default())?;
/// let exact = (8000.0_f64 * (1.0 / 2.0 + 1.0 / 3.0)).sqrt() / std::f64::consts::TAU;
/// assert!((found.modes[0].frequency / exact - 1.0).abs() < 1e-9);
/// // Momentum: the masses move in opposite directions, and their centre stays.
/// let shape = &found.modes[0].shape;
/// assert!((2.0 * shape[0][0] + 3.0 * shape[1][0]).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn solve_modes(
    model: &Model,
    spc: Option<u32>,
    mpc: Option<u32>,
    count: usize,
    options: &SolveOptions,
) -> Result<ModalSolution, FeError> {
    super::unsupported_cards::refuse(model, &[])?;
    let prepared = PreparedModel::new(model);
    let mass = Mass::new(&prepared);
    let x: Vec<Vec3> = model.grids.iter().map(|g| g.x).collect();
    if mass.is_zero() {
        return Err(FeError::NoMassToVibrate);
    }
    let properties = mass.properties(&x);
    let centre = properties.map_or_else(Vec3::zeros, |p| p.cg);
    let mut findings = super::formulation::formulations(model);
    findings.extend(super::shape_checks::check_shapes(model));
    let (pairs, rigid_motions, dofs) = pairs_of(
        &prepared,
        &mass,
        (spc, mpc),
        (count, &options.stop),
        &mut findings,
    )?;
    findings.extend(fewer_than_wanted(pairs.len(), count));
    findings.extend(not_converged(&pairs));
    findings.extend(close_modes(&pairs));
    let modes: Vec<Mode> = pairs
        .into_iter()
        .map(|p| build_mode(&mass, &x, &centre, p))
        .collect();
    let cases: Vec<LoadCase> = (1..)
        .zip(&modes)
        .map(|(subcase, mode)| LoadCase {
            subcase,
            label: format!("mode {subcase}, {} cycles per unit of time", mode.frequency),
            loads: Vec::new(),
            spc,
            mpc,
            relief: Relief::None,
        })
        .collect();
    let solved = DisplacementSolution {
        displacements: modes.iter().map(|m| m.shape.clone()).collect(),
        report: SolveReport::default(),
        findings: Vec::new(),
    };
    let (strain, _) = with_strain(&prepared, &cases, solved, options)?;
    Ok(ModalSolution {
        modes,
        rigid_motions,
        mass: properties,
        dofs,
        strain,
        findings,
    })
}

/// Returns the frequencies of the lowest elastic modes from the factor of a static solution.
///
/// # Errors
/// Returns every error of [`FeError`].
pub(super) fn frequencies(
    prepared: &PreparedModel<'_>,
    mass: &Mass,
    system: &System,
    factor: &Factor<'_>,
    (count, stop): (usize, &Stop),
) -> Result<Vec<f64>, FeError> {
    let wanted = ModeRequest {
        count,
        accuracy: WITH_STATICS_ACCURACY,
        shapes: false,
        stop,
    };
    let pairs = find_lowest_modes(prepared, mass, system, factor, wanted)?;
    Ok(pairs.iter().map(|p| p.frequency).collect())
}

/// Pairs, rigid motions left free, unknowns.
fn pairs_of(
    prepared: &PreparedModel<'_>,
    mass: &Mass,
    (spc, mpc): (Option<u32>, Option<u32>),
    (count, stop): (usize, &Stop),
    findings: &mut Vec<Finding>,
) -> Result<(Vec<Pair>, usize, usize), FeError> {
    let sets = (spc, mpc, [].as_slice());
    let mut system = System::new(prepared, mass, sets, Relief::Automatic, findings)?;
    // Enforced displacements of statics are zero in modes.
    system.reduction.forget_enforced();
    let n = system.symbolic.n_unknowns();
    let rigid_motions = system.body.as_ref().map_or(0, |b| b.n_free());
    if n == 0 || count == 0 {
        return Ok((Vec::new(), rigid_motions, n));
    }
    let stiffness = std::mem::take(&mut system.stiffness);
    let factor = system.factor(prepared, mass, stiffness)?;
    let wanted = ModeRequest {
        count,
        accuracy: ALONE,
        shapes: true,
        stop,
    };
    let pairs = find_lowest_modes(prepared, mass, &system, &factor, wanted)?;
    Ok((pairs, rigid_motions, n))
}

/// A pair with its masses, its largest translation positive.
fn build_mode(mass: &Mass, x: &[Vec3], centre: &Vec3, pair: Pair) -> Mode {
    let frequency_error = pair.frequency_error();
    let mut shape = pair.shape;
    let largest = shape
        .iter()
        .flat_map(|u| &u[..3])
        .fold(0.0_f64, |a, v| if v.abs() > a.abs() { *v } else { a });
    if largest < 0.0 {
        shape.iter_mut().flatten().for_each(|v| *v = -*v);
    }
    let momentum = mass.times(&shape);
    let work = |a: &[[f64; 6]], b: &mut dyn Iterator<Item = [f64; 6]>| -> f64 {
        a.iter()
            .zip(b)
            .map(|(a, b)| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>())
            .sum()
    };
    let generalised_mass = work(&momentum, &mut shape.iter().copied());
    let effective_mass = std::array::from_fn(|i| {
        let motion = mass.rigid_field(i, x, centre);
        work(&momentum, &mut motion.into_iter()).powi(2) / generalised_mass
    });
    Mode {
        frequency: pair.frequency,
        generalised_mass,
        residual: pair.residual,
        frequency_error,
        gap: pair.gap,
        effective_mass,
        shape,
    }
}

fn fewer_than_wanted(found: usize, wanted: usize) -> Option<Finding> {
    (found < wanted).then(|| {
        Finding::new(
            Severity::Info,
            "fewer-modes",
            "modes",
            format!("the structure has {found} elastic modes with mass, {wanted} were asked for"),
            "ask for fewer, or give mass to the parts that should vibrate",
        )
        .with_numbers(found as f64, wanted as f64)
    })
}

fn not_converged(pairs: &[Pair]) -> Option<Finding> {
    let worst = pairs
        .iter()
        .map(Pair::frequency_error)
        .fold(0.0_f64, f64::max);
    (worst > ALONE.frequency.max(1e-6)).then(|| {
        Finding::new(
            Severity::Warning,
            "modes-not-converged",
            "modes",
            "the iteration ended before the last modes had converged: only their frequencies are accurate, to the stated number",
            "ask for fewer modes, or for more than needed, and ignore the last ones",
        )
        .with_numbers(worst, ALONE.frequency)
    })
}

fn close_modes(pairs: &[Pair]) -> Option<Finding> {
    let close: Vec<String> = (1..)
        .zip(pairs.windows(2))
        .filter(|(_, w)| (w[1].frequency - w[0].frequency).abs() < CLOSE * w[0].frequency)
        .map(|(i, _)| format!("{i} and {}", i + 1))
        .collect();
    (!close.is_empty()).then(|| {
        Finding::new(
            Severity::Info,
            "close-modes",
            format!("modes {}", list_few(&close)),
            "these frequencies coincide: each shape is one of many with this frequency",
            "compare the space of these shapes, not single shapes",
        )
        .with_numbers(close.len() as f64, 0.0)
    })
}
