//! `[respond]`.

use super::named_file::NamedFile;
use crate::job::shapes::Ids;
use crate::series::rainflow::MeanStress;

/// `[respond]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Respond {
    /// Elements to report. `None` means the elements with the largest stress.
    pub elements: Option<Ids>,
    /// Number of reported elements with the largest stress. The default is 20.
    pub hottest: usize,
    /// Load histories; `None`: recovered from `[measured]`.
    pub loads: Option<NamedFile>,
    /// Power of the stress range in pseudo-damage; `None`: no damage.
    pub slope: Option<f64>,
    /// Correction of the cycles for their mean stress, report unit of stress.
    pub mean_stress: MeanStress,
    /// Stress range that the detail endures for two million cycles, in the report unit of stress.
    pub fatigue_class: Option<f64>,
    /// Line of the job; 0 where the section is absent.
    pub line: u32,
}
