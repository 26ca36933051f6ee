//! The way from one folder to another.

use std::path::{Component, Path, PathBuf};

/// Returns the path of `to` relative to `from`, with forward slashes. It is absolute if there is no common root.
pub(crate) fn relative_path(from: &Path, to: &Path) -> String {
    let absolute = |p: &Path| {
        let p = if p.as_os_str().is_empty() {
            Path::new(".")
        } else {
            p
        };
        p.canonicalize()
            .or_else(|_| std::path::absolute(p))
            .unwrap_or_else(|_| p.to_path_buf())
    };
    let (from, to) = (absolute(from), absolute(to));
    let (a, b): (Vec<Component<'_>>, Vec<Component<'_>>) =
        (from.components().collect(), to.components().collect());
    let shared = a.iter().zip(&b).take_while(|(x, y)| x == y).count();
    if shared == 0 {
        return to.display().to_string().replace('\\', "/");
    }
    let mut out = PathBuf::new();
    a.iter().skip(shared).for_each(|_| out.push(".."));
    b.iter().skip(shared).for_each(|c| out.push(c));
    let text = out.display().to_string().replace('\\', "/");
    if text.is_empty() { ".".into() } else { text }
}
