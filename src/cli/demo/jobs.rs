//! The jobs of the story.

use crate::units::{Quantity, ReportUnits, find_unit};

/// Wheels in the deck's order.
pub(super) const WHEELS: [(&str, u32); 6] = [
    ("LF", 900_001),
    ("RF", 900_002),
    ("LM", 900_003),
    ("RM", 900_004),
    ("LR", 900_005),
    ("RR", 900_006),
];
/// Grid of the payload.
pub(super) const PAYLOAD: u32 = 900_101;
/// Rail zones: name and property.
pub(super) const ZONES: [(&str, u32); 10] = [
    ("L1", 11),
    ("L2", 12),
    ("L3", 13),
    ("L4", 14),
    ("L5", 15),
    ("R1", 21),
    ("R2", 22),
    ("R3", 23),
    ("R4", 24),
    ("R5", 25),
];
/// Runs kept from fitting.
pub(super) const HOLD_OUT: [&str; 3] = ["R10", "R11", "R12"];
/// Noise of a reading, microstrain, and of a wheel force, kN.
pub(super) const NOISE: (f64, f64) = (1.0, 0.06);

/// Model uncertainty, of the predicted strain.
const MODEL: f64 = 0.02;

/// kN, kN m, m, kg, MPa.
pub(super) fn report_units() -> ReportUnits {
    let mut units = ReportUnits::from_system(crate::units::UnitSystem::MmTS);
    let named = |quantity, name, own| find_unit(quantity, name).unwrap_or(own);
    units.force = named(Quantity::Force, "kN", units.force);
    units.moment = named(Quantity::Moment, "kN m", units.moment);
    units.length = named(Quantity::Length, "m", units.length);
    units.mass = named(Quantity::Mass, "kg", units.mass);
    units
}

/// First lines of every job.
const HEAD: &str = r#"title = "Roll-off truck"
units = "mm-t-s"
report_units = { force = "kN", moment = "kN m", length = "m", mass = "kg" }

[model]
deck = "truck.bdf"

"#;

fn load(name: &str, grid: u32, component: &str, expected: f64) -> String {
    format!(
        "[[load]]\nname = \"{name}\"\ngrid = {grid}\ncomponent = \"{component}\"\nexpected = {expected:.1}\n\n"
    )
}

fn wheel_loads() -> String {
    WHEELS
        .iter()
        .map(|(name, grid)| load(&format!("{name}.FZ"), *grid, "FZ", 8_000.0))
        .collect()
}

fn payload_loads() -> String {
    load("payload.FZ", PAYLOAD, "FZ", 40_000.0)
        + &load("payload.MX", PAYLOAD, "MX", 5.0e6)
        + &load("payload.MY", PAYLOAD, "MY", 1.0e7)
}

fn measured_section(strain: &str) -> String {
    let held: Vec<String> = HOLD_OUT.iter().map(|r| format!("\"{r}\"")).collect();
    format!(
        "[gauges]\nfile = \"2-place/gauges.csv\"\n\n[measured]\nstrain = \"{strain}\"\nnoise_microstrain = {:.1}\n\
         model_uncertainty_rel = {MODEL}\nhold_out = [{}]\n\n",
        NOISE.0,
        held.join(", ")
    )
}

fn runs() -> String {
    format!(
        "[runs]\nfile = \"runs.csv\"\nunits = {{ force = \"kN\", mass = \"kg\", length = \"m\" }}\nnoise = {{ force = {} }}\n\
         wheel_forces = \"measured\"\n\n",
        NOISE.1
    )
}

/// Returns the part of the job with the unit loads and the places where gauges may go.
pub(super) fn plan() -> String {
    let properties: Vec<String> = ZONES
        .iter()
        .map(|z| z.1)
        .chain(31..=37)
        .map(|p| p.to_string())
        .collect();
    HEAD.to_owned()
        + &wheel_loads()
        + &payload_loads()
        + &format!(
            "[candidates]\nproperties = [{}]\nsurfaces = [\"top\", \"bottom\"]\nangle_step_deg = 15\n\n[placement]\ngauges = 24\n\
             spacing = 60.0\nnoise_microstrain = {:.1}\nmodel_uncertainty_rel = {MODEL}\nangle_tolerance_deg = 1.0\nposition_tolerance = 2.0\n",
            properties.join(", "),
            NOISE.0
        )
}

/// Nine loads from strain.
pub(super) fn recover(strain: &str) -> String {
    HEAD.to_owned() + &wheel_loads() + &payload_loads() + &measured_section(strain)
}

/// Measured wheel forces against strain.
pub(super) fn reconcile() -> String {
    let zones: Vec<String> = ZONES.iter().map(|(n, p)| format!("{n} = [{p}]")).collect();
    HEAD.to_owned()
        + &wheel_loads()
        + &measured_section("strain.csv")
        + &runs()
        + &format!(
            "[payload]\ngrid = {PAYLOAD}\nposition = \"known\"\nweight_in_model = true\n\n[reconcile]\npath = \"static\"\n\
             zones = {{ {} }}\neffects = \"all\"\n",
            zones.join(", ")
        )
}

/// Returns the size and place of the payload.
pub(super) fn payload(strain: &str) -> String {
    HEAD.to_owned()
        + &wheel_loads()
        + &payload_loads()
        + &measured_section(strain)
        + &runs()
        + &format!(
            "[payload]\ngrid = {PAYLOAD}\nposition = \"free\"\nuse = [\"strain\", \"reactions\"]\n"
        )
}

/// Stress under the recovered loads.
pub(super) fn respond(strain: &str) -> String {
    HEAD.to_owned()
        + &wheel_loads()
        + &payload_loads()
        + &measured_section(strain)
        + "[respond]\nhottest = 12\n"
}
