//! The parameter file.

use serde::Deserialize;

/// Inches to millimetres.
pub const INCH: f64 = 25.4;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Truck {
    pub mesh: Mesh,
    pub material: Material,
    pub rails: Rails,
    pub cross_member: Vec<CrossMember>,
    pub bracket: Bracket,
    pub axles: Axles,
    pub front_spring: FrontSpring,
    pub rear_spring: RearSpring,
    pub mass: Vec<Mass>,
    pub axle_mass: AxleMass,
    pub compensating: Vec<Mass>,
    pub payload: Payload,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mesh {
    pub size: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Material {
    pub youngs_modulus: f64,
    pub poisson: f64,
    pub density: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rails {
    pub start_in: f64,
    pub end_in: f64,
    pub outboard_width_in: f64,
    pub lower_flange_above_ground_in: f64,
    pub height: f64,
    pub flange: f64,
    pub thickness: f64,
    pub zone_bounds_in: Vec<f64>,
}

impl Rails {
    /// Returns y of the right rail's web, mid-plane.
    pub fn web_y(&self) -> f64 {
        self.outboard_width_in * INCH / 2.0 - self.thickness / 2.0
    }
    /// Returns z of the lower and upper flange, mid-plane.
    pub fn z(&self) -> [f64; 2] {
        let low = self.lower_flange_above_ground_in * INCH + self.thickness / 2.0;
        [low, low + self.height - self.thickness]
    }
    /// Returns the mid-height.
    pub fn z_mid(&self) -> f64 {
        let [low, high] = self.z();
        (low + high) / 2.0
    }
    /// Returns the zone 0 to 4 of a station in mm.
    pub fn zone(&self, x: f64) -> u32 {
        self.zone_bounds_in
            .iter()
            .filter(|b| x > **b * INCH)
            .count() as u32
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CrossMember {
    pub name: String,
    pub station_in: f64,
    pub height: f64,
    pub flange: f64,
    pub thickness: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bracket {
    pub gap: f64,
    pub length: f64,
    pub thickness: f64,
    pub bolt_diameter: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Axles {
    pub hub_above_ground: f64,
    pub front_in: f64,
    pub middle_in: f64,
    pub rear_in: f64,
    pub pivot_in: f64,
    pub front_half_track: f64,
    pub rear_half_track: f64,
    pub tube_outer: f64,
    pub tube_wall: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrontSpring {
    pub front_hanger_in: f64,
    pub rear_hanger_in: f64,
    pub above_hub: f64,
    pub rate: f64,
    pub bush_stiff: f64,
    pub bush_rotation: f64,
    pub shackle_longitudinal: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RearSpring {
    pub above_hub: f64,
    pub end_rate: f64,
    pub width: f64,
    pub end_slider: f64,
    pub bush_stiff: f64,
    pub bush_rotation: f64,
    pub rod_area: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mass {
    pub name: String,
    pub tonnes: f64,
    pub station_in: f64,
    #[serde(default)]
    pub y: f64,
    /// Height above the upper flange.
    pub above_rail: f64,
    pub feet_in: Vec<f64>,
    /// `left` or `right` if only one rail carries the mass.
    #[serde(default)]
    pub side: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxleMass {
    pub front: f64,
    pub middle: f64,
    pub rear: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Payload {
    pub station_in: f64,
    pub above_rail: f64,
    pub feet_in: [f64; 2],
}
