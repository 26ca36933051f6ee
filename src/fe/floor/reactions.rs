//! Reactions from the flexibility of the free structure.

use crate::linalg::{Matrix, Vector, dense};
use crate::model::{GridIx, Model, Vec3};
use std::fmt;

/// Support of a structure on a floor: the contacts, and the displacement of each contact under an upward unit force at each contact.
///
/// `C` (`n x n`) is the displacement along `axis` of contact j under a unit force at contact i of the free structure, balanced by its inertia. `k` is
/// the rate of the spring between a contact and the floor, and `t + theta x r` is a rigid motion. The reactions `R` obey
///
/// `sum_i C_ji R_i + R_j / k + t + theta_b r_c - theta_c r_b = -lift_j` at every contact,
/// `sum R = -F`, `sum r_c R = -M_b`, `-sum r_b R = -M_c`,
///
/// where `lift_j` is the displacement of the contact under all other loads on the free structure. `F` and `M` are the resultant of these loads.
/// `(axis, b, c)` is a right-handed permutation of the basic axes. The reactions are exact for any rigid motion in the free solutions. The floor can
/// pull here: a negative reaction means that the wheel lifts off and that the linear solution is no longer valid.
#[derive(Clone, Debug)]
pub struct Floor {
    axis: usize,
    contacts: Vec<GridIx>,
    /// Locations, basic frame.
    x: Vec<Vec3>,
    centre: Vec3,
    /// Inverse of the system: reactions and rigid motion from right-hand sides.
    inverse: Matrix,
    /// Scale of the equilibrium rows and of the rigid motion's columns: displacement, length.
    scale: (f64, f64),
}

/// Loads other than the reactions: their resultant about the centre of the contacts and the lift of the contacts.
#[derive(Clone, Debug, PartialEq)]
pub struct FloorLoad {
    /// Force along the axis.
    pub force: f64,
    /// Moments about the two horizontal axes, at the centre of the contacts.
    pub moment: [f64; 2],
    /// Displacement of each contact along the axis on the free structure.
    pub lift: Vec<f64>,
}

/// Reason why there are no reactions.
#[derive(Clone, Debug, PartialEq)]
pub enum FloorError {
    /// Contacts on a line.
    OnALine {
        /// Number of contacts.
        contacts: usize,
    },
    /// A case without displacements.
    NoDisplacement,
    /// Springs to ground carry the structure already.
    Springs {
        /// Number of rigid motions that the springs resist.
        motions: u8,
        /// Descriptions of the springs.
        springs: String,
    },
    /// The solver refused.
    Solver(crate::fe::FeError),
}

impl FloorError {
    /// Returns pairs of message and remedy. A solver error gives one pair for each fault; every other error gives one pair.
    pub fn parts(&self) -> Vec<(String, String)> {
        match self {
            Self::OnALine { contacts } => vec![(
                format!(
                    "the {contacts} contacts are on a line or at a point: they cannot carry the weight without falling over"
                ),
                "name the wheels on both sides".to_owned(),
            )],
            Self::Springs { motions, springs } => vec![(
                format!(
                    "springs to ground ({springs}) hold {motions} of 6 rigid motions: a floor under the wheels would support the structure twice"
                ),
                "remove the springs to ground, so that the wheels alone carry the structure"
                    .to_owned(),
            )],
            Self::NoDisplacement => vec![(
                "no displacement of the contacts".to_owned(),
                "solve with the built-in solver, or ask for DISPLACEMENT = ALL".to_owned(),
            )],
            Self::Solver(e) => {
                let of = |f: crate::fe::Refusal| (format!("{}: {}", f.card, f.reason), f.remedy);
                e.faults().into_iter().map(of).collect()
            }
        }
    }
}

impl From<crate::fe::FeError> for FloorError {
    fn from(e: crate::fe::FeError) -> Self {
        Self::Solver(e)
    }
}

impl fmt::Display for FloorError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts = self.parts();
        let lines: Vec<String> = parts.iter().map(|(w, r)| format!("{w}: {r}")).collect();
        f.write_str(&lines.join("\n"))
    }
}

impl std::error::Error for FloorError {}

/// Spread of the contacts across, as a share of their spread along, under which they count as a line.
const LINE: f64 = 1e-6;

impl Floor {
    /// Computes the floor under `contacts`. `lifts[i][j]` is the displacement along `axis` (0 x, 1 y, 2 z; up) of contact j under a unit force at
    /// contact i.
    ///
    /// `rate` is the stiffness between contact and floor (a tyre), force per length; `None`: rigid.
    ///
    /// # Errors
    /// Contacts on a line.
    pub fn new(
        model: &Model,
        axis: usize,
        contacts: &[GridIx],
        lifts: &[Vec<f64>],
        rate: Option<f64>,
    ) -> Result<Self, FloorError> {
        let n = contacts.len();
        let x: Vec<Vec3> = contacts
            .iter()
            .filter_map(|g| model.grids.get(g.us()).map(|g| g.x))
            .collect();
        let centre = x.iter().sum::<Vec3>() / n.max(1) as f64;
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        let spread = Matrix::from_fn(n.max(2), 2, |i, k| {
            x.get(i)
                .map_or(0.0, |x| (x - centre)[if k == 0 { b } else { c }])
        });
        let shape = dense::svd(&spread).ok_or(FloorError::NoDisplacement)?;
        let (long, short) = (
            shape.s.first().copied().unwrap_or(0.0),
            shape.s.last().copied().unwrap_or(0.0),
        );
        if x.len() != n || n < 3 || !(short > LINE * long) {
            return Err(FloorError::OnALine { contacts: n });
        }
        if lifts.len() != n || lifts.iter().flatten().any(|v| !v.is_finite()) {
            return Err(FloorError::NoDisplacement);
        }
        let own = (0..n).filter_map(|i| lifts[i].get(i)).map(|v| v.abs());
        let soft = own.fold(0.0, f64::max);
        let scale = (
            if soft > 0.0 { soft } else { 1.0 },
            long / (n as f64).sqrt(),
        );
        let mut a = Matrix::zeros(n + 3, n + 3);
        for j in 0..n {
            for i in 0..n {
                a[(j, i)] = lifts[i].get(j).copied().unwrap_or(0.0);
            }
            a[(j, j)] += rate.map_or(0.0, |k| 1.0 / k);
            let r = x[j] - centre;
            for (k, v) in [1.0, r[c] / scale.1, -r[b] / scale.1]
                .into_iter()
                .enumerate()
            {
                a[(j, n + k)] = v * scale.0;
                a[(n + k, j)] = v * scale.0;
            }
        }
        let inverse = a.try_inverse().ok_or(FloorError::OnALine { contacts: n })?;
        Ok(Self {
            axis,
            contacts: contacts.to_vec(),
            x,
            centre,
            inverse,
            scale,
        })
    }

    /// Returns the contacts, in the order of [`Self::reactions`].
    pub fn contacts(&self) -> &[GridIx] {
        &self.contacts
    }

    /// Returns the locations of the contacts, basic frame.
    pub fn positions(&self) -> &[Vec3] {
        &self.x
    }

    /// Returns the axis that points up: 0 x, 1 y, 2 z.
    pub fn axis(&self) -> usize {
        self.axis
    }

    /// Returns the reactions (positive upwards) under a load. They are linear in the load.
    pub fn reactions(&self, load: &FloorLoad) -> Vec<f64> {
        let n = self.contacts.len();
        let mut right = Vector::zeros(n + 3);
        for j in 0..n {
            right[j] = -load.lift.get(j).copied().unwrap_or(0.0);
        }
        right[n] = -load.force * self.scale.0;
        right[n + 1] = -load.moment[0] * self.scale.0 / self.scale.1;
        right[n + 2] = -load.moment[1] * self.scale.0 / self.scale.1;
        let all = &self.inverse * right;
        all.iter().take(n).copied().collect()
    }

    /// Creates a load from a force and a moment at a point. `lift` is the displacement of the contacts on the free structure.
    pub fn load(&self, at: Vec3, force: Vec3, moment: Vec3, lift: Vec<f64>) -> FloorLoad {
        let m = moment + (at - self.centre).cross(&force);
        let (b, c) = ((self.axis + 1) % 3, (self.axis + 2) % 3);
        FloorLoad {
            force: force[self.axis],
            moment: [m[b], m[c]],
            lift,
        }
    }

    /// Returns the structure's weight under gravity `g` (positive, model units) against the axis. On the free structure gravity moves every grid
    /// equally, so all lifts are zero.
    pub fn weight(&self, model: &Model, g: f64) -> FloorLoad {
        let weight = model.weight();
        let mut force = Vec3::zeros();
        force[self.axis] = -weight.mass * g;
        self.load(
            weight.cg,
            force,
            Vec3::zeros(),
            vec![0.0; self.contacts.len()],
        )
    }
}
