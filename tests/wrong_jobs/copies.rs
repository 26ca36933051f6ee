//! Copies of the folders of `examples/`, which the tests damage.

use std::path::{Path, PathBuf};

/// Copies the files of a folder of `examples/`, without subfolders. No other test may use the same name.
pub fn copy_example(name: &str, folder: &str) -> PathBuf {
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

/// Changes a file of a folder. Fails if the change has no effect.
pub fn edit(folder: &Path, file: &str, change: impl Fn(&str) -> String) {
    let path = folder.join(file);
    let text = std::fs::read_to_string(&path).unwrap();
    let changed = change(&text);
    assert_ne!(text, changed, "{file}");
    std::fs::write(path, changed).unwrap();
}
