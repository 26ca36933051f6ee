//! Imports between files: paths of `use` and of expressions, followed through re-exports to the file that defines the
//! name.

use std::collections::{BTreeMap, BTreeSet};

/// Path of a module from the root of the crate.
pub type Module = Vec<String>;

/// Files of one crate as modules, with their code without comments.
pub struct Crate {
    code: BTreeMap<Module, String>,
    /// Names by module, with the module that they come from. Names imported by `*` have an empty name.
    reexports: BTreeMap<Module, Vec<(String, Module)>>,
}

impl Crate {
    /// Reads the modules below `root` (such as `src/`) from files given as path and code.
    pub fn from_files<'a>(root: &str, files: impl Iterator<Item = (&'a str, String)>) -> Self {
        let mut code = BTreeMap::new();
        for (path, text) in files {
            let Some(rest) = path.strip_prefix(root).and_then(|p| p.strip_suffix(".rs")) else {
                continue;
            };
            let mut module: Module = rest.split('/').map(str::to_owned).collect();
            if module.last().is_some_and(|m| m == "mod") {
                module.pop();
            }
            // Tests inside a file refer to it as their parent.
            let text = match text.find("mod tests {") {
                Some(at) => text[..at].to_owned(),
                None => text,
            };
            let is_root = module == ["lib"] || module == ["main"];
            if !is_root && !module.iter().any(|m| m == "tests") {
                code.insert(module, text);
            }
        }
        let mut out = Self {
            code,
            reexports: BTreeMap::new(),
        };
        let modules: Vec<Module> = out.code.keys().cloned().collect();
        for module in modules {
            let list = out.reexports_of(&module);
            out.reexports.insert(module, list);
        }
        out
    }

    fn reexports_of(&self, module: &Module) -> Vec<(String, Module)> {
        let mut list = Vec::new();
        for (statement, public) in uses(&self.code[module]) {
            for path in expand_use(&statement) {
                let Some((from, rest)) = self.resolve_path(module, &path).filter(|_| public) else {
                    continue;
                };
                match rest.as_slice() {
                    [star] if star == "*" => list.push((String::new(), from)),
                    [name] => list.push((name.clone(), from)),
                    _ => {}
                }
            }
        }
        list
    }

    /// Returns the module of a path, and the remaining part of the path.
    fn resolve_path(&self, here: &Module, path: &str) -> Option<(Module, Vec<String>)> {
        let mut parts: Vec<String> = path
            .split("::")
            .map(|p| p.trim().to_owned())
            .filter(|p| !p.is_empty())
            .collect();
        let first = parts.first()?.clone();
        let mut module = match first.as_str() {
            "crate" => {
                parts.remove(0);
                Vec::new()
            }
            "super" | "self" => {
                let mut base = here.clone();
                if first == "self" {
                    parts.remove(0);
                }
                while parts.first().is_some_and(|p| p == "super") {
                    base.pop();
                    parts.remove(0);
                }
                base
            }
            child => {
                let mut below = here.clone();
                below.push(child.to_owned());
                self.code.contains_key(&below).then(|| here.clone())?
            }
        };
        while let Some(next) = parts.first() {
            let mut below = module.clone();
            below.push(next.clone());
            if !self.code.contains_key(&below) {
                break;
            }
            module = below;
            parts.remove(0);
        }
        Some((module, parts))
    }

    /// Returns the module that defines a name, through re-exports.
    fn definer(&self, module: Module, name: &str, depth: usize) -> Module {
        if depth > 6 || self.defines(&module, name) {
            return module;
        }
        let list = self.reexports.get(&module).map_or(&[][..], |l| l);
        let named = list.iter().find(|(n, from)| n == name && *from != module);
        if let Some((_, from)) = named {
            return self.definer(from.clone(), name, depth + 1);
        }
        for (_, from) in list.iter().filter(|(n, _)| n.is_empty()) {
            let end = self.definer(from.clone(), name, depth + 1);
            if self.defines(&end, name) {
                return end;
            }
        }
        module
    }

    fn defines(&self, module: &Module, name: &str) -> bool {
        const WORDS: [&str; 7] = ["fn", "struct", "enum", "trait", "type", "const", "static"];
        let Some(code) = self.code.get(module) else {
            return false;
        };
        WORDS.iter().any(|word| {
            let start = format!("{word} {name}");
            code.match_indices(&start).any(|(at, _)| {
                let after = code[at + start.len()..].chars().next();
                !after.is_some_and(|c| c.is_alphanumeric() || c == '_')
            })
        })
    }

    /// Returns the modules whose names each module uses. A `mod.rs` that only re-exports names does not use them.
    pub fn edges(&self) -> BTreeMap<&Module, BTreeSet<Module>> {
        let mut out = BTreeMap::new();
        for (module, code) in &self.code {
            let mut paths: Vec<String> = Vec::new();
            let mut rest = code.clone();
            for (statement, public) in uses(code) {
                if !public {
                    paths.extend(expand_use(&statement));
                }
                rest = rest.replace(&format!("use {statement};"), "");
            }
            paths.extend(paths_in(&rest));
            let targets: BTreeSet<Module> = paths
                .iter()
                .filter_map(|p| self.resolve_path(module, p))
                .map(|(to, left)| match left.first() {
                    Some(name) if name != "*" => self.definer(to, name, 0),
                    _ => to,
                })
                .filter(|to| to != module && self.code.contains_key(to))
                .collect();
            out.insert(module, targets);
        }
        out
    }

    /// Returns the circles: sets of modules that all reach each other.
    pub fn circles(&self) -> Vec<Vec<String>> {
        let edges = self.edges();
        let reach = |from: &Module| -> BTreeSet<Module> {
            let (mut seen, mut open) = (BTreeSet::new(), vec![from.clone()]);
            while let Some(m) = open.pop() {
                for next in edges.get(&m).into_iter().flatten() {
                    if seen.insert(next.clone()) {
                        open.push(next.clone());
                    }
                }
            }
            seen
        };
        let reached: BTreeMap<&Module, BTreeSet<Module>> =
            edges.keys().map(|m| (*m, reach(m))).collect();
        let mut out: BTreeSet<Vec<String>> = BTreeSet::new();
        for (module, seen) in &reached {
            if seen.contains(*module) {
                let back = |m: &&Module| reached.get(m).is_some_and(|s| s.contains(*module));
                let members = seen.iter().filter(back).map(|m| m.join("::"));
                out.insert(members.collect());
            }
        }
        out.into_iter().filter(|c| c.len() > 1).collect()
    }
}

/// Returns the `use` statements of a file: the text between `use` and `;`, and whether it is public.
fn uses(code: &str) -> Vec<(String, bool)> {
    let mut out = Vec::new();
    for (at, _) in code.match_indices("use ") {
        let before = code[..at].rsplit('\n').next().unwrap_or("").trim();
        let public = before.starts_with("pub");
        if !(before.is_empty() || public && (before == "pub" || before.ends_with(')'))) {
            continue;
        }
        if let Some(end) = code[at..].find(';') {
            out.push((code[at + 4..at + end].to_owned(), public));
        }
    }
    out
}

/// Returns the paths of a `use` with expanded braces.
fn expand_use(statement: &str) -> Vec<String> {
    let statement = statement.trim();
    let Some(open) = statement.find('{') else {
        let path = statement.split(" as ").next().unwrap_or("");
        return vec![path.trim().to_owned()];
    };
    let close = statement.rfind('}').unwrap_or(statement.len());
    let (head, inside) = (&statement[..open], &statement[open + 1..close]);
    let (mut depth, mut part, mut parts) = (0, String::new(), Vec::new());
    for c in inside.chars() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(std::mem::take(&mut part));
                continue;
            }
            _ => {}
        }
        part.push(c);
    }
    parts.push(part);
    let full = parts.iter().filter(|p| !p.trim().is_empty());
    full.flat_map(|p| expand_use(&format!("{head}{}", p.trim())))
        .collect()
}

/// Returns the paths of at least two names in code.
fn paths_in(code: &str) -> Vec<String> {
    // `pub(in crate::x)` states the visibility, not a use.
    let code = code.replace("(in crate::", "(in ");
    let is_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    code.split(|c: char| !is_path(c))
        .filter(|word| word.contains("::"))
        .map(|word| word.trim_matches(':').to_owned())
        .collect()
}
