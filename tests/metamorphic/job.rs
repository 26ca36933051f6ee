//! The jobs for a structure, and its tables of readings and loads.

use crate::frame::{Frame, Gauge, Kind, Load, Seat, V};
use nalgebra::Matrix3;
use std::fmt::Write;

/// Loads of the runs, relative to the expected loads.
const RUNS: [&[f64]; 3] = [
    &[0.9, -0.4, 0.6, 0.1, -1.1, 0.3, 0.7],
    &[-0.2, 0.8, 0.5, -0.7, 0.4, 0.9, -0.6],
    &[1.1, 0.3, -0.8, 0.2, 0.6, -0.5, 0.2],
];

/// Payloads: weight in N, position in mm.
const PAYLOADS: [[f64; 3]; 2] = [[800.0, 400.0, 20.0], [1200.0, 500.0, 0.0]];

/// Returns the channels of the gauges with the names and the order of the base model.
pub fn channels(frame: &Frame) -> Vec<String> {
    let of = |g: &Gauge| match g.rosette {
        true => ["a", "b", "c"]
            .map(|leg| format!("{}.{leg}", g.name))
            .to_vec(),
        false => vec![g.name.clone()],
    };
    frame.gauges.iter().flat_map(of).collect()
}

/// Returns the channel of this model with the reading of channel `base` in the base model, and vice versa.
///
/// On a shell with reversed corner order, the legs of a rosette have the reverse order.
pub fn counterpart(frame: &Frame, base: &str) -> String {
    let Some((gauge, leg)) = base.split_once('.') else {
        return base.to_owned();
    };
    let g = frame.gauges.iter().find(|g| g.name == gauge);
    let flipped = frame.shell(g.expect("a gauge").shell).flipped;
    let leg = match (flipped, leg) {
        (true, "a") => "c",
        (true, "c") => "a",
        _ => leg,
    };
    format!("{gauge}.{leg}")
}

fn vector(v: V) -> String {
    format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z)
}

fn gauge_section(frame: &Frame, g: &Gauge) -> String {
    let l = frame.units.length;
    let mut text = format!("[[gauge]]\nname = \"{}\"\n", g.name);
    let system = match g.system {
        0 => String::new(),
        s => format!("cid = {s}\n"),
    };
    match &g.seat {
        Seat::Bar { tag, station } => {
            let element = frame.id(*tag);
            let _ = writeln!(
                text,
                "element = {element}\npoint = \"C\"\nstation = {station}"
            );
            return text;
        }
        Seat::Shell { tag, top } => {
            let side = if *top != frame.sides_exchanged(*tag) {
                "top"
            } else {
                "bottom"
            };
            let _ = writeln!(text, "element = {}\nsurface = \"{side}\"", frame.id(*tag));
        }
        Seat::Point(x) => {
            let c = frame.coordinates(g.system, *x);
            let kind = match g.system {
                0 => None,
                s => Some(frame.systems[s as usize - 1].kind),
            };
            let _ = writeln!(text, "position = {}", vector(scale_lengths(c, kind, l)));
        }
    }
    let direction = frame.components(g.system, g.at, g.direction);
    let angle = match (frame.shell(g.shell).flipped, g.rosette) {
        (false, _) => g.angle_deg,
        (true, false) => -g.angle_deg,
        (true, true) => -g.angle_deg - 90.0,
    };
    let _ = writeln!(
        text,
        "{system}direction = {}\nangle_deg = {angle:?}",
        vector(direction)
    );
    if let Some(bridge) = g.bridge {
        let _ = writeln!(text, "bridge = \"{bridge}\"");
    }
    if g.rosette {
        text += "rosette = \"rectangular\"\n";
    }
    if g.grid_length > 0.0 {
        let _ = writeln!(text, "grid_length = {:?}", g.grid_length * l);
    }
    text
}

/// Converts coordinates to job units. Only lengths are multiplied by `l`.
fn scale_lengths(c: V, kind: Option<Kind>, l: f64) -> V {
    match kind {
        None | Some(Kind::Rectangular) => c * l,
        Some(Kind::Cylindrical) => V::new(c.x * l, c.y, c.z * l),
        Some(Kind::Spherical) => V::new(c.x * l, c.y, c.z),
    }
}

fn load_section(frame: &Frame, load: &Load) -> String {
    let (component, _) = frame.component(load);
    let unit = frame.load_unit(load);
    let system = match load.system {
        0 => String::new(),
        s => format!("cid = {s}\n"),
    };
    format!(
        "[[load]]\nname = \"{}\"\ngrid = {}\ncomponent = \"{component}\"\n{system}applied = {:?}\nexpected = {:?}\n",
        load.name,
        frame.id(load.grid),
        load.applied * unit,
        load.expected * unit
    )
}

fn head(frame: &Frame, loads: &[Load], results: &str) -> String {
    let mut text = format!(
        "units = \"{}\"\nreport_units = {{ force = \"kN\", moment = \"kN m\", length = \"m\", mass = \"kg\", stress = \"MPa\" }}\n\
         [model]\ndeck = \"frame.bdf\"\nmesh_error = false\nsupport = \"free\"\n{results}",
        frame.units.name
    );
    for load in loads {
        text += &load_section(frame, load);
    }
    let mut gauges: Vec<&Gauge> = frame.gauges.iter().collect();
    if frame.reversed_tables {
        gauges.reverse();
    }
    for g in gauges {
        text += &gauge_section(frame, g);
    }
    text + "[measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 0.5\nmodel_uncertainty_rel = 0.01\n"
}

/// Returns the job of every command except `payload`.
pub fn job(frame: &Frame, results: &str) -> String {
    let properties = [1, 2].map(|p| frame.id(p));
    head(frame, &frame.loads, results)
        + &format!(
            "[candidates]\nproperties = {properties:?}\nangle_step_deg = 30\n\
             [placement]\ngauges = {}\nspacing = {:?}\n\
             [respond]\nhottest = 15\n\
             [study]\nlayouts = [\"given\"]\ntrials = {TRIALS}\n\
             errors = [{{ kind = \"absolute-normal\", size = 1.0 }}, {{ kind = \"angle\", size = 2.0 }}]\n",
            frame.loads.len() + 4,
            60.0 * frame.units.length
        )
}

/// Number of trials of `study`.
pub const TRIALS: usize = 1000;

/// Returns the job of `payload`: three wheels, and a payload at the point above the frame.
pub fn payload_job(frame: &Frame, results: &str) -> String {
    let wheels = frame.loads.iter().filter(|l| WHEELS.contains(&l.name));
    let wheels: Vec<Load> = wheels.cloned().collect();
    let text = head(frame, &wheels, results).replace("strain.csv", "payload_strain.csv");
    text + &format!(
        "[runs]\nfile = \"runs.csv\"\nunits = {{ force = \"kN\", mass = \"kg\", length = \"m\" }}\nnoise = {{ force = 0.02 }}\n\
         [payload]\ngrid = {}\nposition = \"free\"\n",
        frame.id(902)
    )
}

/// Returns a scatter of the readings below one microstrain.
fn scatter(run: usize, channel: usize) -> f64 {
    0.4 * (((run * 5 + channel * 3) % 7) as f64 / 3.0 - 1.0)
}

/// Returns the sum of the strains of all loads, in microstrain. `loads` is in N and N mm.
fn microstrain(row: &[f64], loads: &[f64]) -> f64 {
    1e6 * row.iter().zip(loads).map(|(s, f)| s * f).sum::<f64>()
}

/// Returns the readings of every channel, for loads relative to the expected loads. `s` is that of the base model, by
/// channel and load.
pub fn readings(frame: &Frame, s: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let run = |(r, shares): (usize, &&[f64])| -> Vec<f64> {
        let loads = frame.loads.iter().zip(*shares);
        let loads: Vec<f64> = loads.map(|(l, share)| share * l.expected).collect();
        let rows = s.iter().enumerate();
        rows.map(|(g, row)| microstrain(row, &loads) + scatter(r, g))
            .collect()
    };
    RUNS.iter().enumerate().map(run).collect()
}

/// Returns the forces that the payload adds to three wheels, N.
fn wheel_forces(frame: &Frame, [f, x, y]: [f64; 3]) -> [f64; 3] {
    let places = WHEELS.map(|w| {
        let load = frame.loads.iter().find(|l| l.name == w);
        frame.x(load.expect("a wheel").grid)
    });
    let lever = Matrix3::from_columns(&places.map(|p| V::new(1.0, p.x, p.y)));
    let inverse = lever.try_inverse().expect("wheels on no line");
    (inverse * f * V::new(1.0, x, y)).into()
}

/// Returns readings and wheel forces (kN) under the payloads.
pub fn payload_runs(frame: &Frame, s: &[Vec<f64>]) -> (Vec<Vec<f64>>, Vec<[f64; 3]>) {
    let at = frame.x(902);
    let forces = PAYLOADS.map(|p| wheel_forces(frame, p));
    let loads = |r: usize| -> Vec<f64> {
        let [f, x, y] = PAYLOADS[r];
        let of = |l: &Load| match l.name {
            "P.FZ" => -f,
            "P.MX" => -f * (y - at.y),
            "P.MY" => f * (x - at.x),
            name => WHEELS
                .iter()
                .position(|w| *w == name)
                .map_or(0.0, |w| forces[r][w]),
        };
        frame.loads.iter().map(of).collect()
    };
    let run = |r: usize| -> Vec<f64> {
        let (rows, loads) = (s.iter().enumerate(), loads(r));
        rows.map(|(g, row)| microstrain(row, &loads) + scatter(r, g))
            .collect()
    };
    (
        (0..PAYLOADS.len()).map(run).collect(),
        forces.map(|f| f.map(|f| f / 1e3)).to_vec(),
    )
}

/// Returns a table of readings. `rows` are by channel of the base model.
pub fn strain_csv(frame: &Frame, rows: &[Vec<f64>]) -> String {
    let mut columns: Vec<(usize, String)> = channels(frame)
        .iter()
        .map(|c| counterpart(frame, c))
        .enumerate()
        .collect();
    if frame.reversed_tables {
        columns.reverse();
    }
    let names: Vec<&str> = columns.iter().map(|c| c.1.as_str()).collect();
    let mut text = format!("run,{}\n", names.join(","));
    for (r, row) in (1..).zip(rows) {
        let _ = write!(text, "R{r}");
        for (c, _) in &columns {
            let _ = write!(text, ",{:?}", row[*c]);
        }
        text.push('\n');
    }
    text
}

/// Vertical loads of the wheels.
const WHEELS: [&str; 3] = ["W1.FZ", "W2.FZ", "W3.FZ"];

/// Returns the table of wheel forces, kN. A load that points down in this model has the opposite sign.
pub fn runs_csv(frame: &Frame, forces: &[[f64; 3]]) -> String {
    let mut order = [0, 1, 2];
    if frame.reversed_tables {
        order.reverse();
    }
    let mut text = format!("run,{}\n", order.map(|w| WHEELS[w]).join(","));
    for (r, row) in (1..).zip(forces) {
        let value = |w: usize| {
            let load = frame.loads.iter().find(|l| l.name == WHEELS[w]);
            let sign = frame.component(load.expect("a wheel")).1;
            format!("{:?}", row[w] * sign)
        };
        let _ = writeln!(text, "R{r},{}", order.map(value).join(","));
    }
    text
}
