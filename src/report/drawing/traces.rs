//! Traces of a figure as series of points.

use serde_json::Value;

/// Style in which a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::report) enum Kind {
    /// Upright bars from the axis.
    Bars,
    /// Points alone.
    Points,
    /// A line alone.
    Lines,
    /// Both.
    Both,
    /// The area between a line and the line before it, of its colour.
    Filled,
}

/// A series of a figure.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::report) struct Series {
    /// Name of the series. Empty if it has none.
    pub(in crate::report) name: String,
    /// Kind of drawing.
    pub(in crate::report) kind: Kind,
    /// `#rrggbb`.
    pub(in crate::report) colour: String,
    /// Name of the point symbol in the figure.
    pub(in crate::report) symbol: String,
    /// Right and up: numbers or names.
    values: [Vec<Value>; 2],
    /// Below and above a value to the right.
    errors: [Vec<Value>; 2],
    /// Whether these are the ends of a range instead of an interval.
    pub(in crate::report) is_span: bool,
    /// Lower edge of a filled area.
    pub(in crate::report) foot: Vec<Option<f64>>,
}

impl Series {
    /// Returns the number of points.
    pub(in crate::report) fn len(&self) -> usize {
        self.values[0].len().min(self.values[1].len())
    }

    /// Returns the name of a point on axis `k`, if this axis has names.
    pub(in crate::report) fn name_at(&self, k: usize, i: usize) -> Option<&str> {
        self.values[k].get(i)?.as_str()
    }

    /// Returns the value on axis `k`.
    pub(in crate::report) fn value_at(&self, k: usize, i: usize) -> Option<f64> {
        self.values[k].get(i)?.as_f64()
    }

    /// Returns the interval about a value to the right.
    pub(in crate::report) fn interval_at(&self, i: usize) -> Option<[f64; 2]> {
        let v = self.value_at(0, i)?;
        let [below, above] = &self.errors;
        Some([v - below.get(i)?.as_f64()?, v + above.get(i)?.as_f64()?])
    }

    /// Returns the values that axis `k` must cover: values of the series, their intervals, and 0 for bars.
    pub(in crate::report) fn reach(&self, k: usize) -> Vec<f64> {
        let mut out: Vec<f64> = self.values[k].iter().filter_map(Value::as_f64).collect();
        if k == 0 {
            out.extend(
                (0..self.len())
                    .filter_map(|i| self.interval_at(i))
                    .flatten(),
            );
        }
        if k == 1 && self.kind == Kind::Bars {
            out.push(0.0);
        }
        if k == 1 {
            out.extend(self.foot.iter().flatten());
        }
        out
    }
}

/// Returns a colour as `#rrggbb`. For `rgba(r,g,b,a)` it is the colour on a white background.
pub(in crate::report) fn on_white(colour: &str) -> Option<String> {
    if colour.starts_with('#') {
        return Some(colour.to_owned());
    }
    let inside = colour.strip_prefix("rgba(")?.strip_suffix(')')?;
    let parts: Option<Vec<f64>> = inside.split(',').map(|p| p.trim().parse().ok()).collect();
    let [r, g, b, a] = *parts?.as_slice() else {
        return None;
    };
    let mixed = [r, g, b].map(|c| (255.0 + (c - 255.0) * a).round() as u8);
    Some(format!("#{:02x}{:02x}{:02x}", mixed[0], mixed[1], mixed[2]))
}

/// Returns the series of the traces. Traces without a colour take the next one of `colours`.
pub(in crate::report) fn series_of(traces: &[Value], colours: &[&str]) -> Vec<Series> {
    let list = |v: &Value| v.as_array().cloned().unwrap_or_default();
    let word = |v: &Value| v.as_str().unwrap_or("").to_owned();
    let mut next = colours.iter().cycle();
    let mut out = Vec::new();
    for (i, t) in traces.iter().enumerate() {
        let is_filled = t["fill"] == "tonexty";
        // Other lines of zero width only bound a filled area.
        if t["line"]["width"] == 0 && !is_filled {
            continue;
        }
        let kind = match (t["type"].as_str(), t["mode"].as_str()) {
            (Some("bar"), _) => Kind::Bars,
            _ if is_filled => Kind::Filled,
            (_, Some("lines")) => Kind::Lines,
            (_, Some("lines+markers")) => Kind::Both,
            _ => Kind::Points,
        };
        let own = [&t["fillcolor"], &t["marker"]["color"], &t["line"]["color"]];
        let own = own.into_iter().find_map(Value::as_str);
        let own = own.and_then(on_white);
        let foot = match i.checked_sub(1).and_then(|i| traces.get(i)) {
            Some(before) if is_filled => list(&before["y"]),
            _ => Vec::new(),
        };
        let colour = own.or_else(|| next.next().map(|c| (*c).to_owned()));
        out.push(Series {
            name: word(&t["name"]),
            kind,
            colour: colour.unwrap_or_else(|| "#1f618d".to_owned()),
            symbol: word(&t["marker"]["symbol"]),
            values: [list(&t["x"]), list(&t["y"])],
            errors: [
                list(&t["error_x"]["arrayminus"]),
                list(&t["error_x"]["array"]),
            ],
            is_span: t["error_x"]["span"] == true,
            foot: foot.iter().map(Value::as_f64).collect(),
        });
    }
    out
}

/// Returns the names on axis `k` in order of occurrence. `None` if the axis has numbers.
pub(in crate::report) fn names_of(series: &[Series], k: usize) -> Option<Vec<String>> {
    let mut names: Vec<String> = Vec::new();
    let mut seen = std::collections::BTreeSet::new();
    for value in series.iter().flat_map(|s| &s.values[k]) {
        let name = value.as_str()?;
        if seen.insert(name) {
            names.push(name.to_owned());
        }
    }
    (!names.is_empty()).then_some(names)
}
