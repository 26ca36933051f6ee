//! Names of the columns of the least squares.

/// What a column of the least squares stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnOf {
    /// A parameter of the vehicle.
    Parameter(usize),
    /// The fault of a part (its number in the set).
    Fault(usize),
    /// The gain of a channel (its number in the design) within its tolerance.
    Gain(usize),
    /// The timing of a channel within its tolerance.
    Delay(usize),
}
