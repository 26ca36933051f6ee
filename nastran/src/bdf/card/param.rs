//! PARAM.

use super::super::fault::DeckFaultKind;
use super::super::fields::{Fields, Value};
use crate::cards::{Param, ParamValue};

pub(super) fn param(f: &mut Fields) -> Param {
    if f.is_blank(0) {
        f.fault(0, "N", DeckFaultKind::Missing);
        f.unusable = true;
    }
    let mut values = Vec::new();
    for i in 1..f.len().min(3) {
        match f.value(i) {
            Value::Blank => {}
            Value::Integer(n) => values.push(ParamValue::Integer(n)),
            Value::Real(x) => values.push(ParamValue::Real(x)),
            Value::Text => values.push(ParamValue::Text(f.word(i))),
        }
    }
    Param {
        name: f.word(0),
        values,
    }
}
