//! Named spots of the job's table, laid onto the model.

use super::chosen_layout::Channel;
use crate::gauge::{Bridge, Gauge};
use crate::job::JobGauge;
use crate::model::Vec3;
use crate::placement::region::clear_of;
use crate::placement::sites::Site;

/// A spot on the model.
pub(super) struct LaidSpot {
    /// Spot as the table states it.
    pub stated: JobGauge,
    /// Readings of the spot: one reading, or the three legs of a rosette.
    pub legs: Vec<Leg>,
    /// Stated cost. The default is one for each reading.
    pub cost: f64,
}

/// A reading of a spot.
pub(super) struct Leg {
    /// The gauge on the model.
    pub gauge: Gauge,
    /// Strain of loads of expected size in the candidates' order, microstrain.
    pub strain: Vec<f64>,
    /// Standard deviation of the reading, microstrain.
    pub sd: f64,
    /// Change of the reading with the angle, microstrain per radian, rms over the expected loads.
    pub turn: f64,
    /// Angle of the first grid, radians from the element x axis.
    pub angle: f64,
    /// Site on a side of a shell. `None` on a bar.
    pub site: Option<Site>,
}

impl Leg {
    /// Returns the strain over the standard deviation.
    pub fn row(&self) -> Vec<f64> {
        self.strain.iter().map(|v| v / self.sd).collect()
    }
}

impl LaidSpot {
    /// Returns the position of the first reading, basic frame.
    pub fn position(&self) -> Vec3 {
        self.legs
            .first()
            .map_or_else(Vec3::zeros, |l| l.gauge.position)
    }

    /// Returns whether the spot is at least `apart` away from these points.
    pub fn is_clear_of(&self, points: &[[Vec3; 2]], apart: f64) -> bool {
        clear_of(&[self.position()], points, apart) == [true]
    }

    /// Returns the channels of the spot.
    pub fn channels(&self) -> impl Iterator<Item = Channel> {
        let bridge = match self.legs.len() {
            1 => self.stated.bridge,
            _ => Bridge::Quarter,
        };
        self.legs.iter().map(move |leg| Channel {
            gauge: leg.gauge.clone(),
            bridge: bridge.name(),
            site: leg.site,
            spot: Some(self.stated.clone()),
            row: leg.row(),
            sd: leg.sd,
            turn: leg.turn,
            angle: leg.angle,
            misfit: None,
        })
    }
}
