//! The report of `fleet`.

use super::fleet_damage::damage_section;
use crate::host::outcome::Outcome;
use crate::report::figure::{Line, Scale, lines};
use crate::report::page::{Block, CellLink, Page, Paper, Section};
use crate::series::rainflow::Ratio;
use crate::units::number;
use crate::workflow::fleet::{
    Fleet, GaugeHistory, MissionAnswer, SampleOf, VehicleAnswer, VehicleLoadAnswer,
};

/// Files listed on the page; `result.json` has all.
const LISTED: usize = 500;
/// Vehicles with figures of their own.
const VEHICLES_WITH_FIGURES: usize = 12;
/// Digits of a digest on the page; pointed at, it shows all.
const SHORT: usize = 16;

/// Returns the report.
pub(super) fn page(o: &Outcome<Fleet>) -> Page {
    let hours: f64 = o.vehicles.iter().map(|v| v.hours).sum();
    let lead = format!(
        "Fleet: {} vehicles, {} files, {} hours; S-N slope {}",
        o.vehicles.len(),
        o.files.len(),
        number(hours),
        o.slope
    );
    let mut sections: Vec<Section> = damage_section(o).into_iter().collect();
    sections.push(vehicles(o));
    sections.extend(damage_comparison_section(o));
    sections.extend(o.mission.as_ref().map(mission));
    for v in o.vehicles.iter().take(VEHICLES_WITH_FIGURES) {
        sections.extend([days(v, o.slope), health(v)]);
    }
    if let Some(left) = o.vehicles.len().checked_sub(VEHICLES_WITH_FIGURES + 1) {
        let text = format!("{} more vehicles are in result.json.", left + 1);
        sections.push(Section::new("Other vehicles", vec![Block::Text(text)]));
    }
    sections.push(files(o));
    Page::new(&o.title, &lead, &o.findings, sections).on_paper(Paper::Report)
}

/// Numbers of a gauge by day.
type OfDays = fn(&GaugeHistory) -> &Vec<Option<f64>>;

/// Gauges of a vehicle over its days.
fn health(v: &VehicleAnswer) -> Section {
    let x: Vec<f64> = (1..=v.days.len()).map(|i| i as f64).collect();
    let plain =
        |list: &[Option<f64>]| -> Vec<f64> { list.iter().map(|v| v.unwrap_or(f64::NAN)).collect() };
    let groups: Vec<(String, [Vec<f64>; 2])> = v
        .gauges
        .iter()
        .map(|g| (g.name.clone(), [plain(&g.mean), plain(&g.offset)]))
        .collect();
    let drawn: Vec<(String, Vec<Line>)> = groups
        .iter()
        .map(|(name, [mean, offset])| {
            let line = |name, y| Line { name, x: &x, y };
            let lines = [
                line("mean", mean),
                line("minus the prediction of the others", offset),
            ];
            (name.clone(), Vec::from(lines))
        })
        .collect();
    let head = [
        "gauge",
        "dead on",
        "mean first, µε",
        "mean last, µε",
        "noise, µε",
        "gain relative to the others, first",
        "last",
    ];
    let ends = |list: &[Option<f64>]| {
        let of = |x: Option<Option<f64>>| x.flatten().map_or(String::new(), number);
        (of(list.first().copied()), of(list.last().copied()))
    };
    let rows: Vec<Vec<String>> = v
        .gauges
        .iter()
        .map(|g| {
            let ((m0, m1), (n0, _), (g0, g1)) = (ends(&g.mean), ends(&g.noise), ends(&g.gain));
            let from = |day: &String| match g.dead_from(day) {
                Some(hour) => format!("{day} from hour {hour:.3}"),
                None => day.clone(),
            };
            let dead = match g.dead_days.as_slice() {
                [] => String::new(),
                [one] => from(one),
                [first, rest @ ..] => format!("{} and {} more", from(first), rest.len()),
            };
            vec![g.name.clone(), dead, m0, m1, n0, g0, g1]
        })
        .collect();
    let mut blocks = vec![Block::table(&head, rows).with_links(health_links(v))];
    if x.len() > 1 && !drawn.is_empty() {
        blocks.push(Block::Figure(lines(
            &drawn,
            "day",
            "mean reading, µε",
            Scale::Linear,
            "Mean reading of each day, and minus the prediction of the other gauges: level lines are better, a step or a drift is a fault of the gauge.",
        )));
        let of_gain: OfDays = |g| &g.gain;
        for (what, of, caption) in [
            (
                "gain relative to the others",
                of_gain,
                "Gain of the gauge against the other gauges by day: nearer to 1, and level, is better.",
            ),
            (
                "noise, µε",
                |g| &g.noise,
                "Noise of the gauge by day: lower and level is better.",
            ),
        ] {
            let series: Vec<(&str, Vec<f64>)> = v
                .gauges
                .iter()
                .map(|g| (g.name.as_str(), plain(of(g))))
                .collect();
            let groups: Vec<(String, Vec<Line>)> = series
                .iter()
                .map(|(name, y)| ((*name).to_owned(), vec![Line { name, x: &x, y }]))
                .collect();
            blocks.push(Block::Figure(lines(
                &groups,
                "day",
                what,
                Scale::Linear,
                caption,
            )));
        }
    }
    Section::new(format!("Gauges of {} by day", v.name), blocks)
}

/// Returns links from the numbers of [`health`] to their records. For each gauge these are the first day on which it was dead, the first day and the
/// last day.
fn health_links(v: &VehicleAnswer) -> Vec<CellLink> {
    let mut links = Vec::new();
    for (row, g) in v.gauges.iter().enumerate() {
        let died = g.dead_days.first();
        let died = died.and_then(|day| v.days.iter().position(|d| d == day));
        let died = died.and_then(|i| v.records.get(i));
        let (first, last) = (v.records.first(), v.records.last());
        for (column, record) in [
            (1, died),
            (2, first),
            (3, last),
            (4, first),
            (5, first),
            (6, last),
        ] {
            links.extend(record.map(|r| link(row, column, &r.path, &r.sha256)));
        }
    }
    links
}

fn link(row: usize, column: usize, path: &str, sha256: &str) -> CellLink {
    CellLink {
        row,
        column,
        path: path.to_owned(),
        title: format!("{path}, sha256 {sha256}"),
    }
}

fn time_of(at: &SampleOf) -> String {
    format!("{}, {:.3} s", at.day, at.seconds)
}

/// Returns a number with its interval; empty for `None`.
fn ratio(r: Option<Ratio>) -> String {
    r.map_or(String::new(), |r| {
        let [value, low, high] = [r.value, r.low, r.high].map(number);
        format!("{value} ({low} to {high})")
    })
}

/// Damage against the reference day and the targets; `None` where the job states neither.
fn damage_comparison_section(o: &Outcome<Fleet>) -> Option<Section> {
    if o.rows()
        .all(|(_, l)| l.to_reference.is_none() && l.to_target.is_none())
    {
        return None;
    }
    let head = [
        "vehicle",
        "load",
        "damage per hour, reference 1",
        "share of the target",
    ];
    let cells = |(v, l): (&VehicleAnswer, &VehicleLoadAnswer)| {
        let (a, b) = (ratio(l.to_reference), ratio(l.to_target));
        vec![v.name.clone(), l.load.clone(), a, b]
    };
    let all: Vec<Vec<String>> = o.rows().map(cells).collect();
    let mut blocks = vec![Block::table(&head, all)];
    if let Some(r) = &o.reference {
        let row = vec![
            r.vehicle.clone(),
            r.day.clone(),
            r.path.clone(),
            shorten_digest(&r.sha256),
        ];
        let head = ["reference", "day", "record", "sha256 begins"];
        let links = vec![link(0, 2, &r.path, &r.sha256)];
        blocks.push(Block::table(&head, vec![row]).with_links(links));
    }
    blocks.push(Block::Note(
        "95 % intervals. The part of the error of S that is common to the reference is left out."
            .to_owned(),
    ));
    Some(Section::new("Damage against reference and target", blocks))
}

fn shorten_digest(sha256: &str) -> String {
    sha256.get(..SHORT).unwrap_or_default().to_owned()
}

fn mission(m: &MissionAnswer) -> Section {
    let kinds = m.kinds.iter().map(|k| {
        let share = number(k.share);
        vec![k.name.clone(), share, k.files.to_string(), number(k.hours)]
    });
    let head = ["kind of days", "share", "files", "hours measured"];
    let kinds = Block::table(&head, kinds.collect());
    let mut head = vec!["load", "damage", "low", "high", "between days, at most"];
    let by_kind: Vec<String> = m
        .kinds
        .iter()
        .map(|k| format!("an hour of {}", k.name))
        .collect();
    head.extend(by_kind.iter().map(String::as_str));
    let loads = m.loads.iter().map(|l| {
        let numbers = [
            l.damage,
            l.damage_low,
            l.damage_high,
            l.between_days_at_most,
        ];
        let numbers = numbers
            .into_iter()
            .chain(l.by_kind.iter().copied())
            .map(number);
        std::iter::once(l.load.clone()).chain(numbers).collect()
    });
    let loads = Block::table(&head, loads.collect());
    let note = "The 95 % interval contains the error of S, which is equal on all days, and noise. It does not contain the scatter of days of one kind \
     (sigma_days in result.json). Cycles that close between days are left out of the damage; `between days, at most` is an upper bound of \
     their damage.";
    let statement = Block::Text(m.statement.clone());
    Section::new(
        "Mission",
        vec![statement, kinds, loads, Block::Note(note.to_owned())],
    )
}

/// Table of the days of a vehicle: record, hours, and damage by load with S-N exponent `slope`.
fn days(v: &VehicleAnswer, slope: f64) -> Section {
    let mut head = vec![
        "day".to_owned(),
        "record".to_owned(),
        "sha256 begins".to_owned(),
        "hours".to_owned(),
    ];
    let damage = |l: &VehicleLoadAnswer| format!("damage by {}, ({})^{slope}", l.load, l.unit);
    head.extend(v.loads.iter().map(damage));
    let listed = v.days.iter().zip(&v.records).take(LISTED).enumerate();
    let (mut all, mut links) = (Vec::new(), Vec::new());
    for (row, (day, record)) in listed {
        let (path, sha256) = (record.path.clone(), shorten_digest(&record.sha256));
        let mut cells = vec![day.clone(), path, sha256, number(record.hours)];
        let of_day =
            |l: &VehicleLoadAnswer| l.by_day.get(row).map_or(String::new(), |d| number(*d));
        cells.extend(v.loads.iter().map(of_day));
        all.push(cells);
        links.extend([1, 2].map(|column| link(row, column, &record.path, &record.sha256)));
    }
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    let mut blocks = vec![Block::table(&head, all).with_links(links)];
    if v.days.len() > LISTED {
        blocks.push(Block::Note("All days are in result.json.".to_owned()));
    }
    Section::new(format!("Days of {}", v.name), blocks)
}

/// Every load of every vehicle.
fn vehicles(o: &Outcome<Fleet>) -> Section {
    let head = [
        "vehicle",
        "files",
        "hours",
        "load",
        "unit",
        "max",
        "on",
        "min",
        "on",
        "damage",
        "low",
        "high",
        "damage per hour, mean 1",
        "in doubt, %",
    ];
    let at = |at: &Option<SampleOf>| at.as_ref().map_or(String::new(), time_of);
    let cells = |(v, l): (&VehicleAnswer, &VehicleLoadAnswer)| {
        vec![
            v.name.clone(),
            v.files.to_string(),
            number(l.hours),
            l.load.clone(),
            l.unit.clone(),
            number(l.max.unwrap_or(f64::NAN)),
            at(&l.max_at),
            number(l.min.unwrap_or(f64::NAN)),
            at(&l.min_at),
            number(l.damage),
            number(l.damage_low),
            number(l.damage_high),
            number(l.relative),
            match l.doubtful_share {
                share if share > 0.0 => format!("{:.1}", 100.0 * share),
                _ => String::new(),
            },
        ]
    };
    let note = "Damage is the sum of ranges to the power of the slope, in this power of the load's unit. It compares records and is not a life. \
     Cycles are counted by the four-point method, with the days of a vehicle as one record; ranges without a closed cycle count half (ASTM \
     E1049). The 95 % interval contains the error of S, equal on all days, and the scatter of noise. The mean damage of noise is \
     subtracted, and the interval contains its uncertainty. The column in doubt is the share of days whose strain the loads do not \
     explain. It is in the sum, and the interval does not include its error.";
    let all: Vec<Vec<String>> = o.rows().map(cells).collect();
    let links = o.rows().enumerate().flat_map(|(row, (_, l))| {
        let ends = [(6, &l.max_at), (8, &l.min_at)];
        ends.into_iter().filter_map(move |(column, at)| {
            let at = at.as_ref()?;
            Some(link(row, column, &at.path, &at.sha256))
        })
    });
    let table = Block::table(&head, all).with_links(links.collect());
    Section::new("Vehicles", vec![table, Block::Note(note.to_owned())])
}

/// The records and what became of them.
fn files(o: &Outcome<Fleet>) -> Section {
    let listed = o.files.iter().take(LISTED).map(|f| {
        let digest = f.sha256.get(..16).unwrap_or_default().to_owned();
        let hours = f.hours.map_or(String::new(), number);
        vec![
            f.path.clone(),
            f.vehicle.clone(),
            f.day.clone(),
            f.status.to_owned(),
            f.words(),
            hours,
            digest,
        ]
    });
    let head = [
        "file",
        "vehicle",
        "day",
        "status",
        "why",
        "hours",
        "sha256 begins",
    ];
    let listed: Vec<Vec<String>> = listed.collect();
    let note = if o.files.len() > LISTED {
        "All files are in fleet_files.csv."
    } else {
        "A file name links to the record; point at it to see the whole digest."
    };
    let links = o.files.iter().take(LISTED).enumerate();
    let links = links.map(|(row, f)| link(row, 0, &f.path, &f.sha256));
    let table = Block::table(&head, listed).with_links(links.collect());
    let blocks = vec![table, Block::Note(note.to_owned())];
    Section::new("Files", blocks)
}
