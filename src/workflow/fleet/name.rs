//! Which vehicle and which day a file is of, by its path.

/// Form of file names: text with `{vehicle}` and `{day}`, each once, and `{any}` for text without meaning. With `/` it includes folders:
/// `vehicle={vehicle}/day={day}/{any}.parquet` is compared with the last two folders and the name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NameForm {
    parts: Vec<Part>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Part {
    Text(String),
    Vehicle,
    Day,
    Any,
}

/// Vehicle and day in a file name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VehicleDay {
    /// The vehicle.
    pub vehicle: String,
    /// Day, as written in the name.
    pub day: String,
}

impl NameForm {
    /// Parses the form of a file name.
    ///
    /// # Errors
    /// The reason, if a placeholder is unknown, missing, given twice or not separated from the next one by text.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut parts = Vec::new();
        let mut rest = text;
        while !rest.is_empty() {
            let (before, after) = rest.split_once('{').unwrap_or((rest, ""));
            if !before.is_empty() {
                parts.push(Part::Text(before.to_owned()));
            }
            if before.len() == rest.len() {
                break;
            }
            let (name, left) = after
                .split_once('}')
                .ok_or_else(|| format!("`{{` without `}}` in `{text}`"))?;
            parts.push(match name {
                "vehicle" => Part::Vehicle,
                "day" => Part::Day,
                "any" => Part::Any,
                other => {
                    return Err(format!(
                        "`{{{other}}}` is neither {{vehicle}}, {{day}} nor {{any}}"
                    ));
                }
            });
            rest = left;
        }
        for (part, word) in [(Part::Vehicle, "vehicle"), (Part::Day, "day")] {
            let n = parts.iter().filter(|p| **p == part).count();
            if n != 1 {
                return Err(format!("`{{{word}}}` occurs {n} times, expected once"));
            }
        }
        let touch = |w: &[Part]| !w.iter().any(|p| matches!(p, Part::Text(_)));
        if parts.windows(2).any(touch) {
            return Err("two fields without text between them".to_owned());
        }
        Ok(Self { parts })
    }

    /// Returns vehicle and day of a file; `None` if its path has another form. A placeholder takes the shortest possible text, and the last one takes
    /// the remaining text. No placeholder extends over a folder.
    pub fn read(&self, file: &str) -> Option<VehicleDay> {
        let path = file.replace('\\', "/");
        let folders = (self.parts.iter())
            .filter_map(|p| match p {
                Part::Text(text) => Some(text.matches('/').count()),
                _ => None,
            })
            .sum::<usize>();
        let from = path
            .rmatch_indices('/')
            .nth(folders)
            .map_or(0, |(i, _)| i + 1);
        let name = path.get(from..)?;
        let (mut vehicle, mut day) = (None, None);
        let mut rest = name;
        let mut parts = self.parts.iter().peekable();
        while let Some(part) = parts.next() {
            if let Part::Text(text) = part {
                rest = rest.strip_prefix(text.as_str())?;
                continue;
            }
            let taken = match parts.peek() {
                // The last text must be at the end of the name, even if it also occurs earlier.
                Some(Part::Text(text))
                    if self.parts.last() == Some(&Part::Text(text.clone()))
                        && self.ends_at(part) =>
                {
                    rest.strip_suffix(text.as_str())?
                }
                Some(Part::Text(text)) => rest.get(..rest.find(text.as_str())?)?,
                _ => rest,
            };
            rest = rest.get(taken.len()..)?;
            if taken.contains('/') {
                return None;
            }
            match part {
                Part::Vehicle => vehicle = Some(taken.to_owned()),
                Part::Day => day = Some(taken.to_owned()),
                _ => {}
            }
        }
        let named = VehicleDay {
            vehicle: vehicle.filter(|v| !v.is_empty())?,
            day: day.filter(|d| !d.is_empty())?,
        };
        rest.is_empty().then_some(named)
    }

    /// Whether a place is the last before the end of the name.
    fn ends_at(&self, part: &Part) -> bool {
        self.parts
            .iter()
            .rev()
            .find(|p| !matches!(p, Part::Text(_)))
            == Some(part)
    }
}

/// A part of the files: number `number` of `of`, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Number of the shard, from 1 on.
    pub number: usize,
    /// Number of all shards.
    pub of: usize,
}

impl Shard {
    /// Parses a shard such as `3/64`.
    pub fn parse(text: &str) -> Option<Self> {
        let (number, of) = text.split_once('/')?;
        let shard = Self {
            number: number.trim().parse().ok()?,
            of: of.trim().parse().ok()?,
        };
        (1..=shard.of).contains(&shard.number).then_some(shard)
    }

    /// Returns whether a file belongs to the shard. `i` is the number of the file among all files, from 0 on.
    pub fn holds(&self, i: usize) -> bool {
        i % self.of == self.number - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vehicle_and_day_are_read_from_the_name_whatever_the_folder() {
        let form = NameForm::parse("{vehicle}_{day}.parquet").unwrap();
        let named = form.read("data/2026/T7_2026-05-01.parquet").unwrap();
        assert_eq!(
            (named.vehicle.as_str(), named.day.as_str()),
            ("T7", "2026-05-01")
        );
        // The day is the remaining text, points included.
        assert_eq!(form.read("T7_1.5.parquet").unwrap().day, "1.5");
        assert_eq!(form.read("T7_a_b.parquet").unwrap().day, "a_b");
        for other in ["T7.parquet", "T7_1.csv", "_1.parquet", "T7_.parquet"] {
            assert_eq!(form.read(other), None, "{other}");
        }
        let form = NameForm::parse("{day}-{any}-{vehicle}.mf4").unwrap();
        let named = form.read("0502-west-T7.mf4").unwrap();
        assert_eq!((named.vehicle.as_str(), named.day.as_str()), ("T7", "0502"));
    }

    #[test]
    fn vehicle_and_day_stand_anywhere_in_the_path() {
        let form = NameForm::parse("vehicle={vehicle}/day={day}/{any}.parquet").unwrap();
        let read = |path: &str| form.read(path).map(|n| (n.vehicle, n.day));
        let wanted = Some(("T9".to_owned(), "2026-05-01".to_owned()));
        assert_eq!(
            read("lake/vehicle=T9/day=2026-05-01/part-0.parquet"),
            wanted
        );
        assert_eq!(read("vehicle=T9/day=2026-05-01/part-0.parquet"), wanted);
        assert_eq!(
            read("lake\\vehicle=T9\\day=2026-05-01\\part-0.parquet"),
            wanted
        );
        for other in [
            "vehicle=T9/part-0.parquet",
            "day=2026-05-01/part-0.parquet",
            "vehicle=T9/day=2026-05-01/deeper/part-0.parquet",
            "vehicle=/day=1/p.parquet",
        ] {
            assert_eq!(read(other), None, "{other}");
        }
        let form = NameForm::parse("{vehicle}/{day}.csv").unwrap();
        let named = form.read("data/T1/0502.csv").unwrap();
        assert_eq!((named.vehicle.as_str(), named.day.as_str()), ("T1", "0502"));
    }

    #[test]
    fn forms_that_can_not_tell_are_refused() {
        for text in [
            "{vehicle}.csv",
            "{vehicle}{day}.csv",
            "{vehicle}_{day}_{day}",
            "{truck}_{day}",
            "{vehicle_{day}",
        ] {
            assert!(NameForm::parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn shards_count_from_one_and_share_all_files() {
        assert_eq!(Shard::parse("3/64"), Some(Shard { number: 3, of: 64 }));
        for text in ["0/4", "5/4", "1", "a/b", "1/0"] {
            assert_eq!(Shard::parse(text), None, "{text}");
        }
        let all: Vec<Shard> = (1..=4).map(|number| Shard { number, of: 4 }).collect();
        for i in 0..100 {
            assert_eq!(all.iter().filter(|s| s.holds(i)).count(), 1);
        }
    }
}
