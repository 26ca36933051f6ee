//! Gauges on shells whose strain is taken elsewhere than at the skin.

use super::arms::{Gauge, Spot};
use super::surface::to_side;
use crate::finding::{Finding, Severity, list_few};
use crate::model::{Model, ShellKind};
use crate::units::number;

/// Share of the thickness by which a fibre distance may differ from the skin, to allow for rounding of a deck.
const ROUNDED: f64 = 0.01;

/// Returns a warning for gauges whose strain is taken at a Z1 or Z2 of PSHELL that is not on the skin.
pub fn off_skin(model: &Model, gauges: &[Gauge]) -> Option<Finding> {
    let heights = |gauge: &Gauge| {
        gauge.arms.iter().find_map(|arm| {
            let Spot::Shell { shell, surface, .. } = arm.spot else {
                return None;
            };
            let shell = model.shells.get(shell.us())?;
            let property = model.shell_properties.get(shell.property.us())?;
            let ShellKind::Homogeneous { .. } = property.kind else {
                return None;
            };
            let read = model.fibres(shell).centre[surface.ix()];
            let skin = to_side(model, shell, surface) - shell.zoffs;
            let off = (read - skin).abs();
            (off > 2.0 * ROUNDED * skin.abs()).then_some((shell.id, surface, read, skin))
        })
    };
    let found: Vec<_> = gauges
        .iter()
        .filter_map(|g| Some((g.name.as_str(), heights(g)?)))
        .collect();
    let (name, (element, surface, read, skin)) = *found.first()?;
    let names: Vec<&str> = found.iter().map(|f| f.0).collect();
    let field = ["Z1", "Z2"][surface.ix()];
    Some(
        Finding::new(
            Severity::Warning,
            "fibre-off-skin",
            list_few(&names),
            format!(
                "gauge `{name}` on the {} of element {element} reads the strain at {field} = {}. The skin is at {} from the middle surface (units of the deck), and has another bending strain. Gauges concerned: {}",
                surface.word(),
                number(read),
                number(skin),
                names.len()
            ),
            "delete Z1 and Z2 of the PSHELL, so that strain is taken on the skins",
        )
        .with_numbers(read, skin),
    )
}
