//! Limits of the estimate of modes from a record, each with its reason.

/// Limits of the estimate of modes.
pub struct EstimateRules {
    /// Largest number of steps of the method of Gauss and Newton. From twice a frequency or damping, five steps are sufficient.
    pub steps: usize,
    /// A step below this share of every standard deviation ends the search.
    pub converged: f64,
    /// Largest change in one step of the logarithm of a frequency and of a damping, within which the response is nearly linear in them.
    pub longest_step: [f64; 2],
    /// Damping from which an estimate without a stated value starts; the start with the smallest residual is taken. From steel frames to dampers.
    pub starts: [f64; 4],
    /// One standard deviation of the logarithm of a damping without a stated value: a factor of 4.5 up or down. This range connects the starting
    /// values.
    pub open_sd: f64,
    /// Least standard deviation of the strain of a mode at a gauge, as a share of this strain. It is the error of a mesh that was not fitted to
    /// measured shapes.
    pub shape_sd: f64,
    /// Number of blocks of the record that are used, evenly spaced. With more blocks, the errors of the strain of the modes dominate.
    pub blocks: usize,
    /// Parts of the record whose gradients are compared: their scatter is then known to a tenth.
    pub parts: usize,
    /// Largest number of parameters. Only the lowest modes are estimated. More parameters take minutes, and neighbouring modes are then
    /// indistinguishable.
    pub parameters: usize,
    /// Largest damping, share of critical: a mode beyond does not vibrate.
    pub largest_damping: f64,
    /// Standard deviations by which a mode may differ from its stated frequency or damping. If the stated values are right, 3 in 1,000 modes differ
    /// by more.
    pub contradicted_sd: f64,
    /// Largest share of the mean square of the vibration that may remain in the residual. It corresponds to a third of the amplitude.
    pub unexplained: f64,
    /// Mean square of the residual, divided by the mean square of the noise, from which the residual counts as vibration.
    pub over_noise: f64,
}

/// Limits in use.
pub const RULES: EstimateRules = EstimateRules {
    steps: 10,
    converged: 0.05,
    longest_step: [0.1, 0.7],
    starts: [0.01, 0.03, 0.1, 0.3],
    open_sd: 1.5,
    shape_sd: 0.01,
    blocks: 16,
    parts: 64,
    parameters: 40,
    largest_damping: 0.95,
    contradicted_sd: 3.0,
    unexplained: 0.1,
    over_noise: 2.0,
};
