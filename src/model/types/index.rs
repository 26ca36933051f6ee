//! Indices into the arrays of a model, and vectors.

/// A point or vector in the basic frame unless stated otherwise.
pub type Vec3 = crate::linalg::Vector3<f64>;
/// Rows are the axes of a local frame in the basic frame: `local = R * basic`.
pub type Mat3 = crate::linalg::Matrix3<f64>;

macro_rules! index {
    ($($(#[$doc:meta])* $name:ident),+) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub u32);
        impl $name {
            /// Returns the index into an array.
            pub fn us(self) -> usize { self.0 as usize }
        }
    )+};
}
index!(
    /// Index into [`Model::grids`](super::Model::grids).
    GridIx,
    /// Index into [`Model::frames`](super::Model::frames); 0 is the basic frame.
    FrameIx,
    /// Index into [`Model::shells`](super::Model::shells).
    ShellIx,
    /// Index into [`Model::beams`](super::Model::beams).
    BeamIx,
    /// Index into [`Model::shell_properties`](super::Model::shell_properties).
    ShellPropertyIx,
    /// Index into [`Model::beam_properties`](super::Model::beam_properties).
    BeamPropertyIx,
    /// Index into [`Model::materials`](super::Model::materials).
    MaterialIx
);
