//! The static frame of a job whose S and signatures are given as CSV files.

use super::described_effects;
use super::frame_columns::FrameColumns;
use super::model_part::{ModelPart, facts, nominal_x_m, nominal_y_m};
use super::signature_table::{SignatureTable, TableColumn};
use crate::host::fault::{Fault, Faults};
use crate::host::files::Inputs;
use crate::host::work::Work;
use crate::job::payload_signature::COLUMNS;
use crate::job::quantity::quantity_of_name;
use crate::job::{GivenSensitivity, Job, JobLoad, LoadRole, NamedFile, Signatures};
use crate::reconcile::strain::{
    GaugeFacts, MassSignature, N_PAYLOAD_COLUMNS, PlaneStrainRow, StiffnessOf, StiffnessSignature,
    Wiring,
};
use crate::strain_chain::read_given;
use crate::units::{KILO, Quantity};

/// Ratio of the transverse to the axial strain if a table contains only the axial strain: a rail flange in bending.
const POISSON: f64 = 0.29;

/// Reads everything that `[sensitivity]` names. `channels` are the gauges in the order of the strain file.
pub(super) fn read(
    work: &mut Work,
    job: &Job,
    given: &GivenSensitivity,
    channels: &[String],
) -> Result<ModelPart, Faults> {
    let s = FrameColumns::from_sensitivity(job, read_given(work, job)?, channels)?;
    let nuisance = s.nuisance();
    let wanted = s.wanted_columns();
    let tables = Tables::from_sensitivity(job, given, channels, &wanted);
    let mut by_column: Vec<Vec<f64>> = wanted.into_iter().map(|w| w.1).collect();
    by_column.extend(tables.payload(&mut work.inputs)?);
    let gauges: Vec<GaugeFacts> = channels.iter().map(|name| facts(job, name)).collect();
    let mut part = ModelPart {
        nuisance,
        learnt: s.calibrated_uncertainty(),
        gauge_noise: s.gauge_noise(job)?,
        load_names: tables.columns.iter().map(|c| c.0.clone()).collect(),
        payload_origin: [
            nominal_x_m(job).unwrap_or(0.0),
            nominal_y_m(job).unwrap_or(0.0),
        ],
        influence: (0..channels.len())
            .flat_map(|g| by_column.iter().map(move |c| c[g]))
            .collect(),
        ..ModelPart::default()
    };
    part.tensors = tables.tensors(&mut work.inputs, &gauges, &part.influence)?;
    part.gauges = gauges;
    part.other_loads = tables.other_loads(&mut work.inputs)?;
    [part.thermal_uniform, part.thermal_gradient] = tables.read_thermal_strain(&mut work.inputs)?;
    part.masses = tables.masses(&mut work.inputs)?;
    part.stiffness = tables.stiffness(&mut work.inputs)?;
    part.stiffness.extend(described_effects::from_tables(
        &mut work.inputs,
        job,
        channels,
        &tables.table_columns(),
        tables.n_columns(),
    )?);
    if tables.columns.is_empty() {
        return Err(Faults::from(Fault::new(
            &*given.file.given,
            "columns",
            "no load column",
            "give S one column for each load",
        )));
    }
    Ok(part)
}

/// The tables of signatures, and what their columns are.
struct Tables<'a> {
    job: &'a Job,
    signatures: &'a Signatures,
    channels: &'a [String],
    /// Name of each load, and of its column in S. Tables use the same column names.
    columns: Vec<(String, String)>,
    /// Factors to kN, kN m, kg and m, in which the frame counts.
    per_kn: f64,
    per_knm: f64,
    per_kg: f64,
    per_m: f64,
}

impl<'a> Tables<'a> {
    fn from_sensitivity(
        job: &'a Job,
        given: &'a GivenSensitivity,
        channels: &'a [String],
        wanted: &[(String, Vec<f64>)],
    ) -> Self {
        let column_of = |name: &String| {
            let stated = given.columns.iter().find(|c| c.0 == *name);
            stated.map_or_else(|| name.clone(), |c| c.1.clone())
        };
        Self {
            job,
            signatures: &given.signatures,
            channels,
            columns: wanted
                .iter()
                .map(|(name, _)| (name.clone(), column_of(name)))
                .collect(),
            per_kn: KILO / given.per.force.si,
            per_knm: KILO / given.per.moment.si,
            per_kg: 1.0 / given.per.mass.si,
            per_m: 1.0 / given.per.length.si,
        }
    }

    /// Columns of the influence matrix.
    fn n_columns(&self) -> usize {
        self.columns.len() + N_PAYLOAD_COLUMNS
    }

    fn read(&self, inputs: &mut Inputs, file: &NamedFile) -> Result<SignatureTable, Faults> {
        SignatureTable::read(inputs, self.job, file, self.channels)
    }

    /// Returns the factor of a load's column.
    fn scale(&self, name: &str) -> f64 {
        match quantity_of_load(self.job, name) {
            Quantity::Moment => self.per_knm,
            _ => self.per_kn,
        }
    }

    /// Returns the column and factor of each load.
    fn loads(&self) -> Vec<(String, f64)> {
        self.columns
            .iter()
            .map(|(name, c)| (c.clone(), self.scale(name)))
            .collect()
    }

    /// Returns column and factor of each load, then of the payload columns.
    fn loads_and_payload(&self) -> Vec<(String, f64)> {
        let mut names = self.loads();
        names.extend(
            COLUMNS
                .iter()
                .zip(self.payload_scale())
                .map(|(n, f)| (n[0].to_owned(), f)),
        );
        names
    }

    /// Returns the columns that a user's own table may contain, each by its name in S or by the name of its load.
    fn table_columns(&self) -> Vec<TableColumn> {
        let one = |(name, column): &(String, String)| TableColumn {
            names: vec![column.clone(), name.clone()],
            factor: self.scale(name),
        };
        self.columns.iter().map(one).collect()
    }

    fn payload_scale(&self) -> [f64; N_PAYLOAD_COLUMNS] {
        payload_scale(self.per_kg, self.per_m)
    }

    /// Returns the payload columns; zeros if the table has none.
    fn payload(&self, inputs: &mut Inputs) -> Result<Vec<Vec<f64>>, Faults> {
        let mut payload = vec![vec![0.0; self.channels.len()]; N_PAYLOAD_COLUMNS];
        if let Some(file) = &self.signatures.payload {
            let t = self.read(inputs, file)?;
            let named = COLUMNS.into_iter().zip(self.payload_scale());
            for (column, (names, f)) in payload.iter_mut().zip(named) {
                if let Some(name) = names.iter().find(|n| t.has(n)) {
                    *column = t.column(name, f)?;
                }
            }
            t.note_unread(inputs);
        }
        Ok(payload)
    }

    /// Returns the in-plane strain under each gauge; empty if the job names no table of it.
    fn tensors(
        &self,
        inputs: &mut Inputs,
        gauges: &[GaugeFacts],
        influence: &[f64],
    ) -> Result<Vec<PlaneStrainRow>, Faults> {
        let n = self.channels.len();
        let Some(file) = &self.signatures.gauge_angle else {
            return Ok(vec![PlaneStrainRow::new(); n]);
        };
        let t = self.read(inputs, file)?;
        let names = self.loads_and_payload();
        // Columns are read as far as the table contains them: the payload columns may end with b_dx.
        let known: Vec<&(String, f64)> = names
            .iter()
            .take_while(|(c, _)| t.has(&format!("exx_{c}")))
            .collect();
        let mut planes = vec![PlaneStrainRow::new(); n];
        for (c, f) in known {
            let exx = t.column(&format!("exx_{c}"), *f)?;
            let gxy = t.column(&format!("gxy_{c}"), *f)?;
            let eyy = if t.has(&format!("eyy_{c}")) {
                t.column(&format!("eyy_{c}"), *f)?
            } else {
                exx.iter().map(|e| -POISSON * e).collect()
            };
            for (g, plane) in planes.iter_mut().enumerate() {
                plane.push([exx[g], eyy[g], gxy[g]]);
            }
        }
        t.note_unread(inputs);
        let (n_l, n_c) = (self.columns.len(), self.n_columns());
        let wired = |(g, plane): (usize, PlaneStrainRow)| match gauges[g].wiring {
            Wiring::Quarter => plane,
            // A bending bridge reads the strain along its axis. The shear strains of its two sides cancel.
            Wiring::Bending => (0..n_l + 2)
                .map(|c| influence[g * n_c + c])
                .map(|a| [a, -POISSON * a, 0.0])
                .collect(),
            Wiring::Shear => Vec::new(),
        };
        Ok(planes.into_iter().enumerate().map(wired).collect())
    }

    /// Returns the loads of the wheels that the job does not ask for, except its nuisance loads.
    fn other_loads(&self, inputs: &mut Inputs) -> Result<Vec<(String, Vec<f64>)>, Faults> {
        let mut loads = Vec::new();
        if let Some(file) = &self.signatures.lateral_wheel_loads {
            let t = self.read(inputs, file)?;
            let missing = |n: &String| !is_nuisance(self.job, n);
            for name in t.names().into_iter().filter(missing) {
                let column = t.column(&name, self.scale(&name))?;
                loads.push((name, column));
            }
            t.names().iter().for_each(|name| t.leave(name));
            t.note_unread(inputs);
        }
        Ok(loads)
    }

    /// Reads the thermal strain of an even temperature and of a gradient. A nuisance load of the job is not a missing effect.
    fn read_thermal_strain(&self, inputs: &mut Inputs) -> Result<[Option<Vec<f64>>; 2], Faults> {
        let Some(file) = &self.signatures.thermal else {
            return Ok([None, None]);
        };
        let t = self.read(inputs, file)?;
        let one = |names: [&str; 2]| {
            if is_nuisance(self.job, names[0]) {
                names.iter().for_each(|n| t.leave(n));
                return Ok(None);
            }
            names
                .iter()
                .find(|n| t.has(n))
                .map(|n| t.column(n, 1.0))
                .transpose()
        };
        let both = [
            one(["thermal_uniform", "uniform"])?,
            one(["thermal_gradient", "gradient"])?,
        ];
        t.note_unread(inputs);
        Ok(both)
    }

    /// Returns a mass at each place of the table.
    fn masses(&self, inputs: &mut Inputs) -> Result<Vec<MassSignature>, Faults> {
        let mut masses = Vec::new();
        if let Some(file) = &self.signatures.unaccounted_mass {
            let t = self.read(inputs, file)?;
            for place in t.names() {
                masses.push(MassSignature {
                    per_kg: t.column(&place, self.per_kg)?,
                    place,
                });
            }
        }
        Ok(masses)
    }

    /// Returns the change of the influence matrix by one percent of each zone's stiffness.
    fn stiffness(&self, inputs: &mut Inputs) -> Result<Vec<StiffnessSignature>, Faults> {
        let n_c = self.n_columns();
        let mut stiffness = Vec::new();
        for (zone, file) in &self.signatures.rail_stiffness {
            let t = self.read(inputs, file)?;
            let mut change = vec![0.0; self.channels.len() * n_c];
            let names = self.loads_and_payload();
            for (c, (name, f)) in names
                .iter()
                .enumerate()
                .filter(|(_, (name, _))| t.has(name))
            {
                for (g, v) in t.column(name, *f)?.into_iter().enumerate() {
                    change[g * n_c + c] = v;
                }
            }
            t.note_unread(inputs);
            stiffness.push(StiffnessSignature {
                of: StiffnessOf::Zone,
                place: zone.clone(),
                at_percent: vec![(1.0, change)],
                prior_percent: 15.0,
            });
        }
        Ok(stiffness)
    }
}

/// Returns whether the job has a nuisance load of this name.
fn is_nuisance(job: &Job, name: &str) -> bool {
    job.loads
        .iter()
        .any(|l| l.name == name && l.role == LoadRole::Nuisance)
}

/// Returns the factors of the payload's columns, weight, times dx, times dy, times dx dy, from a table's units to the frame's kg and m.
pub(super) fn payload_scale(per_kg: f64, per_m: f64) -> [f64; N_PAYLOAD_COLUMNS] {
    [
        per_kg,
        per_kg * per_m,
        per_kg * per_m,
        per_kg * per_m * per_m,
    ]
}

/// Returns the quantity of a load, force or moment: from the load entry of the job, or else from the name.
pub(super) fn quantity_of_load(job: &Job, name: &str) -> Quantity {
    let stated = job.loads.iter().find(|l| l.name == name);
    stated
        .and_then(JobLoad::quantity)
        .unwrap_or_else(|| quantity_of_name(name))
}
