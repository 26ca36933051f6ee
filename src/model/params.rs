//! Parameters that affect the model, its solution or its output.

use super::build::Builder;
use super::fault::FaultKind;
use nastran::cards::ParamValue;
use nastran::place::Place;

impl Builder<'_> {
    pub(super) fn params(&mut self) {
        let cards = self.cards;
        let bulk = cards.params.iter().map(|p| (&p.card, p.at));
        for (p, at) in bulk.chain(self.case_params.iter().map(|p| (p, Place::default()))) {
            let Some(value) = p.values.first() else {
                continue;
            };
            let number = value.as_f64();
            let yes = matches!(value, ParamValue::Text(t) if t.eq_ignore_ascii_case("YES"));
            let no = matches!(value, ParamValue::Text(t) if t.eq_ignore_ascii_case("NO"));
            let to = &mut self.model.params;
            let mut wrong = None;
            match (p.name.as_str(), number) {
                ("WTMASS", Some(x)) if x > 0.0 => to.wtmass = x,
                ("WTMASS", _) => wrong = Some("a number above 0"),
                ("GRDPNT", Some(x)) => to.grdpnt = (x >= 0.0).then_some(x as u32),
                ("INREL", Some(x)) if [0.0, -1.0, -2.0].contains(&x) => to.inrel = x as i32,
                ("INREL", _) => wrong = Some("0, -1 or -2"),
                ("K6ROT", Some(x)) => to.k6rot = x,
                ("SNORM", Some(x)) => to.snorm_rad = x.to_radians(),
                ("AUTOSPC", None) if yes => to.autospc = true,
                ("AUTOSPC", None) if no => to.autospc = false,
                ("COUPMASS", Some(x)) => to.coupmass = x > 0.0,
                ("COUPMASS", None) => to.coupmass = yes,
                ("POST", Some(x)) => to.post = Some(x as i64),
                ("OMID", _) => to.omid = yes,
                ("UNITSYS", _) => {
                    if let ParamValue::Text(t) = value {
                        to.unitsys = Some(t.clone());
                    }
                }
                _ => {}
            }
            if let Some(expected) = wrong {
                let kind = FaultKind::Word {
                    found: match value {
                        ParamValue::Integer(n) => n.to_string(),
                        ParamValue::Real(x) => x.to_string(),
                        ParamValue::Text(t) => t.clone(),
                    },
                    expected,
                };
                self.fault(format!("PARAM,{}", p.name), "V1", at, kind);
            }
        }
    }
}
