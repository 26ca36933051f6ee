//! Members of a set of effects, and the meaning of the columns of its least squares.

use super::change::Change;

/// One effect of a set in the chosen form.
#[derive(Clone, Debug)]
pub struct Part {
    /// Number of the candidate.
    pub candidate: usize,
    /// Selected form of the effect.
    pub shape: Change,
    /// Parameter of a channel fault. It is 1 / gain of a gain fault, the delay in s of a delay fault, or the rate of a clock. It is the step in s of
    /// a slip, and the time constant in s of a low-pass. Other changes do not use it.
    pub fault: f64,
}

/// Unknown to which a column of the least squares belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnOf {
    /// A parameter of the vehicle.
    Parameter(usize),
    /// The fault of a part (its number in the set).
    Fault(usize),
    /// A mains line of a part: its cosine or its sine.
    Line(usize),
    /// The gain of a channel (its number in the design) within its tolerance.
    Gain(usize),
    /// The timing of a channel within its tolerance.
    Delay(usize),
}
