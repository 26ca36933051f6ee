//! The answer of `ballast` and its findings.

use super::completed_deck::MassCards;
use super::task::{CompletedDeck, DECK, Task, force, length, mass};
use crate::estimate::NORMAL_95;
use crate::finding::{Finding, Severity};
use crate::host::outcome::Answer;
use crate::host::work::Work;
use crate::job::Job;
use crate::payload::{BallastFit, BallastSpec};
use crate::units::{number, plus_minus};
use serde::Serialize;

/// Masses that complete a model, report units.
#[derive(Serialize)]
pub struct BallastAnswer {
    /// The masses.
    pub masses: Vec<HungMass>,
    /// Reactions by wheel.
    pub reactions: Vec<Reaction>,
    /// Run whose measured reactions the completed model reproduces.
    pub run: String,
    /// Number of unknowns that the reactions determine.
    pub numbers_fixed: usize,
    /// Number of unknowns: three for each mass.
    pub numbers_asked: usize,
    /// All masses together, from statics alone.
    pub together: TotalMass,
    /// Name of the completed deck.
    pub completed_deck: String,
    /// Height of the masses (no influence on a level floor).
    #[serde(skip)]
    pub height: f64,
    /// The completed deck.
    #[serde(skip)]
    pub deck: CompletedDeck,
    /// The job.
    #[serde(skip)]
    pub job: Job,
}

impl Answer for BallastAnswer {
    const COMMAND: &'static str = "ballast";
    const RESULT: &'static str = "The masses";

    fn verdict(&self) -> String {
        let (mass, force) = (self.job.report_units.mass, self.job.report_units.force);
        let largest = |of: fn(&Reaction) -> f64| self.reactions.iter().map(of).fold(0.0, f64::max);
        let off = largest(|r| (r.after - r.measured).abs());
        let equal = match off <= 1e-6 * largest(|r| r.measured.abs()) {
            true => "equals the measured reaction".to_owned(),
            false => format!(
                "is within {} {} of the measured reaction",
                number(off),
                force.name
            ),
        };
        let half = NORMAL_95 * self.together.mass_sigma;
        format!(
            "{} of {} {} in total: every reaction {equal}.",
            match self.masses.len() {
                1 => "1 lumped mass".to_owned(),
                n => format!("{n} lumped masses"),
            },
            plus_minus(self.together.mass, half),
            mass.name,
        )
    }
}

/// A lumped mass. Each number has a 95 % interval. For its ends, the other numbers are adjusted to the data.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HungMass {
    /// Mass.
    pub mass: f64,
    /// 95 % interval of the mass.
    pub mass_range: [f64; 2],
    /// Place in plan.
    pub position: [f64; 2],
    /// 95 % intervals of the position.
    pub position_range: [[f64; 2]; 2],
    /// Grid of the completed deck.
    pub grid: u32,
    /// RBE3 that ties the mass.
    pub rbe3: u32,
    /// CONM2 of the mass.
    pub conm2: u32,
}

/// Reaction of a wheel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reaction {
    /// Name of the load.
    pub name: String,
    /// Measured reaction.
    pub measured: f64,
    /// Standard deviation of the reaction.
    pub sigma: f64,
    /// Reaction of the given deck.
    pub before: f64,
    /// Reaction of the completed deck, read back and solved.
    pub after: f64,
}

/// Total missing mass and its centre, from the resultant of measured reactions minus reactions of the model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TotalMass {
    /// Mass.
    pub mass: f64,
    /// Standard deviation of the total mass.
    pub mass_sigma: f64,
    /// Place in plan.
    pub position: [f64; 2],
    /// Standard deviations of the common centre.
    pub position_sigma: [f64; 2],
}

/// Result of the sizing, job units.
pub(super) struct BallastSizing<'a> {
    pub run: String,
    pub measured: &'a [f64],
    pub sigma: &'a [f64],
    pub before: &'a [f64],
    pub after: &'a [f64],
    pub fit: &'a BallastFit,
    pub cards: &'a [MassCards],
    pub height: f64,
}

/// Returns the answer in report units, with the completed deck.
pub(super) fn report_ballast(
    task: &Task,
    sized: &BallastSizing,
) -> impl FnOnce(CompletedDeck) -> BallastAnswer + use<> {
    let (job, g) = (task.job.clone(), task.gravity);
    let (f, l, m) = (force(&job), length(&job), mass(&job));
    let masses: Vec<HungMass> = sized
        .fit
        .masses
        .iter()
        .zip(sized.cards)
        .map(|(b, c)| HungMass {
            mass: b.weight / g * m,
            mass_range: b.weight_range.map(|v| v / g * m),
            position: b.at.map(|v| v * l),
            position_range: b.at_range.map(|r| r.map(|v| v * l)),
            grid: c.grid,
            rbe3: c.rbe3,
            conm2: c.conm2,
        })
        .collect();
    let reactions = task.wheels.loads.iter().enumerate();
    let reactions = reactions
        .map(|(i, w)| Reaction {
            name: job.loads[*w].name.clone(),
            measured: sized.measured[i] * f,
            sigma: sized.sigma[i] * f,
            before: sized.before[i] * f,
            after: sized.after[i] * f,
        })
        .collect();
    let (run, numbers_fixed, height) = (sized.run.clone(), sized.fit.fixed, sized.height * l);
    let together = missing_mass_resultant(task, sized);
    move |deck| BallastAnswer {
        numbers_asked: 3 * masses.len(),
        masses,
        reactions,
        run,
        numbers_fixed,
        together,
        completed_deck: format!("{DECK}.bdf"),
        height,
        deck,
        job,
    }
}

/// Returns the missing mass from statics alone: resultant of the measured reactions minus resultant of the model's reactions.
fn missing_mass_resultant(task: &Task, sized: &BallastSizing) -> TotalMass {
    let (job, g) = (task.job, task.gravity);
    let (l, m) = (length(job), mass(job));
    let pairs = sized.measured.iter().zip(sized.before);
    let lacking: Vec<f64> = pairs.map(|(m, b)| m - b).collect();
    let total: f64 = lacking.iter().sum();
    let spread = sized.sigma.iter().map(|s| s * s).sum::<f64>().sqrt();
    let (b, c) = ((task.wheels.axis + 1) % 3, (task.wheels.axis + 2) % 3);
    let centre = [b, c].map(|axis| {
        let x = task.standing.floor.positions().iter().map(|x| x[axis]);
        let at = x.clone().zip(&lacking).map(|(x, r)| x * r).sum::<f64>() / total;
        let var: f64 = x
            .zip(sized.sigma)
            .map(|(x, s)| ((x - at) * s).powi(2))
            .sum();
        [at * l, var.sqrt() / total.abs() * l]
    });
    TotalMass {
        mass: total / g * m,
        mass_sigma: spread / g * m,
        position: [centre[0][0], centre[1][0]],
        position_sigma: [centre[0][1], centre[1][1]],
    }
}

/// Ratio of the weight of the masses to the weight of the model above which a unit is wrong. The lightest structures carry some tens of times their
/// own weight. A mistaken unit gives a factor of a thousand.
const FAR_BEYOND: f64 = 100.0;

/// Density of steel, kg/m^3: of what carries a ballast, the heaviest that is common.
const STEEL_KG_M3: f64 = 7850.0;

/// Returns the weight of the structure in steel, job units, if no property has mass; 0 otherwise. Lumped masses do not count, because an
/// accelerometer may be the only mass in the model.
fn in_steel(task: &Task) -> f64 {
    let mut structure = task.read.model.clone();
    structure.masses.clear();
    if structure.weight().mass > 0.0 {
        return 0.0;
    }
    let units = task.job.units;
    let density = STEEL_KG_M3 * units.length_m().powi(3) / units.mass_kg();
    structure.params.wtmass = 1.0;
    structure.materials.iter_mut().for_each(|m| m.rho = density);
    structure.weight().mass * task.gravity
}

/// Returns the finding on masses that no structure of the model's mass carries.
pub(super) fn far_beyond(
    task: &Task,
    run: &str,
    before: &[f64],
    fit: &BallastFit,
) -> Option<Finding> {
    let steel = in_steel(task);
    let own = before.iter().sum::<f64>().max(0.0) + steel;
    let hung: f64 = fit.masses.iter().map(|m| m.weight).sum();
    let in_words = |weight: f64| number(weight / task.gravity * mass(task.job));
    let times = hung / own;
    let weighs = match steel > 0.0 {
        true => "would weigh in steel",
        false => "weighs",
    };
    (own > 0.0 && times > FAR_BEYOND).then(|| {
        Finding::new(
            Severity::Error,
            "ballast-beyond-model",
            run,
            format!(
                "the masses weigh {} times the mass that the model {weighs}: {} against {} {}",
                number(times),
                in_words(hung),
                in_words(own),
                task.job.report_units.mass.name
            ),
            "check the unit of the reactions ([runs] units), `units` of the job, and the densities of the deck",
        )
        .with_numbers(times, FAR_BEYOND)
    })
}

/// Misfit of a reaction above which the masses do not explain it, of the measured value.
const MATCHED: f64 = 0.02;

/// Reports the findings on the masses.
pub(super) fn report_mass_findings(
    work: &mut Work,
    task: &Task,
    run: &str,
    measured: &[f64],
    after: &[f64],
    fit: &BallastFit,
    spec: &BallastSpec,
) {
    let job = task.job;
    work.findings.push(Finding::new(
        Severity::Info,
        "flat-floor",
        "reactions",
        "the model is on a flat, level, frictionless floor; its springs determine how the wheels share the weight, and tyres are rigid",
        "",
    ));
    let (mut worst, mut name) = (0.0_f64, "");
    for ((l, m), a) in task.wheels.loads.iter().zip(measured).zip(after) {
        let off = ((a - m) / m).abs();
        if off > worst {
            (worst, name) = (off, &job.loads[*l].name);
        }
        if *a < 0.0 {
            work.findings.push(Finding::new(
                Severity::Error,
                "wheel-lifts-off",
                &job.loads[*l].name,
                "the completed model pulls at the floor here: the wheel would lift off, and the reactions are not valid",
                "check masses and stations, or the measured reactions",
            ));
        }
    }
    if worst > MATCHED {
        let explained = fit.chi2 <= 2.0 * measured.len() as f64;
        work.findings.push(
            Finding::new(
                if explained { Severity::Info } else { Severity::Warning },
                "reactions-not-matched",
                name,
                format!(
                    "no {} masses in the region reduce the difference of every reaction of run `{run}`: spring rates, the ground or \
                     friction distribute the weight differently than the model",
                    spec.masses
                ),
                "measure on level ground after rolling; check how the suspension distributes load between axles and sides",
            )
            .with_numbers(worst, MATCHED),
        );
    }
    let numbers = 3 * spec.masses;
    if fit.fixed < numbers {
        let ranges: Vec<String> = fit
            .masses
            .iter()
            .enumerate()
            .map(|(k, b)| {
                format!(
                    "mass {} {} to {} {}, {} to {} and {} to {} {}",
                    k + 1,
                    number(b.weight_range[0] / task.gravity * mass(job)),
                    number(b.weight_range[1] / task.gravity * mass(job)),
                    job.report_units.mass.name,
                    number(b.at_range[0][0] * length(job)),
                    number(b.at_range[0][1] * length(job)),
                    number(b.at_range[1][0] * length(job)),
                    number(b.at_range[1][1] * length(job)),
                    job.report_units.length.name,
                )
            })
            .collect();
        work.findings.push(
            Finding::new(
                Severity::Warning,
                "masses-not-separable",
                "ballast",
                format!(
                    "the reactions determine {} of the {numbers} numbers: the total mass and its centre, not its distribution. With the \
                     other masses adjusted, these values fit equally well: {}",
                    fit.fixed,
                    ranges.join("; ")
                ),
                "state the position of the heavy parts (a smaller `region`, a `max_mass`), or ask for fewer masses",
            )
            .with_numbers(fit.fixed as f64, numbers as f64),
        );
    }
}
