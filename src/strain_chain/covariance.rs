//! `calibration.bin`: uncertainty of a calibrated S, from which its intervals are computed.
//!
//! The file begins with the eight bytes `SBCALIB1`, the length of a JSON header (u32), and the header. The header contains the names of gauges and
//! loads, the scale, the degrees of freedom, and whether each calibration run had one load alone.
//!
//! Little-endian f64 numbers follow:
//! - covariance of S by rows, entry `g k + l`, (strain per job unit)^2
//! - scatter over gauges by rows
//! - mean squares of S
//! - if the header states `additive`, the covariance of readings at any load by rows

use crate::finding::list_few;
use crate::host::fault::{Fault, Faults};
use crate::sensitivity::{Sensitivity, Uncertainty};
use serde::{Deserialize, Serialize};

const MAGIC: &[u8; 8] = b"SBCALIB1";

#[derive(Serialize, Deserialize)]
struct Header {
    gauges: Vec<String>,
    loads: Vec<String>,
    scale: f64,
    /// Degrees of freedom; `None` if nothing was estimated.
    dof: Option<f64>,
    #[serde(default)]
    dof_outside: Option<f64>,
    #[serde(default)]
    one_by_one: bool,
    /// Loads at which errors of S do not count. If the strain has an error at any load (`additive`), a further `n x n` block of numbers ends the
    /// file.
    #[serde(default)]
    center: Vec<f64>,
    #[serde(default)]
    additive: bool,
    #[serde(default = "default_true")]
    is_tested: bool,
}

fn default_true() -> bool {
    true
}

/// Returns the file of a calibrated S; `None` if S has no uncertainty.
pub fn covariance_bytes(s: &Sensitivity) -> Option<Vec<u8>> {
    let u = s.uncertainty.as_ref()?;
    let header = Header {
        gauges: s.gauges.clone(),
        loads: s.loads.iter().map(|l| l.name.clone()).collect(),
        scale: u.scale,
        dof: u.dof.is_finite().then_some(u.dof),
        dof_outside: u.dof_outside.is_finite().then_some(u.dof_outside),
        one_by_one: u.one_by_one,
        center: u.center.clone(),
        additive: !u.additive.is_empty(),
        is_tested: u.is_tested,
    };
    let header = serde_json::to_vec(&header).ok()?;
    let mut out = MAGIC.to_vec();
    out.extend(u32::try_from(header.len()).ok()?.to_le_bytes());
    out.extend(header);
    let numbers = u.covariance.iter().chain(&u.scatter).chain(&u.mean_square);
    let numbers = numbers.chain(&u.additive);
    numbers.for_each(|v| out.extend(v.to_le_bytes()));
    Some(out)
}

/// Reads the uncertainty from a file, for the gauges and loads of S in their order.
///
/// # Errors
/// A file that is not a `calibration.bin`, is cut, or contains other gauges or loads.
pub fn read_covariance(
    file: &str,
    bytes: &[u8],
    gauges: &[String],
    loads: &[String],
) -> Result<Uncertainty, Faults> {
    let fault = |field: &str, wrong: String| {
        let remedy =
            "run `calibrate` again, and keep its sensitivity.csv and calibration.bin together";
        Faults::from(Fault::new(file, field, wrong, remedy))
    };
    let broken = || {
        fault(
            "covariance",
            "it is not a file of `calibrate`, or it is cut".to_owned(),
        )
    };
    let rest = bytes.strip_prefix(MAGIC).ok_or_else(broken)?;
    let (length, rest) = rest.split_first_chunk::<4>().ok_or_else(broken)?;
    let length = u32::from_le_bytes(*length) as usize;
    let header = rest.get(..length).ok_or_else(broken)?;
    let header: Header = serde_json::from_slice(header).map_err(|_| broken())?;
    let (n, k) = (header.gauges.len(), header.loads.len());
    let sizes = n
        .checked_mul(k)
        .and_then(|nk| {
            let n2 = n.checked_mul(n)?;
            let additive = if header.additive { n2 } else { 0 };
            Some([nk.checked_mul(nk)?, n2, k.checked_mul(k)?, additive])
        })
        .ok_or_else(broken)?;
    let numbers: Vec<f64> = rest[length..]
        .chunks_exact(8)
        .filter_map(|c| c.try_into().ok().map(f64::from_le_bytes))
        .collect();
    if numbers.len() as u128 != sizes.iter().map(|s| *s as u128).sum::<u128>()
        || !(rest.len() - length).is_multiple_of(8)
        || numbers.iter().any(|v| !v.is_finite())
        || !header.scale.is_finite()
        || !(header.center.is_empty() || header.center.len() == k)
    {
        return Err(broken());
    }
    if header.loads != loads {
        return Err(fault(
            "loads",
            format!(
                "it contains the loads {}, the job has {}",
                list_few(&header.loads),
                list_few(loads)
            ),
        ));
    }
    let places: Vec<Option<usize>> = gauges
        .iter()
        .map(|g| header.gauges.iter().position(|h| h == g))
        .collect();
    if let Some(missing) = gauges.iter().zip(&places).find(|(_, p)| p.is_none()) {
        return Err(fault(
            "gauges",
            format!("it does not contain gauge `{}`", missing.0),
        ));
    }
    let (covariance, numbers) = numbers.split_at(sizes[0]);
    let (scatter, rest) = numbers.split_at(sizes[1]);
    let (squares, additive) = rest.split_at(sizes[2]);
    let all = Uncertainty {
        covariance: covariance.to_vec(),
        scatter: scatter.to_vec(),
        mean_square: squares.to_vec(),
        scale: header.scale,
        dof: header.dof.unwrap_or(f64::INFINITY),
        dof_outside: header.dof_outside.or(header.dof).unwrap_or(f64::INFINITY),
        one_by_one: header.one_by_one,
        additive: additive.to_vec(),
        center: header.center,
        is_tested: header.is_tested,
    };
    let order: Vec<usize> = places.into_iter().flatten().collect();
    Ok(all.of_gauges(&order))
}
