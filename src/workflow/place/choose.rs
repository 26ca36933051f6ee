//! The choice: single gauges through the tensors, or bundles (rosettes, pairs, unlike costs) within a budget.

use super::chosen_layout::{Channel, ChoiceRefusal, ChosenLayout};
use super::misfits::fit_gauge_to_part;
use super::pool::Kind;
use super::spot_layout;
use super::task::{Task, know_the_loads, position};
use super::wanted_elements::on_wanted;
use crate::gauge::{Bridge, CornerRows, Gauge, GaugeSpec, build};
use crate::host::fault::{Fault, Faults};
use crate::host::work::Work;
use crate::job::Optimality;
use crate::linalg::spd;
use crate::model::Vec3;
use crate::placement::bundles::{BundleSpec, Bundles, place_bundles};
use crate::placement::candidates::{Angles, Choice};
use crate::placement::required_places::value;
use crate::placement::sites::axis_of;
use crate::placement::{Layout, PlaceError, Spec, condition, place};
use std::collections::HashMap;

/// Bundles at most: memory for their rows.
const MOST_BUNDLES: usize = 4_000_000;

/// Returns whether the choice is only between single gauges of one wiring.
pub(super) fn is_plain(task: &Task) -> bool {
    let (c, p) = (&task.job.candidates, &task.job.placement);
    if let Some(spots) = &task.spots {
        return !c.has_costs() && p.budget.is_none() && spots.iter().all(|s| s.legs.len() == 1);
    }
    c.bridges.len() == 1
        && c.rosette.is_none()
        && p.symmetric.is_none()
        && p.costs.is_empty()
        && p.budget.is_none()
}

/// Chooses gauges. If they can't separate the loads, it chooses again with prior information on the sizes of the loads, and adds a finding.
///
/// # Errors
/// A fault if no layout fits the job.
pub(super) fn choose(
    work: &mut Work,
    task: &Task,
    kinds: &[Kind],
    spec: &mut Spec,
) -> Result<ChosenLayout, Faults> {
    match choose_once(task, kinds, spec) {
        Err(ChoiceRefusal::By(PlaceError::Singular { gauges, loads })) => {
            know_the_loads(work, spec, gauges, loads);
            // A layout that does not separate the loads needs no proof that it is the best. With fewer gauges than loads, the proof may take minutes.
            spec.proof = 0.0;
            choose_once(task, kinds, spec)
        }
        other => other,
    }
    .map_err(|e| {
        Faults::from(match e {
            ChoiceRefusal::By(e) => task.refusal(&e),
            ChoiceRefusal::Job(f) => f,
        })
    })
}

/// Chooses gauges once, as `spec` states.
pub(super) fn choose_once(
    task: &Task,
    kinds: &[Kind],
    spec: &Spec,
) -> Result<ChosenLayout, ChoiceRefusal> {
    if is_plain(task)
        && let [kind] = kinds
    {
        let mut layout = place(&kind.candidates, spec).map_err(ChoiceRefusal::By)?;
        let least_condition = well_conditioned(task, kind, spec, &mut layout);
        if let Some(spots) = &task.spots {
            return Ok(spot_layout::of_layout(spots, &layout, least_condition));
        }
        if let Some(gauges) = on_wanted(task, kind, spec, &layout).map_err(ChoiceRefusal::Job)? {
            put_instead(kind, spec, &mut layout, gauges);
        }
        let n = layout.gauges.len();
        let channels = layout
            .gauges
            .iter()
            .zip(free_names(task, n))
            .map(|(&c, name)| channel(task, kind, c, name))
            .collect::<Result<_, _>>()?;
        return Ok(ChosenLayout {
            channels,
            log_det: layout.log_det,
            upper_bound: layout.upper_bound,
            efficiency_bound: layout.efficiency_bound,
            proved: layout.proved,
            nodes: layout.nodes,
            cost: None,
            least_condition,
        });
    }
    let job = task.job;
    let single = |line, field, what, remedy| {
        let wrong = format!("{what} single gauges of one wiring, without pairs, costs or a budget");
        ChoiceRefusal::Job(Fault::with_line(&*job.file, line, field, wrong, remedy))
    };
    if job.placement.criterion == Optimality::Condition {
        return Err(single(
            job.placement.line,
            "placement.criterion",
            "the least condition number is available only for",
            "write criterion = \"D\", or delete those keys",
        ));
    }
    if job.candidates.wanted_elements.is_some() {
        return Err(single(
            job.candidates.line,
            "candidates.wanted_elements",
            "wanted elements are available only for",
            "delete those keys, or state the gauges of these elements as [[gauge]] and keep them",
        ));
    }
    match &task.spots {
        Some(spots) => spot_layout::within_budget(task, spots, spec),
        None => within_budget(task, kinds, spec),
    }
}

/// Replaces the best D-optimal layout by the layout with the least condition number, if the job requests it.
fn well_conditioned(task: &Task, kind: &Kind, spec: &Spec, layout: &mut Layout) -> Option<f64> {
    if task.job.placement.criterion != Optimality::Condition {
        return None;
    }
    let k = task.cases.len();
    // The gauges that stay installed have the same noise as all other gauges.
    let noise = task.job.placement.noise_microstrain;
    let mut base = vec![0.0; k * k];
    for row in &task.kept_rows {
        spd::add_outer(&mut base, row, noise * noise);
    }
    let found = condition::find_least_condition(&kind.candidates, spec, layout, &base)?;
    put_instead(kind, spec, layout, found.gauges)?;
    Some(found.least)
}

/// Replaces the gauges of the D-optimal layout by `gauges`. The certificate then gives the remaining share of the largest determinant. Returns
/// `None`, without a change, if `gauges` do not separate the loads.
fn put_instead(kind: &Kind, spec: &Spec, layout: &mut Layout, gauges: Vec<Choice>) -> Option<()> {
    let log_det = value(&kind.candidates, spec, &gauges)?;
    let k = kind.candidates.n_loads() as f64;
    layout.proved &= gauges == layout.gauges;
    layout.log_det = log_det;
    layout.efficiency_bound = ((log_det - layout.upper_bound) / k).exp();
    layout.gauges = gauges;
    Some(())
}

/// Returns the name of gauge `i`, from 0, of a layout of `n`.
pub(in crate::workflow) fn name(i: usize, n: usize) -> String {
    let digits = n.to_string().len().max(2);
    format!("P{:0digits$}", i + 1)
}

/// Returns names of a layout of `n` gauges, without names that a gauge has which stays.
fn free_names(task: &Task, n: usize) -> impl Iterator<Item = String> {
    let is_free = |name: &String| !task.kept.iter().any(|g| g.name.starts_with(&**name));
    (0..).map(move |i| name(i, n)).filter(is_free)
}

/// Returns the gauge of a choice as a job reads it from `gauges.csv`: by its element, side, direction and grid length.
fn channel(
    task: &Task,
    kind: &Kind,
    choice: Choice,
    name: String,
) -> Result<Channel, ChoiceRefusal> {
    let job = task.job;
    let refused = |wrong: String, remedy: &str| {
        let (file, line) = (&*job.file, job.candidates.line);
        ChoiceRefusal::Job(Fault::with_line(file, line, "candidates", wrong, remedy))
    };
    let no_place = || {
        refused(
            format!("gauge `{name}` has no place"),
            "widen the candidates",
        )
    };
    let site = choice.place as usize;
    let &(shell, surface) = task.sites.get(site).ok_or_else(no_place)?;
    let by_angle = GaugeSpec {
        surface: Some(surface),
        angle_rad: axis_of(kind.bridge, choice.angle),
        grid_length: job.candidates.grid_length,
        bridge: kind.bridge,
        ..GaugeSpec::place_on_shell(&*name, shell)
    };
    let corners = task.fields.corner_rows(job);
    let build = |spec: &GaugeSpec| build(task.fields.model(), spec, corners);
    let lay = |spec: &GaugeSpec| {
        let (gauges, _) = build(spec).map_err(|e| {
            let (wrong, remedy) = e.parts();
            refused(wrong, remedy)
        })?;
        gauges.into_iter().next().ok_or_else(no_place)
    };
    let (by_angle, misfit) = fit_gauge_to_part(job, by_angle, build);
    let direction = lay(&by_angle)?.direction;
    let by_direction = GaugeSpec {
        direction: Some(direction),
        angle_rad: 0.0,
        ..by_angle
    };
    Ok(Channel {
        gauge: Gauge {
            direction,
            ..lay(&by_direction)?
        },
        bridge: kind.bridge.name(),
        site: Some((shell, surface)),
        spot: None,
        row: kind.candidates.row(choice),
        sd: kind.candidates.sd(choice),
        turn: kind.candidates.turn_rms(choice),
        angle: choice.angle,
        misfit,
    })
}

/// Content of a bundle: wiring, site and angle of each grid or bridge in it. The legs of a rosette are three grids of the quarter kind.
struct BundleContent {
    members: Vec<(usize, Choice)>,
    rosette: bool,
}

/// Bundles of rows to choose from, with the cost and the content of each.
struct DescribedBundles<'a> {
    kinds: &'a [Kind],
    bundles: Bundles,
    described: Vec<BundleContent>,
}

impl DescribedBundles<'_> {
    fn add(&mut self, members: Vec<(usize, Choice)>, cost: f64, rosette: bool) {
        let rows: Vec<Vec<f64>> = members
            .iter()
            .map(|(kind, c)| self.kinds[*kind].candidates.row(*c))
            .collect();
        let first = members.first().map_or(0, |m| m.1.place);
        let last = members.last().map_or(0, |m| m.1.place);
        self.bundles.add(&rows, cost, [first, last]);
        self.described.push(BundleContent { members, rosette });
    }
}

/// Chooses among bundles within the budget.
fn within_budget(task: &Task, kinds: &[Kind], spec: &Spec) -> Result<ChosenLayout, ChoiceRefusal> {
    let of_job = bundles_of(task, kinds)?;
    let budget = task.job.placement.budget.unwrap_or(spec.gauges as f64);
    let spec = BundleSpec {
        budget,
        spacing: spec.spacing,
        prior: spec.prior.clone(),
        criterion: spec.criterion.clone(),
        tolerance: spec.tolerance,
        effort: spec.effort,
    };
    let layout = place_bundles(&of_job.bundles, &spec).map_err(ChoiceRefusal::By)?;
    let n = layout.bundles.len();
    let mut channels = Vec::new();
    for (&u, name) in layout.bundles.iter().zip(free_names(task, n)) {
        channels.extend(channels_of(task, kinds, &of_job.described[u], &name)?);
    }
    Ok(ChosenLayout {
        channels,
        log_det: layout.log_det,
        upper_bound: layout.upper_bound,
        efficiency_bound: layout.efficiency_bound,
        proved: false,
        nodes: 0,
        least_condition: None,
        cost: Some(layout.bundles.iter().map(|&u| of_job.bundles.cost[u]).sum()),
    })
}

/// Returns every bundle that the job's candidates allow: single gauges and rosettes at each site, in pairs for a symmetric layout.
fn bundles_of<'a>(task: &Task, kinds: &'a [Kind]) -> Result<DescribedBundles<'a>, ChoiceRefusal> {
    let p = &task.job.placement;
    let cost_of = |name: &str, default: f64| {
        let own = p.costs.iter().find(|c| c.0 == name);
        own.map_or(default, |c| c.1)
    };
    let positions: Vec<[f64; 3]> = task
        .sites
        .iter()
        .map(|&s| position(task.fields, s).map_or([f64::NAN; 3], |x| [x.x, x.y, x.z]))
        .collect();
    let steps: Vec<f64> = match kinds.first().map(|k| k.candidates.angles()) {
        Some(Angles::Grid(a)) => a.clone(),
        _ => (0..12)
            .map(|i| (15.0 * f64::from(i)).to_radians())
            .collect(),
    };
    let mates = p
        .symmetric
        .map(|axis| Mirror::from_positions(task, &positions, axis));
    // The legs of a rosette are candidates of the quarter-bridge kind.
    let quarter = kinds.iter().position(|k| k.bridge == Bridge::Quarter);
    let legs: Option<[f64; 3]> = task.job.candidates.rosette.map(|r| r.legs().map(|l| l.1));
    let asked = &task.job.candidates.bridges;
    few_enough(
        task,
        asked.len() * steps.len() + if legs.is_some() { 2 } else { 0 },
    )?;
    let mut bundles = DescribedBundles {
        kinds,
        bundles: Bundles::new(task.cases.len(), positions),
        described: Vec::new(),
    };
    let at = |place: usize, angle: f64| Choice {
        place: place as u32,
        step: 0,
        angle,
    };
    for site in 0..task.sites.len() {
        let mate = match &mates {
            Some(m) => match m.mate(site) {
                // The first site of a pair is taken for both. A site without a partner can't be in a symmetric layout.
                Some(other) if other >= site => Some(other),
                _ => continue,
            },
            None => None,
        };
        let paired = |kind: usize, angle: f64| -> Vec<(usize, Choice)> {
            let mut out = vec![(kind, at(site, angle))];
            if let Some(other) = mate.filter(|m| *m != site)
                && let Some(m) = &mates
            {
                out.push((kind, at(other, m.angle(task, site, other, angle))));
            }
            out
        };
        for (n, kind) in kinds.iter().enumerate() {
            if kind.bridge == Bridge::Quarter && !asked.contains(&Bridge::Quarter) {
                continue;
            }
            for &angle in &steps {
                let members = paired(n, angle);
                let cost = cost_of(kind.bridge.name(), 1.0) * members.len() as f64;
                bundles.add(members, cost, false);
            }
        }
        if let (Some(q), Some(legs)) = (quarter, legs) {
            // The orientation of a rosette matters little, so only two orientations are compared.
            for turn in [0.0, 0.5 * legs[1]] {
                let members: Vec<(usize, Choice)> =
                    legs.iter().flat_map(|l| paired(q, turn + l)).collect();
                let cost = cost_of("rosette", 3.0) * members.len() as f64 / 3.0;
                bundles.add(members, cost, true);
            }
        }
    }
    Ok(bundles)
}

/// Refuses candidates whose bundles, so many a site, would not fit into memory.
fn few_enough(task: &Task, a_site: usize) -> Result<(), ChoiceRefusal> {
    let many = task.sites.len() * a_site;
    if many <= MOST_BUNDLES {
        return Ok(());
    }
    Err(ChoiceRefusal::Job(Fault::with_line(
        &*task.job.file,
        task.job.candidates.line,
        "candidates",
        format!("{many} gauges, pairs and rosettes to choose from, limit {MOST_BUNDLES}"),
        "state a wider `angle_step_deg`, or fewer elements; rosettes, pairs and costs are compared one by one",
    )))
}

/// Channels of a bundle, named after it: `P01`, the sides of a pair `P01L` and `P01R`, the legs of a rosette `P01.a` to `P01.c`.
fn channels_of(
    task: &Task,
    kinds: &[Kind],
    bundle: &BundleContent,
    base: &str,
) -> Result<Vec<Channel>, ChoiceRefusal> {
    let mut channels = Vec::new();
    for (m, (kind, choice)) in bundle.members.iter().enumerate() {
        let leg = m % 3;
        let name = match (bundle.rosette, bundle.members.len()) {
            (true, 3) => format!("{base}.{}", ["a", "b", "c"][leg]),
            (true, _) => format!("{base}{}.{}", ["L", "R"][m % 2], ["a", "b", "c"][m / 2]),
            (false, 2) => format!("{base}{}", ["L", "R"][m]),
            (false, _) => base.to_owned(),
        };
        channels.push(channel(task, &kinds[*kind], *choice, name)?);
    }
    Ok(channels)
}

/// Partners of sites at a plane through the origin normal to an axis.
struct Mirror {
    axis: usize,
    mate: Vec<Option<usize>>,
}

impl Mirror {
    fn from_positions(task: &Task, positions: &[[f64; 3]], axis: usize) -> Self {
        let size = positions
            .iter()
            .flatten()
            .fold(0.0_f64, |a, v| a.max(v.abs()));
        // Partners of a mirrored mesh agree within the digits of the deck.
        let cell = (1e-3 * size).max(f64::MIN_POSITIVE);
        let key = |x: [f64; 3]| x.map(|v| (v / cell).round() as i64);
        let mut at: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
        for (i, x) in positions.iter().enumerate() {
            at.entry(key(*x)).or_default().push(i);
        }
        let outward = |site: usize| -> Option<Vec3> {
            let g = probe(task, site, 0.0)?;
            Some(match g.surface {
                crate::fe::strain_tensor::Surface::Top => g.normal,
                crate::fe::strain_tensor::Surface::Bottom => -g.normal,
            })
        };
        let mate = positions
            .iter()
            .enumerate()
            .map(|(i, x)| {
                let mut y = *x;
                y[axis] = -y[axis];
                let mut normal = outward(i)?;
                normal[axis] = -normal[axis];
                let near = key(y);
                let around = (0..27).flat_map(|n| {
                    let step = [n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1];
                    let cell: [i64; 3] = std::array::from_fn(|c| near[c] + step[c]);
                    at.get(&cell).cloned().unwrap_or_default()
                });
                around
                    .filter(|&j| outward(j).is_some_and(|m| m.dot(&normal) > 0.9))
                    .min_by(|&a, &b| {
                        let far = |j: usize| crate::placement::spacing::distance(positions[j], y);
                        far(a).total_cmp(&far(b)).then(a.cmp(&b))
                    })
            })
            .collect();
        Self { axis, mate }
    }

    fn mate(&self, site: usize) -> Option<usize> {
        self.mate.get(site).copied().flatten()
    }

    /// Returns the angle of the mirrored direction on the partner's element.
    fn angle(&self, task: &Task, site: usize, other: usize, angle: f64) -> f64 {
        let Some(here) = probe(task, site, angle) else {
            return angle;
        };
        let mut d = here.direction;
        d[self.axis] = -d[self.axis];
        let frame = (
            probe(task, other, 0.0),
            probe(task, other, std::f64::consts::FRAC_PI_2),
        );
        match frame {
            (Some(x), Some(y)) => d.dot(&y.direction).atan2(d.dot(&x.direction)),
            _ => angle,
        }
    }
}

/// Returns a gauge with a single grid at a site.
fn probe(task: &Task, site: usize, angle: f64) -> Option<Gauge> {
    let (shell, surface) = *task.sites.get(site)?;
    let spec = GaugeSpec {
        surface: Some(surface),
        angle_rad: angle,
        ..GaugeSpec::place_on_shell("probe", shell)
    };
    build(task.fields.model(), &spec, CornerRows::Absent)
        .ok()?
        .0
        .into_iter()
        .next()
}
