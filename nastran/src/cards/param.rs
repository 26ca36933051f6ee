//! PARAM.

/// PARAM: a name and up to two values.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Param {
    /// Upper case.
    pub name: String,
    pub values: Vec<ParamValue>,
}

/// A value as the field reads.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub enum ParamValue {
    Integer(i64),
    Real(f64),
    Text(String),
}

impl ParamValue {
    /// Returns the value as a number, integers included.
    pub fn as_f64(&self) -> Option<f64> {
        match self {
            Self::Integer(i) => Some(*i as f64),
            Self::Real(x) => Some(*x),
            Self::Text(_) => None,
        }
    }
}
