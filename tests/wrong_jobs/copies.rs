//! Copies of the folders of `examples/`, to be damaged.

use std::path::{Path, PathBuf};

/// A copy of a folder of `examples/`, its files alone, under a name that no other test has.
pub fn copy_of(folder: &str, name: &str) -> PathBuf {
    let from = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("examples")
        .join(folder);
    let to = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("wrong_jobs")
        .join(name);
    let _ = std::fs::remove_dir_all(&to);
    std::fs::create_dir_all(&to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            std::fs::copy(&path, to.join(path.file_name().unwrap())).unwrap();
        }
    }
    to
}

/// Changes a file, which it has to do.
pub fn edit(file: &Path, change: impl Fn(&str) -> String) {
    let text = std::fs::read_to_string(file).unwrap();
    let changed = change(&text);
    assert_ne!(text, changed, "{}", file.display());
    std::fs::write(file, changed).unwrap();
}
